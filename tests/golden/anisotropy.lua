-- The same curve three times: round, flat along the picture, and flat across it. The frames show which way.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "anisotropy", unit = "cm"}
scene:set_skin(shape.box({0, 0, 0}, {8, 5, 3.2}, 1.5):mesh{cell = 0.7})
local place = {round = -5, flat = 0, deep = 5}
for _, name in ipairs{"round", "flat", "deep"} do
  local x = place[name]
  scene:add_bone(name .. "_top", shape.sphere({x, 3.6, 0}, 0.5):mesh{cell = 0.3})
  scene:add_bone(name .. "_bottom", shape.sphere({x, -3.6, 0}, 0.5):mesh{cell = 0.3})
end
scene:tetrahedralize{edge_length = 0.9, bone_edge_length = 0.6}
for _, name in ipairs{"round", "flat", "deep"} do
  local x = place[name]
  scene:add_muscle(name, {points = {{x, 3.05, 0}, {x, 1, 0}, {x, -1, 0}, {x, -3.05, 0}}})
end
scene:muscle("flat"):set_frame{axis = {1, 0, 0}, eigenvalues = {1, 2, 0.4}}
scene:muscle("deep"):set_frame{axis = {1, 0, 0}, eigenvalues = {1, 2, 0.4}, angle = 90}
scene:set_fat(0.4)
scene:render{file = out .. "/anisotropy.png", size = {480, 360}, camera = {azimuth = 15, elevation = 10},
             skin_opacity = 0.15, show = {"muscles", "bones", "skin", "frames"}}
scene:render{file = out .. "/anisotropy_section.png", size = {480, 240}, camera = "top", skin_opacity = 0.15,
             clip = {point = {0, 0.1, 0}, normal = {0, 1, 0}}}

local x = scene:extract{}
for _, m in ipairs(scene:muscles()) do
  local part = x:part(m:name())
  local b = part:surface():bounds()
  print(m:name(), string.format("volume %.3g", part:volume()), string.format("wide %.2g", b.max.x - b.min.x),
        string.format("deep %.2g", b.max.z - b.min.z))
  local f = m:frame()
  if f then
    print("", string.format("e1 %.2f %.2f %.2f", f.e1.x, f.e1.y, f.e1.z),
          string.format("e2 %.2f %.2f %.2f", f.e2.x, f.e2.y, f.e2.z))
  end
end
