-- skull - with the mandible, teeth closed. Origin: half way between the ear canals.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local egg, chain, tube, blend, carve, both = kit.egg, kit.chain, kit.tube, kit.blend, kit.carve,
  kit.both
local shape = sinew.shape

local cranium = blend(30,
  egg({0, 58, -14}, {66, 60, 78}), egg({0, 36, -48}, {56, 42, 44}), egg({0, 58, 40},
    {49, 46, 46}), egg({0, 14, -20}, {54, 24, 58}))
cranium = blend(14, cranium, both(egg({22, -6, -30}, {24, 14, 40})))                              -- base, behind
cranium = carve(14, cranium, {both(egg({66, 20, 46}, {14, 28, 26}))})                             -- temples
local base = blend(10, egg({0, 0, 35}, {38, 22, 50}), egg({0, -6, 62}, {32, 34, 22}))
local brow = blend(8, both(tube{{4, 37, 84, 6.5}, {22, 42, 81, 5.8}, {39, 40, 73, 5.5}, {50, 31, 61, 5.2}}))
local cheek = blend(7,
  both(tube{{51, 31, 62, 5.5}, {51, 18, 60, 5.5}, {50, 6, 62, 8}, {40, -2, 70, 9}, {26, 2, 78, 6}}),   -- orbit's rim
  -- zygomatic arch
  both(tube{{50, 4, 62, 8}, {58, -1, 50, 6}, {63, -1, 32, 4.4}, {62.5, 0, 15, 4.4}, {55, 3, 0, 6}}),
  both(tube{{46, -4, 62, 9}, {34, -18, 62, 8}, {27, -34, 58, 7}}))
local maxilla = blend(9, both(egg({20, -14, 66}, {18, 22, 20})), both(egg({20, -32, 62}, {12, 10, 22}, {0, 1, 0}, 18)),
                      egg({0, -32, 78}, {17, 10, 11}))
local nose = blend(6, tube{{0, 34, 85, 7}, {0, 24, 88, 6}, {0, 14, 93, 5}}, both(tube{{9, 32, 82, 5},
  {11, 14, 84, 5}, {14, 0, 84, 5}, {15, -16, 84, 5}}))
local spine = chain{{0, -21, 86, 4}, {0, -22, 93, 2.5}}
local function arch(y, r, dz)                                                                     -- a row of teeth
  local half = {{0, y, 86 + dz, r}, {9, y, 84 + dz, r}, {18, y, 77 + dz, r}, {23, y, 66 + dz, r},
    {26, y, 52 + dz, r}, {27, y, 42 + dz, r}}
  return both(tube(half))
end
local upper = blend(3, cranium, base)
upper = blend(8, upper, brow, cheek, maxilla, nose)
upper = carve(4, upper, {
  both(kit.chain{{35, 20, 84, 19.5}, {28, 20, 60, 14}, {17, 19, 40, 5}}),                         -- orbits
  both(chain{{46, 20, 82, 10}, {42, 19, 70, 9}}),
  both(egg({5, -8, 88}, {7, 10, 18})), egg({0, 3, 88}, {7, 12, 16}),                              -- nasal opening
  both(egg({22, 3, 88}, {3, 3, 4}))})
upper = blend(2, upper, chain{{0, 8, 78, 2}, {0, -18, 78, 2.4}}, spine)                           -- septum
upper = blend(5, upper, both(tube{{55, -2, -12, 9}, {54, -18, -10, 9.5}, {51, -31, -6, 6}}),       -- mastoid process
  both(egg({13, -19, -14}, {7, 6, 11}, {0, 1, 0}, -25)),                                         -- occipital condyle
  both(tube{{0, 20, -89, 5}, {14, 20, -86, 3.5}, {30, 19, -77, 3.2}, {46, 12, -54, 3}}))   -- nuchal line
upper = blend(3, upper, both(kit.fan(2.6, {21, 2, 38}, {{18, -30, 34}, {20, -32, 42}, {23, -26, 48}})))   -- pterygoid
-- foramen magnum, ear
upper = carve(3, upper, {egg({0, -22, -34}, {14, 15, 17}), both(chain{{72, 0, -1, 4}, {58, 0, -1, 4}})})
local teeth = blend(2, arch(-42, 5, 0), arch(-48, 4.5, -1), arch(-54, 5, -2))
teeth = carve(1.5, teeth, {arch(-48.5, 1.6, 5.5)})
local jaw = blend(9,
  both(tube{{0, -71, 81, 8.5}, {14, -70, 76.5, 8.5}, {28, -67.5, 60, 8.2}, {40, -65, 40, 7.8}, {49, -62, 20, 7}}),
  both(kit.net(4, {{{50, -52, 6}, {50, -58, 16}, {48, -56, 34}}, {{52, -24, 4}, {51, -24, 18}, {50, -26, 32}},
                   {{53, -12, 4}, {52, -16, 16}, {50, -8, 30}}})),
  egg({0, -77, 83}, {17, 6.5, 7.5}))
