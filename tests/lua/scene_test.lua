-- scene_test - sinew.scene: skin, bones, body, solving, questions, what happens to closed and removed things
dofile("tests/lua/harness.lua")
local small_scene = dofile("tests/lua/small_scene.lua")

local nan, inf = 0 / 0, 1 / 0
local ball = sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.4}

test("new: what it is", function()
    local s = sinew.scene()
    check(s:name() == "scene" and s:unit() == "m" and s:up() == "y")
    check(s:skin() == nil and #s:bones() == 0 and #s:muscles() == 0 and s:bounds() == nil)
    check(tostring(s) == "scene 'scene': no skin, 0 bones, 0 muscles")
    local t = sinew.scene{name = "leg", unit = "mm", up = "z"}
    check(t:name() == "leg" and t:unit() == "mm" and t:up() == "z")
end)

test("new: wrong options", function()
    checkerr("unknown option 'nmae' (did you mean 'name'? known: name, unit, up)", sinew.scene, {nmae = "x"})
    checkerr("option 'up': unknown axis 'x' (known: y, z)", sinew.scene, {up = "x"})
    checkerr("option 'up': string expected, got number", sinew.scene, {up = 2})
    checkerr("option 'name': string expected, got number", sinew.scene, {name = 7})
    checkerr("option 'name': text with a zero byte", sinew.scene, {name = "a\0b"})
    checkerr("bad argument #1 to 'scene' (table of options expected, got string)",
             function() sinew.scene("leg") end)
end)

test("fat and alpha", function()
    local s = sinew.scene()
    check(s:fat() == 0.2 and s:alpha() == 5)
    s:set_fat(0.3)
    s:set_alpha(10)
    check(s:fat() == 0.3 and s:alpha() == 10)
    s:set_fat(0)
    checkerr("fat is -1, need >= 0", s.set_fat, s, -1)
    checkerr("alpha is 0, need > 0", s.set_alpha, s, 0)
    checkerr("finite number expected", s.set_fat, s, nan)
    checkerr("finite number expected, got inf", s.set_alpha, s, inf)
    checkerr("number expected, got string", s.set_alpha, s, "5")
    checkerr("number expected, got no value", s.set_fat, s)
    check(s:fat() == 0 and s:alpha() == 10, "unchanged by errors")
end)

test("skin", function()
    local s = sinew.scene()
    s:set_skin(ball)
    local back = s:skin()
    check(back:vertex_count() == ball:vertex_count() and back:volume() == ball:volume())
    back:transform{scale = 2}
    check(s:skin():volume() == ball:volume(), "a copy")
    check(s:bounds().max == ball:bounds().max)
    checkerr("sinew.surface expected, got table", s.set_skin, s, {})
    checkerr("bad argument #1 to 'set_skin' (sinew.surface expected, got no value)",
             function() s:set_skin() end)
    checkerr("surface was closed", function()
        local c = ball:copy()
        c:close()
        s:set_skin(c)
    end)
end)

test("bones", function()
    local s = small_scene("bones")
    check(#s:bones() == 2 and s:bones()[1]:name() == "upper" and s:bones()[2]:name() == "lower")
    check(s:bone("upper") == s:bones()[1] and s:bone("upper") ~= s:bone("lower"))
    check(s:bone("upper") ~= small_scene("bones"):bone("upper"), "of another scene")
    check(tostring(s:bone("upper")) == "bone 'upper'")
    local copy = s:bone("upper"):surface()
    check(copy:check().closed and copy:bounds().max.y > 1.3)
    checkerr("no bone 'uper' (did you mean 'upper'?)", s.bone, s, "uper")
    checkerr("no bone 'lowre' (did you mean 'lower'?)", s.remove_bone, s, "lowre")
    checkerr("string expected, got number", s.bone, s, 1)
    checkerr("there is a bone 'upper' already", s.add_bone, s, "upper", ball)
    checkerr("string expected, got sinew.surface", s.add_bone, s, ball)
    checkerr("sinew.surface expected, got nil", s.add_bone, s, "x", nil)
    checkerr("name of bone 'a/b' holds '/', '\"' or a control character", s.add_bone, s, "a/b", ball)
    checkerr("'..' is no name for a bone", s.add_bone, s, "..", ball)
    checkerr("name of a bone has 0 bytes, need 1 to 64", s.add_bone, s, "", ball)
    checkerr("name of a bone has 65 bytes, need 1 to 64", s.add_bone, s, ("x"):rep(65), ball)
    checkerr("text with a zero byte", s.add_bone, s, "a\0b", ball)
    check(#s:bones() == 2)
    check(s:add_bone(("x"):rep(64), ball):name() == ("x"):rep(64))
end)

test("removed bones", function()
    local s = small_scene("bones")
    local upper, lower = s:bone("upper"), s:bone("lower")
    s:remove_bone("upper")
    checkerr("bone 'upper' was removed", upper.name, upper)
    checkerr("bone 'upper' was removed", upper.surface, upper)
    check(lower:name() == "lower", "finds its new place")
    check(tostring(upper) == "bone 'upper'")
    s:remove_bone(lower)
    check(#s:bones() == 0)
end)

test("tetrahedralize", function()
    local s = small_scene("bones")
    local r = s:tetrahedralize{edge_length = 0.35, bone_edge_length = 0.25, max_volume = 0.02,
                               radius_edge = 1.6, time_limit = 60}
    check(r.vertices > 100 and r.tets > r.vertices and r.seconds > 0)
    check(r.surface_faces > 0 and r.min_dihedral > 0 and r.max_dihedral < 180 and r.resampled == false)
    checknear(r.bone_volume, r.bone_volume_exact, 0.1 * r.bone_volume_exact)
    local again = s:tetrahedralize{edge_length = 0.35, bone_edge_length = 0.25, max_volume = 0.02,
                                   radius_edge = 1.6}
    check(again.tets == r.tets and again.vertices == r.vertices, "deterministic")
end)

test("tetrahedralize: wrong options", function()
    local s = small_scene("bones")
    checkerr("known: edge_length, bone_edge_length, adaptive, max_volume, radius_edge, time_limit)", s.tetrahedralize,
             s, {edge = 1})
    checkerr("did you mean 'edge_length'?", s.tetrahedralize, s, {edge_lenght = 1})
    checkerr("option 'edge_length': number above 0 expected, got 0", s.tetrahedralize, s, {edge_length = 0})
    checkerr("option 'edge_length': finite number expected", s.tetrahedralize, s, {edge_length = nan})
    checkerr("option 'time_limit': number expected, got string", s.tetrahedralize, s, {time_limit = "1"})
    checkerr("option 'max_volume': number above 0 expected, got -1", s.tetrahedralize, s, {max_volume = -1})
    checkerr("1.1", s.tetrahedralize, s, {radius_edge = 0.5})
    checkerr("the scene has no skin: set_skin first", sinew.scene().tetrahedralize, sinew.scene())
    local open = sinew.surface.new({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                   {{1, 3, 2}, {1, 2, 4}, {1, 4, 3}})
    checkerr("skin", function()
        local t = sinew.scene()
        t:set_skin(open)
        t:tetrahedralize{}
    end)
    checkerr("rib", function()
        local t = small_scene("skin")
        t:add_bone("rib", open)
        t:tetrahedralize{edge_length = 0.4}
    end)
end)

test("solve", function()
    local s = small_scene()
    local r = s:solve()
    check(r.factorized == true and r.meshed == false)
    check(r.seconds > 0 and r.unknowns > 100 and r.collocation_points > 6)
    check(r.residual < 1e-8 and r.solved == 3)
    check(s:solve().factorized == false, "nothing to do")
    local before = s:revision()
    s:muscle("flexor"):set_point(2, {0, -0.3, 0.65})
    check(s:revision() > before)
    r = s:solve()
    check(r.factorized == false and r.changed_rows > 0, "by the factor of before")
    check(r.solver == "direct" and r.iterations == 0 and #r.tissues == 3 and r.tissues[1] == "fat")
    check(#r.factorized_muscles == 0)
end)

test("solve: quick, then exact", function()
    local s = small_scene()
    s:solve()
    s:muscle("flexor"):set_point(2, {0, -0.3, 0.65})
    local r = s:solve{quick = true}
    check(r.solved + r.kept == 3 and r.quick == (r.kept > 0))
    local p = {0, 0.3, 0.3}
    local quick = s:values_at(p)
    s:set_alpha(6)
    s:solve()
    s:set_alpha(5)
    check(s:solve().factorized)
    for name, value in pairs(s:values_at(p)) do check(math.abs(value - quick[name]) < 1e-9, "exact where it is asked for") end
    checkerr("unknown option 'quik'", s.solve, s, {quik = true})
    checkerr("boolean", s.solve, s, {quick = 1})
end)

test("solve: iterative", function()
    local s = small_scene()
    s:solve()
    local p = {0, 0.3, 0.3}
    local direct = s:values_at(p)
    local r = s:solve{solver = "iterative"}
    check(r.solver == "iterative" and r.solved == 3 and r.factor_entries == 0 and r.iterations > 0)
    for name, value in pairs(s:values_at(p)) do check(math.abs(value - direct[name]) < 1e-8) end
    check(s:solve().solver == "iterative", "stays")
    check(s:solve{solver = "auto"}.solver == "direct")
    checkerr("unknown 'cg' (known: auto, direct, iterative)", s.solve, s, {solver = "cg"})
end)

test("solve: nothing to solve", function()
    checkerr("the scene has no muscles: add_muscle first", function() sinew.scene():solve() end)
    checkerr("the scene has no skin: set_skin first", function()
        local s = sinew.scene()
        s:add_muscle("m", {points = {{0, 0, 0}, {0, 1, 0}}})
        s:solve()
    end)
    checkerr("the scene has no muscles: add_muscle first", function() small_scene("bones"):solve() end)
    local s = small_scene("bones")
    s:tetrahedralize{edge_length = 0.35}
    s:add_muscle("lost", {points = {{5, 5, 5}, {6, 6, 6}}})
    checkerr("muscle 'lost': its curve never enters the soft tissue", s.solve, s)
end)

test("values_at and tissue_at", function()
    local s = small_scene()
    local p = s:muscle("flexor"):curve(9)[5]
    local v = check(s:values_at(p))
    check(v.flexor > v.extensor and v.flexor > v.fat and v.flexor > 0.7)
    local n = 0
    for _ in pairs(v) do n = n + 1 end
    check(n == 3)
    check(s:tissue_at(p) == "flexor" and s:tissue_at{0, 0, -0.6} == "extensor")
    check(s:tissue_at{0.9, 0, 0} == "fat" and s:values_at{0.9, 0, 0}.fat > 0.1)
    check(s:tissue_at{0, 1, 0} == "bone:upper" and s:values_at{0, 1, 0} == nil)
    check(s:tissue_at{0, -1, 0} == "bone:lower")
    check(s:tissue_at{5, 5, 5} == nil and s:values_at{5, 5, 5} == nil)
    checkerr("point: coordinate y: finite number expected", s.values_at, s, {0, nan, 0})
    checkerr("bad argument #1 to 'tissue_at' (point: {x, y, z} expected, got no value)",
             function() s:tissue_at() end)
end)

test("questions solve first", function()
    local s = small_scene()
    check(s:tissue_at{0, 0, -0.6} == "extensor")
    s:remove_muscle("extensor")
    check(s:tissue_at{0, 0, -0.6} ~= "extensor" and s:values_at{0, 0, -0.6}.extensor == nil)
end)

test("report", function()
    local s = small_scene()
    local r = s:report()
    check(r.name == "limb" and r.unit == "cm")
    local sum = r.fat_volume
    for _, m in ipairs(s:muscles()) do
        local part = check(r.muscles[m:name()])
        check(part.volume > 0 and part.tets > 0 and part.components >= 1 and part.length_outside >= 0)
        checknear(part.length, m:length())
        sum = sum + part.volume
    end
    local x, volume = s:extract(), 0
    for _, name in ipairs(x:names()) do volume = volume + x:part(name):volume() end
    checknear(sum, volume, 1e-9 * volume)
    check(#r.tissues_per_tet == 8)
    local tets = 0
    for _, n in ipairs(r.tissues_per_tet) do tets = tets + n end
    check(tets == r.body.tets and r.tissues_per_tet[1] > r.tissues_per_tet[2] and r.tissues_per_tet[2] > 0)
    check(r.solve.collocation_points > 0 and r.timings.extract > 0 and r.timings.tetrahedralize > 0)
end)

test("closed scenes", function()
    local s = small_scene("bones")
    local bone, m = s:bone("upper"), s:add_muscle("m", {points = {{0, 0, 0.5}, {0, 1, 0.5}}})
    s:close()
    s:close()
    check(tostring(s) == "scene (was closed)")
    checkerr("bad self (scene was closed)", function() s:solve() end)
    for name in pairs(getmetatable(s).__index) do
        if name ~= "close" then checkerr("scene was closed", s[name], s, {}, {}) end
    end
    checkerr("bone 'upper': its scene was closed", bone.name, bone)
    checkerr("muscle 'm': its scene was closed", m.set_tissue, m, 1)
    local kept
    do
        local t <close> = sinew.scene()
        kept = t
    end
    checkerr("scene was closed", kept.name, kept)
end)

test("handles keep their scene", function()
    local m = small_scene():muscle("flexor")
    collectgarbage()
    collectgarbage()
    check(m:point_count() == 4 and m:name() == "flexor")
end)

test("unknown methods, wrong objects", function()
    local s = sinew.scene()
    checkerr("scene has no 'sovle'", function() s:sovle() end)
    checkerr("sinew.scene expected, got table", s.solve, {})
    checkerr("sinew.bone expected, got sinew.scene",
             getmetatable(small_scene("bones"):bone("upper")).__index.name, s)
end)

-- Warnings go to the program, which prints them: seen from a second run of it.
test("warnings reach the program", function()
    local first = 0
    while arg[first - 1] do first = first - 1 end
    local path = os.tmpname()
    local file = io.open(path, "w")
    file:write([[local s = dofile("tests/lua/small_scene.lua")()
        s:add_muscle("far", {points = {{0, 0, 0.5}, {0, 0, 3}}})
        s:solve()]])
    file:close()
    local run = io.popen(arg[first] .. " " .. path .. " 2>&1")
    local out = run:read("a")
    check(run:close(), out)
    os.remove(path)
    check(out:find("warning: muscle 'far': [%d.]+ of its curve's 2.5 lies outside"), out)
end)

finish()
