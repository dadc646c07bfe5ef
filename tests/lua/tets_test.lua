-- tets_test - tet meshes from files, and sinew.extract of functions on them
dofile("tests/lua/harness.lua")

local nan, inf = 0 / 0, 1 / 0

local dir = os.tmpname()
os.remove(dir)
assert(os.execute("mkdir " .. dir))

local function write(name, text)
    local file = assert(io.open(dir .. "/" .. name, "w"))
    file:write(text)
    file:close()
    return dir .. "/" .. name
end

-- The unit cube cut into six tets along its diagonal (Kuhn): 8 vertices, volume 1.
local cube_path = write("cube.mesh", [[
MeshVersionFormatted 2
Dimension 3
Vertices 8
0 0 0 0
1 0 0 0
0 1 0 0
1 1 0 0
0 0 1 0
1 0 1 0
0 1 1 0
1 1 1 0
Tetrahedra 6
1 2 4 8 0
1 4 3 8 0
1 3 7 8 0
1 7 5 8 0
1 5 6 8 0
1 6 2 8 0
End
]])
local cube = assert(sinew.tets.load(cube_path))

local function values(t, f)
    local v = {}
    for i = 1, t:vertex_count() do v[i] = f(t:vertex(i)) end
    return v
end

test("load: figures", function()
    check(cube:vertex_count() == 8 and cube:tet_count() == 6)
    check(cube:vertex(8) == sinew.vec3(1, 1, 1) and cube:vertex(2) == sinew.vec3(1, 0, 0))
    checknear(cube:volume(), 1)
    check(cube:bounds().min == sinew.vec3(0, 0, 0) and cube:bounds().max == sinew.vec3(1, 1, 1))
    local t = cube:tet(1)
    check(#t == 4 and t[1] >= 1 and t[4] <= 8)
    check(tostring(cube) == "tets: 8 vertices, 6 tets")
    checkerr("index 0 not in 1..8", cube.vertex, cube, 0)
    checkerr("index 7 not in 1..6", cube.tet, cube, 7)
end)

test("save and load again", function()
    for _, ext in ipairs{"mesh", "vtu"} do
        check(cube:save(dir .. "/a." .. ext) == true)
        local back = check(sinew.tets.load(dir .. "/a." .. ext))
        check(back:vertex_count() == 8 and back:tet_count() == 6 and back:volume() == cube:volume())
    end
    check(cube:save(dir .. "/a.msh") == true)
end)

test("files that cannot be had: nil and a message", function()
    local t, message = sinew.tets.load(dir .. "/none.mesh")
    check(t == nil and message:find("none.mesh: cannot open: No such file", 1, true), message)
    t, message = sinew.tets.load("a.stl")
    check(t == nil and message:find("a.stl", 1, true), message)
    local bad = "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nTetrahedra 1\n1 2 3 4 0\n"
    t, message = sinew.tets.load(write("bad.mesh", bad))
    check(t == nil and message:find("bad.mesh:", 1, true), message)
    local ok
    ok, message = cube:save(dir .. "/no/a.vtu")
    check(ok == nil and message:find("no/a.vtu: cannot write: No such file", 1, true), message)
    ok, message = cube:save(dir .. "/a.obj")
    check(ok == nil and message:find("a.obj", 1, true), message)
    checkerr("string expected, got nil", sinew.tets.load, nil)
    checkerr("text with a zero byte", sinew.tets.load, "a\0")
end)

test("extract: two halves, by hand", function()
    -- x - 0.5 against 0: the plane x = 1/2, volumes 1/2 up to the margin and the grid
    local x = sinew.extract(cube, {{name = "low", values = values(cube, function(p) return 0.5 - p.x end)},
                                   {name = "high", values = values(cube, function(p) return p.x - 0.5 end)}})
    check(#x:names() == 2 and x:names()[1] == "low" and x:names()[2] == "high")
    checknear(x:part("low"):volume(), 0.5, 1e-5)
    checknear(x:part("high"):volume(), 0.5, 1e-5)
    check(x:part("low"):tet_count() + x:part("high"):tet_count() == x:tet_count())
    local c = x:check()
    check(c.conforming and c.manifold and c.positive and c.bad_faces == 0 and c.inverted == 0)
    checknear(c.volume_error, 0, 1e-12)
    local s = x:part("high"):surface()
    checknear(s:volume(), 0.5, 1e-5)
    checknear(s:area(), 4, 1e-4)
    checknear(s:bounds().min.x, 0.5, 1e-5)
end)

test("extract: three tissues", function()
    local x = sinew.extract(cube, {{name = "a", values = values(cube, function(p) return p.x end)},
                                   {name = "b", values = values(cube, function(p) return p.y end)},
                                   {name = "c",
                                    values = values(cube, function(p) return p.z end)}}, {margin = 0.01})
    for _, name in ipairs(x:names()) do checknear(x:part(name):volume(), 1 / 3, 0.05, name) end
    local c = x:check()
    check(c.conforming and c.manifold and c.positive)
    check(c.min_volume > 0 and c.max_volume < 1 and c.moved >= 0 and c.largest_move >= 0)
end)

test("extract: one function takes all", function()
    local x = sinew.extract(cube, {{name = "all", values = {0, 0, 0, 0, 0, 0, 0, 0}}})
    check(x:tet_count() == 6 and x:vertex_count() == 8)
    checknear(x:part("all"):volume(), 1)
end)

test("extract: wrong arguments", function()
    local eight = {1, 2, 3, 4, 5, 6, 7, 8}
    local a = {name = "a", values = eight}
    checkerr("sinew.tets expected, got table", sinew.extract, {}, {a})
    checkerr("functions: list expected, got no value", sinew.extract, cube)
    checkerr("functions: 1 to 4096 expected", sinew.extract, cube, {})
    checkerr("functions[2]: {name=, values=} expected", sinew.extract, cube, {a, 5})
    checkerr("bad argument #2 to 'extract' (unknown option 'value' (did you mean 'values'? known: name, values))",
             function() sinew.extract(cube, {{name = "a", value = eight}}) end)
    checkerr("functions[1]: option 'name': string expected", sinew.extract, cube, {{values = eight}})
    checkerr("functions[1]: option 'name': string expected", sinew.extract, cube,
             {{name = 4, values = eight}})
    for _, name in ipairs{"", "a/b", "a\nb", "a\0b", ("x"):rep(65)} do
        checkerr("functions[1]: option 'name': 1..64 bytes without '/' or control characters expected",
                 sinew.extract, cube,
                 {{name = name, values = eight}})
    end
    checkerr("functions[2]: name 'a' is taken by an earlier one", sinew.extract, cube, {a, a})
    checkerr("functions[1]: option 'values': list of numbers expected", sinew.extract, cube, {{name = "a"}})
    checkerr("functions[1]: 7 values, need one for each of the 8 vertices", sinew.extract, cube,
             {{name = "a", values = {1, 2, 3, 4, 5, 6, 7}}})
    checkerr("functions[1].values[8]: finite number expected", sinew.extract, cube,
             {{name = "a", values = {1, 2, 3, 4, 5, 6, 7, nan}}})
    checkerr("functions[1].values[8]: finite number expected, got inf", sinew.extract, cube,
             {{name = "a", values = {1, 2, 3, 4, 5, 6, 7, inf}}})
    checkerr("functions[1].values[2]: number expected, got string", sinew.extract, cube,
             {{name = "a", values = {1, "2", 3, 4, 5, 6, 7, 8}}})
    checkerr("unknown option 'margn' (did you mean 'margin'? known: margin)", sinew.extract, cube, {a},
             {margn = 1})
    checkerr("option 'margin': number above 0 expected, got 0", sinew.extract, cube, {a}, {margin = 0})
    checkerr("margin is 0.5", sinew.extract, cube, {a}, {margin = 0.5})
end)

test("check after the tets are closed", function()
    local t = assert(sinew.tets.load(cube_path))
    local x = sinew.extract(t,
                            {{name = "a", values = {1, 2, 3, 4, 5, 6, 7, 8}},
                             {name = "b", values = {8, 7, 6, 5, 4, 3, 2, 1}}})
    t:close()
    t:close()
    check(x:check().conforming)
    check(tostring(t) == "tets (was closed)")
    checkerr("tets were closed", t.volume, t)
    checkerr("tets were closed", sinew.extract, t, {})
    t = nil
    collectgarbage()
    check(x:check().conforming)
end)

test("unknown methods, help", function()
    checkerr("tets has no 'vertx' (did you mean 'vertex'?)", function() return cube:vertx(1) end)
    for name in pairs(getmetatable(cube).__index) do check(sinew.help_text["tets:" .. name], name) end
end)

os.execute("rm -rf " .. dir)
finish()
