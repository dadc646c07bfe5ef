-- muscle_shape_test - heads, frames, volumes, pennation and tendon settings of muscles
dofile("tests/lua/harness.lua")

local small_scene = dofile("tests/lua/small_scene.lua")
local vec3 = sinew.vec3
local nan, inf = 0 / 0, 1 / 0
local p1, p2, p3 = {0, 0, 0}, {0, 1, 0}, {0, 3, 0}

local function with_muscle()
    local s = sinew.scene()
    return s:add_muscle("biceps", {points = {p1, p2, p3}}), s
end

local function with_heads()
    local s = sinew.scene()
    return s:add_muscle("biceps", {heads = {
        {points = {p1, p2, p3}, tissue = {1, 2, 3}},
        {points = {{1, 0, 0}, p3}, tissue = 4},
        {points = {{0, 0, 1}, {0, 2, 1}, {0, 2.5, 0.5}, p3}},
    }}), s
end

local function near(got, x, y, z, tolerance)
    checknear(got.x, x, tolerance or 1e-12, "x")
    checknear(got.y, y, tolerance or 1e-12, "y")
    checknear(got.z, z, tolerance or 1e-12, "z")
end

-- ---- heads ----

test("heads: what they have", function()
    local m, s = with_heads()
    check(m:head_count() == 3 and with_muscle():head_count() == 1)
    local a, b, c = m:head(1), m:head(2), m:head(3)
    check(tostring(b) == "muscle 'biceps', head 2")
    check(a == m:head(1) and a ~= b and s:muscle("biceps"):head(2) == b, "equal handles")
    check(a ~= with_heads():head(1), "of another scene")
    check(a:point_count() == 3 and b:point_count() == 2 and c:point_count() == 4)
    check(b:point(1) == vec3(1, 0, 0) and c:point(4) == vec3(0, 3, 0))
    check(a:tissue(2) == 2 and b:tissue(1) == 4 and b:tissue(2) == 4 and c:tissue(3) == 1)
    checknear(a:length(), 3, 1e-9)
    checknear(b:length(), 10 ^ 0.5, 1e-9)
    checknear(m:length(), a:length() + b:length() + c:length(), 1e-12)
    near(b:curve(3)[2], 0.5, 1.5, 0, 1e-9)
    check(s:bounds().max == vec3(1, 3, 1))
end)

test("heads: edited one by one", function()
    local m = with_heads()
    local a, b = m:head(1), m:head(2)
    b:insert_point(2, {1, 1, 0})
    check(b:point_count() == 3 and b:tissue(2) == 4 and a:point_count() == 3)
    b:set_point(1, {2, 0, 0})
    check(m:head(2):point(1).x == 2 and a:point(1).x == 0)
    b:insert_point(4, {0, 4, 0}, 9)
    check(b:tissue(4) == 9)
    b:remove_point(4)
    b:set_tissue(1, 5)
    check(b:tissue(1) == 5 and b:tissue(2) == 4)
    b:set_tissue(6)
    check(b:tissue(1) == 6 and b:tissue(3) == 6 and a:tissue(1) == 1)
    m:set_tissue(7) -- the whole muscle
    check(a:tissue(3) == 7 and b:tissue(1) == 7 and m:head(3):tissue(4) == 7)
end)

test("heads: a muscle with one is its head", function()
    local m = with_muscle()
    m:head(1):set_point(2, {1, 1, 0})
    check(m:point(2) == vec3(1, 1, 0))
    m:set_tissue(2, 3)
    check(m:head(1):tissue(2) == 3 and m:head(1):length() == m:length())
end)

test("heads: which one is meant must be said", function()
    local m = with_heads()
    local say = "muscle 'biceps' has 3 heads: say which, as in muscle:head(1):point(1)"
    checkerr(say, m.point, m, 1)
    checkerr(say, m.point_count, m)
    checkerr(say, m.set_point, m, 1, p1)
    checkerr(say, m.insert_point, m, 1, {9, 9, 9})
    checkerr(say, m.remove_point, m, 1)
    checkerr(say, m.tissue, m, 1)
    checkerr(say, m.set_tissue, m, 1, 2)
    checkerr(say, m.curve, m, 10)
    check(m:head(1):tissue(1) == 1)
end)

