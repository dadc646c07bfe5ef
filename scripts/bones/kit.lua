-- kit - what the scripts of the bone library share: shapes in millimetres, closed meshes, symmetric meshes, cages and
-- pieces of skin, and the two files of each bone.
--
--     local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
--
-- A script works in millimetres in the frame of the left bone: +x lateral, +y up, +z anterior. The files are in metres:
-- NAME.obj with the objects NAME, cage and skin, NAME.txt with the kind, the axis, landmarks and joints.

local shape, vec3 = sinew.shape, sinew.vec3
local simplify = dofile((arg[0]:match("^.*/") or "") .. "simplify.lua")
local kit = {folder = out or "assets/bones"}
if not out then assert(sinew.folder("assets")) end
assert(sinew.folder(kit.folder))

-- ---- shapes ----

function kit.ball(x, y, z, r) return shape.sphere({x, y, z}, r) end

-- An ellipsoid {x, y, z} with radii, turned about its centre: axis and degrees, as often as wanted.
function kit.egg(center, radii, ...)
  local s, turn = shape.ellipsoid({0, 0, 0}, radii), {...}
  for i = 1, #turn, 2 do s = s:transform{rotate = {axis = turn[i], degrees = turn[i + 1]}} end
  return s:transform{translate = center}
end

-- A cone with round ends through the places {x, y, z, radius}, straight from one to the next.
function kit.chain(nodes)
  local list = {}
  for i = 1, #nodes - 1 do
    local a, b = nodes[i], nodes[i + 1]
    list[i] = shape.capsule({a[1], a[2], a[3]}, {b[1], b[2], b[3]}, a[4], b[4])
  end
  return shape.union(list)
end

local function catmull_rom(p0, p1, p2, p3, t)
  local q = {}
  for k = 1, #p1 do
    local a, b, c, d = p0[k], p1[k], p2[k], p3[k]
    q[k] = b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))
  end
  return q
end

