-- The fibers of a fusiform muscle that bends: together at its ends, apart in its belly.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "fibers", unit = "cm"}
scene:set_skin(shape.ellipsoid({0, 0, 0}, {3.5, 6.5, 3.5}):mesh{cell = 0.6})
scene:add_bone("top", shape.sphere({-0.8, 5, 0}, 0.6):mesh{cell = 0.3})
scene:add_bone("bottom", shape.sphere({-0.8, -5, 0}, 0.6):mesh{cell = 0.3})
scene:tetrahedralize{edge_length = 0.6, bone_edge_length = 0.4}
local m = scene:add_muscle("fusiform", {
  points = {{-0.8, 4.35, 0}, {0, 2.5, 0}, {0.4, 0, 0}, {0, -2.5, 0}, {-0.8, -4.35, 0}},
  tissue = {0.3, 0.6, 1.2, 0.6, 0.3}})
scene:set_fat(0.25)
scene:render{file = out .. "/fibers.png", size = {300, 480}, camera = "front", skin_opacity = 0.15,
             show = {"fibers", "bones", "skin"}, fiber_count = 80}

local part = scene:extract{}:part("fusiform")
local lines = part:fiber_lines{count = 80}
local sum, ends = 0, 0
for _, line in ipairs(lines) do
  for i = 2, #line do sum = sum + line[i]:distance(line[i - 1]) end
  if line[1].y > line[#line].y then ends = ends + 1 end
end
print("lines", #lines, "downwards", ends, string.format("mean length %.3g", sum / #lines))
local a = part:architecture()
print(string.format("fiber length %.3g", a.fiber_length), string.format("pcsa %.3g", a.pcsa),
      string.format("volume %.3g", a.volume), string.format("curve %.3g", m:length()))
local fibers, check = part:fibers()
local down, first, last = 0, 1, 0
for _, f in ipairs(fibers) do
  if f.direction.y < 0 then down = down + 1 end
  first, last = math.min(first, f.u), math.max(last, f.u)
end
print("tets", #fibers, "downwards", down, string.format("u from %.2f to %.2f", first, last))
print("sinks", check.sinks, "sources", check.sources, "flipped", check.flipped)
