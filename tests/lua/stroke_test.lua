-- stroke_test - muscles drawn as strokes in a picture.
dofile("tests/lua/harness.lua")
local shape = sinew.shape

-- A camera at {0, 0, 20} that looks along -z: the middle of a picture of 400 x 400 is between pixels 199 and 200.
local camera = {eye = {0, 0, 20}, target = {0, 0, 0}, fov = 40}
local size = {400, 400}
local slope = 2 * math.tan(math.rad(20)) / 400

local function pixel(x, y, z) return {199.5 + x / (20 - z) / slope, 199.5 - y / (20 - z) / slope} end

local skin = shape.box({0, 0, 0}, {5, 2, 2}):mesh{cell = 0.5}
local left = shape.sphere({-3, 0, 0}, 0.5):mesh{cell = 0.1}
local right = shape.sphere({3, 0, -0.5}, 0.5):mesh{cell = 0.1}
local ball = shape.sphere({0, 0, 0.2}, 0.8):mesh{cell = 0.2}

local function new_scene(obstacle)
    local s = sinew.scene{unit = "cm"}
    s:set_skin(skin)
    s:add_bone("left", left)
    s:add_bone("right", right)
    if obstacle then s:add_bone("obstacle", obstacle) end
    return s
end

local from, to = pixel(-2.55, 0, 0.2), pixel(2.55, 0, -0.3)

local function options(changes)
    local o = {camera = camera, size = size, stroke = {from, to}}
    for key, value in pairs(changes or {}) do o[key] = value end
    return o
end

local function distance(a, b) return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2) end

test("draw_muscle: straight where nothing is in the way", function()
    local s = new_scene()
    local m, r = s:draw_muscle("flexor", options())
    check(m == s:muscle("flexor") and m:name() == "flexor" and m:point_count() == 4)
    local a, b = m:point(1), m:point(4)
    checknear(distance(a, {-3, 0, 0}), 0.5, 0.02)
    checknear(distance(b, {3, 0, -0.5}), 0.5, 0.02)
    checknear(m:length(), distance(a, b), 1e-6)
    checknear(r.path_length, distance(a, b), 1e-6)
    check(r.rms <= r.max and r.max < 1e-5 and r.inside_bone == 0 and r.outside_skin == 0 and r.snapped == 0)
    check(r.origin == "left" and r.insertion == "right")
    for i = 1, 4 do check(m:tissue(i) == 1) end
end)

test("draw_muscle: clear and linear depth", function()
    local s = new_scene(ball)
    local m, r = s:draw_muscle("clear", options())
    check(r.inside_bone == 0 and r.outside_skin == 0)
    local n = 0
    for _, p in ipairs(m:curve(101)) do
        if ball:closest(p).distance < 0.05 or ball:contains(p) then n = n + 1 end
        check(math.abs(p.y) < 1e-3 and skin:contains(p))
    end
    check(n == 0, "clear of the ball by half the margin of 1 %")
    check(m:curve(3)[2].z > 1, "before the ball")
    local straight, q = s:draw_muscle("linear", options{depth = "linear"})
    check(q.inside_bone > 0.2 and math.abs(straight:curve(3)[2].z) < 0.3)
    local wide = s:draw_muscle("wide", options{margin = 0.4, points = 6})
    check(ball:closest(wide:curve(3)[2]).distance > 0.2)
end)

test("draw_muscle: points, tissue, default camera and size", function()
    local s = new_scene()
    check(s:draw_muscle("two", options{points = 2}):point_count() == 2)
    check(s:draw_muscle("eight", options{points = 8, tissue = 0.5}):tissue(8) == 0.5)
    local m = s:draw_muscle("three", options{points = 3, tissue = {1, 2, 3}})
    check(m:tissue(1) == 1 and m:tissue(2) == 2 and m:tissue(3) == 3)
    local ok, message = pcall(s.draw_muscle, s, "front", {stroke = {{0, 0}, {1, 1}}}) -- of 800 x 600 pixels
    check(not ok and message:find("'left' at pixel 1%d%d%.%d, 2%d%d%.%d"), message)
end)

test("draw_muscle: the muscle can be solved and drawn again", function()
    local s = new_scene(ball)
    s:tetrahedralize{edge_length = 1}
    s:draw_muscle("m", options())
    check(s:solve().collocation_points > 0)
    check(s:tissue_at(s:muscle("m"):curve(3)[2]) == "m")
    s:remove_muscle("m")
    check(s:draw_muscle("m", options()):name() == "m")
end)

