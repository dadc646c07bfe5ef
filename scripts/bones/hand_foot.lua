-- hand_foot - metacarpal, phalanx, patella, and the hand and the foot as one piece each.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve, both = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve,
  kit.both
local shape, vec3 = sinew.shape, sinew.vec3

-- ---- single bones; z towards the palm ----

local metacarpal = blend(4, shape.box({0, -5, 0}, {7.5, 5, 7.5}, 3), tube{{0, -6, 0, 6.5}, {0, -16, -1, 4.8},
  {0, -32, -2, 4.2}, {0, -46, -1, 4.8}, {0, -58, 0, 6}},
                         egg({0, -61, 0.5}, {6.4, 7, 7.5}))
metacarpal = blend(2, metacarpal, both(ball(5.5, -58, -2.5, 2.5)), both(ball(3.4, -60, 6, 2.6)))
metacarpal = carve(2, metacarpal, {egg({0, 3, 0}, {6, 4, 12})})
kit.bone{
  name = "metacarpal", about = "origin at the base, z towards the palm", kind = "cylinder", shape = metacarpal,
    cell = 1.9, faces = 1000,
  symmetric = true, from = {0, 0, 0}, to = {0, -61, 0},
  landmarks = {{"base_side", 8, -5, 0, 4, pair = true}, {"shaft_side", 5, -30, -1, 5, pair = true},
    {"head_side", 7, -60, -1, 3, pair = true},
    {"base_palmar", 0, -6, 8, 4}, {"base_dorsal", 0, -6, -8, 4}, {"shaft_palmar", 0, -32, 3, 5},
      {"shaft_dorsal", 0, -32, -6, 5},
    {"head", 0, -68, 1, 4}, {"head_palmar", 0, -61, 8, 4}, {"head_dorsal", 0, -60, -7, 4}},
  joints = {{"carpometacarpal", 0, 0, 0}, {"metacarpophalangeal", 0, -61, 0}}}

local phalanx = blend(3, egg({0, -4, 0}, {8, 4.6, 6.2}), tube{{0, -5, 0, 5.4}, {0, -13, -1, 4}, {0, -24, -1.2, 3.6},
  {0, -34, 0, 4}},
                      both(egg({3, -38.5, 0.3}, {3.2, 4.4, 4.4})))
phalanx = carve(1.6, phalanx, {egg({0, 2.4, 0}, {6.5, 4, 5.5})})
kit.bone{
  name = "phalanx", about = "proximal, of a finger; origin at the base, z towards the palm", kind = "cylinder",
    shape = phalanx, cell = 1.5, faces = 800,
  symmetric = true, from = {0, 0, 0}, to = {0, -38.5, 0},
  landmarks = {{"base_side", 8, -4, 0, 3, pair = true}, {"shaft_side", 4, -22, -1, 4, pair = true},
    {"base_palmar", 0, -5, 6, 3}, {"base_dorsal", 0, -5, -6, 3},
    {"shaft_palmar", 0, -22, 2.5, 4}, {"shaft_dorsal", 0, -22, -5, 4}, {"head", 0, -42, 0, 3}},
  joints = {{"proximal", 0, 0, 0}, {"distal", 0, -38.5, 0}}}

-- ---- patella: origin in its middle ----

local patella = blend(6, egg({0, 5, 0}, {21, 17, 9}), chain{{0, -6, 0, 9}, {0, -18, -1, 4.5}}, egg({1, 2, -4},
  {19, 15, 7}))
patella = carve(3, patella, {egg({-13, 4, -19}, {15, 17, 12}, {0, 1, 0}, -14), egg({14, 4, -19}, {15, 17, 12},
  {0, 1, 0}, 10)})
kit.bone{
  name = "patella", about = "left; origin in its middle", kind = "shape", shape = patella, cell = 2.2, faces = 900,
  landmarks = {{"base", 0, 22, 0, 7}, {"base_posterior", 0, 19, -6, 5}, {"apex", 0, -22, -1, 4},
    {"anterior", 0, 2, 9, 8},
    {"medial_border", -20, 4, 0, 6}, {"lateral_border", 20, 4, 0, 6}, {"facet_medial", -9, 4, -8, 5},
      {"facet_lateral", 9, 4, -8, 5}},
  joints = {{"patellofemoral", 0, 0, -10}},
  cage = {cell = 36, shape = shape.box({0, 0, -8}, {66, 68, 46}, 22)},
  skin = {cell = 7, shape = blend(20, chain{{0, -120, -44, 50}, {0, 120, -44, 56}}, egg({0, 0, -10}, {34, 36, 24})),
          planes = {{{0, 0, -28}, {0, 0, 1}}, {{0, 46, 0}, {0, -1, 0}}, {{0, -46, 0}, {0, 1, 0}}}}}

