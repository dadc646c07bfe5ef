-- skeleton_test - bones of the library in scenes: placing, editing, joints, half models, templates of one's own, fits
dofile("tests/lua/harness.lua")

local shape = sinew.shape
local cube = shape.box({0, 0, 0}, {1, 1, 1}):mesh{cell = 0.5}
local rod = shape.capsule({0.5, 0, 0}, {0.5, 1, 0}, 0.1):mesh{cell = 0.08}

local function scene_with_skin()
    local s = sinew.scene{unit = "m"}
    s:set_skin(cube)
    return s
end

local function checkat(p, x, y, z, tolerance)
    check(p:distance{x, y, z} <= (tolerance or 1e-9), string.format("%s is at %g %g %g", tostring(p), x, y, z))
end

-- ---- place_bone ----

test("cylinder bones", function()
    local s = scene_with_skin()
    local b, r = s:place_bone{name = "femur_l", template = "femur", from = {0.1, 0.9, 0}, to = {0.1, 0.4, 0}}
    check(b:name() == "femur_l" and tostring(b) == "bone 'femur_l'" and s:bone("femur_l") == b)
    checkat(r.from, 0.1, 0.9, 0)
    checknear(r.length, 0.5)
    check(not r.clearance)
    local from, to = b:ends()
    checkat(from, 0.1, 0.9, 0)
    checkat(to, 0.1, 0.4, 0)
    local c = s:place_bone{name = "femur_r", template = "femur", from = {-0.1, 0.9, 0}, to = {-0.1, 0.4, 0}}
    local p, q = b:landmark("lesser_trochanter"), c:landmark("lesser_trochanter")
    checkat(q, -p.x, p.y, p.z, 1e-12)
    checknear(c:surface():volume(), b:surface():volume(), 1e-15)
    local d, rd = s:place_bone{name = "thin", template = "femur", from = {x = 0, y = 0.5, z = 0},
                               to = sinew.vec3(0, 0, 0), thickness = 0.5, twist = 90, front = {0, 0, 1}, margin = 0.01}
    check(d:surface():volume() < 0.3 * b:surface():volume() and rd.clearance.moved == 0)
    local own = sinew.bones.surface("femur"):bounds() -- 0.8 m long and as thick as the template
    local kept = s:place_bone{name = "own", template = "femur", from = {0, 0.8, 0.3}, to = {0, 0, 0.3},
                              thickness = "kept"}
    local box = kept:surface():bounds()
    checknear(box.max.x - box.min.x, own.max.x - own.min.x)
end)

