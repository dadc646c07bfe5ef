-- Muscles drawn in a picture: the depth of one keeps clear of a bone in the way, that of the other is a straight line.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "stroke", unit = "cm"}
scene:set_skin(shape.ellipsoid({0, 0, 0}, {6, 3.5, 3.5}):mesh{cell = 0.6})
scene:add_bone("left", shape.sphere({-4, 0, 0}, 0.7):mesh{cell = 0.3})
scene:add_bone("right", shape.sphere({4, 0, 0}, 0.7):mesh{cell = 0.3})
local ball = shape.ellipsoid({0, 0, 0.3}, {0.9, 2.2, 1.2}):mesh{cell = 0.4}
scene:add_bone("ball", ball)
scene:tetrahedralize{edge_length = 0.7, bone_edge_length = 0.5}
local camera, size = {eye = {0, 0, 30}, target = {0, 0, 0}, fov = 26}, {400, 300}
local function wave(sign)                  -- pixels, from the left bone to the right one
  local list = {}
  for i = 0, 40 do
    local t = i / 40
    list[i + 1] = {112 + 175 * t, 150 - sign * (8 + 26 * math.sin(math.pi * t))}
  end
  return list
end
local clear, a = scene:draw_muscle("clear", {camera = camera, size = size, stroke = wave(1), tissue = 0.8})
local linear, b = scene:draw_muscle("linear", {camera = camera, size = size, stroke = wave(-1), tissue = 0.8,
                                               depth = "linear"})
scene:set_fat(0.3)
local show = {"muscles", "bones", "skin", "curves", "points"}
scene:render{file = out .. "/stroke.png", size = size, camera = camera, skin_opacity = 0.15, show = show}
scene:render{file = out .. "/stroke_top.png", size = size, camera = "top", skin_opacity = 0.15, show = show}

for i, r in ipairs{a, b} do
  local m = ({clear, linear})[i]
  local nearest = math.huge
  for _, p in ipairs(m:curve(101)) do
    nearest = math.min(nearest, ball:contains(p) and 0 or ball:closest(p).distance)
  end
  print(m:name(), r.origin, r.insertion, "points", m:point_count(), string.format("length %.3g", m:length()))
  print("", "in bone", string.format("%.2f", r.inside_bone), "outside", string.format("%.2f", r.outside_skin),
        "nearest to the ball", string.format("%.2f", nearest))
end