test("heads: wrong options", function()
    local _, s = with_muscle()
    local add, good = s.add_muscle, {points = {p1, p2}}
    checkerr("option 'heads': 0 heads, need 1..64", add, s, "a", {heads = {}})
    local many = {}
    for i = 1, 65 do many[i] = good end
    checkerr("option 'heads': 65 heads, need 1..64", add, s, "a", {heads = many})
    checkerr("option 'heads': list expected, got number", add, s, "a", {heads = 3})
    checkerr("either option 'heads' or 'points' and 'tissue' expected, got both", add, s, "a",
             {heads = {good}, points = {p1, p2}})
    checkerr("either option 'heads' or 'points' and 'tissue' expected, got both", add, s, "a",
             {heads = {good}, tissue = 1})
    checkerr("heads[2]: {points=, tissue=} expected, got number", add, s, "a", {heads = {good, 5}})
    checkerr("heads[2]: options are given by name: {points = ...}, not as a list", add, s, "a",
             {heads = {good, {p1, p2}}})
    checkerr("heads[2]: option 'points' is missing", add, s, "a", {heads = {good, {tissue = 1}}})
    checkerr("heads[2]: unknown option 'point' (did you mean 'points'? known: points, tissue)", add, s, "a",
             {heads = {good, {point = {p1, p2}}}})
    checkerr("heads[2]: points[2]: {x, y, z} expected, got number", add, s, "a", {heads = {good, {points = {p1, 2}}}})
    checkerr("bad argument #2 to 'add_muscle' (heads[2]: option 'tissue': 1 values for 2 points)", function()
        s:add_muscle("a", {heads = {good, {points = {p1, p2}, tissue = {1}}}})
    end)
    checkerr("muscle 'a', head 2: a curve has 1 point, need 2 or more", add, s, "a",
             {heads = {good, {points = {p1}}}})
    checkerr("muscle 'a', head 1: tissue of point 2 is -1, need > 0", add, s, "a",
             {heads = {{points = {p1, p2}, tissue = {1, -1}}, good}})
    checkerr("muscle 'a': tissue of point 2 is -1, need > 0", add, s, "a",
             {heads = {{points = {p1, p2}, tissue = {1, -1}}}})
    checkerr("unknown option 'head' (did you mean 'heads'? known: points, tissue, heads)", add, s, "a",
             {head = {good}})
    check(#s:muscles() == 1)
    many[65] = nil
    check(s:add_muscle("all", {heads = many}):head_count() == 64)
end)

test("heads: wrong arguments", function()
    local m = with_heads()
    local b = m:head(2)
    checkerr("index 0 not in 1..3", m.head, m, 0)
    checkerr("index 4 not in 1..3", m.head, m, 4)
    checkerr("number expected, got no value", m.head, m)
    checkerr("index 3 not in 1..2", b.point, b, 3)
    checkerr("index 4 not in 1..3", b.insert_point, b, 4, p1)
    checkerr("muscle 'biceps', head 2: points 1 and 2 of a curve are equal", b.set_point, b, 1, p3)
    checkerr("muscle 'biceps', head 2: has 2 points, the fewest a curve can have", b.remove_point, b, 1)
    checkerr("muscle 'biceps', head 2: tissue of point 1 is 0, need > 0", b.set_tissue, b, 1, 0)
    checkerr("muscle 'biceps', head 2: tissue of point 1 is -3, need > 0", b.set_tissue, b, -3)
    checkerr("muscle 'biceps', head 1: tissue of point 1 is 0, need > 0", m.set_tissue, m, 0)
    checkerr("finite number expected", b.set_tissue, b, nan)
    checkerr("1 points, need 2..1000000", b.curve, b, 1)
    checkerr("head has no 'lenght' (did you mean 'length'?)", function() return b:lenght() end)
    check(b:tissue(1) == 4 and b:point(1) == vec3(1, 0, 0))
end)

test("heads: of removed muscles", function()
    local m, s = with_heads()
    local b = m:head(2)
    s:remove_muscle("biceps")
    for _, name in ipairs{"point_count", "point", "set_point", "insert_point", "remove_point", "tissue",
                          "set_tissue", "curve", "length", "frame"} do
        checkerr("muscle 'biceps' was removed", b[name], b, 1, 1)
    end
    check(tostring(b) == "muscle 'biceps', head 2")
    s:add_muscle("biceps", {points = {p1, p2}}) -- the name again, with fewer heads
    checkerr("muscle 'biceps' has no head 2 any more", b.point, b, 1)
    check(m:point(2).y == 1, "the muscle's handle finds it")
    s:close()
    checkerr("muscle 'biceps': its scene was closed", b.length, b)
end)

-- ---- frames ----

test("frame: set, read, turned off", function()
    local m = with_muscle() -- straight up
    check(m:frame() == nil)
    m:set_frame{}
    local f = m:frame()
    check(f.angle == 0 and f.axis == nil)
    check(f.eigenvalues[1] == 1 and f.eigenvalues[2] == 1 and f.eigenvalues[3] == 1)
    near(f.e1, 0, 1, 0)
    near(f.e2, 1, 0, 0) -- x is what it runs along least, before z
    near(f.e3, 0, 0, -1)
    m:set_frame{angle = 90, eigenvalues = {1, 4, 0.5}, axis = {0, 7, 2}}
    f = m:frame()
    check(f.angle == 90 and f.axis == vec3(0, 7, 2))
    check(f.eigenvalues[2] == 4 and f.eigenvalues[3] == 0.5 and #f.eigenvalues == 3)
    near(f.e1, 0, 1, 0)
    near(f.e2, 1, 0, 0) -- from z, turned about y
    near(f.e3, 0, 0, -1)
    m:set_frame(nil)
    check(m:frame() == nil)
end)

test("frame: along the curve", function()
    local s = sinew.scene()
    local m = s:add_muscle("arc", {heads = {
        {points = {{0, 0, 0}, {1, 2, 0}, {3, 3, 0}}}, {points = {{0, 0, 5}, {0, 0, 9}}}}})
    m:set_frame{axis = {0, 0, 1}}
    local h = m:head(1)
    for _, t in ipairs{0, 0.25, 0.5, 1} do
        local f = h:frame(t)
        near(f.e2, 0, 0, 1, 1e-9)
        checknear(f.e1.x * f.e1.x + f.e1.y * f.e1.y, 1, 1e-9)
        near(f.e3, f.e1.y, -f.e1.x, 0, 1e-9)
    end
    near(h:frame().point, 0, 0, 0)
    near(h:frame(1).point, 3, 3, 0, 1e-9)
    near(m:head(2):frame(0.25).point, 0, 0, 6, 1e-9)
    near(m:head(2):frame().e1, 0, 0, 1)
    checkerr("muscle 'arc' has 2 heads", function() return m:point(1) end)
    local say = "a number from 0 (origin) to 1 (insertion) expected"
    checkerr(say, h.frame, h, -0.1)
    checkerr(say, h.frame, h, 1.5)
    checkerr("finite number expected", h.frame, h, nan)
    checkerr("number expected, got string", h.frame, h, "1")
end)

test("frame: wrong options", function()
    local m = with_muscle()
    m:set_frame{angle = 30, eigenvalues = {1, 2, 3}}
    local set = m.set_frame
    checkerr("muscle 'biceps': eigenvalue 1 is -1, need > 0", set, m, {eigenvalues = {-1, 1, 1}})
    checkerr("muscle 'biceps': eigenvalue 2 is 0, need > 0", set, m, {eigenvalues = {1, 0, 1}})
    checkerr("option 'eigenvalues'[3]: finite number expected", set, m, {eigenvalues = {1, 1, nan}})
    checkerr("option 'eigenvalues'[2]: finite number expected, got inf", set, m, {eigenvalues = {1, inf, 1}})
    checkerr("option 'eigenvalues'[2]: number expected, got string", set, m, {eigenvalues = {1, "2", 1}})
    checkerr("option 'eigenvalues': {l1, l2, l3} expected, got 2", set, m, {eigenvalues = {1, 2}})
    checkerr("option 'eigenvalues': {l1, l2, l3} expected, got 1", set, m, {eigenvalues = 2})
    checkerr("option 'eigenvalues': 4 values, need", set, m, {eigenvalues = {1, 2, 3, 4}})
    checkerr("option 'eigenvalues': 0 values, need", set, m, {eigenvalues = {}})
    checkerr("option 'angle': finite number expected, got inf", set, m, {angle = inf})
    checkerr("option 'angle': finite number expected", set, m, {angle = nan})
    checkerr("option 'angle': number expected, got string", set, m, {angle = "90"})
    checkerr("muscle 'biceps': axis {0, 2, 0} of the frame runs along the curve, need a direction across it", set,
             m, {axis = {0, 2, 0}})
    checkerr("muscle 'biceps': axis {0, 0, 0} of the frame", set, m, {axis = {0, 0, 0}})
    checkerr("option 'axis'", set, m, {axis = 3})
    checkerr("unknown option 'eigenvalue' (did you mean 'eigenvalues'? known: angle, eigenvalues, axis)", set, m,
             {eigenvalue = {1, 1, 1}})
    checkerr("value expected", set, m)
    checkerr("table of options expected, got number", set, m, 45)
    local f = m:frame()
    check(f.angle == 30 and f.eigenvalues[3] == 3, "as before")
end)

test("frame: solved by itself", function()
    local s = small_scene()
    s:solve()
    local probe = {0.2, 0, 0.55}
    local before = s:values_at(probe)
    s:muscle("flexor"):set_frame{angle = 20, eigenvalues = {1, 6, 1}}
    local r = s:solve()
    check(r.solved == 1 and r.anisotropic == 1 and not r.factorized and not r.meshed)
    check(r.seconds_frames >= 0 and r.seconds_anisotropic >= 0)
    local after = s:values_at(probe)
    check(math.abs(after.flexor - before.flexor) > 1e-3)
    check(after.extensor == before.extensor and after.fat == before.fat)
    s:muscle("flexor"):set_frame{angle = 20} -- equal eigenvalues: the frame alone
    r = s:solve()
    check(r.solved == 1 and r.anisotropic == 0)
    checknear(s:values_at(probe).flexor, before.flexor, 1e-10)
    check(s:muscle("flexor"):frame().angle == 20)
end)

-- ---- volumes ----

test("volume: asked and set", function()
    local s = small_scene()
    local m, other = s:muscle("flexor"), s:muscle("extensor")
    local v = m:volume() -- solves
    check(v > 0.05)
    checknear(v / s:report().muscles.flexor.volume, 1, 2e-3)
    m:set_volume(0.7 * v)
    checknear(m:volume(), 0.7 * v, 1e-4 * v)
    check(m:tissue(1) < 1 and m:tissue(1) == m:tissue(2))
    check(other:tissue(2) == 1.5 and m:preserved_volume() == nil)
    local tissue = m:tissue(1)
    checkerr("muscle 'flexor': volume is 0, need > 0", m.set_volume, m, 0)
    checkerr("muscle 'flexor': volume is -1, need > 0", m.set_volume, m, -1)
    checkerr("finite number expected, got inf", m.set_volume, m, inf)
    checkerr("finite number expected", m.set_volume, m, nan)
    checkerr("number expected, got string", m.set_volume, m, "1")
    checkerr("number expected, got no value", m.set_volume, m)
    checkerr("muscle 'flexor': no tissue value gives a volume of 1e+06: crowded by its neighbours and the skin it " ..
             "can reach at most", m.set_volume, m, 1e6)
    check(m:tissue(1) == tissue)
    checknear(m:volume(), 0.7 * v, 1e-4 * v)
end)

test("volume: preserved", function()
    local s = small_scene()
    local m = s:muscle("flexor")
    local v = m:volume()
    m:set_preserve_volume(true)
    checknear(m:preserved_volume(), v, 1e-12)
    for i = 1, 5 do
        m:set_point(2, {0.05 * i, -0.3, 0.6})
        m:set_frame{angle = 15 * i, eigenvalues = {1, 1 + 0.5 * i, 1}}
        checknear(m:volume(), v, 1e-3 * v)
        checknear(s:report().muscles.flexor.volume, v, 2e-3 * v)
    end
    m:set_volume(0.5 * v) -- what is kept from now on
    checknear(m:preserved_volume(), 0.5 * v, 1e-12)
    s:set_fat(0.1)
    checknear(m:volume(), 0.5 * v, 1e-3 * v)
    m:set_preserve_volume(false)
    check(m:preserved_volume() == nil)
    s:set_fat(0.05)
    check(m:volume() > 0.51 * v)
    checkerr("boolean expected, got no value", m.set_preserve_volume, m)
    checkerr("boolean expected, got number", m.set_preserve_volume, m, 1)
end)

test("volume: what cannot be kept", function()
    local s = small_scene()
    local a, b = s:muscle("flexor"), s:muscle("extensor")
    local body = s:report().fat_volume + a:volume() + b:volume()
    a:set_volume(0.6 * body)
    a:set_preserve_volume(true)
    local tissue = b:tissue(1)
    local wanted = "muscle 'extensor': there is no room for a volume of " -- beside those that other muscles keep
    checkerr(wanted, b.set_volume, b, 0.6 * body)
    check(b:tissue(1) == tissue)
    local _, message = pcall(b.set_volume, b, 0.6 * body)
    local possible = tonumber(message:match("about ([%d.e-]+) is possible"))
    checkerr(wanted, b.set_volume, b, 1.1 * possible)
    b:set_volume(0.9 * possible) -- what is said to be possible is, nearly
    b:set_tissue(tissue)
    checknear(a:volume(), 0.6 * body, 1e-3 * body)
    a:set_preserve_volume(false)
    b:set_volume(0.6 * body)
    checknear(b:volume(), 0.6 * body, 1e-4 * body)
    local weak = s:add_muscle("weak", {points = {a:point(1), a:point(2), a:point(3), a:point(4)}, tissue = 1e-6})
    check(weak:volume() == 0)
    checkerr("muscle 'weak': it is empty, there is no volume to keep", weak.set_preserve_volume, weak, true)
    local bare = sinew.scene():add_muscle("m", {points = {p1, p2}})
    checkerr("the scene has no skin: set_skin first", bare.volume, bare)
    checkerr("the scene has no skin: set_skin first", bare.set_volume, bare, 1)
    checkerr("the scene has no skin: set_skin first", bare.set_preserve_volume, bare, true)
end)

-- ---- pennation ----

test("pennation", function()
    local m = with_muscle()
    local p = m:pennation()
    check(p.kind == "fusiform" and p.angle == nil and p.sheets == nil)
    for _, kind in ipairs{"fusiform", "parallel", "convergent"} do
        m:set_pennation{kind = kind}
        check(m:pennation().kind == kind and m:pennation().angle == nil)
    end
    m:set_pennation{kind = "unipennate", angle = 15}
    p = m:pennation()
    check(p.kind == "unipennate" and p.angle == 15 and p.sheets == nil)
    m:set_pennation{kind = "bipennate", angle = {10, 20, 0}}
    p = m:pennation()
    check(p.kind == "bipennate" and #p.angle == 3 and p.angle[2] == 20 and p.angle[3] == 0)
    m:set_pennation{kind = "multipennate", angle = 80}
    check(m:pennation().sheets == 2, "two sheets unless said")
    m:set_pennation{kind = "multipennate", angle = 8, sheets = 5}
    check(m:pennation().sheets == 5)
    m:set_pennation(nil)
    check(m:pennation().kind == "fusiform")
end)

test("pennation: wrong options", function()
    local m = with_muscle()
    m:set_pennation{kind = "bipennate", angle = 12}
    local set, many = m.set_pennation, {}
    for i = 1, 17 do many[i] = i end
    checkerr("option 'kind': unknown kind 'bipenate' (did you mean 'bipennate'? known: fusiform, parallel, convergent, " ..
             "unipennate, bipennate, multipennate)", set, m, {kind = "bipenate", angle = 9})
    checkerr("option 'kind': unknown kind 'x' (known: fusiform, ", set, m, {kind = "x"})
    checkerr("option 'kind' is missing", set, m, {angle = 10})
    checkerr("option 'kind' is missing", set, m, {})
    checkerr("option 'kind': string expected, got number", set, m, {kind = 3})
    checkerr("muscle 'biceps': fibers that are fusiform have no pennation angle", set, m,
             {kind = "fusiform", angle = 10})
    checkerr("muscle 'biceps': fibers that are parallel have no pennation angle", set, m,
             {kind = "parallel", angle = {1, 2}})
    checkerr("muscle 'biceps': 0 pennation angles, need 1..16", set, m, {kind = "unipennate"})
    checkerr("option 'angle': 17 values, need 1..16", set, m, {kind = "unipennate", angle = many})
    checkerr("option 'angle': 0 values, need 1..16", set, m, {kind = "unipennate", angle = {}})
    checkerr("muscle 'biceps': pennation angle 1 is 81 degrees, need 0..80", set, m,
             {kind = "unipennate", angle = 81})
    checkerr("muscle 'biceps': pennation angle 2 is -1 degrees, need 0..80", set, m,
             {kind = "bipennate", angle = {1, -1}})
    checkerr("option 'angle': finite number expected", set, m, {kind = "unipennate", angle = nan})
    checkerr("option 'angle'[2]: finite number expected, got inf", set, m, {kind = "unipennate", angle = {1, inf}})
    checkerr("option 'angle': number expected, got string", set, m, {kind = "unipennate", angle = "10"})
    checkerr("option 'sheets': only a multipennate muscle has several", set, m,
             {kind = "bipennate", angle = 10, sheets = 2})
    checkerr("muscle 'biceps': 1 aponeuroses, need 2..16", set, m, {kind = "multipennate", angle = 9, sheets = 1})
    checkerr("muscle 'biceps': 17 aponeuroses, need 2..16", set, m, {kind = "multipennate", angle = 9, sheets = 17})
    checkerr("option 'sheets'", set, m, {kind = "multipennate", angle = 9, sheets = 2.5})
    checkerr("unknown option 'angles' (did you mean 'angle'? known: kind, angle, sheets)", set, m,
             {kind = "unipennate", angles = 10})
    checkerr("value expected", set, m)
    checkerr("table of options expected, got string", set, m, "bipennate")
    check(m:pennation().kind == "bipennate" and m:pennation().angle == 12, "as before")
end)

-- ---- tendon ----

test("tendon", function()
    local m = with_muscle()
    check(m:tendon() == nil)
    m:set_tendon{length = 0.5}
    check(m:tendon().length == 0.5 and m:tendon().area == 0)
    m:set_tendon{area = 0.25}
    check(m:tendon().length == 0 and m:tendon().area == 0.25)
    m:set_tendon{length = 1, area = 2}
    check(m:tendon().length == 1 and m:tendon().area == 2)
    local set = m.set_tendon
    checkerr("option 'length' or 'area' expected", set, m, {})
    checkerr("unknown option 'lenght' (did you mean 'length'? known: length, area)", set, m, {lenght = 1})
    checkerr("muscle 'biceps': tendon length is -1, need >= 0", set, m, {length = -1})
    checkerr("muscle 'biceps': tendon area is -2, need >= 0", set, m, {length = 1, area = -2})
    checkerr("option 'length': finite number expected, got inf", set, m, {length = inf})
    checkerr("option 'area': finite number expected", set, m, {area = nan})
    checkerr("option 'length': number expected, got string", set, m, {length = "1"})
    checkerr("value expected", set, m)
    checkerr("table of options expected, got number", set, m, 1)
    check(m:tendon().length == 1, "as before")
    m:set_tendon(nil)
    check(m:tendon() == nil)
end)

-- ---- all of it ----

test("wishes of removed muscles", function()
    local m, s = with_muscle()
    s:remove_muscle(m)
    for name, arg in pairs{head_count = 1, head = 1, set_frame = {}, frame = 1, volume = 1, set_volume = 1,
                           set_preserve_volume = true, preserved_volume = 1, set_pennation = {kind = "parallel"},
                           pennation = 1, set_tendon = {length = 1}, tendon = 1} do
        checkerr("muscle 'biceps' was removed", m[name], m, arg)
    end
end)

test("revision: pennation and tendon count, too", function()
    local m, s = with_muscle()
    local r = s:revision()
    m:set_tendon{length = 1}
    check(s:revision() > r)
    r = s:revision()
    m:set_pennation{kind = "parallel"}
    check(s:revision() > r)
    r = s:revision()
    m:set_frame{angle = 5}
    check(s:revision() > r)
    r = s:revision()
    pcall(m.set_frame, m, {eigenvalues = {0, 1, 1}})
    pcall(m.set_tendon, m, {length = -1})
    check(s:revision() == r)
end)

test("heads have help", function()
    for name in pairs(getmetatable(with_heads():head(1)).__index) do check(sinew.help_text["head:" .. name], name) end
end)

finish()
