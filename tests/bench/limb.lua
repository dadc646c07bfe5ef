-- limb.lua - a hind limb made by this script in any size of mesh and with any number of muscles, for measurements.
--
--     local limb = dofile("tests/bench/limb.lua")
--     local scene = limb.body()                skin and bones: pelvis, femur, patella, tibia, fibula, foot
--     scene:tetrahedralize{edge_length = 0.006}
--     limb.add_muscles(scene, 40)
--
-- The body is the same whatever the mesh, and so are the first n muscles of any longer list of them: cost is then
-- compared with one thing changed at a time. A muscle runs from bone to bone through the flesh between bones and skin.
-- Metres, z up, the limb of a large cat.

local limb, shape, vec3 = {}, sinew.shape, sinew.vec3

-- The middle of the limb, from the loin to the toes, and how far it is round it.
local axis = {vec3(0.150, 0, 0.330), vec3(0.070, 0, 0.160), vec3(0, 0, 0), vec3(0.030, 0, -0.200),
              vec3(0.045, 0, -0.380), vec3(-0.020, 0, -0.560), vec3(-0.080, 0, -0.720), vec3(-0.040, 0, -0.850),
              vec3(0.020, 0, -0.960)}
local girth = {0.150, 0.160, 0.155, 0.135, 0.095, 0.090, 0.062, 0.048, 0.042}

-- A chain of capsules through {x, y, z, radius}.
local function chain(...)
  local list, node = {}, {...}
  for i = 1, #node - 1 do
    local a, b = node[i], node[i + 1]
    list[i] = shape.capsule({a[1], a[2], a[3]}, {b[1], b[2], b[3]}, a[4], b[4])
  end
  return #list > 1 and shape.union(list) or list[1]
end

local function skin()
  local part = {}
  for i = 1, #axis - 1 do part[i] = shape.capsule(axis[i], axis[i + 1], girth[i], girth[i + 1]) end
  local calf = chain({-0.020, 0, -0.400, 0.060}, {-0.065, 0, -0.520, 0.062}, {-0.100, 0, -0.690, 0.036})
  local thigh = chain({-0.080, 0, -0.020, 0.110}, {-0.060, 0, -0.180, 0.100}, {-0.030, 0, -0.360, 0.060})
  local paw = chain({-0.020, 0, -0.930, 0.046}, {0.070, 0, -0.965, 0.042})
  return shape.smooth_union(0.06, shape.smooth_union(0.05, table.unpack(part)), thigh, calf, paw):mesh{cell = 0.018}
end

local function bones()
  local pelvis = chain({0.160, -0.030, 0.350, 0.024}, {0.110, -0.020, 0.230, 0.030}, {0.030, -0.010, 0.075, 0.028})
  local blade = shape.plate({0.200, -0.020, 0.300}, {0.110, 0.050, 0.270}, {0.050, 0, 0.110}, 0.012)
  local ischium = chain({0.030, -0.010, 0.075, 0.026}, {-0.070, -0.020, 0.060, 0.022})
  local femur = chain({0, 0, 0.010, 0.028}, {0.018, 0, -0.080, 0.018}, {0.035, 0, -0.260, 0.017},
                      {0.040, 0, -0.345, 0.030})
  local tibia = chain({0.034, -0.010, -0.420, 0.028}, {0.012, -0.012, -0.490, 0.017},
                      {-0.050, -0.010, -0.650, 0.014}, {-0.074, -0.006, -0.700, 0.020})
  local fibula = chain({0.014, 0.034, -0.440, 0.012}, {-0.068, 0.026, -0.690, 0.010})
  local foot = chain({-0.118, 0, -0.722, 0.016}, {-0.080, 0, -0.745, 0.022}, {-0.042, 0, -0.850, 0.017},
                     {0.010, 0, -0.955, 0.018}, {0.080, 0, -0.972, 0.015})
  return {{"pelvis", shape.smooth_union(0.02, pelvis, blade, ischium)}, {"femur", femur},
          {"patella", shape.sphere({0.092, 0, -0.372}, 0.016)}, {"tibia", tibia}, {"fibula", fibula}, {"foot", foot}}
end

