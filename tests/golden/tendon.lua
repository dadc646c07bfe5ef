-- Tendons: by length, by cross-section, and none; and what the muscles cover of the bones at their ends.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "tendon", unit = "cm"}
scene:set_skin(shape.box({0, 0, 0}, {6.5, 5.5, 2.5}, 1.2):mesh{cell = 0.7})
scene:add_bone("top", shape.capsule({-5, 4.4, 0}, {5, 4.4, 0}, 0.5):mesh{cell = 0.35})
scene:add_bone("bottom", shape.capsule({-5, -4.4, 0}, {5, -4.4, 0}, 0.5):mesh{cell = 0.35})
scene:tetrahedralize{edge_length = 0.85, bone_edge_length = 0.55}
for i, name in ipairs{"length", "area", "none"} do
  local x = 4 * (i - 2)
  scene:add_muscle(name, {points = {{x, 3.85, 0}, {x, 2, 0}, {x, 0, 0}, {x, -2, 0}, {x, -3.85, 0}},
                          tissue = {0.5, 0.7, 1.1, 0.7, 0.5}})
end
scene:muscle("length"):set_tendon{length = 1.5}
scene:muscle("area"):set_tendon{area = 7}
scene:set_fat(0.3)
scene:render{file = out .. "/tendon.png", size = {480, 400}, camera = "front", skin_opacity = 0.15}

local report = scene:report().muscles
for _, m in ipairs(scene:muscles()) do
  local r = report[m:name()]
  print(m:name(), string.format("belly %.3g", r.belly_volume), string.format("tendon %.3g", r.tendon_volume),
        string.format("fiber length %.3g", r.fiber_length))
  for _, key in ipairs{"origin", "insertion"} do
    local e = r[key]
    print("", key, e.bone, string.format("area %.2g", e.area), string.format("centroid y %.2g", e.centroid.y))
  end
end
