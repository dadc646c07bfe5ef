-- scapula - the shoulder blade. Origin: the middle of the glenoid, at the centre of its surface.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, blend, carve = kit.ball, kit.egg, kit.blend, kit.carve

-- Places are given in the blade: u away from the glenoid, v up, n off its back. It is turned by 35 degrees from the
-- frontal plane.
local function at(u, v, n, r)
  return {-0.819 * u + 0.574 * n, v, -0.574 * u - 0.819 * n, r}
end
local function place(list)
  local t = {}
  for i, p in ipairs(list) do t[i] = at(table.unpack(p)) end
  return t
end
local function tube(list, n) return kit.tube(place(list), n) end
local function chain(list) return kit.chain(place(list)) end

-- The blade: rows from the lateral to the medial border, top to bottom, bulging to the back.
local function row(v, u0, u1, bulge, n0, n1)
  local r = {}
  for i = 0, 4 do
    local t = i / 4
    r[i + 1] = at(u0 + t * (u1 - u0), type(v) == "number" and v or v[1] + t * (v[2] - v[1]),
                  n0 + t * (n1 - n0) + bulge * 4 * t * (1 - t))
  end
  return r
end
local blade = kit.net(2.4, {
  row({24, 44}, 30, 90, 2, -4, -7), row({16, 32}, 22, 97, 5, -2, -3), row({4, 16}, 16, 103, 7, 0, 0),
  row({-14, -8}, 22, 105, 8, 0, 0), row({-34, -34}, 32, 104, 8, 0, 0), row({-58, -60}, 45, 101, 7, 0, -1),
  row({-82, -84}, 60, 96, 5, 0, -3), row({-106, -108}, 76, 88, 1, -2, -5)})
local borders = blend(4,
  tube{{9, -14, 0, 8}, {20, -24, -1, 6.5}, {36, -46, -1, 5}, {54, -76, -1, 4.8}, {70, -101, -2, 5}, {80, -112, -4, 6}},
  tube{{80, -112, -4, 6}, {90, -104, -5, 4}, {98, -80, -3, 3.2}, {104, -36, 0, 3.2}, {105, 0, 0, 3.4},
    {100, 24, -2, 3.2},
       {92, 43, -7, 3.6}},
  tube{{92, 43, -7, 3.6}, {62, 36, -5, 2.6}, {34, 25, -4, 2.6}, {22, 24, -3, 3}})
local neck = kit.blend(7, chain{{7, 11, 0, 7.5}, {7, -13, 0, 9.5}}, chain{{12, 0, 0, 11}, {26, -1, 2, 7}})
neck = carve(2, blend(4, neck, kit.egg({-3, 0, -2}, {5, 18.5, 13}, {0, 1, 0}, 35)), {ball(39, 0, 27.5, 46)})
-- The spine of the scapula: a wall on the back of the blade, with a thick crest that ends in the acromion.
local wall = kit.net(2.4, {
  place{{103, 12, 1}, {80, 13, 6}, {55, 14, 7}, {30, 14, 5}}, place{{103, 13, 2}, {80, 20, 17}, {55, 24, 25},
    {24, 28, 29}}})
local crest = tube{{104, 13, 2, 3.6}, {92, 16, 9, 4}, {78, 21, 18, 5}, {55, 26, 26, 4.2}, {30, 32, 31, 4.8},
                   {8, 37, 31, 5}}
local acromion = blend(6, tube{{12, 37, 31, 5.5}, {-6, 40, 28, 6.5}, {-21, 40, 16, 6.5}, {-25, 38, 2, 6},
  {-20, 37, -9, 5}},
                       tube{{0, 39, 27, 5}, {-10, 39, 14, 5}, {-17, 38, 2, 5}})
acromion = acromion:transform{scale = {1, 0.8, 1}, translate = {0, 8, 0}}
local coracoid = tube{{14, 17, -2, 8}, {14, 28, -7, 7.5}, {13, 34, -16, 6.5}, {5, 31, -27, 6}, {-6, 24, -35, 5.2}}
local bone = blend(5, blade, borders, wall, crest)
bone = blend(6, bone, neck, acromion, coracoid)

local function mark(name, u, v, n, r)
  local p = at(u, v, n)
  return {name, p[1], p[2], p[3], r}
end
kit.bone{
  name = "scapula", about = "left; origin in the middle of the glenoid's surface", kind = "shape",
  shape = bone, cell = 3.4, faces = 3400,
  landmarks = {
    mark("glenoid", 1, 0, 0, 8), mark("acromion", -30, 40, 8, 7), mark("acromion_posterior", -6, 41, 34, 7),
    mark("acromion_medial", -10, 46, 18, 6), mark("acromioclavicular", -18, 40, -13, 4),
    mark("scapular_spine", 55, 28, 30, 9), mark("scapular_spine_lateral", 30, 34, 35, 8),
    mark("scapular_spine_medial", 92, 17, 14, 8), mark("coracoid", -8, 22, -40, 5),
      mark("coracoid_medial", 10, 32, -26, 5),
    mark("coracoid_base", 14, 34, -6, 5), mark("supraspinous_fossa", 70, 28, 3, 12),
    mark("infraspinous_fossa", 70, -25, 11, 18), mark("infraspinous_fossa_lower", 72, -65, 9, 12),
    mark("subscapular_fossa", 65, -25, 4, 18), mark("subscapular_fossa_upper", 65, 22, -1, 12),
    mark("subscapular_fossa_lower", 75, -75, 1, 12), mark("supraglenoid_tubercle", 3, 18, 0, 4),
    mark("infraglenoid_tubercle", 8, -23, 0, 5), mark("lateral_border_upper", 38, -52, 3, 8),
    mark("lateral_border_lower", 60, -90, 3, 8), mark("medial_border", 108, -30, 0, 12),
    mark("medial_border_upper", 102, 28, -3, 9), mark("medial_border_lower", 99, -85, -3, 10),
    mark("medial_border_ventral", 104, -40, -3, 12), mark("superior_angle", 94, 46, -7, 6),
    mark("inferior_angle", 83, -118, -4, 7), mark("inferior_angle_dorsal", 80, -106, 3, 7),
    mark("superior_border", 40, 29, -4, 6)},
  joints = {{"shoulder_center", 26, 0, 0}, {"glenoid_center", 0, 0, 0}},
  cage = {cell = 62, shape = kit.egg({-38, -28, -32}, {130, 140, 115}, {0, 1, 0}, 35)},
  skin = {cell = 13, shape = blend(40, egg({-75, -60, 8}, {95, 155, 92}), egg({0, 0, -5}, {52, 56, 52})),
          planes = {{{0, 0, 10}, {0.35, 0, -1}}, {{-95, 0, 0}, {1, 0, 0}}, {{0, -118, 0}, {0, 1, 0}}}}}
