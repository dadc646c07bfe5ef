-- bones_test - the bone library: every asset is a sound template, and the scripts make the same bytes again
dofile("tests/lua/harness.lua")

local folder = "assets/bones/"
local bones = {
    cylinder = {"humerus", "radius", "ulna", "femur", "tibia", "fibula", "metacarpal", "phalanx", "rib", "clavicle"},
    curve = {"cervical", "thoracic", "lumbar", "caudal", "rib_pair"},
    shape = {"skull", "scapula", "pelvis", "patella", "hand", "foot", "sternum"},
}
local symmetric = {cervical = true, thoracic = true, lumbar = true, caudal = true, rib_pair = true, skull = true,
                   pelvis = true, sternum = true, metacarpal = true, phalanx = true}

-- The objects of an .obj file by name, each {surface=, points= list of {x, y, z}}, and their names in order.
local function objects(name)
    local all, order, count, current = {}, {}, 0, nil
    for line in io.lines(folder .. name .. ".obj") do
        local key, a, b, c = line:match("^(%a) (%S+) ?(%S*) ?(%S*)$")
        check(key, "a line that is not o, v or f: " .. line)
        if key == "o" then
            current = {vertices = {}, faces = {}, first = count}
            all[a], order[#order + 1] = current, a
        elseif key == "v" then
            count = count + 1
            for _, x in ipairs{a, b, c} do check(x:match("^-?%d+%.%d%d%d%d%d%d$"), "a coordinate " .. x) end
            table.insert(current.vertices, {tonumber(a), tonumber(b), tonumber(c)})
        else
            table.insert(current.faces, {a - current.first, b - current.first, c - current.first})
        end
    end
    for _, o in pairs(all) do o.surface = sinew.surface.new(o.vertices, o.faces) end
    return all, order
end

-- {kind=, from=, to=, length=, landmark= {NAME = {x, y, z, r}}, joint= {...}}; the lines come in the fixed order.
local function description(name)
    local rank = {kind = 1, from = 2, to = 3, length = 4, landmark = 5, joint = 6}
    local d, last = {landmark = {}, joint = {}}, 0
    for line in io.lines(folder .. name .. ".txt") do
        if line:sub(1, 1) ~= "#" then
            local word = {}
            for w in line:gmatch("%S+") do word[#word + 1] = tonumber(w) or w end
            local key = word[1]
            check(rank[key] and rank[key] >= last, name .. ": the line '" .. line .. "'")
            last = rank[key]
            if key == "landmark" or key == "joint" then
                check(#word == (key == "landmark" and 6 or 5), "numbers in '" .. line .. "'")
                check(not d.landmark[word[2]] and not d.joint[word[2]], "twice: " .. word[2])
                d[key][word[2]] = {word[3], word[4], word[5], word[6]}
            else
                d[key] = #word == 2 and word[2] or {word[2], word[3], word[4]}
            end
        end
    end
    return d
end

local function check_symmetric(points)
    local there = {}
    local function key(x, y, z) return string.format("%.6f %.6f %.6f", x + 0.0, y, z) end
    for _, p in ipairs(points) do there[key(p[1], p[2], p[3])] = true end
    for _, p in ipairs(points) do check(there[key(p[1] == 0 and 0 or -p[1], p[2], p[3])], "the mirror image") end
end

local function check_bone(name, o)
    local c = o.surface:check()
    check(c.closed and c.manifold and c.oriented and c.components == 1, "closed, manifold, oriented, one piece")
    check(c.self_intersections == 0 and c.degenerate_faces == 0 and c.unused_vertices == 0, "clean faces")
    check(o.surface:face_count() <= 6000 and o.surface:volume() > 0, "size")
    if symmetric[name] then check_symmetric(o.vertices) end
end

-- Landmarks lie on the surface; pairs mirror each other; radii are no larger than the bone.
local function check_landmarks(name, o, d)
    local n = 0
    local box = o.surface:bounds()
    for landmark, p in pairs(d.landmark) do
        n = n + 1
        check(o.surface:closest{p[1], p[2], p[3]}.distance < 1e-6, landmark .. " on the surface")
        check(p[4] > 0 and p[4] < (box.max - box.min):length(), "radius of " .. landmark)
        local twin = landmark:match("^(.*)_l$")
        if twin then
            twin = check(d.landmark[twin .. "_r"], landmark .. " on the other side")
            for k = 1, 3 do checknear(twin[k], k == 1 and -p[1] or p[k], 1e-6, landmark .. " mirrored") end
        end
    end
    check(n >= 7, name .. " has few landmarks")
end

local function check_cage(o, cage, skin)
    local c = cage.surface:check()
    check(c.closed and c.manifold and c.oriented and c.components == 1 and c.self_intersections == 0, "a sound cage")
    check(cage.surface:vertex_count() >= 60 and cage.surface:vertex_count() <= 200, "vertices of the cage")
    local s = skin.surface:check()
    check(not s.closed and s.manifold and s.oriented and s.components == 1 and s.self_intersections == 0
          and s.degenerate_faces == 0, "a sound piece of skin")
    check(skin.surface:face_count() >= 300 and skin.surface:face_count() <= 1500, "faces of the skin")
    for _, part in ipairs{o, skin} do
        for _, p in ipairs(part.vertices) do check(cage.surface:contains(p), "inside the cage") end
    end
end

for kind, names in pairs(bones) do
    for _, name in ipairs(names) do
        test(name, function()
            local all, order = objects(name)
            local d = description(name)
            check(d.kind == kind and order[1] == name and #order == (kind == "shape" and 3 or 1))
            check_bone(name, all[name])
            check_landmarks(name, all[name], d)
            if kind == "cylinder" then
                check(d.from[1] == d.to[1] and d.from[3] == d.to[3] and d.to[2] < d.from[2] and not d.length)
            elseif kind == "curve" then
                check(d.length > 0 and not d.from)
            else
                check(order[2] == "cage" and order[3] == "skin" and not d.length and not d.from)
                check_cage(all[name], all.cage, all.skin)
                if symmetric[name] then
                    check_symmetric(all.cage.vertices)
                    check_symmetric(all.skin.vertices)
                end
            end
        end)
    end
end

test("surface.load takes all objects of a file together", function()
    local s = sinew.surface.load(folder .. "patella.obj")
    local all = objects("patella")
    check(s:face_count() == all.patella.surface:face_count() + all.cage.surface:face_count()
                            + all.skin.surface:face_count())
end)

-- ---- where muscles begin and end: bone landmark, ... ----

local muscles = {
    -- shoulder and arm
    trapezius = "skull occiput, thoracic spinous, scapula scapular_spine, "
        .. "scapula acromion_medial, clavicle lateral_posterior",
    deltoid = "clavicle lateral_anterior, scapula acromion, scapula scapular_spine, humerus deltoid_tuberosity",
    latissimus_dorsi = "lumbar spinous, pelvis iliac_crest_posterior_l, thoracic spinous, "
        .. "humerus lesser_tubercle_crest",
    pectoralis_major = "clavicle medial_anterior, sternum body_anterior_l, humerus greater_tubercle_crest",
    pectoralis_minor = "rib anterior, scapula coracoid_medial",
    serratus_anterior = "rib lateral, scapula medial_border_ventral",
    rhomboideus = "thoracic spinous, scapula medial_border",
    levator_scapulae = "cervical transverse_l, scapula superior_angle",
    supraspinatus = "scapula supraspinous_fossa, humerus greater_tubercle_superior",
    infraspinatus = "scapula infraspinous_fossa, humerus greater_tubercle_middle",
    teres_minor = "scapula lateral_border_upper, humerus greater_tubercle_inferior",
    teres_major = "scapula inferior_angle_dorsal, humerus lesser_tubercle_crest",
    subscapularis = "scapula subscapular_fossa, humerus lesser_tubercle",
    biceps_brachii = "scapula supraglenoid_tubercle, scapula coracoid, radius radial_tuberosity",
    coracobrachialis = "scapula coracoid, humerus coracobrachialis_insertion",
    brachialis = "humerus shaft_anterior_lower, ulna ulnar_tuberosity",
    triceps_brachii = "scapula infraglenoid_tubercle, humerus shaft_posterior_upper, humerus shaft_posterior, "
        .. "ulna olecranon",
    anconeus = "humerus lateral_epicondyle_posterior, ulna olecranon_lateral",
    brachioradialis = "humerus lateral_supracondylar_ridge, radius styloid_base",
    pronator_teres = "humerus medial_epicondyle_anterior, radius pronator_tuberosity",
    supinator = "humerus lateral_epicondyle, ulna supinator_crest, radius shaft_lateral_upper",
    flexor_carpi_radialis = "humerus medial_epicondyle, hand metacarpal_2_base_palmar",
    flexor_carpi_ulnaris = "humerus medial_epicondyle, hand pisiform",
    flexor_digitorum_profundus = "ulna shaft_anterior_upper, hand finger_3_distal_palmar",
    flexor_digitorum_superficialis = "humerus medial_epicondyle, hand finger_3_middle_palmar",
    extensor_carpi_radialis_longus = "humerus lateral_supracondylar_ridge, hand metacarpal_2_base_dorsal",
    extensor_digitorum = "humerus lateral_epicondyle, hand finger_3_middle_dorsal",
    extensor_carpi_ulnaris = "humerus lateral_epicondyle, hand metacarpal_5_base",
    abductor_pollicis_longus = "ulna shaft_posterior, radius shaft_posterior, hand metacarpal_1_base",
    -- head, neck and trunk
    temporalis = "skull temporal_fossa_l, skull coronoid_process_l",
    masseter = "skull zygomatic_arch_l, skull jaw_angle_l",
    digastric = "skull mastoid_l, skull chin_inner",
    sternocleidomastoid = "skull mastoid_l, sternum manubrium, clavicle medial_superior",
    splenius_capitis = "thoracic spinous, skull mastoid_l",
    semispinalis_capitis = "thoracic transverse_l, skull nuchal_line_l",
    longus_colli = "cervical body_anterior, thoracic body_anterior",
    scaleni = "cervical transverse_anterior_l, rib upper_border",
    erector_spinae = "pelvis sacrum_dorsal_l, lumbar spinous, rib angle",
    multifidus = "lumbar mamillary_l, lumbar spinous",
    quadratus_lumborum = "pelvis iliac_crest_posterior_l, lumbar transverse_l, rib lower_border",
    rectus_abdominis = "pelvis pubic_tubercle_l, sternum xiphoid_anterior, rib_pair cartilage_l",
    external_oblique = "rib_pair lateral_l, pelvis iliac_crest_anterior_l",
    internal_oblique = "pelvis iliac_crest_l, rib_pair lower_border_l",
    intercostales = "rib lower_border, rib upper_border",
    diaphragm = "sternum xiphoid, rib_pair inner_l, lumbar body_anterior",
    -- hip and leg
    psoas_major = "lumbar body_lateral_l, lumbar transverse_l, femur lesser_trochanter",
    iliacus = "pelvis iliac_fossa_l, femur lesser_trochanter",
    gluteus_maximus = "pelvis psis_l, pelvis sacrum_dorsal_l, femur gluteal_tuberosity",
    gluteus_medius = "pelvis ilium_lateral_l, femur greater_trochanter",
    gluteus_minimus = "pelvis ilium_lateral_lower_l, femur greater_trochanter_anterior",
    piriformis = "pelvis sacrum_anterior_l, femur greater_trochanter_tip",
    obturator_internus = "pelvis obturator_membrane_inner_l, femur trochanteric_fossa",
    quadratus_femoris = "pelvis ischial_tuberosity_lateral_l, femur quadrate_tubercle",
    tensor_fasciae_latae = "pelvis asis_l, tibia gerdy",
    sartorius = "pelvis asis_l, tibia pes_anserinus",
    rectus_femoris = "pelvis aiis_l, patella base",
    vastus_lateralis = "femur linea_aspera_upper, femur shaft_lateral, patella lateral_border",
    vastus_medialis = "femur linea_aspera_middle, patella medial_border",
    vastus_intermedius = "femur shaft_anterior, patella base_posterior",
    patellar_ligament = "patella apex, tibia tibial_tuberosity",
    pectineus = "pelvis pubic_ramus_superior_l, femur pectineal_line",
    adductor_longus = "pelvis pubic_body_l, femur linea_aspera_middle",
    adductor_brevis = "pelvis pubic_ramus_inferior_l, femur linea_aspera_upper",
    adductor_magnus = "pelvis ischial_ramus_l, femur linea_aspera_lower, femur adductor_tubercle",
    gracilis = "pelvis pubic_ramus_inferior_l, tibia pes_anserinus",
    biceps_femoris = "pelvis ischial_tuberosity_l, femur linea_aspera_lower, fibula head",
    semitendinosus = "pelvis ischial_tuberosity_l, tibia pes_anserinus",
    semimembranosus = "pelvis ischial_tuberosity_l, tibia medial_condyle_posterior",
    gastrocnemius = "femur medial_condyle_posterior, femur lateral_condyle_posterior, foot calcaneal_tuberosity",
    soleus = "tibia soleal_line, fibula head_posterior, foot calcaneal_tuberosity",
    popliteus = "femur popliteal_groove, tibia popliteal_surface",
    tibialis_anterior = "tibia shaft_lateral_upper, foot medial_cuneiform",
    tibialis_posterior = "tibia interosseous_border, foot navicular_tuberosity",
    extensor_digitorum_longus = "fibula shaft_anterior_upper, foot toe_3_middle_dorsal",
    extensor_hallucis_longus = "fibula shaft_anterior, foot toe_1_distal_dorsal",
    flexor_hallucis_longus = "fibula shaft_posterior_lower, foot toe_1_distal_plantar",
    flexor_digitorum_longus = "tibia shaft_posterior_medial, foot toe_3_distal_plantar",
    fibularis_longus = "fibula shaft_lateral_upper, foot medial_cuneiform_plantar",
    fibularis_brevis = "fibula shaft_lateral_lower, foot metatarsal_5_base",
    -- of quadrupeds only
    brachiocephalicus = "skull mastoid_base_l, humerus shaft_anterior",
    omotransversarius = "cervical transverse_l, scapula scapular_spine_lateral",
    sacrocaudalis = "pelvis sacrum, caudal mamillary_l",
    coccygeus = "pelvis ischial_spine_l, caudal transverse_l",
}

test("muscles find where they begin and end", function()
    local known, n = {}, 0
    for name, places in pairs(muscles) do
        n = n + 1
        for bone, landmark in places:gmatch("([%w_]+) ([%w_]+)") do
            known[bone] = known[bone] or description(bone).landmark
            check(known[bone][landmark], name .. ": " .. bone .. " " .. landmark)
        end
    end
    check(n >= 69)
end)

-- ---- the scripts ----

local function read(path)
    local f = assert(io.open(path, "rb"))
    local text = f:read("a")
    f:close()
    return text
end

-- Runs a script of the library with its files in another folder, quietly.
local function make(script, bone, into)
    local kept_arg, kept_print, kept_out, kept_only = arg, print, out, only
    arg, print, out, only = {[0] = "scripts/bones/" .. script .. ".lua"}, function() end, into, bone
    local ok, message = pcall(dofile, arg[0])
    arg, print, out, only = kept_arg, kept_print, kept_out, kept_only
    check(ok, message)
end

test("the scripts make the same bytes again", function()
    local into = os.tmpname()
    os.remove(into)
    assert(sinew.folder(into))
    for script, bone in pairs{hand_foot = "phalanx", vertebrae = "caudal"} do
        make(script, bone, into)
        for _, ending in ipairs{".obj", ".txt"} do
            check(read(into .. "/" .. bone .. ending) == read(folder .. bone .. ending), bone .. ending)
            os.remove(into .. "/" .. bone .. ending)
        end
    end
    os.remove(into)
end)

finish()
