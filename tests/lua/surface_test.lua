-- surface_test - sinew.surface, vec3, and how points, options and indices are read
dofile("tests/lua/harness.lua")

local nan, inf = 0 / 0, 1 / 0

local function temp_dir()
    local dir = os.tmpname()
    os.remove(dir)
    assert(os.execute("mkdir " .. dir))
    return dir, function() os.execute("rm -rf " .. dir) end
end

-- The cube [0, 2]^3 with 12 faces, outside out: area 24, volume 8.
local corners = {
    {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2},
}
local sides = {
    {1, 3, 2}, {1, 4, 3}, {5, 6, 7}, {5, 7, 8}, {1, 2, 6}, {1, 6, 5},
    {2, 3, 7}, {2, 7, 6}, {3, 4, 8}, {3, 8, 7}, {4, 1, 5}, {4, 5, 8},
}
local function cube() return sinew.surface.new(corners, sides) end

test("module", function()
    check(sinew.version:match("^%d+%.%d+%.%d+$"))
    local t = sinew.time()
    check(sinew.time() >= t)
    local n = sinew.threads()
    check(n >= 1)
    check(sinew.threads(2) == 2 and sinew.threads() == 2)
    check(sinew.threads(0) >= 1)
    checkerr("0 (one per core) to 1024 threads expected", sinew.threads, -1)
    checkerr("0 (one per core) to 1024 threads expected", sinew.threads, 1025)
    checkerr("number expected, got boolean", sinew.threads, true)
    check(package.loaded.sinew == sinew)
end)

