-- pelvis - both hip bones with the sacrum and the coccyx. Origin: half way between the centres of the hips.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve
local vec3 = sinew.vec3

local hip, out = vec3(87, 0, 0), vec3(0.76, -0.44, 0.42):unit()
-- The wing of the ilium: rows from the brim up to the crest, front to back.
local wing = kit.net(3.6, {
  {{90, 30, 18}, {86, 34, 4}, {76, 32, -22}, {64, 36, -44}, {54, 46, -64}, {46, 54, -84}},
  {{108, 46, 30}, {106, 56, 6}, {96, 58, -24}, {80, 60, -50}, {62, 66, -72}, {48, 70, -96}},
  {{120, 66, 36}, {122, 84, 8}, {115, 90, -24}, {97, 92, -56}, {72, 92, -82}, {50, 88, -104}},
  {{124, 84, 38}, {134, 112, 12}, {130, 124, -20}, {112, 124, -54}, {82, 112, -86}, {50, 98, -108}}})
local crest = tube{{121, 74, 39, 4.5}, {124, 84, 38, 6.5}, {131, 102, 26, 6}, {135, 114, 10, 6.5}, {131, 125, -20, 6},
                   {113, 125, -54, 5.5}, {82, 113, -86, 6}, {52, 98, -108, 7}, {44, 80, -108, 6}, {44, 62, -98, 6}}
local front = tube({{121, 74, 39, 4.5}, {110, 56, 36, 5}, {101, 42, 34, 8}, {92, 24, 26, 9}})     -- with the AIIS
local pillar = blend(10, chain{{84, 24, -4, 15}, {66, 36, -42, 9}, {52, 52, -70, 11}},
                     tube{{88, 22, -6, 16}, {110, 60, -2, 6}, {130, 104, 4, 5}})
local ilium = blend(9, wing, crest, front, pillar)
local cup = carve(2, ball(87, 0, 0, 34.5), {kit.beyond(hip + out * 13, out)})
local ischium = tube{{86, -10, -22, 17}, {78, -30, -30, 14}, {68, -58, -32, 15}, {60, -76, -24, 14}}
local spine = chain{{72, -14, -40, 8}, {59, -16, -52, 3.5}}
local upper_ramus = tube{{80, 2, 22, 12}, {58, -2, 38, 8.5}, {38, -8, 45, 7.5}, {20, -14, 46, 8}, {11, -22, 43, 8}}
local lower_ramus = tube{{11, -24, 42, 8}, {13, -40, 36, 7}, {27, -60, 18, 6}, {44, -76, -4, 6.5}, {58, -82, -16, 9}}
local coxa = blend(9, ilium, cup, ischium, upper_ramus, lower_ramus)
coxa = blend(6, coxa, spine, ball(22, -7, 50, 4.5))                                               -- pubic tubercle
local socket = ball(87, 0, 0, 26)
coxa = carve(2.5, coxa, {socket, chain{{87, 0, 0, 12}, {72, -34, 16, 8}},                         -- acetabular notch
                         egg({47, -42, 14}, {20, 27, 17}, {0, 1, 0}, 40)})                        -- obturator foramen
-- Sacrum and coccyx; the surfaces that meet the ilia lie at x = 45 to 60.
local sacrum = blend(12, tube{{0, 86, -56, 21}, {0, 62, -82, 17}, {0, 38, -99, 14}, {0, 14, -107, 11},
  {0, -6, -105, 8}},
  kit.both(kit.fan(8, {0, 84, -60}, {{44, 84, -66}, {48, 66, -82}, {34, 40, -95}, {18, 6, -104}, {0, 0, -104}})))
sacrum = blend(6, sacrum, egg({0, 86, -56}, {27, 16, 18}, {1, 0, 0}, 32), kit.both(tube{{12, 84, -86, 5},
  {16, 97, -80, 4.5}, {17, 102, -78, 3.5}}))
sacrum = blend(5, sacrum, chain{{0, 84, -84, 6}, {0, 82, -94, 4}}, chain{{0, 64, -98, 7}, {0, 62, -107, 4}},
  chain{{0, 44, -110, 6}, {0, 42, -116, 4}}, chain{{0, 24, -114, 5}, {0, 22, -120, 4}}, 
  tube{{0, -6, -105, 7}, {0, -20, -98, 6}, {0, -30, -90, 5}, {0, -37, -82, 3.5}})
