-- fig05_06_slab - the tissue functions of two muscles in a slab, and the tissue at each point (Fig. 5 and 6).
--
--     sinew scripts/figures/fig05_06_slab.lua [-D out=FOLDER]
--
-- Writes fig05_06_slab.png into `out`. The paper's pictures are of a plane. A thin slab between two plates of bone is
-- one: bone carries natural conditions, so nothing changes across the slab, and only its rim is skin. Units of length
-- are the half width of the plane's outline.
-- Options: -D size=EDGE_LENGTH of the tets, -D panel=WIDTH of a panel, 500 pixels or more.

local sheet = dofile((arg[0]:match("^.*/") or "") .. "sheet.lua")
sheet.folder()
size = size or 0.026
panel = panel or 560

local half_thickness = 0.03
local fat = 0.2

-- ---- the slab ----

-- A point of the outline, a rounded bean that is star-shaped about the origin; `inside` shrinks it.
local function rim_point(angle, inside)
  local r = (0.86 + 0.10 * math.cos(2 * angle) + 0.05 * math.sin(3 * angle + 0.4)) * (1 - (inside or 0))
  return {r * math.cos(angle), 0.86 * r * math.sin(angle)}
end

local function outline(n)                                    -- n points counter-clockwise
  local points = {}
  for i = 1, n do points[i] = rim_point(2 * math.pi * (i - 1) / n) end
  return points
end

