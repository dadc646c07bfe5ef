-- fig12_fibers - muscle architectures with their fibers: parallel, fusiform, triangular, uni-, bi- and multipennate
-- (Fig. 12).
--
--     sinew scripts/figures/fig12_fibers.lua [-D out=FOLDER]
--
-- Writes fig12_fibers.png into `out` and prints the numbers. Each muscle is alone in a body, on bones that suit it; the
-- length under each is the mean of its fibers, the angle that between fibers and line of action, PCSA the
-- physiological cross-section: volume times cos(angle) over fiber length.
-- Options: -D size=EDGE_LENGTH of the tets, -D panel=WIDTH of a panel, 500 pixels or more, -D fibers=LINES in each.

local sheet = dofile((arg[0]:match("^.*/") or "") .. "sheet.lua")
sheet.folder()
size = size or 0.25
panel = panel or 520
fibers = fibers or 400

local shape = sinew.shape

-- ---- bodies (cm; y up, the muscles in front of the plane z = 0) ----

local function knob(y, direction)
  return shape.smooth_union(0.5, shape.capsule({0, y, 0}, {0, y + 1.6 * direction, 0}, 0.42),
                            shape.sphere({0, y, 0}, 0.62))
end

local function bar(y) return shape.capsule({-1.1, y, 0}, {1.1, y, 0}, 0.45) end

-- The point of a fan at a distance from its insertion; angle 0 is upwards.
local fan_end = sinew.vec3(0, -2.62, 0.25)
local function fan_point(degrees, distance, z)
  local a = math.rad(degrees)
  return sinew.vec3(distance * math.sin(a), fan_end.y + distance * math.cos(a), z)
end

local function crest()
  local parts = {}
  for a = -32, 24, 8 do
    parts[#parts + 1] = shape.capsule(fan_point(a, 5.65, 0), fan_point(a + 8, 5.65, 0), 0.42)
  end
  return shape.union(parts)
end

local function body(origin, insertion)
  local scene = sinew.scene{unit = "cm"}
  scene:set_skin(shape.ellipsoid({0, 0, 0}, {4.6, 6.2, 3.2}):mesh{cell = 1.6 * size})
  scene:add_bone("origin", origin:mesh{cell = 0.9 * size})
  scene:add_bone("insertion", insertion:mesh{cell = 0.9 * size})
  scene:tetrahedralize{edge_length = 1.4 * size, bone_edge_length = size, max_volume = 0.2 * size ^ 3}
  return scene
end

-- ---- muscles ----

local upright = {{0, 2.62, 0.25}, {0, 1.2, 0.4}, {0, -1.2, 0.4}, {0, -2.62, 0.25}}
-- e2 runs across the picture and e3 through it: the tissue spreads to a sheet that is seen from its flat side.
local sheet_frame = {axis = {1, 0, 0}, eigenvalues = {1, 2.5, 0.6}}
-- The other way round: the fibers of pennate muscles lean towards e3.
local leaning_frame = {axis = {0, 0, 1}, eigenvalues = {1, 0.6, 1.6}}

local fan = {}
for a = -30, 30, 7.5 do
  fan[#fan + 1] = {points = {fan_point(a, 5.25, 0.2), fan_point(a, 3.5, 0.3), fan_point(a, 1.8, 0.3), fan_end},
                   tissue = {0.9, 0.9, 0.7, 0.4}}
end

local strap_body, fan_body = body(bar(3.1), bar(-3.1)), body(crest(), knob(-3.2, -1))
local spindle_body = body(knob(3.2, 1), knob(-3.2, -1))
local pennate = {body = spindle_body, fat = 0.32, frame = leaning_frame,
                 curve = {points = upright, tissue = {0.5, 1.3, 1.3, 0.5}}}
local muscles = {
  {"Parallel", {kind = "parallel"},
    {body = strap_body, fat = 0.40, frame = sheet_frame, curve = {points = upright}}},
  {"Fusiform", {kind = "fusiform"},
    {body = spindle_body, fat = 0.30, curve = {points = upright, tissue = {0.35, 1.4, 1.4, 0.35}}}},
  {"Triangular", {kind = "convergent"},
    {body = fan_body, fat = 0.70, frame = {axis = {1, 0, 0}, eigenvalues = {1, 1, 0.4}}, curve = {heads = fan}}},
  {"Unipennate", {kind = "unipennate", angle = 25}, pennate},
  {"Bipennate", {kind = "bipennate", angle = 25}, pennate},
  {"Multipennate", {kind = "multipennate", angle = 25, sheets = 3}, pennate},
}

-- The body's scene with this muscle alone.
local function scene_of(kind, m)
  local scene = m.body
  for _, other in ipairs(scene:muscles()) do scene:remove_muscle(other) end
  local muscle = scene:add_muscle("muscle", m.curve)
  if m.frame then muscle:set_frame(m.frame) end
  muscle:set_pennation(kind)
  scene:set_fat(m.fat)
  return scene
end

-- ---- the sheet ----

local w, h = panel, math.floor(1.2 * panel)
local camera = {eye = {7, 4, 32}, target = {0, 0, 0.2}, fov = 15.2}
local s = sheet.new{rows = 2, columns = 3, panel = {w, h}, lines = 3, title = "Fibers of six muscle architectures",
                    note = "lines along the fiber field, from origin (above) to insertion; the body around is not shown"}
print("kind          volume   fiber length  pennation   PCSA")
for k, m in ipairs(muscles) do
  local label, kind, rest = table.unpack(m)
  local scene = scene_of(kind, rest)
  s.paste(k, scene:render{size = {w, h}, camera = camera, samples = 3, background = "#f5f2ee",
                          show = {"bones", "fibers"}, fiber_count = fibers})
  local a = scene:extract{}:part("muscle"):architecture{}
  s.label(k, "(" .. ("abcdef"):sub(k, k) .. ")  " .. label,
          string.format("fibers %.2f cm, pennation %.1f°", a.fiber_length, a.pennation_angle),
          string.format("PCSA %.2f cm², volume %.2f cm³", a.pcsa, a.volume))
  print(string.format("%-12s %6.2f cm3 %9.2f cm %8.1f deg %6.2f cm2", label, a.volume, a.fiber_length,
                      a.pennation_angle, a.pcsa))
end
sheet.save(s.img, "fig12_fibers.png")