-- condyle
jaw = blend(5, jaw, both(chain{{53, -14, 4, 5}, {53, -5, 5, 5}}), both(chain{{48, -5, 7, 4}, {56, -5, 4, 4.2}}),
  both(tube{{50, -12, 28, 4}, {50, -2, 31, 3.6}, {50, 3, 29, 2.6}}), both(tube{{48, -64, 20, 6}, {51, -56, 4, 6},
    {52, -36, 1, 4.5}}),
  both(tube{{30, -58, 46, 6}, {24, -59, 60, 6.5}, {11, -60, 77, 6.5}, {0, -60, 80, 6.5}}))
jaw = carve(5, jaw, {both(egg({51, -5, 17}, {12, 9, 7}))})                                        -- mandibular notch
local bone = blend(4, upper, teeth)
bone = blend(4, bone, jaw)

kit.bone{
  name = "skull", about = "with the mandible; origin half way between the ear canals", kind = "shape",
  shape = bone, cell = 4.2, faces = 5200, symmetric = true,
  landmarks = {
    {"mastoid", 54, -32, -7, 7, pair = true}, {"mastoid_base", 60, -10, -16, 7, pair = true},
    {"temporal_fossa", 57, 40, 26, 18, pair = true}, {"temporal_line", 62, 70, 10, 14, pair = true},
    {"zygoma", 52, -4, 68, 7, pair = true}, {"zygomatic_arch", 66, -4, 28, 6, pair = true},
    {"jaw_angle", 54, -56, 6, 8, pair = true}, {"jaw_ramus", 56, -40, 16, 10, pair = true},
      {"coronoid_process", 50, 5, 29, 4, pair = true},
    {"jaw_condyle", 54, -2, 5, 4, pair = true}, {"jaw_body", 42, -68, 40, 8, pair = true},
      {"pterygoid", 20, -24, 38, 6, pair = true},
    {"jaw_angle_medial", 46, -52, 10, 7, pair = true}, {"nuchal_line", 40, 18, -72, 10, pair = true},
    {"nuchal_line_lower", 24, -2, -74, 10, pair = true}, {"occipital_condyle", 14, -24, -12, 6, pair = true},
    {"orbit_lateral", 56, 22, 60, 5, pair = true}, {"maxilla", 26, -20, 82, 7, pair = true},
      {"jugular_process", 34, -18, -22, 6, pair = true},
    {"ear", 66, 2, 0, 5, pair = true}, {"occiput", 0, 19, -99, 7}, {"basilar", 0, -20, 6, 6}, {"chin", 0, -80, 92, 7},
    {"chin_inner", 0, -80, 71, 6}, {"forehead", 0, 66, 84, 12}, {"glabella", 0, 38, 94, 5}, {"vertex", 0, 116, -14, 12},
    {"nasal_bone", 0, 18, 98, 4}, {"nuchal_plane", 0, 0, -84, 9}},
  joints = {{"atlanto_occipital", 0, -26, -14}, {"jaw", 53, -3, 4, pair = true}, {"eye", 33, 20, 74, pair = true}},
  cage = {cell = 84, shape = blend(60, egg({0, 40, -12}, {124, 120, 148}), egg({0, -60, 30}, {104, 100, 112}))},
  skin = {cell = 16,
          shape = blend(26, egg({0, 52, -12}, {79, 74, 99}), egg({0, 0, -14}, {74, 50, 62}), egg({0, 64, 40}, {60, 57, 54}),
                        egg({0, 38, 56}, {61, 36, 38}), egg({0, -46, 22}, {68, 38, 46}), egg({0, -20, 44}, {74, 72, 60}),
                        egg({0, -78, 62}, {42, 30, 45}), tube{{0, -16, -26, 63}, {0, -70, -18, 56}, {0, -140, -20, 56}},
                        tube{{0, 22, 95, 8}, {0, -10, 110, 13}}),
          planes = {{{0, -92, 0}, {0, 1, 0.3}}}}}