-- The Catmull-Rom spline through places of any dimension, n steps from one to the next.
function kit.spline(nodes, n)
  local list = {nodes[1]}
  for i = 1, #nodes - 1 do
    for k = 1, n do
      list[#list + 1] = catmull_rom(nodes[math.max(i - 1, 1)], nodes[i], nodes[i + 1],
                                    nodes[math.min(i + 2, #nodes)], k / n)
    end
  end
  return list
end

-- As chain, on a smooth curve.
function kit.tube(nodes, n) return kit.chain(kit.spline(nodes, n or 4)) end

-- Triangles, r thick to each side, between the rows of a net of places; rows of one length.
function kit.net(r, rows)
  local list = {}
  for i = 1, #rows - 1 do
    local p, q = rows[i], rows[i + 1]
    for j = 1, #p - 1 do
      list[#list + 1] = shape.plate(p[j], q[j], q[j + 1], r)
      list[#list + 1] = shape.plate(p[j], q[j + 1], p[j + 1], r)
    end
  end
  return shape.union(list)
end

-- Triangles from a hub to each side of a line of places.
function kit.fan(r, hub, rim)
  local list = {}
  for i = 1, #rim - 1 do list[i] = shape.plate(hub, rim[i], rim[i + 1], r) end
  return shape.union(list)
end

-- An elliptic disc: radii rx, rz across, h half as high, edges rounded by e.
function kit.disc(center, rx, h, rz, e)
  local round = shape.capsule({0, -4 * h, 0}, {0, 4 * h, 0}, 1.0 * rx)
  local s = shape.smooth_subtract(2 * e, round, shape.box({0, 6 * h, 0}, {3 * rx, 5 * h, 3 * rx}))
  s = shape.smooth_subtract(2 * e, s, shape.box({0, -6 * h, 0}, {3 * rx, 5 * h, 3 * rx}))
  return s:transform{scale = {1, 1, rz / rx}, translate = center}
end

function kit.blend(k, ...) return shape.smooth_union(k, ...) end

-- s without each of the shapes in the list, rims rounded over k.
function kit.carve(k, s, list)
  for _, hole in ipairs(list) do s = shape.smooth_subtract(k, s, hole) end
  return s
end

-- s and its mirror image in x = 0.
function kit.both(s) return shape.union(s, s:mirror{normal = {1, 0, 0}}) end

-- The half space on the side that the normal points to, near enough: one very large ball.
function kit.beyond(point, normal)
  local n = vec3(normal):unit()
  return shape.sphere(vec3(point) + n * 1e5, 1e5)
end

-- ---- meshes: {vertices = list of {x, y, z}, faces = list of {a, b, c}} ----

function kit.mesh_of(surface)
  local m = {vertices = {}, faces = {}}
  for i = 1, surface:vertex_count() do
    local p = surface:vertex(i)
    m.vertices[i] = {p.x, p.y, p.z}
  end
  for i = 1, surface:face_count() do m.faces[i] = surface:face(i) end
  return m
end

function kit.surface_of(m) return sinew.surface.new(m.vertices, m.faces) end

-- The mesh without vertices that no face uses.
local function compact(m)
  local new, vertices, faces = {}, {}, {}
  for i, f in ipairs(m.faces) do
    local g = {}
    for k = 1, 3 do
      if not new[f[k]] then
        vertices[#vertices + 1] = m.vertices[f[k]]
        new[f[k]] = #vertices
      end
      g[k] = new[f[k]]
    end
    faces[i] = g
  end
  return {vertices = vertices, faces = faces}
end

-- Pushes f without the corners below the plane as triangles; at(a, b) is the vertex on the plane between two.
local function clip_face(f, side, at, faces)
  local poly = {}
  for k = 1, 3 do
    local a, b = f[k], f[k % 3 + 1]
    if side[a] >= 0 then poly[#poly + 1] = a end
    if side[a] * side[b] < 0 then poly[#poly + 1] = at(a, b) end
  end
  for k = 3, #poly do faces[#faces + 1] = {poly[1], poly[k - 1], poly[k]} end
end

-- What lies on the side of the plane that the normal (one of the axes, or any unit vector) points to. Vertices nearer
-- to the plane than snap are moved onto it first; faces that lie in it are left out.
function kit.clip(m, point, normal, snap)
  local vertices, side, faces, cut = {}, {}, {}, {}
  for i, p in ipairs(m.vertices) do
    local d = 0
    for k = 1, 3 do d = d + (p[k] - point[k]) * normal[k] end
    local near = math.abs(d) < snap
    side[i] = near and 0 or d
    vertices[i] = near and {p[1] - d * normal[1], p[2] - d * normal[2], p[3] - d * normal[3]} or p
  end
  local function at(a, b)
    if a > b then a, b = b, a end
    local key = a .. " " .. b
    if not cut[key] then
      local t, p, q = side[a] / (side[a] - side[b]), vertices[a], vertices[b]
      vertices[#vertices + 1] = {p[1] + t * (q[1] - p[1]), p[2] + t * (q[2] - p[2]), p[3] + t * (q[3] - p[3])}
      side[#vertices] = 0
      cut[key] = #vertices
    end
    return cut[key]
  end
  for _, f in ipairs(m.faces) do
    local a, b, c = side[f[1]], side[f[2]], side[f[3]]
    if math.max(a, b, c) > 0 then
      if math.min(a, b, c) < 0 then clip_face(f, side, at, faces) else faces[#faces + 1] = f end
    end
  end
  return compact{vertices = vertices, faces = faces}
end

-- The half with x > 0 and its mirror image, sewn together in x = 0; with n, simplified to that many faces.
function kit.symmetric(m, snap, n)
  local half = kit.clip(m, {0, 0, 0}, {1, 0, 0}, snap)
  if n then half = simplify(half, n // 2) end
  local vertices, faces, twin = {}, {}, {}
  for i, p in ipairs(half.vertices) do vertices[i] = math.abs(p[1]) < 1e-9 and {0, p[2], p[3]} or p end
  for i = 1, #half.vertices do
    local p = vertices[i]
    if p[1] ~= 0 then vertices[#vertices + 1] = {-p[1], p[2], p[3]} end
    twin[i] = p[1] ~= 0 and #vertices or i
  end
  for i, f in ipairs(half.faces) do faces[i] = f end
  for _, f in ipairs(half.faces) do faces[#faces + 1] = {twin[f[1]], twin[f[3]], twin[f[2]]} end
  return {vertices = vertices, faces = faces}
end

-- The largest connected piece of a mesh: slivers that a cut leaves behind go.
local function largest_piece(m)
  local parent = {}
  for i = 1, #m.vertices do parent[i] = i end
  local function root(i)
    while parent[i] ~= i do
      parent[i] = parent[parent[i]]
      i = parent[i]
    end
    return i
  end
  for _, f in ipairs(m.faces) do
    parent[root(f[2])] = root(f[1])
    parent[root(f[3])] = root(f[1])
  end
  local count, best = {}, nil
  for _, f in ipairs(m.faces) do
    local r = root(f[1])
    count[r] = (count[r] or 0) + 1
    if not best or count[r] > count[best] then best = r end
  end
  local kept = {}
  for _, f in ipairs(m.faces) do
    if root(f[1]) == best then kept[#kept + 1] = f end
  end
  return compact{vertices = m.vertices, faces = kept}
end

-- Metres, rounded as they will be written.
local function to_metres(m)
  local vertices = {}
  for i, p in ipairs(m.vertices) do
    vertices[i] = {}
    for k = 1, 3 do vertices[i][k] = tonumber(string.format("%.6f", p[k] * 1e-3)) + 0.0 end
  end
  return {vertices = vertices, faces = m.faces}
end

local function is_sound(m)
  local c = kit.surface_of(m):check()
  local sound = c.closed and c.manifold and c.oriented and c.components == 1 and c.self_intersections == 0
                and c.degenerate_faces == 0
  local format = "closed %s, manifold %s, oriented %s, %d components, %d self-intersections, %d degenerate faces"
  return sound, string.format(format, c.closed, c.manifold, c.oriented, c.components, c.self_intersections,
                              c.degenerate_faces)
end

-- A shape's closed mesh in metres, of about n faces where n is given, symmetric on request. Simplifying knows nothing
-- of faces that come near from elsewhere, and the plane of symmetry may touch the surface: where the result is not
-- sound, a few faces more or less and other distances for snapping are tried.
local function closed_mesh(name, s, cell, n, symmetric)
  local fine, message = kit.mesh_of(s:mesh{cell = cell}), nil
  for i, step in ipairs{0, 4, -4, 8, -8, 12, -12} do
    local count, m = n and n + n * step // 100, fine
    if symmetric then
      m = kit.symmetric(fine, ({0.25, 0.15, 0.35, 0.20, 0.30, 0.10, 0.40})[i] * cell, count)
    elseif n then
      m = simplify(fine, count)
    end
    local sound
    m = to_metres(m)
    sound, message = is_sound(m)
    if sound then return m end
    if not n and not symmetric then break end
  end
  error(name .. ": " .. message)
end

-- The piece of a closed skin that the planes {point, normal} leave.
local function skin_piece(s, symmetric)
  local m = kit.mesh_of(s.shape:mesh{cell = s.cell})
  if symmetric then m = kit.symmetric(m, 0.25 * s.cell) end
  for _, plane in ipairs(s.planes) do
    local n = vec3(plane[2]):unit()
    m = kit.clip(m, plane[1], {n.x, n.y, n.z}, 0.3 * s.cell)
  end
  m = to_metres(largest_piece(m))
  assert(not kit.surface_of(m):check().closed, "the skin is a closed surface, wanted an open piece")
  return m
end

-- The bone lies under its skin.
local function check_under_skin(name, m, skin)
  for _, p in ipairs(m.vertices) do
    local depth = -skin.shape:value{p[1] * 1e3, p[2] * 1e3, p[3] * 1e3}
    assert(depth > 1, string.format("%s: %g mm under the skin at %.1f %.1f %.1f, wanted 1 mm", name, depth, p[1] * 1e3,
                                    p[2] * 1e3, p[3] * 1e3))
  end
end

-- The cage holds bone and skin with room to spare.
local function check_cage(name, cage, ...)
  local s, least = kit.surface_of(cage), math.huge
  for _, m in ipairs{...} do
    for _, p in ipairs(m.vertices) do
      assert(s:contains(p), name .. ": the cage leaves out " .. table.concat(p, " "))
      least = math.min(least, s:closest(p).distance)
    end
  end
  assert(least > 0.003, string.format("%s: the cage comes as near as %g m, wanted 3 mm", name, least))
end

-- ---- files ----

local function write_object(file, name, m, first)
  file:write("o ", name, "\n")
  for _, p in ipairs(m.vertices) do file:write(string.format("v %.6f %.6f %.6f\n", p[1], p[2], p[3])) end
  for _, f in ipairs(m.faces) do
    file:write(string.format("f %d %d %d\n", f[1] + first, f[2] + first, f[3] + first))
  end
  return first + #m.vertices
end

-- {point in mm, radius in mm} of the landmark; those of pairs end in _l (as given) and _r (mirrored).
local function spread(list)
  local all = {}
  for _, item in ipairs(list or {}) do
    local name, x, y, z, r = table.unpack(item)
    if item.pair then
      all[#all + 1] = {name .. "_l", x, y, z, r}
      all[#all + 1] = {name .. "_r", -x, y, z, r}
    else
      all[#all + 1] = item
    end
  end
  return all
end

local function write_text(path, bone, surface)
  local file = assert(io.open(path, "w"))
  local function line(...) file:write(string.format(...), "\n") end
  line("# %s: %s", bone.name, bone.about)
  line("kind %s", bone.kind)
  if bone.from then line("from %.6f %.6f %.6f", bone.from[1] / 1e3, bone.from[2] / 1e3, bone.from[3] / 1e3) end
  if bone.to then line("to %.6f %.6f %.6f", bone.to[1] / 1e3, bone.to[2] / 1e3, bone.to[3] / 1e3) end
  if bone.length then line("length %.6f", bone.length / 1e3) end
  for _, l in ipairs(spread(bone.landmarks)) do
    local wanted = vec3(l[2], l[3], l[4]) * 1e-3
    local hit = surface:closest(wanted)
    local p = hit.point
    if hit.distance > 0.006 then
      print(string.format("  %s: %s is %.1f mm off the surface", bone.name, l[1], hit.distance * 1e3))
    end
    line("landmark %s %.9f %.9f %.9f %.4f", l[1], p.x, p.y, p.z, l[5] / 1e3)
  end
  for _, j in ipairs(spread(bone.joints)) do
    line("joint %s %.6f %.6f %.6f", j[1], j[2] / 1e3, j[3] / 1e3, j[4] / 1e3)
  end
  file:close()
end

-- Makes a bone's two files: {name=, about=, kind=, shape=, cell=, faces=, symmetric=, from=, to=, length=,
-- landmarks=, joints=, cage={shape=, cell=}, skin={shape=, cell=, planes=}}. Landmarks are {name, x, y, z, radius},
-- pair = true for both sides; they are moved to the nearest place on the surface. `only` (-D only=NAME) makes just that
-- one.
function kit.bone(b)
  if only and only ~= b.name then return end
  local m = closed_mesh(b.name, b.shape, b.cell, b.faces, b.symmetric)
  local path = kit.folder .. "/" .. b.name
  local file = assert(io.open(path .. ".obj", "w"))
  local next_vertex = write_object(file, b.name, m, 0)
  local text = ""
  if b.cage then
    local cage = closed_mesh(b.name .. " cage", b.cage.shape, b.cage.cell, nil, b.symmetric)
    local skin = skin_piece(b.skin, b.symmetric)
    text = string.format(", cage %d vertices, skin %d faces", #cage.vertices, #skin.faces)
    check_under_skin(b.name, m, b.skin)
    check_cage(b.name, cage, m, skin)
    next_vertex = write_object(file, "cage", cage, next_vertex)
    write_object(file, "skin", skin, next_vertex)
  end
  file:close()
  write_text(path .. ".txt", b, kit.surface_of(m))
  print(string.format("%s: %d faces%s", b.name, #m.faces, text))
end

return kit
