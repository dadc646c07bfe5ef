-- human_skeleton.lua - the skeleton of human.lua: bones of the library placed by the centres of the joints.
--
-- Lengths in the code are those of the templates, metres of a grown-up, times `unit`; what differs from body to body is
-- taken from its joints and its skin.
local vec3 = sinew.vec3
local unit = 10 -- decimetres in a metre

local function lerp(a, b, t) return a + (b - a) * t end

-- The turn that takes the axes of a template to these directions, as an axis and an angle. x, y, z: unit.
local function turn(x, y, z)
  local trace = x.x + y.y + z.z
  local axis = vec3(y.z - z.y, z.x - x.z, x.y - y.x)
  return {axis = axis, degrees = math.deg(math.atan(axis:length(), trace - 1))}
end

local function frame(origin, x, y, z)
  return function(lateral, up, front) return origin + (x * lateral + y * up + z * front) * unit end
end

-- has_face: the skin of the head is like enough to the library's to fit the skull to it.
return function(scene, joint, has_face)
  local skin = scene:skin()
  local left, up, ahead = vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)
  local function place(options) return (scene:place_bone(options)) end
  local function first_hit(p, direction)
    local hit = skin:raycast(p, direction)
    return hit[1] and hit[1].point
  end

  -- Trunk: the pelvis hangs at the hips, tilted to the front; the skull at the eyes.
  local pelvis_size = joint.hip.x / (0.087 * unit)
  local pelvis = place{name = "pelvis", template = "pelvis", at = {0, joint.hip.y, joint.hip.z}, size = pelvis_size,
                       rotate = {axis = {1, 0, 0}, degrees = 6}, margin = 0.10}
  local skull_size = 0.94
  local skull = place{name = "skull", template = "skull", size = skull_size, fit = has_face, margin = has_face and 0.05 or nil,
                      at = vec3(0, joint.eye.y, joint.eye.z) - vec3(0, 0.020, 0.074) * (unit * skull_size)}

  -- The spine runs as far in front of the back's skin as its spinous processes reach. Each vertebra has a part of the
  -- curve for itself, in proportion to its height.
  local bottom, top = pelvis:landmark("lumbosacral"), skull:landmark("atlanto_occipital")
  local along, size = {bottom}, (top.y - bottom.y) / (0.6 * unit)
  for _, node in ipairs{{0.22, 0.072}, {0.50, 0.064}, {0.78, 0.054}} do
    local y = lerp(bottom.y, top.y, node[1])
    along[#along + 1] = vec3(0, y, first_hit({0, y, -10}, ahead).z + (0.008 + node[2] * size) * unit)
  end
  along[#along + 1] = top
  local rows = {{"lumbar", "L", 5, 0.037, 0.034}, {"thoracic", "T", 12, 0.0285, 0.0195}, {"cervical", "C", 7, 0.0185, 0.0165}}
  local total, reached = 0, 0
  for _, row in ipairs(rows) do total = total + row[3] * 0.5 * (row[4] + row[5]) end
  local plane = {point = {0, 0, 0}, normal = left}
  local template_height = {lumbar = 0.037, thoracic = 0.025, cervical = 0.017}
  local vertebra = {}
  for _, row in ipairs(rows) do
    local template, letter, count, first, last = table.unpack(row)
    for k = count, 1, -1 do
      local height = lerp(first, last, (count - k) / (count - 1)) / total
      local name = letter .. k
      local wish = lerp(0.9, template_height[template] / (height * total), 0.6)
      vertebra[name] = place{name = name, template = template, along = along, plane = plane, count = 1,
                             range = {reached, math.min(1, reached + height)}, thickness = wish, margin = 0.06}
      reached = reached + height
    end
  end

  -- Sternum: its upper end between the clavicles, along the skin of the chest.
  local k = 0.86
  local notch = vec3(0, joint.sternum.y, joint.sternum.z)
  local upper = first_hit({0, notch.y, 10}, -ahead)
  local lower = first_hit({0, notch.y - 0.16 * unit * k, 10}, -ahead)
  local down = (lower - upper):unit()
  local sternum = place{name = "sternum", template = "sternum", at = upper + down * (0.085 * unit * k) - ahead * 0.20,
                        size = k, rotate = turn(left, -down, left:cross(-down)), margin = 0.10}

  -- Ribs: of each pair a template of its own, as wide as the trunk lets it and as long as it takes to the sternum.
  local model = sinew.bones.surface("rib_pair")
  local landmarks = {}
  do
    local s = sinew.scene{unit = "m"}
    local bone = s:place_bone{name = "rib", template = "rib_pair", along = {{0, -0.0125, 0}, {0, 0.0125, 0}}, count = 1}
    for _, mark in ipairs(bone:landmarks()) do landmarks[mark.name:gsub("_1$", "")] = mark end
    s:close()
  end
  local function rib_template(name, sx, sy, sz, length, cut)
    local vertices, faces = {}, {}
    for i = 1, model:vertex_count() do
      local p = model:vertex(i)
      vertices[i] = {sx * p.x, sy * p.y, sz * p.z}
    end
    for i = 1, model:face_count() do faces[i] = model:face(i) end
    local mesh, marks = sinew.surface.new(vertices, faces), {}
    if cut then mesh = mesh:cut{point = {0, 0, cut * sz}, normal = {0, 0, -1}} end
    for mark, m in pairs(landmarks) do
      local p = m.point
      if not cut or p.z < cut then
        marks[mark] = {point = {sx * p.x, sy * p.y, sz * p.z}, radius = m.radius}
      end
    end
    sinew.bones.add{name = name, kind = "curve", mesh = mesh, length = length, landmarks = marks}
  end
  -- width over that of the widest; where they end in front, z of the template
  local width = {0.42, 0.62, 0.76, 0.86, 0.93, 0.97, 1, 1, 0.98, 0.94, 0.86, 0.70}
  local ends = {[8] = 0.150, [9] = 0.142, [10] = 0.128, [11] = 0.070, [12] = 0.020}
  local widest = vertebra.T8:landmark("rib_facet_l_1")
  local side = skin:raycast({0, widest.y - 0.3, widest.z + 0.3}, left)[1].point.x - 0.13
  local top_notch = lerp(sternum:landmark("first_costal_notch_l"), sternum:landmark("first_costal_notch_r"), 0.5)
  local low_notch = lerp(sternum:landmark("body_anterior_lower_l"), sternum:landmark("body_anterior_lower_r"), 0.5)
  local depth, drop
  for rib = 1, 12 do
    local below, above = vertebra["T" .. rib]:landmark("disc_lower_1"), vertebra["T" .. rib]:landmark("disc_upper_1")
    local y = (above - below):unit()
    local z, center = left:cross(y), lerp(below, above, 0.5)
    if rib <= 7 then
      local target = lerp(top_notch, low_notch, (rib - 1) / 6) - center
      depth, drop = target:dot(z) / (0.160 * unit), target:dot(y) / (-0.050 * unit)
    else
      depth, drop = depth * 0.985, drop * 1.04
    end
    local name = "rib_" .. rib
    local long = (above - below):length()
    rib_template(name, side * width[rib] / 1.28, drop, depth, long / unit, ends[rib])
    place{name = name, template = name, along = {below, above}, count = 1, margin = rib < 3 and 0.10 or 0.16}
  end

  -- Arm. The frame of the elbow: y up the upper arm, x away from the trunk along the axis that it bends about.
  local arm, fore = (joint.elbow - joint.shoulder):unit(), (joint.wrist - joint.elbow):unit()
  local lateral = fore:cross(arm):unit()
  local front = lateral:cross(-arm)
  local scapula = place{name = "scapula_l", template = "scapula", at = joint.shoulder - vec3(0.025, 0, 0) * unit * 0.88,
                        size = 0.88, rotate = {axis = {0, 1, 0}, degrees = 4}, margin = 0.10}
  place{name = "clavicle_l", template = "clavicle", from = joint.sternum, to = scapula:landmark("acromioclavicular"),
        thickness = 1, front = ahead, margin = 0.08}
  local limb = (joint.elbow - joint.shoulder):length() / (0.300 * unit)
  place{name = "humerus_l", template = "humerus", from = joint.shoulder, to = joint.elbow, front = front,
        thickness = 0.88 / limb, margin = 0.08}
  limb = (joint.wrist - joint.elbow):length() / (0.255 * unit)
  local elbow = frame(joint.elbow, lateral, -arm, front)
  local radial = joint.index - joint.little
  radial = (radial - fore * radial:dot(fore)):unit()
  place{name = "ulna_l", template = "ulna", from = elbow(-0.008, 0, 0), to = joint.wrist - radial * 0.17 - fore * 0.05,
        front = lateral:cross(-fore), thickness = 0.88 / limb, margin = 0.06}
  place{name = "radius_l", template = "radius", from = elbow(0.012, 0, 0) + fore * 0.12, to = joint.wrist + radial * 0.05,
        front = radial:cross(-fore), thickness = 0.88 / limb, margin = 0.06}
  local finger = ((joint.middle - joint.wrist):unit() + (joint.tip - joint.wrist):unit()):unit()
  local across = (radial - finger * radial:dot(finger)):unit()
  place{name = "hand_l", template = "hand", at = joint.wrist, size = (has_face and 0.93 or 0.88) * (joint.middle - joint.wrist):length() / (0.095 * unit),
        rotate = turn(across, -finger, across:cross(-finger))}

  -- Leg.
  local hip = pelvis:landmark("hip_center_l")
  limb = (joint.knee - hip):length() / (0.430 * unit)
  place{name = "femur_l", template = "femur", from = hip, to = joint.knee, thickness = 0.97 / limb, margin = 0.15}
  local shin = (joint.ankle - joint.knee):unit()
  limb = (joint.ankle - joint.knee):length() / (0.388 * unit)
  local tibia = place{name = "tibia_l", template = "tibia", from = joint.knee - shin * 0.05, to = joint.ankle + shin * 0.04, thickness = 0.97 / limb,
                      margin = 0.10}
  place{name = "fibula_l", template = "fibula", from = tibia:landmark("fibular_facet") + vec3(0.06, 0, -0.02),
        to = joint.ankle + left * 0.20 - shin * 0.04, thickness = 1, margin = 0.08}
  place{name = "patella_l", template = "patella", at = joint.knee + vec3(0.01, 0.12, 0.40), size = 0.95, margin = 0.08}
  local step = joint.toe - joint.ankle
  place{name = "foot_l", template = "foot", at = joint.ankle, size = 0.93,
        rotate = {axis = up, degrees = math.deg(math.atan(step.x, step.z))}, margin = 0.03}

  -- Joints, and the right side.
  local function connect(name, parent, child, center)
    scene:add_joint{name = name, parent = parent, child = child, center = center}
  end
  connect("lumbosacral", "pelvis", "L5", bottom)
  connect("neck", "T1", "C7", vertebra.C7:landmark("disc_lower_1"))
  connect("head", "C1", "skull", top)
  connect("shoulder_l", "scapula_l", "humerus_l", joint.shoulder)
  connect("elbow_l", "humerus_l", "ulna_l", joint.elbow)
  connect("wrist_l", "radius_l", "hand_l", joint.wrist)
  connect("hip_l", "pelvis", "femur_l", hip)
  connect("knee_l", "femur_l", "tibia_l", joint.knee)
  connect("ankle_l", "tibia_l", "foot_l", joint.ankle)
  return scene:mirror_bones{}
end
