-- Fibers at an angle to the line of action: to one side, to a sheet in the middle, and to two sheets.
out = out or "out"
local shape = sinew.shape
local scene = sinew.scene{name = "pennation", unit = "cm"}
scene:set_skin(shape.box({0, 0, 0}, {7.5, 5, 2.5}, 1.2):mesh{cell = 0.7})
local kinds = {{kind = "unipennate", angle = 25}, {kind = "bipennate", angle = 25},
               {kind = "multipennate", angle = {30, 10}, sheets = 2}}
for i, pennation in ipairs(kinds) do
  local x = 4.6 * (i - 2)
  scene:add_bone(pennation.kind .. "_top", shape.sphere({x, 3.8, 0}, 0.5):mesh{cell = 0.3})
  scene:add_bone(pennation.kind .. "_bottom", shape.sphere({x, -3.8, 0}, 0.5):mesh{cell = 0.3})
end
scene:tetrahedralize{edge_length = 0.9, bone_edge_length = 0.6}
for i, pennation in ipairs(kinds) do
  local x = 4.6 * (i - 2)
  local m = scene:add_muscle(pennation.kind, {points = {{x, 3.25, 0}, {x, 1.2, 0}, {x, -1.2, 0}, {x, -3.25, 0}},
                                              tissue = {0.7, 1, 1, 0.7}})
  m:set_frame{axis = {0, 0, 1}}            -- the sheet stands upright to the picture
  m:set_pennation(pennation)
end
scene:set_fat(0.3)
scene:render{file = out .. "/pennation.png", size = {520, 360}, camera = "front", skin_opacity = 0.15,
             show = {"fibers", "bones", "skin", "frames"}, fiber_count = 150}

local x = scene:extract{}
for _, m in ipairs(scene:muscles()) do
  local part, left, right, lean = x:part(m:name()), 0, 0, 0
  local n = part:tet_count()
  for _, f in ipairs(part:fibers()) do
    if f.direction.x < -0.1 then left = left + 1 elseif f.direction.x > 0.1 then right = right + 1 end
    lean = lean + math.deg(math.acos(math.min(1, -f.direction.y)))
  end
  local a = part:architecture()
  print(m:name(), string.format("angle %.3g", a.pennation_angle), string.format("mean lean %.3g", lean / n),
        string.format("fiber length %.3g", a.fiber_length), string.format("pcsa %.3g", a.pcsa))
  print("", string.format("to the left %.2f", left / n), string.format("to the right %.2f", right / n))
end