local holes = {sinew.shape.box({0, 0, 0}, {34, 14, 30}):transform{rotate = {axis = {1, 0, 0}, degrees = 32},
  translate = {0, 107.5, -42.5}}}
for i, p in ipairs{{19, 72, -58}, {17, 50, -79}, {15, 29, -90}, {12, 9, -95}} do
  holes[#holes + 1] = kit.both(ball(p[1], p[2], p[3], 6.5 - 0.5 * i))
end
for _, p in ipairs{{18, 70, -92}, {16, 50, -105},
  {14, 29, -114}} do holes[#holes + 1] = kit.both(ball(p[1], p[2], p[3], 5)) end
sacrum = carve(4, sacrum, holes)
local symphysis = egg({0, -25, 41}, {9, 17, 8}, {1, 0, 0}, -30)
local bone = blend(6, kit.both(coxa), sacrum, symphysis)
bone = carve(2, bone, {kit.both(socket)})

kit.bone{
  name = "pelvis", about = "both hip bones and the sacrum; origin half way between the centres of the hips",
    kind = "shape",
  shape = bone, cell = 4.6, faces = 5600, symmetric = true,
  landmarks = {
    {"asis", 128, 84, 44, 7, pair = true}, {"aiis", 103, 42, 42, 7, pair = true},
    {"iliac_crest", 135, 128, -16, 14, pair = true}, {"iliac_crest_anterior", 136, 112, 18, 10, pair = true},
    {"iliac_crest_posterior", 82, 120, -88, 12, pair = true}, {"psis", 48, 96, -115, 7, pair = true},
    {"iliac_fossa", 106, 84, -12, 18, pair = true}, {"ilium_lateral", 126, 84, -14, 18, pair = true},
    {"ilium_lateral_anterior", 122, 82, 14, 14, pair = true}, {"ilium_lateral_posterior", 92, 92, -72, 14, pair = true},
    {"ilium_lateral_lower", 108, 52, -6, 12, pair = true}, {"acetabular_rim", 100, 34, 6, 6, pair = true},
    {"ischial_spine", 56, -16, -55, 4, pair = true}, {"ischial_tuberosity", 60, -84, -34, 10, pair = true},
    {"ischial_tuberosity_lateral", 76, -66, -36, 8, pair = true}, {"ischium_lateral", 90, -28, -32, 8, pair = true},
    {"ischial_ramus", 38, -76, 2, 8, pair = true}, {"obturator_membrane_outer", 30, -22, 42, 8, pair = true},
    {"obturator_membrane_inner", 50, -62, -22, 8, pair = true}, {"pubic_ramus_superior", 38, 0, 49, 8, pair = true},
    {"pubic_body", 14, -26, 50, 8, pair = true}, {"pubic_ramus_inferior", 20, -52, 32, 8, pair = true},
    {"pubic_tubercle", 22, -4, 55, 5, pair = true}, {"iliopubic_eminence", 72, 12, 32, 6, pair = true},
    {"sacrum_lateral", 26, 30, -99, 8, pair = true}, {"sacrum_anterior", 27, 44, -98, 8, pair = true},
    {"sacrum_dorsal", 28, 58, -97, 10, pair = true}, {"sacrotuberous", 22, 6, -106, 6, pair = true},
    {"pubic_symphysis", 0, -22, 51, 7}, {"sacrum", 0, 62, -112, 10}, {"promontory", 0, 90, -36, 7},
    {"sacrum_top", 0, 96, -50, 9}, {"coccyx", 0, -39, -82, 4}, {"sacral_crest_lower", 0, 24, -124, 6}},
  joints = {{"hip_center", 87, 0, 0, pair = true}, {"lumbosacral", 0, 101, -47},
    {"sacroiliac", 52, 68, -78, pair = true}},
  cage = {cell = 110, shape = sinew.shape.box({0, 22, -30}, {215, 178, 165}, 75)},
  skin = {cell = 24, shape = blend(60, egg({0, 60, -28}, {172, 190, 130}), egg({85, -90, -30},
    {105, 120, 115}), egg({-85, -90, -30}, {105, 120, 115})),
          planes = {{{0, 138, 0}, {0, -1, 0}}, {{0, -108, 0}, {0, 1, 0}}}}}
