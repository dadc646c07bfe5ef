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
arch = blend(4, arch, kit.net(3, {{{0, 4, -38}, {0, 2, -55}, {0, 0, -70}}, {{0, -8, -40}, {0, -9, -55}, {0, -10, -70}},
                                  {{0, -17, -42}, {0, -19, -55}, {0, -20, -68}}}),
             chain{{0, 0, -69, 4.2}, {0, -21, -67, 5}},                                             -- spinous process
             both(tube{{15, 4, -24, 5.5}, {30, 5, -30, 4}, {44, 6, -33, 4}}),                       -- transverse
             -- upper joints, mamillary
             both(chain{{16, 4, -28, 6.5}, {19, 15, -31, 6}, {19, 19, -32, 5.5}}), both(ball(22, 13, -36, 4)),
             both(chain{{13, -10, -33, 6}, {13, -22, -36, 6}}))                                     -- lower joints
arch = carve(2, arch, {both(egg({12.5, 18, -36}, {5, 12, 7}))})
local lumbar = blend(4, carve(3, arch, {canal}), body(24, 13.5, 17))
kit.bone{
  name = "lumbar", about = "third lumbar vertebra; origin in the centre of the body", kind = "curve",
  shape = lumbar, cell = 2.6, faces = 2400, symmetric = true, length = 37,
  landmarks = {
    {"transverse", 48, 6, -34, 4, pair = true}, {"mamillary", 25, 14, -38, 4, pair = true},
      {"lamina", 10, -5, -40, 5, pair = true},
    {"body_lateral", 22, 0, 0, 7, pair = true}, {"pedicle", 20, 7, -16, 4, pair = true},
      {"facet_upper", 16, 18, -33, 4, pair = true},
    {"facet_lower", 18, -22, -37, 4, pair = true}, {"spinous_lateral", 4, -8, -55, 6, pair = true},
    {"spinous", 0, -10, -74, 6}, {"spinous_upper", 0, 6, -60, 4}, {"spinous_lower", 0, -24, -58, 4},
      {"body_anterior", 0, 0, 16, 8}},
  joints = {{"disc_upper", 0, 18.5, 0}, {"disc_lower", 0, -18.5, 0}}}

-- ---- thoracic ----

canal = chain{{0, -60, -20, 7.5}, {0, 60, -20, 7.5}}
arch = blend(4,
  both(chain{{9, 4, -8, 5}, {10, 4, -20, 5}}),
  both(kit.net(3, {{{10, 5, -22}, {7, 6, -27}, {0, 5, -31}}, {{9, -9, -25}, {6, -10, -29}, {0, -10, -33}}})))
arch = blend(4, arch, tube{{0, -2, -31, 5}, {0, -10, -42, 4}, {0, -24, -54, 3.5}, {0, -34, -60, 3.6}},
             kit.net(2.2, {{{0, 4, -31}, {0, -10, -46}, {0, -26, -57}}, {{0, -12, -33}, {0, -24, -46}, {0, -35, -57}}}),
             both(tube{{10, 3, -21, 5}, {20, 6, -29, 4.2}, {30, 9, -36, 4.6}, {32, 9, -37, 5.5}}),
             -- upper joints, facing back
             both(kit.net(2.6, {{{6, 6, -25}, {12, 6, -23}}, {{6, 14, -26}, {11, 14, -24}}})),
             both(kit.net(2.6, {{{4, -8, -30}, {11, -8, -27}}, {{5, -15, -31}, {10, -15, -29}}})))
local thoracic = blend(3, carve(2, arch, {canal}), body(15.5, 9.5, 13.5))
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
      {"spinous_lateral", 3, -18, -48, 4, pair = true},
    {"spinous", 0, -36, -63, 4}, {"spinous_upper", 0, 0, -38, 3}, {"body_anterior", 0, 0, 12, 6}},
  joints = {{"disc_upper", 0, 12.5, 0}, {"disc_lower", 0, -12.5, 0}, {"costovertebral", 16, 8, -8, pair = true}}}

-- ---- cervical ----

canal = blend(4, both(chain{{5, -60, -14.5, 5.5}, {5, 60, -14.5, 5.5}}), chain{{0, -60, -17, 6.5}, {0, 60, -17, 6.5}})
arch = blend(3,
  both(chain{{9, 1, -6, 3.6}, {16, 1, -12, 4.6}}),
  both(tube{{16, 0, -13, 5}, {12, -1, -22, 3.4}, {5, -3, -28, 3.4}, {0, -4, -30, 3.6}}),
  both(kit.net(2.2, {{{15, 4, -15}, {7, 4, -26}, {0, 3, -28}}, {{14, -5, -17}, {6, -7, -27}, {0, -8, -30}}})))
-- spinous process, split
arch = blend(2.5, arch, both(tube{{0, -4, -30, 4}, {1.5, -6, -38, 3.4}, {5, -9, -44, 3}}),
             both(chain{{19, 7, -11, 4.6}, {19, -7, -17, 4.8}}),                                    -- joints
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