-- ---- a ray of the hand or foot: its bones in a row, waisted, with joints that swell and leave a groove ----

-- nodes: {x, y, z, r} of the joints; r is that of the shaft. wide: the joints' radius is r times that.
local function ray(nodes, wide)
  local parts, grooves = {}, {}
  for i = 1, #nodes - 1 do
    local a, b = nodes[i], nodes[i + 1]
    local p, q = vec3(a[1], a[2], a[3]), vec3(b[1], b[2], b[3])
    local l = (q - p):length()
    local function at(t, r)
      local x = p + (q - p) * t
      return {x.x, x.y, x.z, r}
    end
    local last = i == #nodes - 1
    parts[#parts + 1] = kit.tube({at(math.min(0.1, 3 / l), a[4] * wide), at(0.3, a[4] * 1.05), at(0.55, a[4]),
                                  at(last and 0.85 or 0.78, last and b[4] * 0.9 or a[4]),
                                    at(last and 0.97 or 0.93, last and b[4] or a[4] * wide)}, 3)
    if i > 1 then
      local n = (q - p):unit()
      grooves[#grooves + 1] = shape.torus({a[1], a[2], a[3]}, n, a[4] * wide * 1.28, a[4] * 0.36)
    end
  end
  return carve(1, blend(2.5, parts), grooves)
end

-- ---- hand: origin in the middle of the wrist; the palm to the front, the thumb outwards ----

local carpals = {
  -- scaphoid, lunate, triquetrum, pisiform
  egg({13, -9, 1}, {9, 8, 8}), egg({0, -7, 0}, {8, 8, 8}), egg({-11, -9, -2}, {7.5, 7, 7}), egg({-13, -9, 8},
    {5, 6, 5}),
  -- trapezium to hamate
  egg({18, -21, 3}, {8, 7.5, 8}), egg({9, -21, -1}, {6.5, 7, 8}), egg({-1, -20, 0},
    {7, 10, 8.5}), egg({-12, -21, 0}, {8, 8.5, 8})}
local rays = {
  ray({{21, -29, 5, 5}, {40, -60, 14, 4.6}, {51, -86, 18, 4}, {58, -110, 20, 3.4}}, 1.42),
  ray({{13, -30, -1, 4.6}, {22, -94, 0, 4.2}, {25, -134, 2, 3.6}, {27, -159, 4, 3.2}, {28, -179, 5, 2.8}}, 1.45),
  ray({{1, -30, -1, 4.6}, {2, -95, 0, 4.2}, {2, -139, 2, 3.6}, {2, -168, 4, 3.2}, {2, -189, 5, 2.8}}, 1.45),
  ray({{-9, -30, -1, 4.2}, {-16, -88, 0, 4}, {-18, -129, 2, 3.4}, {-19, -156, 4, 3.1}, {-20, -177, 5, 2.7}}, 1.45),
  ray({{-17, -29, 0, 4}, {-32, -80, 0, 3.8}, {-37, -112, 2, 3.2}, {-40, -131, 4, 2.9}, {-42, -149, 5, 2.5}}, 1.45)}
local hand = blend(2.5, blend(2, carpals), chain{{-11, -19, 6, 3}, {-11, -20, 12, 2.8}}, table.unpack(rays))
local sleeve = {kit.tube{{0, 40, 0, 30}, {0, 0, 0, 27}, {2, -40, 1, 32}, {2, -80, 1, 38},
  {2, -92, 1, 38}}:transform{scale = {1.15, 1, 0.62}}}
for _, d in ipairs{{{20, -85, 0}, {26, -134, 3}, {29, -184, 6}}, {{2, -85, 0}, {2, -139, 3}, {2, -194, 6}},
  {{-15, -80, 0}, {-18, -129, 3}, {-21, -182, 6}},
                   {{-30, -72, 0}, {-37, -112, 3}, {-43, -154, 6}}, {{26, -35, 6}, {42, -66, 14}, {59, -115, 20}}} do
  sleeve[#sleeve + 1] = tube{{d[1][1], d[1][2], d[1][3], 13.5}, {d[2][1], d[2][2], d[2][3], 11},
    {d[3][1], d[3][2], d[3][3], 9}}
end
kit.bone{
  name = "hand", about = "left, the palm to the front; origin in the middle of the wrist", kind = "shape",
    shape = hand, cell = 2.4, faces = 4200,
  landmarks = {
    {"pisiform", -14, -9, 14, 4}, {"hook_of_hamate", -11, -20, 16, 4}, {"scaphoid_tubercle", 14, -10, 10, 4},
      {"trapezium", 20, -21, 12, 4}, {"capitate", 0, -20, 9, 4},
    {"triquetrum_dorsal", -11, -9, -9, 4}, {"metacarpal_1_base", 27, -32, 6, 4},
      {"metacarpal_1_lateral", 35, -45, 10, 5}, {"metacarpal_2_base_dorsal", 13, -33, -8, 4},
      {"metacarpal_2_base_palmar", 14, -33, 6, 4},
    {"metacarpal_3_base_dorsal", 1, -33, -8, 4}, {"metacarpal_3_base_palmar", 1, -33, 6, 4},
      {"metacarpal_3_palmar", 1, -60, 4, 6}, {"metacarpal_5_base", -22, -32, 0, 4},
      {"metacarpal_5_medial", -29, -58, 0, 5},
    {"thumb_proximal_base", 42, -62, 20, 4}, {"thumb_proximal_medial", 38, -65, 14, 4},
      {"thumb_distal_base", 52, -88, 22, 3}, {"thumb_distal_dorsal", 52, -90, 13, 3},
    {"finger_2_proximal_base", 22, -97, -6, 4}, {"finger_3_proximal_base", 2, -98, -6, 4},
      {"finger_4_proximal_base", -16, -91, -6, 4}, {"finger_5_proximal_base", -37, -83, 1, 4},
    {"finger_2_middle_palmar", 26, -145, 6, 3}, {"finger_3_middle_palmar", 2, -152, 7, 3},
      {"finger_4_middle_palmar", -18, -141, 7, 3}, {"finger_5_middle_palmar", -38, -121, 6, 3},
    {"finger_2_middle_dorsal", 26, -140, -1, 3}, {"finger_3_middle_dorsal", 2, -145, -1, 3},
      {"finger_4_middle_dorsal", -18, -135, -1, 3}, {"finger_5_middle_dorsal", -38, -117, 0, 3},
    {"finger_2_distal_palmar", 28, -168, 8, 3}, {"finger_3_distal_palmar", 2, -177, 8, 3},
      {"finger_4_distal_palmar", -19, -165, 8, 3}, {"finger_5_distal_palmar", -41, -139, 8, 3}},
  joints = {{"wrist_center", 0, 0, 0}, {"thumb_cmc", 20, -28, 4}, {"mcp_2", 22, -94, 0}, {"mcp_3", 2, -95, 0},
    {"mcp_4", -16, -88, 0}, {"mcp_5", -32, -80, 0}},
  cage = {cell = 62, shape = blend(30, egg({2, -85, 4}, {98, 155, 68}), egg({30, -75, 12}, {72, 85, 58}))},
  skin = {cell = 10.5, shape = blend(6, sleeve), planes = {{{0, 2, 0}, {0, -1, 0}}}}}

-- ---- foot: origin in the middle of the ankle; toes to the front, the great toe inwards ----

local talus = blend(6, carve(4, egg({0, -10, 0},
  {15.5, 16, 20}), {both(ball(31, -10, 0, 17))}), chain{{-1, -22, -6, 13}, {2, -22, 4, 13}},
  chain{{-1, -16, 10, 11}, {-4, -19, 24, 10.5}}, egg({-5, -21, 27}, {12.5, 11, 8}), chain{{8, -17, -2, 8},
    {14, -20, -2, 4.5}}, chain{{-2, -20, -14, 6}, {-2, -21, -20, 4}})
local calcaneus = blend(8, tube{{2, -46, -48, 13}, {1, -41, -32, 12}, {2, -36, -8, 14}, {6, -38, 12, 13},
  {9, -42, 26, 11}}, egg({2, -50, -47}, {14, 15, 12}),
                        -- sustentaculum
                        chain{{-2, -60, -45, 6}, {6, -59, -44, 5.5}}, chain{{-4, -33, 4, 9}, {-13, -31, 6, 6.5}})
-- navicular, cuboid
local tarsals = {egg({-9, -23, 37}, {15, 11.5, 8}), ball(-23, -27, 36, 6), egg({10, -44, 40}, {11, 9.5, 13}),
  -- cuneiforms
  egg({-20, -32, 52}, {7.5, 12, 11}), egg({-8, -28, 50}, {7, 10, 9}), egg({2, -33, 51}, {7, 10, 10})}
local toes = {
  ray({{-21, -35, 62, 7.4}, {-29, -58, 118, 6.4}, {-26, -63, 150, 5}, {-25, -65, 175, 4.5}}, 1.36),
  ray({{-9, -30, 60, 4.5}, {-10, -57, 126, 3.7}, {-9, -57, 152, 3.2}, {-9, -64, 168, 3}, {-9, -66, 180, 2.8}}, 1.5),
  ray({{1, -34, 60, 4.3}, {6, -59, 122, 3.6}, {8, -59, 146, 3.1}, {9, -65, 160, 2.9}, {9.5, -67, 171, 2.7}}, 1.5),
  ray({{10, -40, 55, 4.3}, {20, -61, 114, 3.5}, {24, -61, 136, 3}, {25, -66, 149, 2.8}, {26, -67, 159, 2.6}}, 1.5),
  ray({{19, -48, 49, 4.4}, {33, -63, 104, 3.5}, {37, -63, 123, 3}, {38, -67, 135, 2.8}, {39, -68, 144, 2.6}}, 1.5)}
local foot = blend(3, blend(2.5, talus, calcaneus), blend(2.5, tarsals), chain{{19, -49, 50, 5.5},
  {26, -52, 42, 3.6}}, ball(-34, -65, 116, 4), ball(-24, -65, 116, 4), table.unpack(toes))
-- sinus of the tarsus
foot = carve(3, foot, {chain{{14, -27, 14, 5}, {28, -27, 16, 7}}, chain{{8, -30, -24, 3.5}, {24, -30, -20, 5}}})
local sock = blend(26, chain{{0, 70, -8, 44}, {0, 0, -6, 42}, {0, -12, -4, 42}}, chain{{2, -44, -50, 30},
  {0, -40, 0, 36}}, tube{{0, -30, 20, 40}, {-2, -42, 60, 36}, {0, -54, 105, 31}},
                   kit.net(22.5, {{{-30, -56, 115}, {0, -57, 118}, {32, -60, 105}}, {{-25, -61, 164}, {2, -60, 160},
                     {32, -63, 128}}}))
kit.bone{
  name = "foot", about = "left; origin in the middle of the ankle", kind = "shape", shape = foot, cell = 2.7,
    faces = 4600,
  landmarks = {
    {"calcaneal_tuberosity", 2, -46, -62, 8}, {"calcaneal_tuberosity_upper", 2, -33, -56, 6},
      {"calcaneus_plantar", 2, -65, -46, 8}, {"calcaneus_plantar_medial", -8, -62, -46, 6},
    {"calcaneus_plantar_lateral", 10, -62, -44, 6}, {"calcaneus_anterior", 8, -30, 16, 6},
      {"calcaneus_lateral", 16, -42, -8, 6}, {"sustentaculum", -18, -31, 4, 5}, {"talar_dome", 0, 5, 0, 7},
    {"navicular_tuberosity", -29, -28, 37, 5}, {"medial_cuneiform", -27, -33, 54, 5},
      {"medial_cuneiform_plantar", -20, -44, 54, 5}, {"cuboid", 12, -54, 42, 5}, {"cuboid_groove", 20, -48, 40, 4},
    {"metatarsal_1_base", -26, -42, 66, 5}, {"metatarsal_1_base_plantar", -21, -45, 66, 5},
      {"metatarsal_1_head", -30, -66, 118, 5}, {"metatarsal_3_plantar", 4, -46, 85, 6},
    {"metatarsal_5_base", 30, -53, 42, 4}, {"metatarsal_5_base_dorsal", 22, -43, 54, 4},
      {"metatarsal_5_head", 38, -64, 103, 4},
    {"toe_1_proximal_base", -27, -70, 124, 4}, {"toe_1_proximal_medial", -36, -60, 122, 4},
      {"toe_1_distal_plantar", -26, -70, 156, 4}, {"toe_1_distal_dorsal", -26, -57, 154, 4},
    {"toe_2_middle_dorsal", -9, -54, 156, 3}, {"toe_3_middle_dorsal", 8, -56, 150, 3},
      {"toe_4_middle_dorsal", 24, -58, 140, 3}, {"toe_5_proximal_base", 38, -63, 108, 3},
    {"toe_5_middle_dorsal", 37, -60, 126, 3}, {"toe_2_distal_plantar", -9, -69, 171, 3},
      {"toe_3_distal_plantar", 9, -69, 163, 3}, {"toe_4_distal_plantar", 25, -70, 152, 3},
      {"toe_5_distal_plantar", 38, -70, 138, 3}},
  joints = {{"ankle_center", 0, 0, 0}, {"subtalar", 0, -25, 0}, {"mtp_1", -29, -58, 118}, {"mtp_2", -10, -57, 126},
    {"mtp_5", 33, -63, 104}},
  cage = {cell = 66, shape = blend(40, egg({0, -42, 55}, {92, 78, 178}), egg({0, 0, -12}, {88, 100, 92}))},
  skin = {cell = 12, shape = sock, planes = {{{0, 26, 0}, {0, -1, 0}}}}}
