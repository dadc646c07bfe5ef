-- human_body.lua - the body of human.lua: a skin, and the centres of the joints of its midline and its left side.
--
-- From the folder `data` where it holds body_only.obj and skin.obj, whose groups joint-* are small cubes around the
-- joints of a rig; else both are made by this file. Decimetres; x to the subject's left, y up, z to the front.
local body = {}
local shape, vec3 = sinew.shape, sinew.vec3

-- The middle of the vertices of every group whose name begins with joint-.
local function group_centers(path)
  local vertices, centers, sum, count, name = {}, {}, nil, 0, nil
  local function finish()
    if name and count > 0 then centers[name] = sum * (1 / count) end
  end
  for line in io.lines(path) do
    local key, rest = line:match("^(%a) (.*)")
    if key == "v" then
      local x, y, z = rest:match("(%S+) (%S+) (%S+)")
      vertices[#vertices + 1] = vec3(tonumber(x), tonumber(y), tonumber(z))
    elseif key == "g" then
      finish()
      name, sum, count = rest:match("^joint%-(%S+)"), vec3(0, 0, 0), 0
    elseif key == "f" and name then
      for corner in rest:gmatch("(%d+)%S*") do    -- each vertex of a cube is in three of its faces
        sum, count = sum + vertices[tonumber(corner)], count + 1
      end
    end
  end
  finish()
  return centers
end

-- The joints of a rig lie where its skin bends best. These are moved to where the bones turn: the hip to the middle of
-- the buttock and as far from the midline as in a pelvis of this height, knee and ankle to the middle of the limb.
local function from_rig(c)
  local hip, knee, ankle = c["l-upper-leg"], c["l-knee"], c["l-ankle"]
  return {
    eye = c["l-eye"], neck = c["neck"], sternum = c["l-clavicle"],
    shoulder = c["l-shoulder"], elbow = c["l-elbow"], wrist = c["l-hand"],
    index = c["l-finger-2-1"], middle = c["l-finger-3-1"], tip = c["l-finger-3-4"], little = c["l-finger-5-1"],
    hip = vec3(0.80 * hip.x, hip.y, hip.z + 0.36), knee = vec3(knee.x, knee.y, knee.z - 0.06),
    ankle = vec3(ankle.x, ankle.y, ankle.z + 0.10), toe = c["l-foot-1"],
  }
end

function body.load(folder)
  local skin = sinew.surface.load(folder .. "/body_only.obj")
  local file = skin and io.open(folder .. "/skin.obj")
  if not file then return nil end
  file:close()
  skin = skin:repair{wrap = "always", alpha = 0.1, offset = 0.01, tolerance = 0.2}   -- closes the mouth and the eyes
  return {has_face = true, skin = skin, joints = from_rig(group_centers(folder .. "/skin.obj"))}
end

-- A mannequin whose joints stand as those of the rig do. cell: edge length of its triangles.
function body.make(cell)
  local joints = {
    eye = vec3(0.31, 7.28, 1.25), neck = vec3(0, 5.90, 0.10), sternum = vec3(0.27, 5.19, 0.69),
    shoulder = vec3(1.68, 5.25, 0.15), elbow = vec3(3.13, 3.49, 0.13), wrist = vec3(4.31, 2.45, 1.76),
    index = vec3(4.50, 2.03, 2.64), middle = vec3(4.61, 1.89, 2.48), little = vec3(4.75, 1.76, 2.12),
    tip = vec3(4.90, 1.38, 3.08), hip = vec3(0.88, 0.49, 0.48), knee = vec3(1.58, -3.69, 0.26),
    ankle = vec3(2.20, -7.45, 0.09), toe = vec3(2.20, -8.10, 1.21),
  }
  local function chain(...)                                 -- capsules through {point, radius} pairs
    local list, node = {}, {...}
    for i = 1, #node - 1 do
      list[i] = shape.capsule(node[i][1], node[i + 1][1], node[i][2], node[i + 1][2])
    end
    return shape.union(list)
  end
  local j = joints
  local function between(a, b, t, off) return a + (b - a) * t + (off or vec3(0, 0, 0)) end
  local head = shape.smooth_union(0.3, shape.ellipsoid({0, 7.42, 0.52}, {0.80, 1.02, 1.00}),
    shape.capsule({0, 6.95, 0.75}, {0, 6.45, 1.08}, 0.60, 0.42), shape.capsule({0, 7.2, 1.35}, {0, 6.95, 1.62}, 0.10, 0.14))
  local trunk = shape.smooth_union(0.5, shape.ellipsoid({0, 4.45, 0.45}, {1.36, 1.75, 0.98}),
    shape.ellipsoid({0, 2.7, 0.58}, {1.28, 1.6, 0.86}), shape.ellipsoid({0, 0.95, 0.32}, {1.68, 1.45, 1.12}),
    chain({{-1.0, 5.25, 0.12}, 0.52}, {{1.0, 5.25, 0.12}, 0.52}))
  local neck = chain({{0, 6.9, 0.35}, 0.56}, {{0, 5.6, 0.18}, 0.60})

  local fore, finger = (j.wrist - j.elbow):unit(), ((j.middle - j.wrist):unit() + (j.tip - j.wrist):unit()):unit()
  local across = j.index - j.little
  across = (across - fore * across:dot(fore)):unit()
  across = (across - finger * across:dot(finger)):unit()
  local palm, k = across:cross(-finger), (j.middle - j.wrist):length() / 0.095
  local function hand(x, y, z) return j.wrist + (across * x - finger * y + palm * z) * k end
  local digits = {}
  for i, d in ipairs{{0.022, 0.094, 0.029, 0.186}, {0.002, 0.095, 0.002, 0.196}, {-0.016, 0.088, -0.020, 0.184},
                     {-0.034, 0.080, -0.042, 0.157}} do
    digits[i] = chain({hand(0.4 * d[1], 0, 0.004), 0.20}, {hand(d[1], -d[2], 0.002), 0.19}, {hand(d[3], -d[4], 0.006), 0.13})
  end
  digits[5] = chain({hand(0.012, -0.010, 0.004), 0.20}, {hand(0.034, -0.045, 0.010), 0.20}, {hand(0.058, -0.118, 0.022), 0.15})

  local side = shape.smooth_union(0.25,
    chain({{0.9, 5.28, 0.12}, 0.50}, {j.shoulder + vec3(-0.02, 0.02, 0), 0.53}, {between(j.shoulder, j.elbow, 0.45), 0.46},
          {j.elbow, 0.36}),
    chain({j.elbow, 0.38}, {between(j.elbow, j.wrist, 0.25), 0.42}, {between(j.elbow, j.wrist, 0.7), 0.31}, {j.wrist, 0.27}),
    shape.smooth_union(0.06, table.unpack(digits)),
    shape.sphere({0.72, 0.35, -0.18}, 0.88), shape.sphere({1.15, 0.1, 0.35}, 0.82),
    chain({j.hip + vec3(0.1, -0.5, -0.15), 0.88}, {between(j.hip, j.knee, 0.5, vec3(0, 0, 0)), 0.72}, {j.knee, 0.52}),
    chain({j.knee + vec3(0, 0.1, 0), 0.50}, {between(j.knee, j.ankle, 0.25, vec3(0, 0, -0.14)), 0.54},
          {between(j.knee, j.ankle, 0.7), 0.38}, {j.ankle, 0.40}),
    chain({j.ankle, 0.42}, {j.ankle + vec3(0, -0.28, -0.34), 0.34}),
    chain({j.ankle + vec3(0, -0.10, 0.1), 0.42}, {j.toe + vec3(0, 0.35, -0.1), 0.36}, {j.toe + vec3(-0.08, 0.22, 0.66), 0.24}),
    chain({j.toe + vec3(-0.25, 0.28, 0), 0.30}, {j.toe + vec3(-0.27, 0.22, 0.66), 0.22}),
    chain({j.toe + vec3(0.15, 0.25, -0.2), 0.28}, {j.toe + vec3(0.33, 0.18, 0.30), 0.20}))
  local skin = shape.smooth_union(0.3, head, neck, trunk, side, side:mirror{normal = {1, 0, 0}})
  return {skin = skin:mesh{cell = cell}, joints = joints}
end

return body
