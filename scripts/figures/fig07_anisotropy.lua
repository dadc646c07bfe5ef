-- fig07_anisotropy - how the frame and the eigenvalues of a muscle change its shape (Fig. 7).
--
--     sinew scripts/figures/fig07_anisotropy.lua [-D out=FOLDER]
--
-- Writes fig07_anisotropy.png into `out` and prints the volumes. One muscle between two bones in a body; (a) and (b)
-- are flat and differ by the rotation of e2 and e3 about the curve, (c) to (f) by the rate along e2 or e3. All six are
-- seen alike; the small picture in the corner is the section half way, seen from above.
-- Options: -D size=EDGE_LENGTH of the tets, -D panel=WIDTH of a panel, 500 pixels or more.

local sheet = dofile((arg[0]:match("^.*/") or "") .. "sheet.lua")
sheet.folder()
size = size or 0.075
panel = panel or 520

local shape = sinew.shape

-- ---- the body: a limb with a long bone at each end (cm; y along the limb) ----

local scene = sinew.scene{name = "limb", unit = "cm"}
scene:set_skin(shape.ellipsoid({0, 0, 0}, {1.5, 2.3, 1.5}):mesh{cell = 1.3 * size})
local function bone(y, direction)
  return shape.smooth_union(0.2, shape.capsule({0, y, 0}, {0, y + 0.6 * direction, 0}, 0.17),
                            shape.sphere({0, y, 0}, 0.26))
end
scene:add_bone("upper", bone(1.25, 1):mesh{cell = 0.9 * size})
scene:add_bone("lower", bone(-1.25, -1):mesh{cell = 0.9 * size})
scene:tetrahedralize{edge_length = size}

local m = scene:add_muscle("muscle", {points = {{0, 1.02, 0.06}, {0, 0.45, 0.16}, {0, -0.45, 0.16}, {0, -1.02, 0.06}},
                                      tissue = {0.7, 1, 1, 0.7}})
scene:set_fat(0.45)

-- ---- the six ----

-- At angle 0, e2 points to the right of the picture's front and e3 towards the eye's side.
local axis = {1, 0, 0}
local cases = {
  {"(a)  frame turned by 0°", 0, {1, 4, 0.25}},
  {"(b)  frame turned by 60°", 60, {1, 4, 0.25}},
  {"(c)  λ₂ small", 0, {1, 0.2, 1}},
  {"(d)  λ₂ large", 0, {1, 5, 1}},
  {"(e)  λ₃ small", 0, {1, 1, 0.2}},
  {"(f)  λ₃ large", 0, {1, 1, 5}},
}

-- ---- the pictures ----

local w, h = panel, math.floor(1.02 * panel)
local ground = "#f5f2ee"
local eye = {eye = {4.4, 3.4, 12}, target = {0.22, 0, 0.05}, fov = 11.6}

-- Muscle and bones, and the arrows over them: inside the muscle they would be faint.
local function view()
  local img = scene:render{size = {w, h}, camera = eye, samples = 3, background = ground, show = {"muscles", "bones"}}
  return img:paste(scene:render{size = {w, h}, camera = eye, samples = 3, background = "transparent",
                                show = {"frames"}}, 1, 1)
end

-- A 2D arrow of `length` pixels from (x, y).
local function arrow(img, x, y, dx, dy, length, color)
  local n = math.sqrt(dx * dx + dy * dy)
  dx, dy = dx / n, dy / n
  local tx, ty = x + length * dx, y + length * dy
  img:line{points = {{x, y}, {tx, ty}}, width = 3, color = color}
  for side = -1, 1, 2 do
    local bx, by = tx - 8 * dx - side * 5 * dy, ty - 8 * dy + side * 5 * dx
    img:line{points = {{bx, by}, {tx, ty}}, width = 3, color = color}
  end
end

-- The section half way along the curve, seen from above (the front is below), with e2 and e3 as long as the roots of
-- their eigenvalues.
local function section(side, l)
  local middle = m:curve(101)[51]
  local camera = {eye = middle + sinew.vec3(0, 20, 0), target = middle, up = {0, 0, -1}, fov = 4.6}
  local img = scene:render{size = {side, side}, camera = camera, samples = 3, show = {"muscles"},
                           clip = {point = middle, normal = {0, 1, 0}}}
  local c, frame, most = (side + 1) / 2, m:frame(), math.sqrt(math.max(l[2], l[3]))
  arrow(img, c, c, frame.e3.x, frame.e3.z, 0.36 * side * math.sqrt(l[3]) / most, "#2455c7")
  arrow(img, c, c, frame.e2.x, frame.e2.z, 0.36 * side * math.sqrt(l[2]) / most, "#218c33")
  sheet.frame(img, 1, 1, side, side)
  return img
end

local s = sheet.new{rows = 2, columns = 3, panel = {w, h}, lines = 2,
                    title = "Anisotropy: the frame and the eigenvalues of one muscle",
                    note = "arrows: e₁ (red, along the curve), e₂ (green) and e₃ (blue), as long as the root of their "
                           .. "eigenvalue; in the corner the section half way, from above"}
for k, case in ipairs(cases) do
  local label, angle, l = table.unpack(case)
  m:set_frame{angle = angle, eigenvalues = l, axis = axis}
  local side = math.floor(0.31 * w)
  local img = view()
  img:paste(section(side, l), w - side - 11, h - side - 11)
  s.paste(k, img)
  s.label(k, label, string.format("λ = (%g, %g, %g), angle %g°", l[1], l[2], l[3], angle))
  print(string.format("(%s)  angle %2g°  eigenvalues (%g, %g, %g)  volume %.3f cm3", ("abcdef"):sub(k, k), angle, l[1],
                      l[2], l[3], m:volume()))
end
sheet.save(s.img, "fig07_anisotropy.png")
