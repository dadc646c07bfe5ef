-- repair_test - surface:repair{}: options, the report, what stays as it was
dofile("tests/lua/harness.lua")

local corners = {
    {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2},
}
local sides = {
    {1, 3, 2}, {1, 4, 3}, {5, 6, 7}, {5, 7, 8}, {1, 2, 6}, {1, 6, 5},
    {2, 3, 7}, {2, 7, 6}, {3, 4, 8}, {3, 8, 7}, {4, 1, 5}, {4, 5, 8},
}
local function cube(first) return sinew.surface.new(corners, {table.unpack(sides, first or 1)}) end

local function steps_of(report)
    local by_name = {}
    for _, step in ipairs(report.steps) do by_name[step.name] = step end
    return by_name
end

local function check_usable(c)
    check(c.closed and c.manifold and c.oriented and c.self_intersections == 0 and c.degenerate_faces == 0)
end

test("a hole", function()
    local open = cube(2)
    local s, report = open:repair{fill_holes = 3, wrap = "never"}
    check(open:face_count() == 11 and s:face_count() == 12 and not open:check().closed)
    check_usable(s:check())
    checknear(s:volume(), 8)
    local steps = steps_of(report)
    check(report.steps[1].name == "weld" and steps.weld.joined_vertices == 0 and steps.weld.moved == 0)
    check(steps.fill.filled_holes == 1 and steps.fill.added_faces == 1 and steps.fill.left_holes == 0)
    check(steps.clean.degenerate_faces == 0 and steps.orient.turned_faces == 0 and steps.components.turned == 0)
    check(report.wrapped == false and report.alpha == nil and report.check.closed and report.check.components == 1)
    check(report.moved > 0.4 and report.missed < 1e-12) -- the middle of the filling is away from its rim
    checkerr("what remains: 3 boundary edges; fill_holes closes larger holes, wrap = \"auto\" wraps it", open.repair,
             open, {fill_holes = 0, wrap = "never"})
end)

test("no options", function()
    local s, report = cube():repair()
    check(s:face_count() == 12 and s:vertex_count() == 8 and report.moved < 1e-12)
    check_usable(cube(1):repair{}:check())
end)

test("two that cross", function()
    local ball = sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.2}
    local other = ball:copy():transform{translate = {1, 0.01, 0.02}}
    local vertices, faces = {}, {}
    for _, s in ipairs{ball, other} do
        local n = #vertices
        for i = 1, s:vertex_count() do vertices[n + i] = s:vertex(i) end
        for i = 1, s:face_count() do
            local f = s:face(i)
            faces[#faces + 1] = {n + f[1], n + f[2], n + f[3]}
        end
    end
    local both = sinew.surface.new(vertices, faces)
    local s, report = both:repair{wrap = "never"}
    check(steps_of(report).untangle.unions == 1 and report.check.components == 1)
    checknear(s:volume() / ball:volume(), 27 / 16, 0.01)
    local w, wrapped = both:repair{wrap = "always", tolerance = 0.1}
    check_usable(wrapped.check)
    check(wrapped.wrapped and wrapped.tolerance == 0.1 and wrapped.alpha < 0.1 and wrapped.offset < 0.1)
    check(wrapped.moved <= 0.1 and wrapped.missed <= 0.1 and steps_of(wrapped).wrap.faces_after == w:face_count())
    checknear(w:volume() / s:volume(), 1, 0.1)
    checkerr("self_intersections = true resolves them", both.repair, both,
             {self_intersections = false, wrap = "never"})
end)

test("options", function()
    local s = cube()
    checkerr("unknown option 'wield' (did you mean 'weld'? known: weld, fill_holes, self_intersections, components, " ..
             "wrap, tolerance, alpha, offset, time_limit)", s.repair, s, {wield = 1})
    checkerr("bad argument #1 to 'repair'.*table of options expected, got number", function() s:repair(1) end)
    checkerr("option 'weld': number of at least 0 expected, got -1", s.repair, s, {weld = -1})
    checkerr("option 'weld': number expected, got string", s.repair, s, {weld = "1"})
    checkerr("option 'fill_holes': finite number expected", s.repair, s, {fill_holes = 0 / 0})
    checkerr("option 'self_intersections': boolean expected, got number", s.repair, s, {self_intersections = 1})
    checkerr("option 'wrap': unknown value 'alway' (did you mean 'always'? known: auto, always, never)", s.repair, s,
             {wrap = "alway"})
    checkerr("option 'components': unknown value 'one' (known: all, largest)", s.repair, s, {components = "one"})
    for _, key in ipairs{"tolerance", "alpha", "offset", "time_limit"} do
        checkerr("option '" .. key .. "': number above 0 expected, got 0", s.repair, s, {[key] = 0})
    end
    local closed = cube()
    closed:close()
    checkerr("surface was closed", closed.repair, closed)
end)

finish()
