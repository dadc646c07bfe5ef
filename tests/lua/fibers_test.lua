-- fibers_test - fibers, lines, tendon, architecture and attachments of parts: against what is known of a cylinder,
-- and every message
dofile("tests/lua/harness.lua")
local small_scene = dofile("tests/lua/small_scene.lua")

local nan = 0 / 0
local dir = os.tmpname()
os.remove(dir)
assert(os.execute("mkdir " .. dir))

local function read(path)
    local file = assert(io.open(path, "rb"))
    local text = file:read("a")
    file:close()
    return text
end

-- A closed tube around z from 0 to length with n sides.
local function tube(radius, length, n, layers)
    local v, f = {}, {}
    for k = 0, layers do
        for i = 0, n - 1 do
            local a = 2 * math.pi * i / n
            v[#v + 1] = {radius * math.cos(a), radius * math.sin(a), length * k / layers}
        end
    end
    for k = 0, layers - 1 do
        for i = 0, n - 1 do
            local a, b = k * n + i + 1, k * n + (i + 1) % n + 1
            f[#f + 1] = {a, b, b + n}
            f[#f + 1] = {a, b + n, a + n}
        end
    end
    v[#v + 1] = {0, 0, 0}
    v[#v + 1] = {0, 0, length}
    for i = 0, n - 1 do
        f[#f + 1] = {#v - 1, (i + 1) % n + 1, i + 1}
        f[#f + 1] = {#v, layers * n + i + 1, layers * n + (i + 1) % n + 1}
    end
    return sinew.surface.new(v, f)
end

local radius, length, sides = 0.3, 2, 24
local section = 0.5 * sides * math.sin(2 * math.pi / sides) * radius ^ 2

-- Without fat the only muscle has all of the skin's inside.
local function cylinder_scene(options)
    local s = sinew.scene{}
    s:set_skin(tube(radius, length, sides, 20))
    s:tetrahedralize{edge_length = 0.1}
    s:set_fat(0)
    options = options or {}
    options.points = options.points or {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}
    return s, s:add_muscle("m", options)
end

local function angle(a, b)
    local dot = a.x * b.x + a.y * b.y + a.z * b.z
    return math.deg(math.acos(math.max(-1, math.min(1, dot))))
end

local along = sinew.vec3(0, 0, 1)
local scene, muscle = cylinder_scene()

test("fibers of a cylinder", function()
    local part = scene:extract():part("m")
    local list, found = part:fibers()
    check(#list == part:tet_count())
    for _, f in ipairs(list) do
        check(angle(f.direction, along) < 1, f.direction)
        checknear(f.u, f.point.z / length, 0.005, "u")
        check(f.tendon == false)
    end
    check(found.sinks == 0 and found.sources == 0 and found.flipped == 0 and found.still == 0)
    check(found.worst_turn < 2)
end)

test("architecture of a cylinder", function()
    local a = scene:extract():part("m"):architecture()
    checknear(a.volume, section * length, 0.01 * section * length) -- the skin is meshed anew
    checknear(a.belly_volume, a.volume, 0)
    checknear(a.tendon_volume, 0, 0)
    checknear(a.fiber_length, length, 0.02 * length)
    checknear(a.pcsa, section, 0.03 * section)
    check(a.pennation_angle < 1)
    checknear(a.pcsa, a.belly_volume * math.cos(math.rad(a.pennation_angle)) / a.fiber_length, 1e-12)
    check(a.fiber_check.sinks == 0 and a.fiber_check.flipped == 0)
end)

test("lines of a cylinder", function()
    local x = scene:extract()
    local lines = x:part("m"):fiber_lines{count = 20}
    check(#lines == 20)
    for _, line in ipairs(lines) do
        check(#line > 50)
        check(line[1].z < 0.05 and line[#line].z > length - 0.05)
        for k = 2, #line do check(line[k].z > line[k - 1].z) end
        for _, p in ipairs(line) do check(p.x ^ 2 + p.y ^ 2 <= radius ^ 2 + 1e-9) end
    end
    check(#x:part("m"):fiber_lines() == 100)
    local all = x:fiber_lines{count = 7}
    check(#all.m == 7 and all.fat == nil)
end)

test("tendon by length and by area", function()
    muscle:set_tendon{length = 0.3}
    local a = scene:extract():part("m"):architecture()
    checknear(a.tendon_volume, section * 0.6, 0.05 * section * 0.6)
    checknear(a.belly_volume + a.tendon_volume, a.volume, 1e-12)
    checknear(a.fiber_length, length - 0.6, 0.02 * length)
    for _, f in ipairs((scene:extract():part("m"):fibers())) do
        check(f.tendon == (f.point.z < 0.3 or f.point.z > length - 0.3))
    end
    muscle:set_tendon{area = 1.2 * section} -- nowhere so thick
    a = scene:extract():part("m"):architecture()
    check(a.belly_volume == 0 and a.fiber_length == 0 and a.pcsa == 0)
    muscle:set_tendon(nil)
    checknear(scene:extract():part("m"):architecture().tendon_volume, 0, 0)
end)

test("pennate kinds", function()
    muscle:set_pennation{kind = "unipennate", angle = 20}
    local part = scene:extract():part("m")
    for _, f in ipairs((part:fibers())) do checknear(angle(f.direction, along), 20, 1e-6) end
    local uni = part:architecture()
    checknear(uni.pennation_angle, 20, 1e-6)
    muscle:set_pennation{kind = "bipennate", angle = {0, 40}}
    part = scene:extract():part("m")
    for _, f in ipairs((part:fibers())) do
        checknear(angle(f.direction, along), 40 * f.u, 1e-4)
    end
    muscle:set_pennation{kind = "bipennate", angle = 20}
    check(scene:extract():part("m"):architecture().fiber_length < 0.6 * uni.fiber_length)
    muscle:set_pennation(nil)
end)

test("a curve given with the call", function()
    local part = scene:extract():part("m")
    local list = part:fibers{points = {{0, 0, 2}, {0, 0, 0}}}
    for _, f in ipairs(list) do check(angle(f.direction, along) > 179) end
    list = part:fibers{points = {{0, 0, 0}, {0, 0, 2}}, kind = "unipennate", angle = 30, axis = {1, 0, 0}}
    for _, f in ipairs(list) do checknear(f.direction.y, 0.5, 1e-9) end -- e2 is x, e3 is y
    list = part:fibers{points = {{0, 0, 0}, {0, 0, 2}}, kind = "unipennate", angle = 30, axis = {1, 0, 0},
                       frame_angle = 90}
    for _, f in ipairs(list) do checknear(f.direction.x, -0.5, 1e-9) end
    list = part:fibers{kind = "parallel", heads = {{points = {{0.1, 0, 0}, {0, 0, 2}}},
                                                   {points = {{-0.1, 0, 0}, {0, 0, 2}}}}}
    for _, f in ipairs(list) do
        if f.point.z < 1 and math.abs(f.point.x) > 0.05 then check(f.direction.x * f.point.x < 0) end
    end
    check(#part:fiber_lines{points = {{0, 0, 0}, {0, 0, 2}}, count = 5} == 5)
    checknear(part:architecture{points = {{0, 0, 0}, {0, 0, 2}}}.fiber_length, 2, 0.04)
end)

test("parts of anybody's functions need a curve", function()
    local path = dir .. "/tube.mesh"
    check(scene:extract():save(path))
    local tets = check(sinew.tets.load(path))
    local ones, zeros = {}, {}
    for v = 1, tets:vertex_count() do ones[v], zeros[v] = 1, 0 end
    local x = sinew.extract(tets, {{name = "rest", values = zeros}, {name = "all", values = ones}})
    local part = x:part("all")
    for _, f in ipairs{part.fibers, part.fiber_lines, part.architecture} do
        checkerr("part 'all' has no curve that fibers could follow: give one", f, part)
    end
    checkerr("part 'rest' has no curve that fibers could follow: give one", x:part("rest").fibers, x:part("rest"))
    checkerr("no part has a curve that fibers could follow", x.fiber_lines, x)
    local a = part:architecture{points = {{0, 0, 0}, {0, 0, 2}}}
    checknear(a.pcsa, section, 0.03 * section)
    checkerr("fibers of muscle 'rest': it is empty", x:part("rest").fibers, x:part("rest"),
             {points = {{0, 0, 0}, {0, 0, 2}}})
    tets:close()
    checkerr("part 'all': the tets it was cut from were closed", part.fibers, part,
             {points = {{0, 0, 0}, {0, 0, 2}}})
    check(part:save(dir .. "/all.vtu"))
    check(not read(dir .. "/all.vtu"):find('Name="fiber"', 1, true))
end)

local limb = small_scene()
local x = limb:extract()
local part = x:part("flexor")
local line = {{0, -1, 0.5}, {0, 1, 0.5}}

test("wrong options", function()
    local fibers = part.fibers
    local function fails(message, options) checkerr(message, fibers, part, options) end
    fails("unknown option 'pints' (did you mean 'points'? known: points, heads, kind, angle, sheets, axis, " ..
              "frame_angle)", {pints = line})
    for _, key in ipairs{"kind", "angle", "sheets", "axis", "frame_angle"} do
        fails("option '" .. key .. "': goes with a curve given here (option 'points' or 'heads')", {[key] = 3})
    end
    fails("option 'kind': unknown kind 'unipenate' (did you mean 'unipennate'? known: fusiform, parallel, " ..
              "convergent, unipennate, bipennate, multipennate)", {points = line, kind = "unipenate"})
    fails("option 'kind': string expected, got number", {points = line, kind = 3})
    fails("muscle 'flexor': 0 pennation angles, need 1..16", {points = line, kind = "unipennate"})
    fails("muscle 'flexor': pennation angle 1 is 90 degrees, need 0..80",
          {points = line, kind = "unipennate", angle = 90})
    fails("option 'angle': 0 values, need 1..16", {points = line, kind = "unipennate", angle = {}})
    fails("muscle 'flexor': fibers that are fusiform have no pennation angle", {points = line, angle = 3})
    fails("option 'sheets': only a multipennate muscle has several",
          {points = line, kind = "bipennate", angle = 3, sheets = 2})
    fails("need 2..16", {points = line, kind = "multipennate", angle = 3, sheets = 1})
    fails("either option 'heads' or 'points' and 'tissue' expected, got both",
          {points = line, heads = {{points = line}}})
    fails("fibers of muscle 'flexor': its 2 heads share neither an insertion (last point) nor an origin (first " ..
              "point)", {heads = {{points = line}, {points = {{1, 0, 0}, {1, 1, 0}}}}})
    fails("muscle 'flexor': axis {0, 1, 0} of the frame runs along the curve",
          {points = line, kind = "unipennate", angle = 10, axis = {0, 1, 0}})
    fails("option 'frame_angle': finite number expected", {points = line, frame_angle = nan})
    fails("muscle 'flexor': a curve has 1 point, need 2 or more", {points = {{0, 0, 0}}})
    fails("points[2]: {x, y, z} expected, got number", {points = {{0, 0, 0}, 1}})
    fails("table of options expected, got number", 3)
end)

test("wrong options of lines", function()
    local function fails(message, options)
        checkerr(message, part.fiber_lines, part, options)
        checkerr(message, x.fiber_lines, x, options)
    end
    fails("option 'count': 0 lines, need 1..1000000", {count = 0})
    fails("option 'count': 1000001 lines, need 1..1000000", {count = 1000001})
    fails("option 'count': whole number", {count = 2.5})
    fails("option 'file': string expected, got number", {file = 3})
    fails("/no/lines.vtp: cannot write: No such file or directory", {count = 2, file = dir .. "/no/lines.vtp"})
    fails("lines.xyz: no format of lines to write 'xyz' (known: .vtp .obj)", {count = 2, file = dir .. "/lines.xyz"})
    checkerr("unknown option 'points' (known: count, file)", x.fiber_lines, x, {points = line})
end)

test("what has no fibers", function()
    local fat = x:part("fat")
    for _, f in ipairs{part.fibers, part.fiber_lines, part.architecture} do
        checkerr("part 'fat' is no muscle: it has no fibers", f, fat)
    end
    local s = small_scene()
    s:add_muscle("ghost", {points = {{0, -1, 0.5}, {0, -0.3, 0.6}, {0, 0.3, 0.6}, {0, 1, 0.5}}, tissue = 0.01})
    local y = s:extract()
    local ghost = y:part("ghost")
    for _, f in ipairs{part.fibers, part.fiber_lines, part.architecture} do
        checkerr("fibers of muscle 'ghost': it is empty", f, ghost)
    end
    local lines = y:fiber_lines{count = 3}
    check(#lines.ghost == 0 and #lines.flexor == 3 and #lines.extensor == 3)
    local report = s:report().muscles
    check(report.ghost.fiber_length == nil and report.ghost.origin.area == 0 and report.flexor.fiber_length > 1)
    check(y:save(dir .. "/ghost.vtu"))
    y:close()
    checkerr("the part's extraction was closed", ghost.fibers, ghost)
    checkerr("extraction was closed", y.fiber_lines, y)
end)

test("heads that share no end: no fibers, but files", function()
    local s = small_scene()
    s:add_muscle("pair", {heads = {{points = {{0.5, -1, 0}, {0.5, -0.2, 0}}},
                                   {points = {{0.6, 0.2, 0}, {0.5, 1, 0}}}}})
    local y = s:extract()
    local pair = y:part("pair")
    check(pair:tet_count() > 0)
    checkerr("fibers of muscle 'pair': its 2 heads share neither an insertion (last point) nor an origin (first " ..
                 "point)", pair.fibers, pair)
    check(y:save(dir .. "/pair.vtu") and pair:save(dir .. "/pair_alone.msh"))
    check(#y:fiber_lines{count = 3}.pair == 0)
    local muscles = s:report().muscles
    check(muscles.pair.fiber_length == nil and #muscles.pair.heads == 2)
    check(muscles.flexor.heads == nil)
end)

test("files have fibers and tendon", function()
    local s = small_scene()
    s:muscle("flexor"):set_tendon{length = 0.2}
    local y = s:extract()
    check(y:save(dir .. "/f.vtu") and y:save(dir .. "/f.msh") and y:save(dir .. "/f.mesh"))
    local vtu, msh, mesh = read(dir .. "/f.vtu"), read(dir .. "/f.msh"), read(dir .. "/f.mesh")
    check(vtu:find('Name="fiber" NumberOfComponents="3"', 1, true) and vtu:find('Name="tendon"', 1, true))
    check(select(2, msh:gsub("%$ElementData", "")) == 2 and msh:find('"fiber"', 1, true))
    check(mesh:find("# tissue 2 flexor\n# tissue 3 extensor\n# tissue 4 flexor:tendon\n# tissue 5 extensor:tendon\n",
                    1, true))
    local _, tendon_tets = mesh:match("Tetrahedra.*$"):gsub("%d+ %d+ %d+ %d+ 4\n", "")
    local n = 0
    for _, f in ipairs((y:part("flexor"):fibers())) do n = n + (f.tendon and 1 or 0) end
    check(n > 0 and tendon_tets == n, tendon_tets)
    check(y:part("flexor"):save(dir .. "/p.vtu"))
    check(read(dir .. "/p.vtu"):find('Name="fiber"', 1, true))
    check(s:extract():save(dir .. "/again.vtu") and read(dir .. "/again.vtu") == vtu, "same bytes")
end)

test("files of lines", function()
    local path = dir .. "/lines.vtp"
    local lines = part:fiber_lines{count = 4, file = path}
    local text = read(path)
    check(text:find('NumberOfLines="4"', 1, true) and text:find('Name="u"', 1, true))
    local points = 0
    for _, l in ipairs(lines) do points = points + #l end
    check(text:find('NumberOfPoints="' .. points .. '"', 1, true))
    x:fiber_lines{count = 3, file = dir .. "/lines.obj"}
    text = read(dir .. "/lines.obj")
    check(select(2, text:gsub("\nl ", "")) == 6 and text:find("o flexor\n", 1, true))
end)

test("attachments in the report", function()
    local m = limb:report().muscles.flexor
    check(m.origin.bone == "lower" and m.insertion.bone == "upper")
    check(m.origin.area > 0 and m.insertion.area > 0 and m.origin.distance > 0)
    check(m.origin.centroid.y < 0 and m.insertion.centroid.y > 0)
    for _, key in ipairs{"fiber_length", "pennation_angle", "pcsa", "belly_volume", "tendon_volume"} do
        checknear(m[key], part:architecture()[key], 1e-9, key)
    end
    local bare = scene:report().muscles.m
    check(bare.origin.bone == nil and bare.origin.area == 0 and bare.origin.distance == 0)
    check(bare.origin.centroid == sinew.vec3(0, 0, 0) and bare.insertion.centroid == sinew.vec3(0, 0, 2))
end)

os.execute("rm -rf " .. dir)
finish()
