-- Two muscles side by side over a bone in an egg of fat: the smallest scene with every kind of thing in a picture.
out = out or "out"
local scene = sinew.scene{name = "two muscles", unit = "cm"}
scene:set_skin(sinew.shape.ellipsoid({0, 0, 0}, {4, 7, 4}):mesh{cell = 0.5})
scene:add_bone("shaft", sinew.shape.capsule({0, -5, -1}, {0, 5, -1}, 0.8, 0.8):mesh{cell = 0.4})
local mesh = scene:tetrahedralize{edge_length = 0.6, bone_edge_length = 0.45}
scene:add_muscle("left", {points = {{0, 4.5, -0.1}, {-1.3, 2, 1}, {-1.3, -2, 1}, {0, -4.5, -0.1}}})
scene:add_muscle("right", {points = {{0.3, 4.5, -0.2}, {1.4, 2, 1}, {1.4, -2, 1}, {0.3, -4.5, -0.2}}, tissue = {0.6, 1.2, 1.2, 0.6}})
scene:set_fat(0.25)
scene:render{file = out .. "/two_muscles.png", size = {360, 420}, camera = {azimuth = 20, elevation = 12},
             show = {"muscles", "bones", "skin", "curves", "points"}, skin_opacity = 0.25}
scene:render{file = out .. "/two_muscles_section.png", size = {360, 300}, camera = {azimuth = 0, elevation = 60},
             show = {"muscles", "bones", "skin"}, clip = {point = {0, 0.5, 0}, normal = {0, 1, 0}}}

-- Numbers beside the pictures: pictures within a tolerance would hide a change of topology.
local x = scene:extract{}
local check = x:check()
print("conforming", check.conforming, "manifold", check.manifold, "positive", check.positive)
print("volume error below 1e-9", check.volume_error < 1e-9)
for _, name in ipairs(x:names()) do
  local s = x:part(name):surface():check()
  print(name, string.format("%.2g", x:part(name):volume()), "components", s.components, "closed", s.closed)
end