test("vec3 fields", function()
    local p = sinew.vec3(1, 2, 3)
    check(p.x == 1 and p.y == 2 and p.z == 3 and p[1] == 1 and p[2] == 2 and p[3] == 3)
    check(p[0] == nil and p[4] == nil and p[1.5] == nil and #p == 3)
    check(tostring(p) == "{1, 2, 3}")
    check(tostring(sinew.vec3(0.1, -1e300, 1 / 3)) == "{0.1, -1e+300, 0.3333333333333333}")
    check(select("#", table.unpack(p)) == 3)
    local n = 0
    for _ in ipairs(p) do n = n + 1 end
    check(n == 3)
    checkerr("^tests/lua/surface_test.lua:%d+: vec3 has no 'w'", function() return p.w end)
    checkerr("did you mean 'length'", function() return p:lenght() end)
    checkerr("a vec3 does not change", function() p.x = 1 end)
end)

test("vec3 arithmetic", function()
    local p, q = sinew.vec3(1, 2, 3), sinew.vec3{4, 5, 6}
    check(p + q == sinew.vec3(5, 7, 9) and q - p == sinew.vec3(3, 3, 3))
    check(p + {1, 1, 1} == sinew.vec3(2, 3, 4) and {x = 1, y = 2, z = 3} - p == sinew.vec3(0, 0, 0))
    check(2 * p == p * 2 and 2 * p == sinew.vec3(2, 4, 6) and p / 2 == sinew.vec3(0.5, 1, 1.5))
    check(-p == sinew.vec3(-1, -2, -3) and p ~= q and p ~= {1, 2, 3})
    check(p:dot(q) == 32 and p:cross(q) == sinew.vec3(-3, 6, -3))
    check(sinew.vec3(3, 4, 0):length() == 5 and sinew.vec3(1, 1, 1):distance{1, 1, 4} == 3)
    check(sinew.vec3(0, 0, 9):unit() == sinew.vec3(0, 0, 1))
    check(sinew.vec3(0, 0, 0):unit() == sinew.vec3(0, 0, 0))
    checkerr("a:dot(b) or a:cross(b)", function() return p * q end)
    checkerr("right side: {x, y, z} expected, got number", function() return p + 1 end)
    checkerr("division by zero", function() return p / 0 end)
    checkerr("finite number expected", function() return p * inf end)
end)

test("vec3 wrong arguments", function()
    checkerr("bad argument #3 to 'vec3' (number expected, got no value)", function() sinew.vec3(1, 2) end)
    checkerr("number expected, got string", sinew.vec3, "1", 2, 3)
    checkerr("finite number expected, got", sinew.vec3, nan, 0, 0)
    checkerr("point: {x, y, z} expected, got nil", sinew.vec3, nil)
    checkerr("point: {x, y, z} expected, got a list of 4", sinew.vec3, {1, 2, 3, 4})
    checkerr("point: coordinate z: number expected, got nil", sinew.vec3, {1, 2})
    checkerr("point: coordinate x: number expected, got nil", sinew.vec3, {})
    checkerr("point: coordinate y: number expected, got string", sinew.vec3, {x = 1, y = "2", z = 3})
    checkerr("point: coordinate y: finite number expected, got", sinew.vec3, {1, nan, 3})
    checkerr("point: coordinate y: finite number expected, got -inf", sinew.vec3, {1, -inf, 3})
    local far = sinew.vec3(1e300, 0, 0) * 1e300
    checkerr("point: a coordinate of {inf, 0.0, 0.0} is not finite", cube().contains, cube(), far)
end)

test("new: figures of a cube", function()
    local s = cube()
    check(s:vertex_count() == 8 and s:face_count() == 12)
    check(s:area() == 24 and s:volume() == 8)
    check(s:bounds().min == sinew.vec3(0, 0, 0) and s:bounds().max == sinew.vec3(2, 2, 2))
    check(s:vertex(7) == sinew.vec3(2, 2, 2))
    check(s:face(12)[1] == 4 and s:face(12)[2] == 5 and s:face(12)[3] == 8)
    check(tostring(s) == "surface: 8 vertices, 12 faces")
    local c = s:check()
    check(c.closed == true and c.manifold == true and c.oriented == true and c.components == 1)
    for _, key in ipairs{"boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "degenerate_faces",
                         "duplicate_vertices", "duplicate_faces", "unused_vertices", "self_intersections"} do
        check(c[key] == 0, key)
    end
    check(c.first_pair == nil)
end)

test("new: vec3 vertices, vec3 faces, x y z fields", function()
    local s = sinew.surface.new({sinew.vec3(0, 0, 0), {x = 1, y = 0, z = 0}, {0, 1, 0}},
                                {sinew.vec3(1, 2, 3)})
    check(s:area() == 0.5)
    local c = s:check()
    check(not c.closed and c.boundary_edges == 3)
end)

test("new: wrong lists", function()
    local new = sinew.surface.new
    checkerr("vertices: list expected, got no value", function() new() end)
    checkerr("bad argument #2 to 'new' (faces: list expected, got nil)",
             function() sinew.surface.new(corners, nil) end)
    checkerr("faces: the list is empty", new, corners, {})
    checkerr("vertices[2]: {x, y, z} expected, got number", new, {{0, 0, 0}, 5, {1, 0, 0}}, {{1, 2, 3}})
    checkerr("vertices[1]: coordinate z: finite number expected", new, {{0, 0, nan}}, {{1, 1, 1}})
    checkerr("vertices[1]: coordinate z: finite number expected, got inf", new, {{0, 0, inf}}, {{1, 1, 1}})
    checkerr("faces[2]: {a, b, c} expected, got number", new, corners, {{1, 2, 3}, 7})
    checkerr("faces[1]: 3 corners expected, got 4", new, corners, {{1, 2, 3, 4}})
    checkerr("faces[1]: 3 corners expected, got 2", new, corners, {{1, 2}})
    checkerr("faces[1]: corner 2 is 0, need a vertex index in 1..8", new, corners, {{1, 0, 3}})
    checkerr("faces[1]: corner 3 is 9, need a vertex index in 1..8", new, corners, {{1, 2, 9}})
    checkerr("faces[1]: corner 1 is -1, need", new, corners, {{-1, 2, 3}})
    checkerr("faces[1]: corner 1 is 1.5, need", new, corners, {{1.5, 2, 3}})
    checkerr("faces[1]: corner 1 is 4294967297, need", new, corners, {{4294967297, 2, 3}})
    checkerr("faces[1]: corner 1 is ", new, corners, {{nan, 2, 3}})
    checkerr("faces[1]: corner 2 is true, need", new, corners, {{1, true, 3}})
    checkerr("faces[1]: corner 1 is 1, need a vertex index in 1..0", new, {}, {{1, 1, 1}})
end)

test("check: what is wrong is counted", function()
    local open = {table.unpack(sides, 1, 11)}
    local c = sinew.surface.new(corners, open):check()
    check(c.closed == false and c.boundary_edges == 3 and c.components == 1)
    local twice = {table.unpack(sides)}
    twice[13] = sides[1]
    c = sinew.surface.new(corners, twice):check()
    check(c.duplicate_faces == 1 and c.manifold == false)
    -- two triangles that cross like a plus sign
    c = sinew.surface.new({{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, -1, 0}, {0, 1, 0}, {0, 0.5, 2}},
                          {{1, 2, 3}, {4, 5, 6}}):check()
    check(c.self_intersections == 1 and c.first_pair[1] == 1 and c.first_pair[2] == 2)
end)

test("index rules", function()
    local s = cube()
    checkerr("index 0 not in 1..8", s.vertex, s, 0)
    checkerr("index 9 not in 1..8", s.vertex, s, 9)
    checkerr("index -1 not in 1..12", s.face, s, -1)
    checkerr("number has no integer representation", s.vertex, s, 1.5)
    checkerr("number expected, got string", s.vertex, s, "1")
    checkerr("bad argument #1 to 'vertex' (number expected, got no value)", function() s:vertex() end)
end)

test("raycast", function()
    local s = cube()
    local hits = s:raycast({-3, 0.5, 0.75}, {2, 0, 0})
    check(#hits == 2)
    check(hits[1].distance == 3 and hits[1].point == sinew.vec3(0, 0.5, 0.75) and hits[1].entering == true)
    check(hits[2].distance == 5 and hits[2].point == sinew.vec3(2, 0.5, 0.75) and hits[2].entering == false)
    local f = s:face(hits[1].face)
    for k = 1, 3 do check(s:vertex(f[k]).x == 0) end
    check(#s:raycast({-3, 5, 0}, {1, 0, 0}) == 0)
    check(#s:raycast({1, 0.9, 0.8}, sinew.vec3(0, 1, 0)) == 1)
    check(#s:raycast({-3, 0.5, 0.75}, {1e-200, 0, 0}) == 2)
    checknear(s:raycast({-3, 0.5, 0.75}, {1e200, 0, 0})[1].distance, 3, 1e-12)
    checkerr("bad argument #2 to 'raycast' (direction: has no length)",
             function() s:raycast({0, 0, 0}, {0, 0, 0}) end)
    checkerr("origin: coordinate x: finite number expected", s.raycast, s, {nan, 0, 0}, {1, 0, 0})
    checkerr("direction: {x, y, z} expected, got no value", s.raycast, s, {0, 0, 0})
end)

test("closest, contains", function()
    local s = cube()
    local c = s:closest{1, 1, 5}
    check(c.distance == 3 and c.point == sinew.vec3(1, 1, 2) and c.face >= 3 and c.face <= 4)
    check(s:contains{1, 1, 1} == true and s:contains{3, 1, 1} == false)
    checkerr("point: {x, y, z} expected, got string", s.closest, s, "here")
    checkerr("point: coordinate x: finite number expected", s.contains, s, {nan, 1, 1})
end)

test("transform changes the surface itself", function()
    local s = cube()
    check(s:contains{1, 1, 1})
    local same = s:transform{scale = 2, rotate = {axis = {0, 0, 1}, degrees = 90}, translate = {10, 0, 0}}
    check(rawequal(same, s))
    checknear(s:volume(), 64, 1e-10)
    checknear(s:bounds().min.x, 6)
    checknear(s:bounds().max.y, 4)
    check(s:contains{9, 1, 1} and not s:contains{1, 1, 1}, "queries after a change")
    s:transform{}
    s:transform()
    checknear(s:volume(), 64, 1e-10)
end)

test("transform: wrong options", function()
    local s = cube()
    checkerr("unknown option 'scael' (did you mean 'scale'? known: scale, rotate, translate)", s.transform,
             s, {scael = 2})
    checkerr("unknown option 'a' (known: scale, rotate, translate)", s.transform, s, {zzzz = 1, a = 2})
    checkerr("bad argument #1 to 'transform' (options are given by name: {scale = ...}, not as a list)",
             function() s:transform{2} end)
    checkerr("table of options expected, got number", s.transform, s, 2)
    checkerr("option 'scale': number expected, got string", s.transform, s, {scale = "2"})
    checkerr("option 'scale': number above 0 expected, got 0", s.transform, s, {scale = 0})
    checkerr("option 'scale': number above 0 expected, got -1", s.transform, s, {scale = -1})
    checkerr("option 'scale': finite number expected", s.transform, s, {scale = nan})
    checkerr("option 'translate': coordinate z: number expected, got nil", s.transform, s,
             {translate = {1, 2}})
    checkerr("option 'rotate': table expected, got number", s.transform, s, {rotate = 90})
    checkerr("bad argument #1 to 'transform' (unknown option 'angle' (known: axis, degrees))",
             function() s:transform{rotate = {axis = {0, 0, 1}, angle = 3}} end)
    checkerr("option 'axis' is missing", s.transform, s, {rotate = {degrees = 3}})
    checkerr("option 'degrees' is missing", s.transform, s, {rotate = {axis = {0, 0, 1}}})
    checkerr("option 'axis': has no length", s.transform, s, {rotate = {axis = {0, 0, 0}, degrees = 1}})
    checkerr("option 'degrees': finite number expected, got inf", s.transform, s,
             {rotate = {axis = {0, 0, 1}, degrees = inf}})
    check(s:volume() == 8, "unchanged by errors")
    s:transform{scale = 1e200}
    checkerr("has a coordinate that is not finite", s.transform, s, {scale = 1e200})
    check(s:bounds().max.x == 2e200, "unchanged by overflow")
end)

test("mirror", function()
    local s = cube()
    local left = s:copy():mirror{normal = {5, 0, 0}}
    check(left:bounds().min.x == -2 and left:volume() == 8 and s:bounds().min.x == 0)
    check(s:copy():mirror{point = {0, 3, 0}, normal = {0, 1, 0}}:bounds().max.y == 6)
    checkerr("option 'normal' is missing", s.mirror, s, {})
    checkerr("option 'normal' is missing", s.mirror, s)
    checkerr("normal that is not zero", s.mirror, s, {normal = {0, 0, 0}})
    checkerr("unknown option 'zzzzzz' (known: point, normal)", s.mirror, s, {zzzzzz = 1})
end)

test("files", function()
    local dir, remove = temp_dir()
    local s = cube()
    for _, ext in ipairs{"obj", "ply", "stl", "off"} do
        local path = dir .. "/cube." .. ext
        check(s:save(path) == true)
        local back = check(sinew.surface.load(path))
        check(back:vertex_count() == 8 and back:face_count() == 12 and back:volume() == 8, ext)
    end
    check(s:save(dir .. "/a.stl", {ascii = true}) == true)
    local file = io.open(dir .. "/a.stl")
    check(file:read(5) == "solid")
    file:close()
    remove()
end)

test("files that cannot be had: nil and a message", function()
    local dir, remove = temp_dir()
    local s, message = sinew.surface.load(dir .. "/none.obj")
    check(s == nil and message:find("none.obj: cannot open: No such file", 1, true), message)
    s, message = sinew.surface.load("thing.xyz")
    check(s == nil and message:find("unknown surface format 'xyz' (known: .obj .ply .stl .off .vtp)", 1, true),
          message)
    local file = io.open(dir .. "/bad.obj", "w")
    file:write("v 0 0 0\nv 1 0 0\nf 1 2 3\n")
    file:close()
    s, message = sinew.surface.load(dir .. "/bad.obj")
    check(s == nil and message:find("bad.obj:3:", 1, true), message)
    local ok
    ok, message = cube():save(dir .. "/no/such/a.obj")
    check(ok == nil and message:find("/no/such/a.obj: cannot write: No such file", 1, true), message)
    ok, message = cube():save(dir .. "/a.vtu")
    check(ok == nil and message:find("unknown surface format 'vtu'", 1, true), message)
    checkerr("string expected, got no value", sinew.surface.load)
    checkerr("string expected, got number", sinew.surface.load, 1)
    checkerr("text with a zero byte", sinew.surface.load, "a\0b.obj")
    checkerr("bad argument #2 to 'save' (unknown option 'text' (known: ascii))",
             function() cube():save(dir .. "/a.stl", {text = true}) end)
    checkerr("option 'ascii': boolean expected, got number", s or cube().save, cube(), dir .. "/a.stl",
             {ascii = 1})
    remove()
end)

test("closed surfaces", function()
    local s = cube()
    s:close()
    s:close()
    check(tostring(s) == "surface (was closed)")
    for _, name in ipairs{"area", "volume", "bounds", "check", "copy", "vertex_count", "face_count",
                          "transform",
                          "mirror", "raycast", "closest", "contains", "vertex", "face", "save"} do
        checkerr("surface was closed", s[name], s, "x.obj")
    end
    local kept
    do
        local t <close> = cube()
        kept = t
    end
    checkerr("bad self (surface was closed)", function() kept:area() end)
end)

test("wrong objects and unknown methods", function()
    local s = cube()
    checkerr("sinew.surface expected, got table", s.area, {})
    checkerr("sinew.surface expected, got no value", s.area)
    checkerr("sinew.surface expected, got sinew.vec3", s.area, sinew.vec3(1, 2, 3))
    checkerr("^tests/lua/surface_test.lua:%d+: surface has no 'volum' %(did", function() return s:volum() end)
    checkerr("^tests/lua/surface_test.lua:%d+: bad argument #1 to 'save'", function() s:save(1) end)
    checkerr("surface has no 'volum' (did you mean 'volume'?)", function() return s:volum() end)
    checkerr("surface has no 'qqqqqqqq'", function() return s.qqqqqqqq end)
    checkerr("sinew.surface expected, got sinew.vec3", getmetatable(s).__gc, sinew.vec3(1, 2, 3))
    check(s[1] == nil)
end)

test("many surfaces are collected without being asked", function()
    local before = collectgarbage("count")
    for _ = 1, 2000 do cube():copy() end
    check(collectgarbage("count") < before + 20000)
end)

test("help texts", function()
    local h = sinew.help_text
    check(h["surface:check"]:find("self_intersections", 1, true))
    for name, fn in pairs(sinew.surface) do check(type(fn) == "function" and h["sinew.surface." .. name],
                                                  name) end
    for name in pairs(sinew.shape) do check(h["sinew.shape." .. name], name) end
    for name in pairs(sinew.image) do check(h["sinew.image." .. name], name) end
    for name in pairs(sinew.tets) do check(h["sinew.tets." .. name], name) end
    for name, value in pairs(sinew) do
        if type(value) == "function" then check(h["sinew." .. name], name) end
    end
    local objects = {surface = cube(), scene = sinew.scene(), shape = sinew.shape.sphere({0, 0, 0}, 1)}
    for kind, object in pairs(objects) do
        for name in pairs(getmetatable(object).__index) do check(h[kind .. ":" .. name],
                                                                 kind .. ":" .. name) end
    end
end)

finish()