-- The closed surface between two copies of the outline, `grow` times as large, at z = -h and h. Each copy is cut into
-- rings of triangles about as large as the tets will be: needles from the middle to the rim would take long to remesh.
local function prism(grow, h)
  local n_ring = math.ceil(0.9 * grow / (2 * size))
  local n = 6 * n_ring
  local rim = outline(n)
  local vertices, faces = {{0, 0, -h}, {0, 0, h}}, {}
  local function at(ring, i) return ring == 0 and 1 or 2 * ((ring - 1) * n + i % n) + 3 end   -- below; +1: above
  local function both(a, b, c)
    faces[#faces + 1] = {a, c, b}
    faces[#faces + 1] = {a + 1, b + 1, c + 1}
  end
  for ring = 1, n_ring do
    local t = grow * ring / n_ring
    for i = 0, n - 1 do
      local x, y = t * rim[i + 1][1], t * rim[i + 1][2]
      vertices[#vertices + 1], vertices[#vertices + 2] = {x, y, -h}, {x, y, h}
      both(at(ring - 1, i), at(ring, i), at(ring, i + 1))
      if ring > 1 then both(at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1)) end
    end
  end
  for i = 0, n - 1 do
    local a, b = at(n_ring, i), at(n_ring, i + 1)
    faces[#faces + 1] = {a, b, b + 1}
    faces[#faces + 1] = {a, b + 1, a + 1}
  end
  return sinew.surface.new(vertices, faces)
end

-- A plate of bone a little wider than the skin.
local function plate(z0, z1)
  return prism(1.03, (z1 - z0) / 2):transform{translate = {0, 0, (z0 + z1) / 2}}
end

local scene = sinew.scene{name = "slab", unit = "half widths"}
scene:set_skin(prism(1, 2 * half_thickness))
scene:add_bone("plate below", plate(-3 * half_thickness, -half_thickness))
scene:add_bone("plate above", plate(half_thickness, 3 * half_thickness))
local mesh = scene:tetrahedralize{edge_length = size, bone_edge_length = size}

local muscles = {
  {"f1", {{-0.60, -0.02, 0}, {-0.38, 0.25, 0}, {-0.05, 0.36, 0}, {0.30, 0.30, 0}}, "#c8443c"},
  {"f2", {{-0.18, -0.36, 0}, {0.10, -0.24, 0}, {0.36, -0.14, 0}, {0.62, 0.02, 0}}, "#e2933d"},
}
for _, m in ipairs(muscles) do scene:add_muscle(m[1], {points = m[2], tissue = 1}) end
scene:set_fat(fat)
scene:solve()

-- ---- samples of the middle plane ----

local w, h = panel, math.floor(0.82 * panel)
local scale = w / 1.97                                       -- pixels per half width
local middle = {w / 2 - 0.010 * scale, 0.46 * h}             -- the pixel of the origin
local function to_pixel(x, y) return middle[1] + scale * x, middle[2] - scale * y end
local function to_place(i, j) return (i - middle[1]) / scale, (middle[2] - j) / scale end

-- f[name][j][i], nil outside; one pixel more on each side than is drawn, for the slopes.
local names = {"f1", "f2", "fat"}
local f = {f1 = {}, f2 = {}, fat = {}}
for j = 0, h + 1 do
  for _, name in ipairs(names) do f[name][j] = {} end
  for i = 0, w + 1 do
    local x, y = to_place(i, j)
    local v = scene:values_at{x, y, 0}
    for _, name in ipairs(names) do f[name][j][i] = v and v[name] end
  end
end

-- How fast a function of (i, j) changes per pixel there.
local function slope(at, i, j)
  local c, a, b = at(i, j), at(i + 1, j) or at(i - 1, j), at(i, j + 1) or at(i, j - 1)
  return a and b and math.sqrt((a - c) ^ 2 + (b - c) ^ 2) or 0
end

-- How much of the pixel a line of `width` pixels covers whose middle is `distance` pixels away.
local function cover(distance, width)
  return math.min(math.max((width + 1) / 2 - distance, 0), 1)
end

-- ---- drawing ----

local function rim(img, x0, y0, width)
  local points = {}
  for i, p in ipairs(outline(400)) do
    local x, y = to_pixel(p[1], p[2])
    points[i] = {x0 + x, y0 + y}
  end
  points[#points + 1] = points[1]
  img:line{points = points, width = width, color = sheet.skin}
end

local function curves(img, x0, y0, color)
  for _, m in ipairs(muscles) do
    local points = {}
    for k, p in ipairs(scene:muscle(m[1]):curve(100)) do
      local x, y = to_pixel(p.x, p.y)
      points[k] = {x0 + x, y0 + y}
    end
    img:line{points = points, width = 6, color = "white"}
    img:line{points = points, width = 3.5, color = color or m[3]}
  end
end

local function name_at(img, x0, y0, x, y, text, color)
  local px, py = to_pixel(x, y)
  img:text{x = x0 + px, y = y0 + py, text = text, size = 22, color = color or sheet.ink, align = "center"}
end

local white, black = {1, 1, 1}, {0, 0, 0}

-- A colour map of one function with contour lines every `step`; its colours run from 0 to `top`.
local function map(img, x0, y0, name, top, step)
  local function at(i, j) return f[name][j] and f[name][j][i] end
  sheet.pixels(img, x0, y0, w, h, function(i, j)
    local v = at(i, j)
    if not v then return nil end
    local c, s = sheet.color(v / top), slope(at, i, j)
    local nearest = step * math.floor(v / step + 0.5)
    if s == 0 or nearest <= 0 or nearest > top - step / 2 then return c end
    return sheet.mix(c, nearest > 0.55 * top and black or white, 0.55 * cover(math.abs(v - nearest) / s, 1))
  end)
  rim(img, x0, y0, 7)
end

-- The colours of a map from 0 to `top`, below it.
local function legend(img, x0, y0, top)
  local width, height = 260, 12
  local x, y = math.floor(x0 + (w - width) / 2), y0 + h - 34
  for k = 0, width - 1 do
    img:fill{x = x + k, y = y, width = 1, height = height, color = sheet.hex(sheet.color(k / (width - 1)))}
  end
  for _, v in ipairs{0, top / 2, top} do
    local at = x + (width - 1) * v / top
    img:line{points = {{at, y + height}, {at, y + height + 4}}, color = sheet.ink}
    img:text{x = at, y = y + height + 19, text = string.format("%g", v), size = 15, color = sheet.ink, align = "center"}
  end
end

local tint = {f1 = sheet.rgb("#dc7f76"), f2 = sheet.rgb("#f2bd84"), fat = sheet.rgb("#f4ecd8")}

-- The tissue of each point, with soft edges: each pixel is mixed from the best two by how near they are to a tie.
local function segmentation(img, x0, y0)
  sheet.pixels(img, x0, y0, w, h, function(i, j)
    if not f.fat[j][i] then return nil end
    local order = {table.unpack(names)}
    table.sort(order, function(a, b) return f[a][j][i] > f[b][j][i] end)
    local best, next = order[1], order[2]
    local function lead(p, q) return f[best][q] and f[best][q][p] and f[best][q][p] - f[next][q][p] end
    local s = slope(lead, i, j)
    local distance = s > 0 and lead(i, j) / s or 1
    local c = sheet.mix(tint[best], tint[next], math.max(0.5 - distance, 0))
    return sheet.mix(c, sheet.rgb(sheet.ink), 0.8 * cover(distance, 2))
  end)
  rim(img, x0, y0, 7)
end

-- ---- the values along a line ----

local from, to = rim_point(math.rad(92), 0.01), rim_point(math.rad(-74), 0.01)
local line_color = {f1 = "#c8443c", f2 = "#e2933d", fat = "#9a8a5c"}

local function section_line(img, x0, y0)
  local ax, ay = to_pixel(from[1], from[2])
  local bx, by = to_pixel(to[1], to[2])
  for k = 0, 23 do
    local t0, t1 = k / 24, (k + 0.6) / 24
    img:line{points = {{x0 + ax + t0 * (bx - ax), y0 + ay + t0 * (by - ay)},
                       {x0 + ax + t1 * (bx - ax), y0 + ay + t1 * (by - ay)}}, width = 2, color = sheet.ink}
  end
  img:text{x = x0 + ax, y = y0 + ay - 14, text = "A", size = 19, color = sheet.ink, align = "center"}
  img:text{x = x0 + bx, y = y0 + by + 28, text = "B", size = 19, color = sheet.ink, align = "center"}
end

-- The three functions from A to B, the largest drawn thick; the strip below has the winner's colour.
local function profile(img, x0, y0)
  local left, right, top, bottom = x0 + 62, x0 + w - 16, y0 + 26, y0 + h - 74
  local n = 400
  local function px(t) return left + t * (right - left) end
  local function py(v) return bottom - (bottom - top) * v / 1.05 end
  for v = 0, 1, 0.25 do
    img:line{points = {{left, py(v)}, {right, py(v)}}, color = v == 0 and sheet.ink or "#e4e4e4"}
    img:text{x = left - 10, y = py(v) + 5, text = string.format("%g", v), size = 15, color = sheet.soft,
             align = "right"}
  end
  local lines, best = {f1 = {}, f2 = {}, fat = {}}, {}
  for k = 0, n do
    local t = k / n
    local v = scene:values_at{from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2]), 0}
    best[k] = "fat"
    for _, name in ipairs(names) do
      if v[name] > v[best[k]] then best[k] = name end
      lines[name][k + 1] = {px(t), py(v[name])}
    end
    img:fill{x = math.floor(px(t)), y = math.floor(bottom) + 12, width = math.ceil((right - left) / n) + 1, height = 16,
             color = sheet.hex(tint[best[k]])}
  end
  for _, name in ipairs(names) do img:line{points = lines[name], width = 1.5, color = line_color[name]} end
  local first = 0
  for k = 1, n + 1 do
    if best[k] ~= best[first] then
      img:line{points = table.move(lines[best[first]], first + 1, math.min(k + 1, n + 1), 1, {}), width = 4.5,
               color = line_color[best[first]]}
      first = k
    end
  end
  img:text{x = left, y = bottom + 52, text = "A", size = 19, color = sheet.ink, align = "center"}
  img:text{x = right, y = bottom + 52, text = "B", size = 19, color = sheet.ink, align = "center"}
  img:text{x = (left + right) / 2, y = bottom + 52, text = "tissue with the largest value", size = 15,
           color = sheet.soft, align = "center"}
  local function peak(name)
    local p = lines[name][1]
    for _, q in ipairs(lines[name]) do if q[2] < p[2] then p = q end end
    return p
  end
  local function name(x, y, text, color)
    img:text{x = x, y = y, text = text, size = 22, color = color, align = "center"}
  end
  local p1, p2 = peak("f1"), peak("f2")
  name(p1[1] - 26, p1[2] + 26, "f₁", line_color.f1)
  name(p2[1] + 26, p2[2] + 26, "f₂", line_color.f2)
  name(left + 9, py(fat) - 12, "fₛ", line_color.fat)
end

-- ---- the sheet ----

local s = sheet.new{rows = 2, columns = 3, panel = {w, h}, lines = 2,
                    title = "Two muscle curves in a slab: tissue functions and segmentation",
                    note = string.format("fat on the skin %g, tissue value of both curves 1, alpha %g; %d tets", fat,
                                         scene:alpha(), mesh.tets)}

local x, y = s.place(1)
sheet.pixels(s.img, x - 1, y - 1, w, h, function(i, j) return f.fat[j][i] and sheet.rgb("#f3fbf9") or nil end)
rim(s.img, x - 1, y - 1, 10)
curves(s.img, x - 1, y - 1, "#c03028")
name_at(s.img, x - 1, y - 1, -0.05, 0.44, "∂Ω₁")
name_at(s.img, x - 1, y - 1, 0.36, -0.32, "∂Ω₂")
name_at(s.img, x - 1, y - 1, -0.45, -0.25, "Ω", sheet.soft)
s.label(1, "(a)  curves and skin", "fₛ = " .. fat .. " on the skin, fᵢ = 1 on curve i, 0 on the others")

for k, name in ipairs(names) do
  x, y = s.place(k + 1)
  local top = name == "fat" and fat or 1
  map(s.img, x - 1, y - 1, name, top, top / 10)
  legend(s.img, x - 1, y - 1, top)
  local function largest()
    local v = 0
    for j = 1, h do for i = 1, w do v = math.max(v, f[name][j][i] or 0) end end
    return v
  end
  s.label(k + 1, "(" .. ("bcd"):sub(k, k) .. ")  " .. ({f1 = "f₁", f2 = "f₂", fat = "fₛ, fat"})[name],
          string.format("contour lines every %g; largest value %.2f", top / 10, largest()))
end

x, y = s.place(5)
profile(s.img, x - 1, y - 1)
s.label(5, "Fig. 6 left: each point has a value of every tissue", "along the dashed line from A to B")
x, y = s.place(6)
segmentation(s.img, x - 1, y - 1)
curves(s.img, x - 1, y - 1)
section_line(s.img, x - 1, y - 1)
s.label(6, "Fig. 6 right: the tissue of a point is the largest", "muscle 1, muscle 2 and fat")

sheet.save(s.img, "fig05_06_slab.png")