test("draw_muscle: ends off the bones", function()
    local s = new_scene()
    local off = {from[1] - 45, from[2]}
    checkerr("muscle 'm': the first point of the stroke (point 1, pixel ", s.draw_muscle, s, "m", options{stroke = {off, to}})
    checkerr("is not over a bone; the nearest is 'left' at pixel", s.draw_muscle, s, "m", options{stroke = {off, to}})
    checkerr("off the line of sight): begin there, or set snap = ", s.draw_muscle, s, "m", options{stroke = {off, to}})
    checkerr("the last point of the stroke (point 3, pixel 0, 0) is not over a bone", s.draw_muscle, s, "m",
             options{stroke = {from, to, {0, 0}}})
    checkerr("and no bone is before the camera", s.draw_muscle, s, "m",
             options{camera = {eye = {0, 0, -20}, target = {0, 0, -40}}})
    check(#s:muscles() == 0)
    local _, r = s:draw_muscle("m", options{stroke = {off, to}, snap = 40})
    check(r.snapped > 0 and r.snapped <= 40 and r.origin == "left")
end)

test("draw_muscle: wrong strokes", function()
    local s = new_scene()
    local function bad(pattern, o) checkerr(pattern, s.draw_muscle, s, "m", options(o)) end
    bad("a stroke has 0 points, need 2 or more", {stroke = {}})
    bad("a stroke has 1 point, need 2 or more", {stroke = {from}})
    bad("the stroke has no length: all its 2 points are equal", {stroke = {from, from}})
    bad("the stroke begins and ends at the same spot of bone 'left'", {stroke = {from, to, from}})
    bad("stroke[2]: {x, y} in pixels expected, got number", {stroke = {from, 7}})
    bad("stroke[1]: {x, y} in pixels expected, got a list of 3", {stroke = {{1, 2, 3}, to}})
    bad("stroke[1]: coordinate y: number expected, got string", {stroke = {{1, "2"}, to}})
    bad("stroke[2]: coordinate x: finite number expected", {stroke = {from, {0 / 0, 1}}})
    bad("option 'stroke': list expected, got number", {stroke = 1})
    checkerr("option 'stroke' is missing", s.draw_muscle, s, "m", {camera = camera})
    check(#s:muscles() == 0)
end)

test("draw_muscle: wrong options", function()
    local s = new_scene()
    local function bad(pattern, o) checkerr(pattern, s.draw_muscle, s, "m", options(o)) end
    bad("option 'depth': unknown 'deep' (known: clear, linear)", {depth = "deep"})
    bad("option 'points': 2..32 control points expected, got 1", {points = 1})
    bad("option 'points': 2..32 control points expected, got 0", {points = 0})
    bad("option 'points': 2..32 control points expected, got 33", {points = 33})
    bad("option 'snap': number of pixels, 0 or more, expected, got -1.0", {snap = -1})
    bad("option 'margin': number above 0 expected, got 0.0", {margin = 0})
    bad("option 'tissue': 3 values for 4 points", {tissue = {1, 2, 3}})
    bad("option 'tissue': number or list of numbers expected, got string", {tissue = "1"})
    bad("tissue[2]: number expected, got boolean", {points = 2, tissue = {1, true}})
    bad("option 'tissue': finite number expected", {tissue = 0 / 0})
    bad("unknown option 'strokes' (did you mean 'stroke'? known: camera, size", {strokes = {}})
    bad("camera: unknown view 'frnt'", {camera = "frnt"})
    bad("option 'size': {width, height} expected", {size = {1}})
    checkerr("table expected", s.draw_muscle, s, "m")
    checkerr("string expected", s.draw_muscle, s, nil, options())
    checkerr("'fat' is no name for a muscle", s.draw_muscle, s, "fat", options())
    s:draw_muscle("m", options())
    bad("there is a muscle 'm' already")
end)

test("draw_muscle: without bones", function()
    checkerr("draw_muscle: the scene has no bones", sinew.scene().draw_muscle, sinew.scene(), "m", options())
end)

test("draw_muscle: a curve through bone is a warning", function()
    local first, path = 0, os.tmpname()
    while arg[first - 1] do first = first - 1 end
    local file = assert(io.open(path, "w"))
    file:write([[
        local shape, s = sinew.shape, sinew.scene()
        s:add_bone("a", shape.sphere({-3, 0, 0}, 0.5):mesh{cell = 0.2})
        s:add_bone("b", shape.sphere({3, 0, 0}, 0.5):mesh{cell = 0.2})
        s:add_bone("wall", shape.box({0, 0, 0}, {1, 1, 1}):mesh{cell = 0.4})
        s:draw_muscle("m", {camera = {eye = {0, 0, 20}, target = {0, 0, 0}, fov = 40}, size = {400, 400},
                            stroke = {{120, 199}, {279, 199}}, depth = "linear"})]])
    file:close()
    local run = io.popen(arg[first] .. " " .. path .. " 2>&1")
    local out = run:read("a")
    os.remove(path)
    check(run:close(), out)
    check(out:find("warning: muscle 'm': %d+ %% of the drawn curve is inside bone: depth = \"clear\" keeps out of it"), out)
end)

finish()
