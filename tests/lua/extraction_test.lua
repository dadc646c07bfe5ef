-- extraction_test - scene:extract: parts, checks, files
dofile("tests/lua/harness.lua")
local small_scene = dofile("tests/lua/small_scene.lua")

local nan = 0 / 0
local dir = os.tmpname()
os.remove(dir)
assert(os.execute("mkdir " .. dir))

local scene = small_scene()
local x = scene:extract{}

local function exists(path)
    local file = io.open(path)
    if file then file:close() end
    return file ~= nil
end

test("names and counts", function()
    check(table.concat(x:names(), " ") == "fat flexor extensor")
    check(x:tet_count() > 1000 and x:vertex_count() > 300)
    local n = 0
    for _, name in ipairs(x:names()) do n = n + x:part(name):tet_count() end
    check(n == x:tet_count())
    check(tostring(x) == ("extraction: %d vertices, %d tets, 3 tissues"):format(x:vertex_count(),
                                                                                x:tet_count()))
end)

test("check", function()
    local c = x:check()
    check(c.conforming == true and c.manifold == true and c.positive == true)
    check(c.volume_error < 1e-9 and c.bad_faces == 0 and c.inverted == 0)
    check(c.nonmanifold_edges == 0 and c.nonmanifold_vertices == 0)
    check(c.min_volume > 0 and c.max_volume > c.min_volume)
end)

test("the check does not follow later edits of the scene", function()
    local s = small_scene()
    local y = s:extract()
    s:tetrahedralize{edge_length = 0.5}
    check(y:check().conforming)
    s:close()
    collectgarbage()
    check(y:check().conforming and y:part("flexor"):volume() > 0)
end)

test("parts", function()
    local part = x:part("flexor")
    check(part:name() == "flexor" and tostring(part) == ("part 'flexor': %d tets"):format(part:tet_count()))
    local s = part:surface()
    local c = s:check()
    check(c.closed and c.manifold and c.oriented and c.self_intersections == 0)
    checknear(s:volume(), part:volume(), 1e-9)
    check(s:contains(scene:muscle("flexor"):curve(3)[2]))
    check(x:part("fat"):volume() > part:volume())
end)

test("unknown parts", function()
    checkerr("no part 'flexer' (did you mean 'flexor'?)", x.part, x, "flexer")
    checkerr("no part 'qqqqqqqqqq'", x.part, x, "qqqqqqqqqq")
    checkerr("string expected, got number", x.part, x, 1)
    checkerr("bad argument #1 to 'part' (string expected, got no value)", function() x:part() end)
end)

test("options", function()
    check(scene:extract{margin = 0.01}:check().conforming)
    check(scene:extract():tet_count() == x:tet_count())
    checkerr("unknown option 'margn' (did you mean 'margin'? known: margin)", scene.extract, scene,
             {margn = 0.1})
    checkerr("option 'margin': number above 0 expected, got 0", scene.extract, scene, {margin = 0})
    checkerr("option 'margin': number above 0 expected, got -1", scene.extract, scene, {margin = -1})
    checkerr("margin is 0.3", scene.extract, scene, {margin = 0.3})
    checkerr("option 'margin': finite number expected", scene.extract, scene, {margin = nan})
    checkerr("table of options expected, got number", scene.extract, scene, 0.1)
end)

test("save all", function()
    for _, ext in ipairs{"vtu", "mesh", "msh"} do
        check(x:save(dir .. "/all." .. ext) == true)
        check(exists(dir .. "/all." .. ext))
    end
    local back = sinew.tets.load(dir .. "/all.vtu")
    check(back:tet_count() == x:tet_count() and back:vertex_count() == x:vertex_count())
    check(x:save(dir .. "/parts") == true)
    check(exists(dir .. "/parts/flexor.obj") and exists(dir .. "/parts/extensor.obj"))
    check(not exists(dir .. "/parts/fat.obj"))
    checknear(sinew.surface.load(dir .. "/parts/flexor.obj"):volume(), x:part("flexor"):volume(), 1e-9)
end)

