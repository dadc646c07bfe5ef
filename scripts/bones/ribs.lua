-- ribs - a rib alone, a pair of ribs with its piece of the sternum, the sternum and the clavicle.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve, both = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve,
  kit.both

-- A flat band along places {x, y, z, half height, half thickness} of a spline; up: the direction of its height.
local function band(nodes, up, n)
  local list, p = {}, kit.spline(nodes, n or 5)
  local function edge(q, s)
    local h = math.max(q[4] - q[5], 0.1) * s
    return {q[1] + up[1] * h, q[2] + up[2] * h, q[3] + up[3] * h}
  end
  for i = 1, #p - 1 do
    local a, b = p[i], p[i + 1]
    local r = 0.5 * (a[5] + b[5])
    list[#list + 1] = sinew.shape.plate(edge(a, -1), edge(b, -1), edge(b, 1), r)
    list[#list + 1] = sinew.shape.plate(edge(a, -1), edge(b, 1), edge(a, 1), r)
  end
  return sinew.shape.union(list)
end

-- ---- a rib in its own frame: -y from the head to the front end, x outwards, z to the head ----

local rib = blend(2, band({{2, 0, 0, 3.5, 3.5}, {8, 12, 2, 4.5, 3}, {20, 26, 2, 5.5, 3.6}, {45, 26, -1, 6.5, 4},
  {78, 0, -5, 7, 3.8}, {98, -45, -7, 7, 3.4},
  {96, -95, -5, 7, 3.2}, {72, -140, 0, 7, 3.2}, {40, -172, 2, 7, 3.4}, {6, -188, 0, 7.5, 4}}, {0, 0, 1}),
  egg({1, -1, 0}, {5, 5, 6}))
rib = blend(3, rib, egg({18, 29, 1}, {5, 4, 5}))
rib = carve(2, rib, {tube{{50, 16, -11, 3.5}, {77, -5, -15, 3.5}, {93, -46, -17, 3.5}, {91, -95, -15, 3.5}}})
kit.bone{
  name = "rib", kind = "cylinder",
  about = "left; origin at the head, -y towards the front end, x outwards, z towards the head of the body",
  shape = rib, cell = 2.7, faces = 1800, from = {0, 0, 0}, to = {0, -188, 0},
  landmarks = {
    {"head", -3, 2, 0, 4}, {"neck", 8, 14, 4, 4}, {"tubercle", 18, 33, 1, 4}, {"angle", 48, 29, -1, 7},
      {"lateral", 101, -50, -7, 8},
    {"lateral_upper", 98, -50, 0, 6}, {"lateral_lower", 97, -60, -14, 6}, {"upper_border", 80, -2, 2, 6},
      {"lower_border", 78, -4, -12, 6},
    {"anterior", 75, -143, 0, 7}, {"costal_end", 6, -192, 0, 6}, {"inner", 91, -60, -6, 7}},
  joints = {{"costovertebral", 0, 0, 0}, {"costochondral", 6, -188, 0}}}

-- ---- a pair of ribs: origin in the centre of the vertebra between them ----

local arc = {{17, 8, -9, 3.6, 3.6}, {25, 9, -20, 4.2, 3.2}, {36, 8, -29, 5, 3.6}, {62, 0, -42, 6, 4},
  {96, -14, -32, 6.3, 3.8}, {120, -30, 8, 6, 3.4},
             {124, -43, 55, 5.6, 3.1}, {106, -54, 102, 5.2, 3}, {76, -60, 134, 5, 3.3},
               {44, -57, 152, 4.8, 4}, {20, -51, 158, 4.8, 4.2}, {10, -50, 159, 4.8, 4.2}}
local pair = both(blend(2, band(arc, {0, 1, 0}), egg({17, 8, -8}, {4.5, 5, 4.5}), egg({37, 8, -32}, {5, 4.5, 4})))
pair = blend(3, pair, kit.disc({0, -50, 159}, 16, 6.2, 5.5, 1.5))
kit.bone{
  name = "rib_pair",
    about = "two ribs with their cartilage and a piece of the sternum; origin in the centre of the vertebra",
    kind = "curve",
  shape = pair, cell = 3.2, faces = 3000, symmetric = true, length = 25,
  landmarks = {
    {"head", 15, 8, -7, 4, pair = true}, {"tubercle", 38, 8, -36, 4, pair = true},
      {"angle", 64, 0, -47, 7, pair = true},
    {"posterior", 98, -14, -37, 7, pair = true}, {"lateral", 128, -42, 48, 8, pair = true},
      {"lateral_anterior", 118, -54, 90, 8, pair = true},
    {"upper_border", 122, -24, 10, 6, pair = true}, {"lower_border", 120, -38, 10, 6, pair = true},
      {"anterior", 78, -60, 138, 8, pair = true},
    {"anterior_inner", 74, -60, 130, 8, pair = true}, {"cartilage", 46, -57, 157, 7, pair = true},
      {"sternal", 12, -50, 165, 6, pair = true},
    {"inner", 116, -34, 20, 7, pair = true}, {"sternum", 0, -50, 166, 7}, {"sternum_inner", 0, -50, 152, 7}},
  joints = {{"costovertebral", 16, 8, -8, pair = true}}}

-- ---- sternum: origin in the middle of the body ----

local sternum = blend(8,
  kit.net(4.2, {{{-22, 92, -9}, {0, 86, -9}, {22, 92, -9}}, {{-30, 84, -9}, {0, 80, -8}, {30, 84, -9}},
    {{-22, 66, -4}, {0, 64, -4}, {22, 66, -4}}, {{-12, 46, 1}, {0, 46, 1}, {12, 46, 1}}}),
  kit.net(4.2, {{{-11, 44, 1}, {0, 44, 2}, {11, 44, 1}}, {{-12, 20, 1}, {0, 20, 2}, {12, 20, 1}}, {{-15, -16, 0},
    {0, -16, 0}, {15, -16, 0}},
                {{-13, -44, -2}, {0, -44, -2}, {13, -44, -2}}, {{-5, -58, -4}, {0, -58, -4}, {5, -58, -4}}}))
sternum = blend(5, sternum, chain{{-13, 46, 1.5, 5}, {13, 46, 1.5, 5}}, tube{{0, -54, -4, 5}, {0, -72, -7, 4},
  {0, -86, -6, 2.6}})
local cuts = {ball(0, 104, -9, 12), both(egg({29, 94, -9}, {9, 7, 8}, {0, 0, 1}, -35)), both(ball(35, 74, -8, 6))}
for i, y in ipairs{46, 24, 4, -15, -33, -47} do cuts[#cuts + 1] = both(ball(({20, 19, 21.5, 23, 22.5, 18})[i], y, 0,
  5.2)) end
sternum = carve(3, sternum, cuts)
kit.bone{
  name = "sternum", about = "with manubrium and xiphoid process; origin in the middle of the body", kind = "shape",
  shape = sternum, cell = 2.8, faces = 2200, symmetric = true,
  landmarks = {
    {"clavicular_notch", 27, 88, -9, 5, pair = true}, {"manubrium_anterior", 18, 78, -2, 7, pair = true},
      {"manubrium_posterior", 18, 78, -12, 7, pair = true},
    {"first_costal_notch", 29, 74, -8, 4, pair = true}, {"body_anterior_upper", 8, 24, 6, 6, pair = true},
      {"body_anterior", 10, 0, 5, 7, pair = true},
    {"body_anterior_lower", 10, -34, 3, 6, pair = true}, {"body_posterior", 8, -20, -5, 7, pair = true},
      {"jugular_notch", 0, 90, -9, 5},
    {"manubrium", 0, 72, -1, 7}, {"sternal_angle", 0, 46, 7, 6}, {"xiphoid", 0, -88, -6, 3},
      {"xiphoid_anterior", 0, -70, -3, 4}},
  joints = {{"sternoclavicular", 30, 91, -9, pair = true}, {"manubriosternal", 0, 46, 1}},
  cage = {cell = 50, shape = sinew.shape.box({0, 2, 6}, {66, 118, 42}, 20)},
  skin = {cell = 10, shape = egg({0, 0, -62}, {170, 190, 88}), planes = {{{0, 0, 0}, {0, 0, 1}}, {{44, 0, 0},
    {-1, 0, 0}}, {{-44, 0, 0}, {1, 0, 0}},
          {{0, 100, 0}, {0, -1, 0}}, {{0, -97, 0}, {0, 1, 0}}}}}

-- ---- clavicle in its own frame: -y from the sternal to the acromial end, x up, z to the front ----

local clavicle = blend(5, tube({{0, 0, 0, 10}, {0, -10, 2, 9}, {0, -28, 9, 6.6}, {1, -50, 13, 6}, {1, -75, 7, 5.8},
  {1, -98, -4, 6.4}, {1, -118, -10, 7},
  {1, -134, -8, 7}, {1, -148, -2, 6}}), egg({1, -132, -8}, {6, 19, 11}, {1, 0, 0}, 12), egg({-4, -122, -14},
    {4, 5, 5}), egg({-5, -22, 4}, {3, 9, 5}))
clavicle = carve(3, clavicle, {sinew.shape.box({0, 14, 0}, {30, 10, 30})})
kit.bone{
  name = "clavicle", about = "left; origin at the sternal end, -y towards the acromion, x up, z to the front",
    kind = "cylinder",
  shape = clavicle, cell = 2.7, faces = 1500, from = {0, 4, 0}, to = {0, -150, 0},
  landmarks = {
    {"sternal_end", 0, 4, 0, 7}, {"sternal_superior", 9, -8, 2, 6}, {"sternal_anterior", 0, -20, 14, 7},
      {"medial_anterior", 0, -45, 19, 8},
    {"medial_superior", 7, -28, 9, 7}, {"shaft_inferior", -5, -75, 7, 8}, {"costal_tuberosity", -8, -22, 4, 5},
      {"lateral_anterior", 1, -120, -2, 8},
    {"lateral_posterior", 1, -122, -18, 8}, {"lateral_superior", 7, -122, -9, 7},
      {"conoid_tubercle", -8, -122, -15, 4}, {"acromial_end", 1, -152, 0, 5}},
  joints = {{"sternoclavicular", 0, 4, 0}, {"acromioclavicular", 0, -150, 0}}}