-- A scene with skin and bones.
function limb.body()
  local scene = sinew.scene{name = "hind limb", unit = "m", up = "z"}
  scene:set_skin(skin())
  for _, b in ipairs(bones()) do scene:add_bone(b[1], b[2]:mesh{cell = 0.010}) end
  return scene
end

-- Piece i of the axis, or the one next to it where it ends.
local function piece(i)
  i = math.max(1, math.min(i, #axis - 1))
  return axis[i + 1] - axis[i]
end

-- The point of the axis at s in 0..1, and two directions across it.
local function cross_frame(s)
  local at = s * (#axis - 1) + 1
  local i = math.min(math.floor(at), #axis - 1)
  local t = at - i
  local tangent = ((piece(i - 1) + piece(i)) * (1 - t) + (piece(i) + piece(i + 1)) * t):unit()
  local lateral = vec3(0, 1, 0)
  return axis[i] + piece(i) * t, lateral, tangent:cross(lateral)
end

-- Where a ray from the axis leaves the last bone, and where the skin. Directions are in turns, from lateral to cranial.
local function flesh(surfaces, skin, s, turn)
  local p, lateral, cranial = cross_frame(s)
  local d = lateral * math.cos(2 * math.pi * turn) + cranial * math.sin(2 * math.pi * turn)
  local bone = 0
  for _, surface in ipairs(surfaces) do
    for _, hit in ipairs(surface:raycast(p, d)) do bone = math.max(bone, hit.distance) end
  end
  return p, d, bone, skin:raycast(p, d)[1].distance
end

-- From where to where along the axis, and how many of 22.
local kinds = {{0.06, 0.56, 5}, {0.04, 0.36, 4}, {0.03, 0.21, 2}, {0.26, 0.57, 4}, {0.56, 0.86, 4}, {0.46, 0.80, 3}}

-- Numbers in 0..1 that fill a cube of three dimensions evenly, the first n of any longer list too.
local function spread(k)
  return (0.5 + 0.8191725134 * k) % 1, (0.5 + 0.6710436067 * k) % 1, (0.5 + 0.5497004779 * k) % 1
end

local function kind_of(x)
  local sum = 0
  for _, kind in ipairs(kinds) do
    sum = sum + kind[3] / 22
    if x < sum then return kind end
  end
  return kinds[#kinds]
end

-- The control points of candidate k: at a bone at its ends, `depth` of the way from bone to skin between them.
local function control_points(surfaces, skin, k)
  local turn, depth, which = spread(k)
  local kind = kind_of(which)
  local shift, points, n = 0.05 * ((0.618034 * k) % 1 - 0.5), {}, 6
  for i = 0, n do
    local s = kind[1] + (kind[2] - kind[1]) * i / n + shift
    local p, d, bone, out = flesh(surfaces, skin, s, turn)
    local way = (i == 0 or i == n) and 0 or 0.14 + 0.60 * depth
    points[i + 1] = p + d * (bone + 0.002 + way * (out - bone))
  end
  return points
end

-- Does a curve keep to the soft tissue, but for its ends?
local function is_in_flesh(muscle, surfaces, skin)
  local points = muscle:curve(150)
  for i = 3, #points - 2 do
    if not skin:contains(points[i]) then return false end
    for _, bone in ipairs(surfaces) do
      if bone:contains(points[i]) then return false end
    end
  end
  return true
end

-- Adds muscles first..last (or 1..first) of the list, named muscle_1 and so on. A candidate that would run through a
-- bone is passed over.
function limb.add_muscles(scene, first, last)
  if not last then first, last = 1, first end
  local surfaces, skin = {}, scene:skin()
  for i, bone in ipairs(scene:bones()) do surfaces[i] = bone:surface() end
  local candidate, found = 0, 0
  while found < last do
    candidate = candidate + 1
    local name = "muscle_" .. found + 1
    local muscle = scene:add_muscle(name, {points = control_points(surfaces, skin, candidate)})
    local is_good = is_in_flesh(muscle, surfaces, skin)
    if is_good then found = found + 1 end
    if not is_good or found < first then scene:remove_muscle(name) end
  end
  scene:set_fat(0.25)
end

return limb