test("save parts", function()
    local part = x:part("extensor")
    for _, ext in ipairs{"obj", "ply", "off"} do
        check(part:save(dir .. "/e." .. ext) == true)
        checknear(sinew.surface.load(dir .. "/e." .. ext):volume(), part:volume(), 1e-9, ext)
    end
    check(part:save(dir .. "/e.stl") and part:save(dir .. "/e.msh"))
    for _, ext in ipairs{"vtu", "mesh"} do
        check(part:save(dir .. "/e." .. ext) == true)
        local back = sinew.tets.load(dir .. "/e." .. ext)
        check(back:tet_count() == part:tet_count())
        checknear(back:volume(), part:volume(), 1e-12)
    end
end)

test("files that cannot be written: nil and a message", function()
    local function fails(pattern, ok, message)
        check(ok == nil and message:find(pattern, 1, true), message)
    end
    fails("no/all.vtu: cannot write: No such file", x:save(dir .. "/no/all.vtu"))
    fails("all.xyz", x:save(dir .. "/all.xyz"))
    fails("cannot create the folder", x:save(dir .. "/no/such/folder"))
    local part = x:part("flexor")
    fails("no/a.obj: cannot write: No such file", part:save(dir .. "/no/a.obj"))
    fails("no/a.vtu: cannot write: No such file", part:save(dir .. "/no/a.vtu"))
    fails("a.xyz: unknown format 'xyz' (known: .obj .ply .stl .off for the surface, .vtu .mesh .msh for the tets)",
          part:save(dir .. "/a.xyz"))
    checkerr("string expected, got nil", x.save, x, nil)
    checkerr("text with a zero byte", part.save, part, "a\0.obj")
end)

test("an empty muscle: a warning, no surface, no file", function()
    local s = small_scene()
    s:add_muscle("ghost",
                 {points = {{0, -1, 0.5}, {0, -0.3, 0.6}, {0, 0.3, 0.6}, {0, 1, 0.5}}, tissue = 0.01})
    local y = s:extract()
    local part = y:part("ghost")
    check(part:tet_count() == 0 and part:volume() == 0)
    checkerr("part 'ghost' is empty: no tets", part.surface, part)
    local ok, message = part:save(dir .. "/g.obj")
    check(ok == nil and message == "part 'ghost' is empty: no tets")
    ok, message = part:save(dir .. "/g.vtu")
    check(ok == nil and message == "part 'ghost' is empty: no tets")
    check(y:save(dir .. "/with_ghost") and not exists(dir .. "/with_ghost/ghost.obj"))
    check(s:report().muscles.ghost.tets == 0)
end)

test("the warning of an empty muscle reaches the program", function()
    local first = 0
    while arg[first - 1] do first = first - 1 end
    local path = dir .. "/ghost.lua"
    local file = io.open(path, "w")
    file:write([[local s = dofile("tests/lua/small_scene.lua")()
        s:add_muscle("ghost",
                     {points = {{0, -1, 0.5}, {0, -0.3, 0.6}, {0, 0.3, 0.6}, {0, 1, 0.5}}, tissue = 0.01})
        s:extract()]])
    file:close()
    local run = io.popen(arg[first] .. " " .. path .. " 2>&1")
    local out = run:read("a")
    check(run:close(), out)
    local _, count = out:gsub("warning: muscle 'ghost' is empty: no tets", "")
    check(count == 1, out)
end)

test("closed extractions", function()
    local y = scene:extract()
    local part = y:part("flexor")
    y:close()
    y:close()
    check(tostring(y) == "extraction (was closed)")
    for _, name in ipairs{"names", "part", "tet_count", "vertex_count", "check", "save"} do
        checkerr("extraction was closed", y[name], y, "a.vtu")
    end
    for _, name in ipairs{"name", "volume", "tet_count", "surface", "save"} do
        checkerr("the part's extraction was closed", part[name], part, "a.obj")
    end
end)

test("parts keep their extraction", function()
    local part = scene:extract():part("flexor")
    collectgarbage()
    collectgarbage()
    checknear(part:volume(), x:part("flexor"):volume(), 0)
end)

test("unknown methods, help", function()
    checkerr("extraction has no 'chek' (did you mean 'check'?)", function() return x:chek() end)
    for name in pairs(getmetatable(x).__index) do check(sinew.help_text["extraction:" .. name], name) end
    for name in pairs(getmetatable(x:part("fat")).__index) do check(sinew.help_text["part:" .. name],
                                                                    name) end
end)

os.execute("rm -rf " .. dir)
finish()
