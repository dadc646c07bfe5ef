-- simplify - fewer triangles where a surface is flat: edge collapses in the order of their quadric error (Garland and
-- Heckbert 1997), with a small pull towards even triangles.
--
--     local simplify = dofile(folder .. "simplify.lua")
--     mesh = simplify({vertices = list of {x, y, z}, faces = list of {a, b, c}}, n)
--
-- Works down to n faces. The mesh may be closed or end in the plane x = 0, where its border stays. No step makes an
-- edge non-manifold or turns a face over; the same mesh gives the same result.

local PULL = 2e-3            -- weight of the distance gone against the distance from the planes
local TURN = 0.35            -- least cosine between a face's normals before and after a step
local SHAPE = 0.12           -- least quality of a new face: 1 for an equilateral triangle, 0 for a line

-- ---- a binary heap of {cost, a, b, stamp} ----

local function before(p, q)
  if p[1] ~= q[1] then return p[1] < q[1] end
  if p[2] ~= q[2] then return p[2] < q[2] end
  return p[3] < q[3]
end

local function push(heap, item)
  local i = #heap + 1
  while i > 1 and before(item, heap[i // 2]) do
    heap[i] = heap[i // 2]
    i = i // 2
  end
  heap[i] = item
end

local function pop(heap)
  local top, last = heap[1], table.remove(heap)
  local n, i = #heap, 1
  if n == 0 then return top end
  while 2 * i <= n do
    local k = 2 * i
    if k < n and before(heap[k + 1], heap[k]) then k = k + 1 end
    if not before(heap[k], last) then break end
    heap[i] = heap[k]
    i = k
  end
  heap[i] = last
  return top
end

-- ---- vectors ----

local function normal(p, q, r)
  local ax, ay, az = q[1] - p[1], q[2] - p[2], q[3] - p[3]
  local bx, by, bz = r[1] - p[1], r[2] - p[2], r[3] - p[3]
  return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
end

local function length2(p, q)
  return (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2
end

-- ---- quadrics: xx xy xz yy yz zz, x y z, 1 of the weighted squared distances from planes and points ----

local function add_plane(Q, nx, ny, nz, d, w)
  Q[1], Q[2], Q[3] = Q[1] + w * nx * nx, Q[2] + w * nx * ny, Q[3] + w * nx * nz
  Q[4], Q[5], Q[6] = Q[4] + w * ny * ny, Q[5] + w * ny * nz, Q[6] + w * nz * nz
  Q[7], Q[8], Q[9], Q[10] = Q[7] + w * nx * d, Q[8] + w * ny * d, Q[9] + w * nz * d, Q[10] + w * d * d
end

local function add_point(Q, p, w)
  Q[1], Q[4], Q[6] = Q[1] + w, Q[4] + w, Q[6] + w
  Q[7], Q[8], Q[9] = Q[7] - w * p[1], Q[8] - w * p[2], Q[9] - w * p[3]
  Q[10] = Q[10] + w * (p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
end

local function value(Q, p)
  local x, y, z = p[1], p[2], p[3]
  return x * (Q[1] * x + 2 * (Q[2] * y + Q[3] * z + Q[7])) + y * (Q[4] * y + 2 * (Q[5] * z + Q[8]))
         + z * (Q[6] * z + 2 * Q[9]) + Q[10]
end

-- The point of least value; the pull makes the matrix regular.
local function least(Q)
  local a, b, c, d, e, f = Q[1], Q[2], Q[3], Q[4], Q[5], Q[6]
  local A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
  local det = a * A + b * B + c * C
  local x, y, z = -Q[7], -Q[8], -Q[9]
  return {(A * x + B * y + C * z) / det, (B * x + (a * f - c * c) * y + (b * c - a * e) * z) / det,
          (C * x + (b * c - a * e) * y + (a * d - b * b) * z) / det}
end

-- ---- the mesh ----

local function other_corners(f, v)
  if f[1] == v then return f[2], f[3] end
  if f[2] == v then return f[3], f[1] end
  return f[1], f[2]
end

-- {p=, faces= lists around each vertex, Q=, border= of each vertex, stamp=, n_face=}.
local function build(m)
  local s = {p = {}, around = {}, Q = {}, border = {}, stamp = {}, n_face = #m.faces, faces = {}}
  for i, p in ipairs(m.vertices) do
    s.p[i], s.around[i], s.stamp[i] = {p[1], p[2], p[3]}, {}, 0
    s.Q[i] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}
  end
  local seen = {}
  for i, face in ipairs(m.faces) do
    local f = {face[1], face[2], face[3]}
    s.faces[i] = f
    local nx, ny, nz = normal(s.p[f[1]], s.p[f[2]], s.p[f[3]])
    local l = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = nx / l, ny / l, nz / l
    local p = s.p[f[1]]
    for k = 1, 3 do
      local a, b = f[k], f[k % 3 + 1]
      table.insert(s.around[a], f)
      add_plane(s.Q[a], nx, ny, nz, -(nx * p[1] + ny * p[2] + nz * p[3]), l)
      add_point(s.Q[a], s.p[a], PULL * l)
      local key = a < b and a .. " " .. b or b .. " " .. a
      seen[key] = not seen[key] and {a, b} or false
    end
  end
  for _, face in ipairs(m.faces) do
    for k = 1, 3 do
      local a, b = face[k], face[k % 3 + 1]
      local open = seen[a < b and a .. " " .. b or b .. " " .. a]
      if open then
        s.border[a], s.border[b] = true, true
      end
    end
  end
  return s
end

-- Corners next to both a and b, as a list, and how many faces hold both.
local function link(s, a, b)
  local near, both, shared = {}, {}, 0
  for _, f in ipairs(s.around[a]) do
    local u, v = other_corners(f, a)
    near[u], near[v] = true, true
    if u == b or v == b then shared = shared + 1 end
  end
  local met = {}
  for _, f in ipairs(s.around[b]) do
    local u, v = other_corners(f, b)
    if near[u] and not met[u] then both[#both + 1], met[u] = u, true end
    if near[v] and not met[v] then both[#both + 1], met[v] = v, true end
  end
  return both, shared
end

-- Where a and b would go together, and what it costs; nil where they may not.
local function target(s, a, b)
  local Q, pa, pb = {}, s.p[a], s.p[b]
  for k = 1, 10 do Q[k] = s.Q[a][k] + s.Q[b][k] end
  local x
  if s.border[a] and s.border[b] then
    x = {0, 0.5 * (pa[2] + pb[2]), 0.5 * (pa[3] + pb[3])}
  elseif s.border[a] or s.border[b] then
    x = s.border[a] and pa or pb
  else
    x = least(Q)
    if length2(x, pa) + length2(x, pb) > 2 * length2(pa, pb) then
      x = {0.5 * (pa[1] + pb[1]), 0.5 * (pa[2] + pb[2]), 0.5 * (pa[3] + pb[3])}
    end
  end
  return x, value(Q, x), Q
end

-- Whether the faces around a that do not hold b stay upright and well shaped when a moves to x.
local function stays_sound(s, a, b, x)
  for _, f in ipairs(s.around[a]) do
    local u, v = other_corners(f, a)
    if u ~= b and v ~= b then
      local p, q = s.p[u], s.p[v]
      local ox, oy, oz = normal(s.p[a], p, q)
      local nx, ny, nz = normal(x, p, q)
      local n2, o2 = nx * nx + ny * ny + nz * nz, ox * ox + oy * oy + oz * oz
      if ox * nx + oy * ny + oz * nz < TURN * math.sqrt(n2 * o2) then return false end
      local quality = 2 * math.sqrt(3) * math.sqrt(n2) / (length2(x, p) + length2(p, q) + length2(q, x))
      if quality < SHAPE then return false end
    end
  end
  return true
end

-- b goes into a, which moves to x.
local function collapse(s, a, b, x, Q)
  local rest, gone = {}, 0
  for _, f in ipairs(s.around[a]) do
    if f[1] == b or f[2] == b or f[3] == b then
      f.dead, gone = true, gone + 1
    else
      rest[#rest + 1] = f
    end
  end
  for _, f in ipairs(s.around[b]) do
    if not f.dead then
      for k = 1, 3 do if f[k] == b then f[k] = a end end
      rest[#rest + 1] = f
    end
  end
  for _, f in ipairs(rest) do
    for k = 1, 3 do
      local v, kept = f[k], {}
      if v ~= a then
        for _, g in ipairs(s.around[v]) do if not g.dead then kept[#kept + 1] = g end end
        s.around[v] = kept
      end
    end
  end
  s.around[a], s.around[b] = rest, {}
  s.p[a], s.Q[a], s.n_face = x, Q, s.n_face - gone
  s.border[a] = s.border[a] or s.border[b]
  s.stamp[a], s.stamp[b] = s.stamp[a] + 1, s.stamp[b] + 1
end

local function offer(s, heap, a, b)
  if a > b then a, b = b, a end
  local _, cost = target(s, a, b)
  push(heap, {cost, a, b, s.stamp[a] + s.stamp[b]})
end

local function offer_around(s, heap, a)
  local met = {}
  for _, f in ipairs(s.around[a]) do
    local u, v = other_corners(f, a)
    if not met[u] then offer(s, heap, a, u) end
    if not met[v] then offer(s, heap, a, v) end
    met[u], met[v] = true, true
  end
end

local function finished(s)
  local new, vertices, faces = {}, {}, {}
  for _, f in ipairs(s.faces) do
    if not f.dead then
      local g = {}
      for k = 1, 3 do
        if not new[f[k]] then
          vertices[#vertices + 1] = s.p[f[k]]
          new[f[k]] = #vertices
        end
        g[k] = new[f[k]]
      end
      faces[#faces + 1] = g
    end
  end
  return {vertices = vertices, faces = faces}
end

return function(m, n)
  local s, heap = build(m), {}
  for _, f in ipairs(s.faces) do
    for k = 1, 3 do
      local a, b = f[k], f[k % 3 + 1]
      if a < b or (s.border[a] and s.border[b]) then offer(s, heap, a, b) end
    end
  end
  while s.n_face > n and #heap > 0 do
    local item = pop(heap)
    local a, b = item[2], item[3]
    if item[4] == s.stamp[a] + s.stamp[b] and #s.around[a] > 0 and #s.around[b] > 0 then
      local both, shared = link(s, a, b)
      local at_border = s.border[a] and s.border[b]
      local x, _, Q = target(s, a, b)
      if shared == (at_border and 1 or 2) and #both == shared and stays_sound(s, a, b, x) and
         stays_sound(s, b, a, x) then
        collapse(s, a, b, x, Q)
        offer_around(s, heap, a)
      end
    end
  end
  return finished(s)
end
