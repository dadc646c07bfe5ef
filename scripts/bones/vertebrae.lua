-- vertebrae - cervical, thoracic, lumbar and caudal: one of each, typical of its region. Origin: the
-- centre of the body; y along the spine towards the head, z to the front (of a quadruped: down).
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve, both = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve,
  kit.both
local shape = sinew.shape

-- A body with a waist: radii rx, rz, h half as high.
local function body(rx, h, rz)
  local round = shape.smooth_subtract(4, kit.disc({0, 0, 0}, rx, h, rx, 1.6), shape.torus({0, 0, 0}, {0, 1, 0},
    rx + h * 0.95, h * 1.05))
  return round:transform{scale = {1, 1, rz / rx}}
end

-- ---- lumbar ----

local canal = blend(6, both(chain{{6, -60, -23, 5.5}, {6, 60, -23, 5.5}}), chain{{0, -60, -26, 6.5}, {0, 60, -26, 6.5}})
local arch = blend(5,
  both(chain{{13, 5, -10, 7}, {14, 4, -24, 6.5}}),                                                  -- pedicles
  -- laminae
  both(kit.net(4, {{{15, 5, -27}, {10, 6, -34}, {0, 4, -40}}, {{13, -14, -30}, {8, -15, -36}, {0, -13, -41}}})))
arch = blend(4, arch, kit.net(3, {{{0, 2, -38}, {0, -2, -55}, {0, -4, -70}},
                                  {{0, -8, -40}, {0, -9, -55}, {0, -11, -70}},
                                  {{0, -14, -42}, {0, -17, -55}, {0, -18, -68}}}),
             chain{{0, -4, -69, 4}, {0, -18, -67, 4.6}},                                            -- spinous process
             both(tube{{15, 4, -24, 5.5}, {30, 5, -30, 4}, {44, 6, -33, 4}}),                       -- transverse
             -- upper joints, mamillary
             both(chain{{17, 4, -28, 6}, {20.5, 13, -30, 5}, {21, 16, -31, 4.4}}), both(ball(23, 11, -35, 4)),
             both(chain{{10, -10, -35, 5.5}, {9.5, -17, -38.5, 4.4}}))                              -- lower joints
-- room for the lower joints of the next one, which reach down between the upper ones
arch = carve(2, arch, {both(egg({9.5, 18, -39.5}, {7.5, 10.5, 8}))})
local lumbar = blend(4, carve(3, arch, {canal}), body(24, 13.5, 17))
kit.bone{
  name = "lumbar", about = "third lumbar vertebra; origin in the centre of the body", kind = "curve",
  shape = lumbar, cell = 2.6, faces = 2400, symmetric = true, length = 37,
  landmarks = {
    {"transverse", 48, 6, -34, 4, pair = true}, {"mamillary", 25.5, 12, -38, 4, pair = true},
      {"lamina", 10, -5, -40, 5, pair = true},
    {"body_lateral", 22, 0, 0, 7, pair = true}, {"pedicle", 20, 7, -16, 4, pair = true},
      {"facet_upper", 17, 15, -33, 4, pair = true},
    {"facet_lower", 13, -17, -38, 4, pair = true}, {"spinous_lateral", 4, -9, -55, 6, pair = true},
    {"spinous", 0, -11, -74, 6}, {"spinous_upper", 0, 0, -60, 4}, {"spinous_lower", 0, -21, -58, 4},
      {"body_anterior", 0, 0, 16, 8}},
  joints = {{"disc_upper", 0, 18.5, 0}, {"disc_lower", 0, -18.5, 0}}}

-- ---- thoracic ----

canal = chain{{0, -60, -20, 7.5}, {0, 60, -20, 7.5}}
arch = blend(4,
  both(chain{{9, 4, -8, 5}, {10, 4, -20, 5}}),
  both(kit.net(2.6, {{{10, 4, -22}, {7, 4, -27}, {0, 3, -31}}, {{9, -7, -25}, {6, -8, -29}, {0, -8, -33}}})))
arch = blend(4, arch, tube{{0, -2, -31, 4.5}, {0, -8, -42, 3.6}, {0, -17, -53, 3.2}, {0, -24, -60, 3.4}},
             kit.net(2.2, {{{0, 3, -31}, {0, -7, -46}, {0, -18, -57}}, {{0, -9, -33}, {0, -17, -46}, {0, -25, -57}}}),
             both(tube{{10, 3, -21, 5}, {20, 6, -29, 4.2}, {30, 9, -36, 4.6}, {32, 9, -37, 5.5}}),
             -- upper joints, facing back
             both(kit.net(1.8, {{{7, 5, -23.5}, {13, 5, -22}}, {{7.5, 12.5, -24}, {12, 12.5, -22.5}}})),
             both(kit.net(1.8, {{{4, -6, -31}, {11, -6, -29}}, {{5, -12.5, -32}, {10.5, -12.5, -30.5}}})))
local thoracic = blend(3, carve(2, arch, {canal}), body(15.5, 10.3, 13.5))
-- for the ribs
thoracic = carve(2, thoracic, {both(ball(16.5, 9, -9, 3.6)), both(ball(16.5, -8.5, -8, 3)),
  both(ball(35, 9, -32, 3.6))})
