-- symmetry_test - halves of surfaces, and extractions of a half joined with their image
dofile("tests/lua/harness.lua")

local nan = 0 / 0
local dir = os.tmpname()
os.remove(dir)
assert(os.execute("mkdir " .. dir))

-- ---- surface:cut ----

local function cube(k) -- from 0 to k
    return sinew.surface.new({{0, 0, 0}, {k, 0, 0}, {k, k, 0}, {0, k, 0}, {0, 0, k}, {k, 0, k}, {k, k, k}, {0, k, k}},
        {{1, 3, 2}, {1, 4, 3}, {5, 6, 7}, {5, 7, 8}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 4, 8}, {3, 8, 7},
         {4, 1, 5}, {4, 5, 8}})
end

local function clean(s)
    local c = s:check()
    return c.closed and c.manifold and c.oriented and c.self_intersections == 0 and c.degenerate_faces == 0
end

test("cut keeps the side that the normal points to", function()
    local s = cube(2)
    local up = s:cut{point = {0, 0, 0.5}, normal = {0, 0, 3}}
    local down = s:cut{point = {0, 0, 0.5}, normal = {0, 0, -1}}
    check(up:volume() == 6 and down:volume() == 2 and s:volume() == 8)
    check(up:bounds().min.z == 0.5 and down:bounds().max.z == 0.5)
    check(up:area() == 4 + 4 + 4 * 3)
    check(clean(up) and clean(down))
    check(s:face_count() == 12 and up:face_count() == 20 and up:vertex_count() == 12)
    checknear(s:cut{point = {1, 1, 1}, normal = {1, 1, 1}}:volume(), 4)
    check(s:cut{point = {0, 1, 0}, normal = {0, 1, 0}}:cut{point = {1, 0, 0}, normal = {-1, 0, 0}}:volume() == 2)
    check(s:cut{normal = {0, 0, 1}}:volume() == 8) -- a face in the plane
end)

test("a cut through a skin with a hollow has a hole in its cap", function()
    local ball = sinew.shape.subtract(sinew.shape.sphere({0, 0, 0}, 1), sinew.shape.sphere({0, 0, 0.1}, 0.5))
    local s = ball:mesh{cell = 0.1}
    check(s:check().components == 2)
    local a, b = s:cut{normal = {0, 1, 0}}, s:cut{normal = {0, -1, 0}}
    check(clean(a) and clean(b))
    checknear(a:volume() + b:volume(), s:volume(), 1e-12)
    checknear(a:area() - 0.5 * s:area(), math.pi * (1 - 0.25), 0.05)
end)

