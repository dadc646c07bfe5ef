-- repair.lua - real dirty surfaces become usable: an artist's human, and the bones of OpenSim's gait2392.
--
--     sinew tests/real/repair.lua            writes out/human.obj, out/NAME.obj and pictures of them
--
-- The data is looked for in $SINEW_DATA, else in ../shared/data. Options: -D out=FOLDER, -D only=NAME.

out = assert(sinew.folder(out or "out"))
local data = os.getenv("SINEW_DATA") or "../shared/data"
local failed = 0

local function diagonal(s)
  local b = s:bounds()
  return b.min:distance(b.max)
end

local function describe(step)
  local words = {}
  for key, value in pairs(step) do
    if math.type(value) == "integer" and value ~= 0 then words[#words + 1] = key .. " " .. value end
  end
  table.sort(words)
  return string.format("    %-11s moved %.3g%s%s", step.name, step.moved, #words > 0 and ": " or "",
                       table.concat(words, ", "))
end

-- Repairs the surface in the file, by a wrap not farther away than `tolerance` of its size where one is needed; what is
-- seen of it is to be within `limit` of its size from the result.
local function mend(name, path, tolerance, limit, fill_holes)
  if only and only ~= name then return nil end
  local dirty = assert(sinew.surface.load(path))
  local size, start = diagonal(dirty), sinew.time()
  local s, report = dirty:repair{tolerance = tolerance * size, fill_holes = fill_holes and fill_holes * size}
  local c = s:check()
  local is_usable = c.closed and c.manifold and c.oriented and c.self_intersections == 0 and c.degenerate_faces == 0
  local is_near = report.steps[#report.steps].moved <= tolerance * size and report.missed <= limit * size
  print(string.format("%s: %s, %d faces, %d components, volume %.4g (was %.4g), moved %.2f %%, missed %.2f %%: %s", name,
                      report.wrapped and "wrapped" or "mended", s:face_count(), c.components, s:volume(), dirty:volume(),
                      100 * report.moved / size, 100 * report.missed / size, is_usable and is_near and "true" or "FALSE"))
  for _, step in ipairs(report.steps) do print(describe(step)) end
  io.stderr:write(string.format("%-12s %6.2f s\n", name, sinew.time() - start))
  if not (is_usable and is_near) then failed = failed + 1 end
  assert(s:save(out .. "/" .. name .. ".obj"))
  return s
end

-- What is not kept of the human lies in creases narrower than the tolerance, which are bridged.
local human = mend("human", data .. "/human/skin.obj", 0.003, 0.007, 0.01)
if human then
  local scene = sinew.scene{name = "human", unit = "dm", up = "y"}
  local body, report = human:repair{components = "largest", wrap = "never"} -- without the cube under its feet
  if report.check.components ~= 1 then failed = failed + 1 end
  scene:set_skin(body)
  scene:render{file = out .. "/human.png", size = {900, 900}, camera = "front", show = {"skin"}, skin_opacity = 1}
end

local bones = sinew.scene{name = "gait2392", unit = "m", up = "y"}
for _, name in ipairs{"pelvis__pelvis", "pelvis__l_pelvis", "pelvis__sacrum", "torso__hat_spine", "torso__hat_skull",
                      "torso__hat_jaw", "torso__hat_ribs", "calcn_r__foot", "toes_r__bofoot"} do
  local is_open = name == "torso__hat_skull" -- an open bowl: its base is missing
  local bone = mend(name, data .. "/gait2392/posed/" .. name .. ".obj", 0.006, 0.02, is_open and 0.9 or nil)
  if bone then bones:add_bone(name, bone) end
end
if #bones:bones() > 0 then
  for _, view in ipairs{"front", "right"} do
    bones:render{file = out .. "/gait2392_" .. view .. ".png", size = {900, 1200}, camera = view, show = {"bones"}}
  end
end
print(failed .. " surfaces are not as wanted")
