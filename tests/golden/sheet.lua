-- A sheet of views with titles, put together and compared in the script.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "sheet", unit = "cm"}
scene:set_skin(shape.ellipsoid({0, 0, 0}, {4, 7, 4}):mesh{cell = 0.7})
scene:add_bone("shaft", shape.capsule({0, -5, -1}, {0, 5, -1}, 0.8, 0.8):mesh{cell = 0.5})
scene:tetrahedralize{edge_length = 0.9, bone_edge_length = 0.7}
scene:add_muscle("left", {points = {{0, 4.5, -0.1}, {-1.3, 2, 1}, {-1.3, -2, 1}, {0, -4.5, -0.1}}})
scene:add_muscle("right", {points = {{0.3, 4.5, -0.2}, {1.4, 2, 1}, {1.4, -2, 1}, {0.3, -4.5, -0.2}}})
local w, h, head = 160, 220, 24
local sheet = sinew.image.new{size = {3 * w, h + head}, background = "white"}
for i, camera in ipairs{"front", "right", "top"} do
  local x = 1 + (i - 1) * w
  local view = scene:render{size = {w, h}, camera = camera, skin_opacity = 0.2}
  sheet:paste(view, x, 1 + head)
  sheet:text{x = x + w / 2, y = 17, text = camera, size = 14, align = "center"}
  if i > 1 then sheet:line{points = {{x, 1}, {x, h + head}}, color = "#808080"} end
end
local whole = scene:render{size = {w, h}, camera = "iso", skin_opacity = 0.2}
sheet:fill{x = 8, y = head + 8, width = 44, height = 59, color = "#808080"}
sheet:paste(whole:resize(40, 55), 10, head + 10)
sheet:text{x = 3 * w - 6, y = h + head - 8, text = "5 cm", size = 12, color = "#804000", rotate = 90}
assert(sheet:save(out .. "/sheet.png"))

local again = assert(sinew.image.load(out .. "/sheet.png"))
print("size", again:width(), again:height(), "same", sinew.image.compare(sheet, again).equal)
print("frame", again:pixel(9, head + 9))
local tw, th, ascent = sinew.image.new{size = {1, 1}}:text_size{text = "front", size = 14}
print("text", tw, th, ascent)
print("views differ", not sinew.image.compare(whole, scene:render{size = {w, h}, camera = "front", skin_opacity = 0.2},
                                              {max = 12, count = 800}).equal)