test("what cannot be cut", function()
    local s = cube(1)
    checkerr("option 'normal' is missing", s.cut, s, {})
    checkerr("option 'normal' is missing", s.cut, s)
    checkerr("normal that is not zero", s.cut, s, {normal = {0, 0, 0}})
    checkerr("option 'normal'", s.cut, s, {normal = {0, 0, nan}})
    checkerr("option 'point'", s.cut, s, {point = 3, normal = {0, 0, 1}})
    checkerr("unknown option 'centre'", s.cut, s, {centre = {0, 0, 0}, normal = {0, 0, 1}})
    checkerr("the plane misses the surface, which lies between 2 and 3 along the normal: nothing would be cut off",
             s.cut, s, {point = {0, 0, -2}, normal = {0, 0, 1}})
    checkerr("between -1 and 0 along the normal: nothing would be left", s.cut, s,
             {point = {0, 0, 1}, normal = {0, 0, 1}})
    local open = sinew.surface.new({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, {{1, 2, 3}})
    checkerr("the surface is not closed: 3 edges have only one face", open.cut, open,
             {point = {0, 0, 0.5}, normal = {0, 0, 1}})
    local closed = cube(1)
    closed:close()
    checkerr("surface was closed", closed.cut, closed, {normal = {0, 0, 1}})
end)

test("a cut stays when the surface goes", function()
    local s = cube(1)
    local half = s:cut{point = {0, 0, 0.5}, normal = {0, 0, 1}}
    s:close()
    collectgarbage()
    check(half:volume() == 0.5 and half:contains({0.5, 0.5, 0.75}) and not half:contains({0.5, 0.5, 0.25}))
end)

-- ---- extraction:mirror ----

-- n x n x n cubes of six tets each on one side of y = 0, and functions on them.
local function half_block(n)
    local path, lines, points = dir .. "/block.mesh", {}, {}
    local function id(i, j, k) return (i * (n + 1) + j) * (n + 1) + k + 1 end
    for i = 0, n do for j = 0, n do for k = 0, n do
        points[#points + 1] = {i / n, j / n, k / n}
        lines[#lines + 1] = ("%.17g %.17g %.17g 0"):format(i / n, j / n, k / n)
    end end end
    local tets = {}
    for i = 0, n - 1 do for j = 0, n - 1 do for k = 0, n - 1 do
        for _, order in ipairs{{1, 2, 3}, {1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}} do
            local at, tet = {i, j, k}, {id(i, j, k)}
            for _, axis in ipairs(order) do
                at[axis] = at[axis] + 1
                tet[#tet + 1] = id(at[1], at[2], at[3])
            end
            tets[#tets + 1] = table.concat(tet, " ") .. " 1"
        end
    end end end
    local file = assert(io.open(path, "w"))
    file:write("MeshVersionFormatted 2\nDimension 3\nVertices\n", #lines, "\n", table.concat(lines, "\n"),
               "\nTetrahedra\n", #tets, "\n", table.concat(tets, "\n"), "\nEnd\n")
    file:close()
    return assert(sinew.tets.load(path)), points
end

local function made_half()
    local tets, points = half_block(4)
    local function near(x, y) -- a column along z
        local values = {}
        for i, p in ipairs(points) do values[i] = 0.8 - 1.5 * math.sqrt((p[1] - x) ^ 2 + (p[2] - y) ^ 2) end
        return values
    end
    local flat = {}
    for i = 1, #points do flat[i] = 0.4 end
    return sinew.extract(tets, {{name = "fat", values = flat}, {name = "biceps_l", values = near(0.3, 0.7)},
                                {name = "linea", values = near(0.7, 0)}}), tets
end

test("mirror joins both sides", function()
    local half = made_half()
    local x = half:mirror{point = {0, 0, 0}, normal = {0, -2, 0}}
    check(table.concat(x:names(), " ") == "fat biceps_l linea biceps_r")
    check(x:tet_count() == 2 * half:tet_count() and x:vertex_count() < 2 * half:vertex_count())
    local c = x:check()
    check(c.conforming and c.manifold and c.positive and c.bad_faces == 0)
    check(c.volume_error < 1e-12)
    checknear(x:part("biceps_r"):volume(), half:part("biceps_l"):volume())
    checknear(x:part("biceps_l"):volume(), half:part("biceps_l"):volume())
    checknear(x:part("linea"):volume(), 2 * half:part("linea"):volume())
    local s = x:part("linea"):surface():check()
    check(s.closed and s.manifold and s.components == 1)
    check(x:part("biceps_r"):surface():bounds().max.y < 0)
    check(table.concat(half:names(), " ") == "fat biceps_l linea") -- as it was
end)

test("the mirrored extraction outlives its half", function()
    local half, tets = made_half()
    local x = half:mirror{point = {0, 0, 0}, normal = {0, 1, 0}}
    half:close()
    half, tets = nil, nil
    collectgarbage()
    check(x:check().conforming)
    local fibers = x:part("biceps_r"):fibers{points = {{0.3, -0.7, 0}, {0.3, -0.7, 1}}}
    check(#fibers == x:part("biceps_r"):tet_count())
    for _, f in ipairs(fibers) do check(f.point.y < 0 and f.direction.z > 0.99) end
    local up = x:part("biceps_l"):fiber_lines{count = 10, points = {{0.3, 0.7, 0}, {0.3, 0.7, 1}}}
    check(#up > 5 and up[1][1].y > 0)
end)

test("mirrored files", function()
    local x = made_half():mirror{point = {0, 0, 0}, normal = {0, 1, 0}}
    for _, extension in ipairs{"vtu", "mesh"} do
        local path = dir .. "/whole." .. extension
        check(x:save(path) == true)
        local back = sinew.tets.load(path)
        check(back:tet_count() == x:tet_count() and back:vertex_count() == x:vertex_count())
        checknear(back:volume(), 2, 1e-12)
        local box = back:bounds()
        check(box.min.y == -1 and box.max.y == 1)
    end
    check(x:save(dir .. "/parts") == true)
    check(sinew.surface.load(dir .. "/parts/biceps_r.obj"):volume() > 0)
end)

test("what cannot be mirrored", function()
    local half = made_half()
    checkerr("option 'point' is missing", half.mirror, half, {normal = {0, 1, 0}})
    checkerr("option 'normal' is missing", half.mirror, half, {point = {0, 1, 0}})
    checkerr("unknown option 'plane'", half.mirror, half, {plane = 3})
    checkerr("normal that is not zero", half.mirror, half, {point = {0, 0, 0}, normal = {0, 0, 0}})
    checkerr("lies 0.25 beyond the plane", half.mirror, half, {point = {0, 0.25, 0}, normal = {0, 1, 0}})
    checkerr("no face in the plane, its nearest vertex is 0.5 from it", half.mirror, half,
             {point = {0, -0.5, 0}, normal = {0, 1, 0}})
    local x = half:mirror{point = {0, 0, 0}, normal = {0, 1, 0}}
    checkerr("mirrored already", x.mirror, x, {point = {0, 0, 0}, normal = {0, 1, 0}})
    half:close()
    checkerr("extraction was closed", half.mirror, half, {point = {0, 0, 0}, normal = {0, 1, 0}})
end)

os.execute("rm -r " .. dir)
finish()