test("what place_bone refuses", function()
    local s = scene_with_skin()
    local function refused(pattern, o) checkerr(pattern, s.place_bone, s, o) end
    checkerr("table expected", s.place_bone, s)
    refused("option 'name' is missing", {template = "femur"})
    refused("option 'template' is missing", {name = "x"})
    refused("did you mean 'femur'? known: caudal, cervical", {name = "x", template = "femurr"})
    refused("option 'template'", {name = "x", template = {}})
    refused("option 'name'", {name = 7, template = "femur"})
    refused("option 'margin'", {name = "x", template = "femur", margin = -1})
    refused("option 'from' is missing", {name = "x", template = "femur", to = {0, 0, 0}})
    refused("option 'to' is missing", {name = "x", template = "femur", from = {0, 0, 0}})
    refused("unknown option 'form' (did you mean 'from'?", {name = "x", template = "femur", form = {0, 0, 0}})
    refused("unknown option 'along'", {name = "x", template = "femur", along = {}})
    for option, value in pairs{thickness = "thin", front = 1, twist = 0 / 0} do
        refused("option '" .. option .. "'",
                {name = "x", template = "femur", from = {0, 1, 0}, to = {0, 0, 0}, [option] = value})
    end
    refused("option 'direction' is missing",
            {name = "x", template = "femur", from = {origin = {0, 0, 9}}, to = {0, 0, 0}})
    refused("unknown option 'dir'", {name = "x", template = "femur", to = {0, 0, 0},
                                     from = {origin = {0, 0, 9}, direction = {0, 0, 1}, dir = 1}})
    refused("bone 'x': from: ", {name = "x", template = "femur", from = {origin = {0, 0, 9}, direction = {0, 0, 1}},
                                 to = {0, 0, 0}})
    refused("option 'along' is missing", {name = "x", template = "lumbar", count = 5})
    refused("along[2]", {name = "x", template = "lumbar", count = 5, along = {{0, 0, 0}, {0, 1}}})
    refused("need one of them", {name = "x", template = "lumbar", along = {{0, 0, 0}, {0, 1, 0}}})
    for option, value in pairs{range = {1}, size = 3, reversed = 1, plane = 7, count = 1.5, fill = 0} do
        local o = {name = "x", template = "lumbar", along = {{0, 0, 0}, {0, 1, 0}}, count = 5}
        o[option] = value
        refused("option '" .. option .. "'", o)
    end
    refused("unknown option 'from'", {name = "x", template = "lumbar", from = {0, 0, 0}})
    refused("option 'at' is missing", {name = "x", template = "skull"})
    refused("option 'axis' is missing", {name = "x", template = "skull", at = {0, 0, 0}, rotate = {degrees = 3}})
    refused("option 'axis'", {name = "x", template = "skull", at = {0, 0, 0}, rotate = {axis = {0, 0, 0}, degrees = 3}})
    refused("option 'fit'", {name = "x", template = "skull", at = {0, 0, 0}, fit = "yes"})
    refused("unknown option 'scale' (", {name = "x", template = "skull", at = {0, 0, 0}, scale = 2})
    check(#s:bones() == 0)
end)

test("pixels pick the middle of the limb under them", function()
    local s = sinew.scene{unit = "m"}
    s:set_skin(shape.ellipsoid({0, 0, 0}, {0.2, 1, 0.2}):mesh{cell = 0.05})
    local function pixel(y) return {camera = "front", size = {200, 400}, pixel = {100, y}} end
    local b, r = s:place_bone{name = "femur_l", template = "femur", from = pixel(100), to = pixel(300)}
    check(math.abs(r.from.x) < 0.01 and math.abs(r.from.z) < 0.01 and r.from.y > 0.3)
    checknear(r.to.y, -r.from.y, 0.02)
    checkerr("misses the skin by", s.place_bone, s, {name = "x", template = "femur", to = {0, 0, 0},
             from = {camera = "front", size = {200, 400}, pixel = {1, 1}}})
    for message, from in pairs{["{x, y} expected"] = {camera = "front", size = {200, 400}, pixel = {1}},
                               ["unknown option 'pixels'"] = {camera = "front", pixel = {1, 1}, pixels = 1},
                               ["pixel: y"] = {camera = "front", pixel = {1, {}}},
                               ["'topp'"] = {camera = "topp", pixel = {1, 1}}} do
        checkerr(message, s.place_bone, s, {name = "x", template = "femur", from = from, to = {0, 0, 0}})
    end
    check(#s:bones() == 1)
end)

test("rows along points and strokes", function()
    local s = scene_with_skin()
    local b, r = s:place_bone{name = "lumbar", template = "lumbar", along = {{0, 0, 0}, {0, 0.185, 0}}, count = 5}
    check(r.count == 5 and r.fill == 1 and r.moved == 0)
    checknear(r.length, 0.185)
    checknear(b:landmark("spinous_3").y - b:landmark("spinous_2").y, 0.037)
    check(b:ends() == nil)
    local middle = {point = {0, 0, 0}, normal = {1, 0, 0}}
    local stroke = {}
    for i = 0, 40 do stroke[#stroke + 1] = {200 + 0.01 * (i - 20) ^ 2, 300 - 5 * i} end
    local c, q = s:place_bone{name = "thoracic", template = "thoracic", plane = middle, count = 12, size = {1.2, 1},
                              along = {camera = "left", size = {400, 400}, stroke = stroke}}
    check(q.count == 12 and q.moved == 0 and q.length > 0.3)
    for k = 1, 12 do check(math.abs(c:landmark("spinous_" .. k).x) < 1e-9) end
    check(c:landmark("spinous_12").y > c:landmark("spinous_1").y)
    checkerr("option 'plane' is missing: a stroke is seen on the plane of symmetry", s.place_bone, s,
             {name = "x", template = "thoracic", count = 3, along = {camera = "left", stroke = stroke}})
    checkerr("does not meet the plane: look at it from the side", s.place_bone, s,
             {name = "x", template = "thoracic", count = 3, plane = middle,
              along = {camera = "front", stroke = stroke}})
    checkerr("option 'normal' is missing", s.place_bone, s,
             {name = "x", template = "thoracic", count = 3, plane = {}, along = {{0, 0, 0}, {0, 1, 0}}})
    local _, m = s:place_bone{name = "caudal", template = "caudal", spacing = 0.03, plane = middle, reversed = true,
                              along = {{0.1, 0, 0}, {0, 0, -0.3}, {0, 0.1, -0.5}}}
    checknear(m.moved, 0.1)
    check(m.count == math.floor(m.length / 0.03) and m.spacing == 0.03)
end)

-- The spine of the library: at their own length no two vertebrae cross, also of neighbouring rows.
test("a spine of three rows", function()
    local rows = {{"lumbar", 5, 0, 185}, {"thoracic", 12, 185, 485}, {"cervical", 7, 485, 604}}
    local function spine(along, fill)
        local s, vertices, faces = sinew.scene{unit = "m"}, {}, {}
        for _, row in ipairs(rows) do
            local b, r = s:place_bone{name = row[1], template = row[1], along = along, count = row[2], fill = fill,
                                      range = {row[3] / 604, row[4] / 604}}
            checknear(r.fill, fill, 1e-12, "fill of " .. row[1])
            local m, first = b:surface(), #vertices
            for i = 1, m:vertex_count() do vertices[first + i] = m:vertex(i) end
            for i = 1, m:face_count() do
                local f = m:face(i)
                faces[#faces + 1] = {f[1] + first, f[2] + first, f[3] + first}
            end
        end
        local c = sinew.surface.new(vertices, faces):check()
        check(c.components == 24 and c.self_intersections == 0, c.self_intersections .. " crossings")
    end
    spine({{0, 0, 0}, {0, 0.604, 0}}, 1)
    local bent, angle, y, z = {{0, 0, 0}}, 0.37, 0, 0 -- arcs of 0.25 m: lordosis, kyphosis, lordosis
    for _, arc in ipairs{{185, -1}, {300, 1}, {119, -1}} do
        for _ = 1, 4 do
            angle = angle + arc[2] * arc[1] / 2000
            y, z = y + arc[1] / 4000 * math.cos(angle), z + arc[1] / 4000 * math.sin(angle)
            angle = angle + arc[2] * arc[1] / 2000
            bent[#bent + 1] = {0, y, z}
        end
    end
    bent[#bent] = nil -- 12 control points
    spine(bent, 0.9)
    local s = sinew.scene{unit = "m"}
    local _, r = s:place_bone{name = "ribs", template = "rib_pair", along = {{0, 0, 0}, {0, 0.3, 0}}, count = 12}
    check(r.fill == 1)
end)

test("shape bones", function()
    local s = sinew.scene{unit = "mm", up = "z"}
    local b, r = s:place_bone{name = "skull", template = "skull", at = {10, 20, 30}, size = 1.5,
                              rotate = {axis = {0, 0, 1}, degrees = 180}}
    checkat(b:landmark("atlanto_occipital"), 10, 20 - 1.5 * 14, 30 - 1.5 * 26, 1e-9) -- looks along +y, stands along z
    check(next(r) == nil)
    checkerr("'furlong' is not known (known: m, dm, cm, mm, km, in, ft)", function()
        sinew.scene{unit = "furlong"}:place_bone{name = "skull", template = "skull", at = {0, 0, 0}}
    end)
    checkerr("fitting needs a skin", s.place_bone, s, {name = "x", template = "skull", at = {0, 0, 0}, fit = true})
end)

-- ---- templates of one's own ----

test("templates of one's own", function()
    local add, n = sinew.bones.add, #sinew.bones.list()
    add{name = "rod", kind = "cylinder", mesh = rod, from = {0.5, 1, 0}, to = {0.5, 0, 0},
        landmarks = {tip = {0.5, 1.1, 0}, side = {point = {0.6, 0.5, 0}, radius = 0.05}}}
    add{name = "bead", kind = "curve", mesh = shape.sphere({0, 0, 0}, 0.1):mesh{cell = 0.05}, length = 0.25}
    add{name = "lying", kind = "curve", mesh = rod:copy(), from = {0.5, -0.2, 0}, to = {0.5, 1.2, 0}, front = {1, 0, 0},
        landmarks = {front = {0.6, 0.5, 0}}}
    add{name = "block", kind = "shape", mesh = rod}
    local list = sinew.bones.list()
    check(#list == n + 4 and list[n + 1].name == "rod" and list[n + 1].kind == "cylinder" and not list[n + 1].fits)
    check(list[n + 1].faces == rod:face_count() and #list[n + 1].landmarks == 2)
    check(list[n + 2].kind == "curve" and list[n + 4].kind == "shape")
    check(sinew.bones.surface("rod"):face_count() == rod:face_count())
    local s = scene_with_skin()
    local b = s:place_bone{name = "rod_l", template = "rod", from = {0, 0.5, 0}, to = {0, 0, 0}}
    checkat(b:landmark("tip"), 0, 0.55, 0)
    local p, radius = b:landmark("side")
    checkat(p, 0.05, 0.25, 0)
    checknear(radius, 0.025)
    local _, r = s:place_bone{name = "beads", template = "bead", along = {{0, 0, 0}, {0, 1, 0}}, count = 4}
    check(r.count == 4 and r.fill == 1)
    local c = s:place_bone{name = "row", template = "lying", along = {{0, 0, 0}, {0, 2.8, 0}}, count = 2}
    checkat(c:landmark("front_1"), 0, 0.7, 0.1) -- its front to the front
    local block = s:place_bone{name = "block", template = "block", at = {1, 2, 3}}
    checkat(block:surface():bounds().min, 1.4, 1.9, 2.9, 0.01)
    add{name = "rod", kind = "shape", mesh = rod} -- again: another one in its place
    check(#sinew.bones.list() == n + 4 and sinew.bones.list()[n + 1].kind == "shape")
end)

test("what bones.add and bones.surface refuse", function()
    local add, n = sinew.bones.add, #sinew.bones.list()
    local function refused(pattern, o)
        for key, value in pairs{name = "new", kind = "shape", mesh = rod} do
            if o[key] == nil then o[key] = value end
        end
        checkerr(pattern, add, o)
    end
    checkerr("table expected", add)
    checkerr("option 'name' is missing", add, {kind = "shape", mesh = rod})
    checkerr("option 'kind' is missing", add, {name = "new", mesh = rod})
    checkerr("option 'mesh' is missing", add, {name = "new", kind = "shape"})
    refused("unknown option 'bone'", {bone = rod})
    refused("surface expected, got table", {mesh = {}})
    refused("option 'cage': surface expected", {cage = 3})
    refused("did you mean 'cylinder'? known: cylinder, curve, shape", {kind = "cylindre"})
    refused("option 'from' is missing", {kind = "cylinder", to = {0, 0, 0}})
    refused("its ends 'from' and 'to' are one point", {kind = "cylinder", from = {0, 0, 0}, to = {0, 0, 0}})
    refused("its length along the curve is 0", {kind = "curve"})
    refused("option 'length'", {kind = "curve", length = -1})
    refused("option 'to' is missing", {kind = "curve", from = {0, 0, 0}})
    refused("'front' across their line", {kind = "curve", from = {0, 0, 0}, to = {0, 0, 1}})
    refused("'femur' comes with sinew: give yours another name", {name = "femur"})
    refused("holds '/'", {name = "a/b"})
    refused("it has a cage but no skin", {cage = cube})
    refused("the bone is not a closed surface",
            {mesh = sinew.surface.new({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 2, 3}})})
    refused("every landmark needs a name", {landmarks = {{0, 0, 0}}})
    refused("landmark 'tip'", {landmarks = {tip = 3}})
    refused("option 'landmarks'", {landmarks = "tip"})
    refused("unknown option 'size'", {landmarks = {tip = {point = {0, 0, 0}, size = 2}}})
    refused("landmark 'tip' is not a finite point and radius", {landmarks = {tip = {point = {0, 0, 0}, radius = -2}}})
    check(#sinew.bones.list() == n)
    checkerr("template 'femur' has no cage: only shape bones have", sinew.bones.surface, "femur", "cage")
    checkerr("no bone template 'thigh'", sinew.bones.surface, "thigh")
    checkerr("invalid option 'hull'", sinew.bones.surface, "skull", "hull")
    check(not sinew.bones.surface("skull", "skin"):check().closed)
    check(sinew.bones.surface("skull", "cage"):check().closed)
end)

-- ---- edits ----

test("bones are moved, turned and scaled", function()
    local s = scene_with_skin()
    local b = s:place_bone{name = "tibia_l", template = "tibia", from = {0, 0.4, 0}, to = {0, 0, 0}}
    local about = {0.1, 0, 0}
    check(b:move{0.1, 0, 0}:rotate{axis = {0, 0, 1}, degrees = 90, about = about}:scale(2, {about = about}) == b)
    local from, to = b:ends()
    checkat(from, -0.7, 0, 0, 1e-12)
    checkat(to, 0.1, 0, 0, 1e-12)
    b:set_ends({0, 0.4, 0}, {0, 0, 0}, {thickness = 0.5})
    check(b:surface():closest(b:landmark("tibial_tuberosity")).distance < 1e-5)
    b:set_landmark("mine", {1, 2, 3}, 0.5):set_landmark("point", {0, 0, 0})
    local p, r = b:landmark("mine")
    check(p == sinew.vec3(1, 2, 3) and r == 0.5)
    local list = b:landmarks()
    check(list[#list].name == "point" and list[#list].radius == 0)
    checkerr("did you mean 'tibial_tuberosity'?", b.landmark, b, "tibial_tuberosty")
    checkerr("option 'axis' is missing", b.rotate, b, {degrees = 3})
    checkerr("option 'degrees' is missing", b.rotate, b, {axis = {1, 0, 0}})
    checkerr("has no length", b.rotate, b, {axis = {0, 0, 0}, degrees = 3})
    checkerr("a factor > 0 expected", b.scale, b, 0)
    checkerr("unknown option 'center'", b.scale, b, 2, {center = {0, 0, 0}})
    checkerr("need > 0", b.set_ends, b, {0, 0, 0}, {0, 0, 0})
    checkerr("option 'thickness'", b.set_ends, b, {0, 0, 0}, {0, 0, 1}, {thickness = 0})
    checkerr("name of a landmark has 0 bytes", b.set_landmark, b, "", {0, 0, 0})
    checkerr("option 'margin' is missing", b.keep_clear, b, {})
    check(b:clearance{margin = 0.1}.outside == 0 and b:keep_clear{margin = 0.01}.moved == 0)
    s:remove_bone(b)
    checkerr("bone 'tibia_l' was removed", b.name, b)
end)

test("joints and the other side", function()
    local s = scene_with_skin()
    s:place_bone{name = "pelvis", template = "pelvis", at = {0, 0, 0}}
    local b = s:place_bone{name = "femur_l", template = "femur", from = {0.1, 0, 0}, to = {0.1, -0.4, 0}}
    s:add_joint{name = "hip_l", parent = "pelvis", child = b, center = {0.1, 0, 0},
                axes = {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}}
    local r = s:mirror_bones()
    check(r.added == 1 and r.replaced == 0 and #s:bones() == 3)
    local j = s:joints()
    check(#j == 2 and j[2].name == "hip_r" and j[2].parent == "pelvis" and j[2].child == "femur_r")
    check(j[2].center == sinew.vec3(-0.1, 0, 0) and j[1].axes[1] == sinew.vec3(1, 0, 0))
    check(s:mirror_bones{plane = {point = {0, 0, 0}, normal = {1, 0, 0}}}.replaced == 1)
    checkerr("option 'normal' is missing", s.mirror_bones, s, {plane = {}})
    checkerr("unknown option 'point'", s.mirror_bones, s, {point = {0, 0, 0}})
    checkerr("option 'name' is missing", s.add_joint, s, {parent = "pelvis"})
    checkerr("option 'parent' is missing", s.add_joint, s, {name = "x"})
    checkerr("option 'center' is missing", s.add_joint, s, {name = "x", parent = "femur_l", child = "pelvis"})
    checkerr("a list of three vectors expected", s.add_joint, s,
             {name = "x", parent = "femur_l", child = "pelvis", center = {0, 0, 0}, axes = {{1, 0, 0}}})
    checkerr("in turn: a ring", s.add_joint, s, {name = "x", parent = "femur_l", child = "pelvis", center = {0, 0, 0}})
    checkerr("did you mean 'hip_l'?", s.remove_joint, s, "hipl")
    s:remove_joint("hip_r")
    s:remove_bone("femur_l")
    check(#s:joints() == 0)
end)

-- ---- half models ----

test("half models and both sides of their extraction", function()
    local s = sinew.scene{unit = "m"}
    local skin = shape.capsule({0, -1, 0}, {0, 1, 0}, 0.8):mesh{cell = 0.2}
    s:set_skin(skin)
    s:add_bone("spine", shape.capsule({0, -0.6, -0.4}, {0, 0.6, -0.4}, 0.15):mesh{cell = 0.1})
    local other = s:add_bone("rib_r", shape.sphere({-0.4, 0, 0}, 0.1):mesh{cell = 0.05})
    checkerr("table expected", s.cut, s)
    checkerr("option 'normal' is missing", s.cut, s, {})
    checkerr("unknown option 'plane'", s.cut, s, {plane = 1})
    checkerr("nothing would be left", s.cut, s, {point = {2, 0, 0}, normal = {1, 0, 0}})
    s:cut{normal = {1, 0, 0}}
    check(s:skin():bounds().min.x == 0 and other:surface():face_count() == 0)
    s:add_muscle("rectus_l", {points = {{0.4, -0.6, 0.2}, {0.45, 0, 0.25}, {0.4, 0.6, 0.2}}})
    s:tetrahedralize{edge_length = 0.2}
    local half = s:extract()
    local x = half:mirror()
    check(table.concat(x:names(), " ") == "fat rectus_l rectus_r")
    local c = x:check()
    check(c.conforming and c.manifold and c.positive and c.bad_faces == 0 and c.volume_error < 1e-12)
    checknear(x:part("rectus_r"):volume(), half:part("rectus_l"):volume(), 1e-12)
    checknear(x:part("fat"):volume(), 2 * half:part("fat"):volume(), 1e-12)
    checknear(x:part("fat"):volume() + 2 * x:part("rectus_l"):volume(),
              skin:volume() - s:bone("spine"):surface():volume() * 2, 0.02)
    check(x:part("rectus_r"):surface():bounds().max.x <= 0)
    s:cut(nil)
    check(s:skin():volume() == skin:volume() and other:surface():face_count() > 0)
    check(s:values_at{-0.4, 0.3, 0.3}) -- a whole body again
end)

-- ---- fits ----

-- What a script of the library says about a bone, without making it.
local function description(script, name)
    local real, real_arg, found = dofile, arg, nil
    dofile = function(path)
        local kit = real(path)
        if path:match("kit%.lua$") then
            kit.bone = function(b) if b.name == name then found = b end end
        end
        return kit
    end
    arg = {[0] = "scripts/bones/" .. script .. ".lua"}
    local ok, message = pcall(real, arg[0])
    dofile, arg = real, real_arg
    check(ok, message)
    return found
end

local function warped(surface, warp)
    local vertices, faces = {}, {}
    for i = 1, surface:vertex_count() do vertices[i] = warp(surface:vertex(i)) end
    for i = 1, surface:face_count() do faces[i] = surface:face(i) end
    return sinew.surface.new(vertices, faces)
end

-- Stretched by up to 10 % to the sides, tapered, sheared, bent to the front.
local function warp(p)
    local k = 1 + 0.05 * math.sin(15 * p.y)
    return {1.05 * k * p.x + 0.05 * p.y, 0.96 * p.y, 1.04 * k * p.z + 0.3 * p.y * p.y}
end

-- A body whose skin holds the template's piece of skin, deformed along with the bone: the fit finds the bone again.
for name, limit in pairs{skull = {0.02, 0.005}, pelvis = {0.05, 0.02}} do
    test("the " .. name .. " of a deformed body is found", function()
        local b = description(name, name)
        local body = b.skin.shape:mesh{cell = 9}:transform{scale = 1e-3}
        local s, bone = sinew.scene{unit = "m"}, sinew.bones.surface(name)
        s:set_skin(warped(body, warp))
        local fitted, r = s:place_bone{name = name, template = name, at = {0, 0, 0}, fit = true}
        check(r.cage.stop == "settled" and r.inverted_faces == 0 and r.crossings == 0)
        check(r.cage.residual[#r.cage.residual] < 0.1 * r.rigid.residual[#r.rigid.residual])
        local got, box, worst, sum, before = fitted:surface(), bone:bounds(), 0, 0, 0
        local size, n = (box.max - box.min):length(), bone:vertex_count()
        for i = 1, n do
            local want = sinew.vec3(warp(bone:vertex(i)))
            local d = got:vertex(i):distance(want)
            worst, sum = math.max(worst, d), sum + d * d
            before = math.max(before, want:distance(bone:vertex(i)))
        end
        check(before > 0.035 * size)
        check(worst < limit[1] * size, string.format("off by %.4f of its size", worst / size))
        check(math.sqrt(sum / n) < limit[2] * size, string.format("off by %.4f in the mean", math.sqrt(sum / n) / size))
        for _, l in ipairs(fitted:landmarks()) do
            if l.radius > 0 then check(got:closest(l.point).distance < 0.002 * size, l.name .. " on the bone") end
        end
    end)
end

finish()
