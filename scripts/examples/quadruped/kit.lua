-- kit.lua - what the parts of the quadruped share: chains of capsules, both sides, and bones of the library reshaped.
local shape, vec3 = sinew.shape, sinew.vec3
local kit = {}

-- A chain of capsules (cones with round ends) through {x, y, z, radius} nodes.
function kit.chain(nodes)
  local list = {}
  for i = 1, #nodes - 1 do
    local a, b = nodes[i], nodes[i + 1]
    list[i] = shape.capsule({a[1], a[2], a[3]}, {b[1], b[2], b[3]}, a[4], b[4])
  end
  return shape.union(list)
end

-- The left part and its image on the right.
function kit.both(part)
  return shape.union(part, part:mirror{normal = {1, 0, 0}})
end

-- 0 before a, 1 after b, smooth in between.
function kit.step(a, b, t)
  t = math.max(0, math.min(1, (t - a) / (b - a)))
  return t * t * (3 - 2 * t)
end

-- A template of the library under a new name, each of its points and landmarks moved to map(p). The proportions of
-- animals differ by more than one factor: a cat's scapula is long where ours is wide. length: of a curve bone.
function kit.reshape(template, name, map, length)
  local surface, vertices, faces, landmarks = sinew.bones.surface(template), {}, {}, {}
  for i = 1, surface:vertex_count() do vertices[i] = map(surface:vertex(i)) end
  for i = 1, surface:face_count() do faces[i] = surface:face(i) end
  local scene = sinew.scene{name = "landmarks of a template"}
  local place = {name = "bone", template = template}
  if length then
    place.along, place.count = {{0, -0.5 * length, 0}, {0, 0.5 * length, 0}}, 1
  else
    place.at = {0, 0, 0}
  end
  for _, mark in ipairs(scene:place_bone(place):landmarks()) do
    landmarks[length and mark.name:gsub("_1$", "") or mark.name] = map(mark.point)
  end
  scene:close()
  sinew.bones.add{name = name, kind = length and "curve" or "shape", length = length,
                  mesh = sinew.surface.new(vertices, faces), landmarks = landmarks}
end

-- A template made of shapes. landmarks: {NAME = {x, y, z}}.
function kit.template(name, cell, parts, landmarks)
  sinew.bones.add{name = name, kind = "shape", mesh = shape.smooth_union(0.008, parts):mesh{cell = cell},
                  landmarks = landmarks}
end

return kit
