-- Muscles of several heads: a fan of three from a bar to a shaft, and one with two bellies that share a tendon.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "heads", unit = "cm"}
scene:set_skin(shape.ellipsoid({0, 0, 0}, {4.5, 7, 3.2}):mesh{cell = 0.6})
scene:add_bone("bar", shape.capsule({-2.4, 4.4, 0}, {2.4, 4.4, 0}, 0.5):mesh{cell = 0.35})
scene:add_bone("shaft", shape.capsule({0, -5.4, -0.6}, {0, 3.2, -0.6}, 0.7):mesh{cell = 0.4})
scene:tetrahedralize{edge_length = 0.85, bone_edge_length = 0.6}
local to = {0, 0.8, 0.15}
local fan = scene:add_muscle("fan", {heads = {
  {points = {{-2.2, 3.9, 0.1}, {-1.4, 3, 0.7}, {-0.4, 1.6, 0.6}, to}, tissue = {0.8, 1, 0.8, 0.5}},
  {points = {{0, 3.9, 0.2}, {0, 3, 0.9}, {0, 1.8, 0.8}, to}, tissue = {0.8, 1, 0.8, 0.5}},
  {points = {{2.2, 3.9, 0.1}, {1.4, 3, 0.7}, {0.4, 1.6, 0.6}, to}, tissue = {0.8, 1, 0.8, 0.5}}}})
fan:set_pennation{kind = "convergent"}
local pair = scene:add_muscle("pair", {heads = {
  {points = {{-0.55, -0.2, -0.1}, {-2, -1.3, 0.3}, {-1.5, -3, 0.5}, {0, -5, 0.15}}, tissue = {0.4, 0.9, 0.9, 0.3}},
  {points = {{0.55, -0.2, -0.1}, {2, -1.3, 0.3}, {1.5, -3, 0.5}, {0, -5, 0.15}}, tissue = {0.4, 0.9, 0.9, 0.3}}}})
scene:set_fat(0.45)
scene:render{file = out .. "/heads.png", size = {360, 480}, camera = "front", skin_opacity = 0.2,
             show = {"muscles", "bones", "skin", "curves", "points"}}
scene:render{file = out .. "/heads_fibers.png", size = {360, 480}, camera = "front", skin_opacity = 0.2,
             show = {"fibers", "bones", "skin"}, fiber_count = 120}

local report = scene:report().muscles
for _, m in ipairs(scene:muscles()) do
  local r = report[m:name()]
  print(m:name(), "heads", m:head_count(), string.format("length %.3g", m:length()), "components", r.components)
  print("", string.format("volume %.3g", r.volume), "tets", r.tets)
  for k = 1, m:head_count() do
    local ends = r.heads[k]
    print("", "head", k, string.format("length %.3g", m:head(k):length()), ends.origin.bone, ends.insertion.bone)
  end
end