kit.bone{
  name = "thoracic", about = "sixth thoracic vertebra; origin in the centre of the body", kind = "curve",
  shape = thoracic, cell = 2.1, faces = 2400, symmetric = true, length = 25,
  landmarks = {
    {"transverse", 34, 10, -42, 4, pair = true}, {"lamina", 6, -4, -32, 4, pair = true},
      {"body_lateral", 14, 0, 2, 5, pair = true},
    {"rib_facet", 14, 8, -8, 3, pair = true}, {"transverse_facet", 34, 9, -34, 3, pair = true},
      {"spinous_lateral", 3, -13, -48, 4, pair = true},
    {"spinous", 0, -25, -64, 4}, {"spinous_upper", 0, 0, -38, 3}, {"body_anterior", 0, 0, 12, 6}},
  joints = {{"disc_upper", 0, 12.5, 0}, {"disc_lower", 0, -12.5, 0}, {"costovertebral", 16, 8, -8, pair = true}}}

-- ---- cervical ----

canal = blend(4, both(chain{{5, -60, -14.5, 5.5}, {5, 60, -14.5, 5.5}}), chain{{0, -60, -17, 6.5}, {0, 60, -17, 6.5}})
arch = blend(3,
  both(chain{{9, 1, -6, 3.6}, {16, 1, -12, 4.6}}),
  both(tube{{16, 0, -13, 5}, {12, -1, -22, 3.4}, {5, -3, -28, 3.4}, {0, -4, -30, 3.6}}),
  both(kit.net(2.2, {{{15, 3, -15}, {7, 3, -26}, {0, 2, -28}}, {{14, -2.5, -17}, {6, -3.5, -27}, {0, -5, -30}}})))
-- the pillar of the joints: cut off at both ends along the joints, which rise to the front
local pillar = shape.intersect(chain{{19, 30, -14, 5.4}, {19, -30, -14, 5.4}},
  shape.box({0, 0, 0}, {60, 6.2, 60}, 1):transform{rotate = {axis = {1, 0, 0}, degrees = -33}, translate = {0, 0, -14}})
-- spinous process, split
arch = blend(2.5, arch, both(tube{{0, -4, -30, 4}, {1.5, -6, -38, 3.4}, {5, -9, -44, 3}}),
             both(pillar),
             -- foramen of the artery
             both(shape.torus({16.5, 0, -2}, {0, 1, 0.15}, 5, 2.3)),
             both(chain{{15, -1, 3, 2.6}, {23, -2.5, 4, 3}}), both(chain{{17, -1, -7, 2.6}, {26, -3, -4, 3}}))
local cervical = blend(2, carve(2, arch, {canal}), body(12, 6.5, 8.5), both(chain{{10.5, 5, -4, 2.4},
  {11, 7.5, 2, 1.9}}))
cervical = carve(1, cervical, {both(chain{{16.5, -12, -3.8, 2.7}, {16.5, 12, -0.2, 2.7}})})
kit.bone{
  name = "cervical", about = "fifth cervical vertebra; origin in the centre of the body", kind = "curve",
  shape = cervical, cell = 1.5, faces = 2600, symmetric = true, length = 17,
  landmarks = {
    {"transverse", 28, -3, -3, 3, pair = true}, {"transverse_anterior", 25, -3, 6, 3, pair = true},
      {"articular", 23, 0, -14, 4, pair = true},
    {"lamina", 8, -3, -29, 4, pair = true}, {"body_lateral", 10, 0, 5, 3, pair = true},
      {"spinous_tip", 6, -10, -47, 3, pair = true},
    {"spinous", 0, -8, -40, 4}, {"body_anterior", 0, 0, 7, 4}},
  joints = {{"disc_upper", 0, 8.5, 0}, {"disc_lower", 0, -8.5, 0}}}

-- ---- caudal: as in the middle of a dog's tail ----

local caudal = blend(4, body(5.2, 8.6, 5), chain{{0, -7, 0, 3.6}, {0, 7, 0, 3.6}})
caudal = blend(2.5, caudal, both(chain{{4, 6, 0, 2.4}, {7.5, 6.5, -0.5, 1.8}}), both(chain{{4, -6.5, 0, 2.2},
  {6.8, -7.5, 0, 1.6}}),
               both(chain{{2.5, 6, -4, 1.8}, {3, 10, -5.5, 1.5}}), both(chain{{2, -6, -4, 1.7},
                 {2.2, -9.5, -4.8, 1.3}}),
               both(chain{{2, 7, 4, 1.6}, {2.4, 8, 6, 1.4}}), chain{{0, 2, -4, 1.6}, {0, -4, -5, 1.7}})
kit.bone{
  name = "caudal", about = "vertebra from the middle of a tail; origin in the centre of the body", kind = "curve",
  shape = caudal, cell = 1.0, faces = 900, symmetric = true, length = 21,
  landmarks = {
    {"transverse", 9, 7, -0.5, 2, pair = true}, {"transverse_lower", 8, -8, 0, 2, pair = true},
      {"mamillary", 3, 11, -6, 2, pair = true},
    {"body_lateral", 4, 0, 0, 2, pair = true}, {"hemal", 2.5, 8, 7, 2, pair = true}, {"spinous", 0, -3, -7, 2},
      {"body_anterior", 0, 0, 4, 2}},
  joints = {{"disc_upper", 0, 10.5, 0}, {"disc_lower", 0, -10.5, 0}}}
