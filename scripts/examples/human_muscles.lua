-- human_muscles.lua - the muscles of the left side for human.lua.
--
-- Ends are landmarks of the bones. Points between are given on limbs as (t, angle, r): the part of the way from joint
-- to joint, degrees around the bone from the front over the side that faces away from the trunk, and the part of the
-- way from the bone's axis to the skin; elsewhere by their depth under the skin. So they fit any body.
local vec3 = sinew.vec3

local function lerp(a, b, t) return a + (b - a) * t end

-- skeleton: the scene with the bones of the library; solid: name -> surface that stands for a bone in the mesh.
return function(skeleton, skin, joint, solid)
  local left, up, ahead = vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)

  -- A landmark, outside of what stands for its bone.
  local function on(bone, mark)
    local p = skeleton:bone(bone):landmark(mark)
    local surface = solid(bone)
    local q = surface:closest(p).point
    if surface:contains(p) then return q + (q - p):unit() * 0.01 end
    return q + (p - q):unit() * 0.01
  end

  -- p moved to this depth under the skin.
  local function under(p, depth)
    local q = skin:closest(p).point
    return skin:contains(p) and q + (p - q):unit() * depth or q + (q - p):unit() * depth
  end

  -- From a to b under the skin: n points between the ends.
  local function sheet(a, b, n, depth)
    local points = {a}
    for i = 1, n do points[i + 1] = under(lerp(a, b, i / (n + 1)), depth) end
    points[n + 2] = b
    return points
  end

  -- The frames of limbs. near and far: the direction of 90 degrees at both ends.
  local function limb(from, to, near, far, reach)
    local along = (to - from):unit()
    return function(t, angle, r)
      local p, side = lerp(from, to, t), lerp(near, far, t)
      side = (side - along * side:dot(along)):unit()
      local front, a = along:cross(side), math.rad(angle)
      local direction = front * math.cos(a) + side * math.sin(a)
      local hit = skin:raycast(p, direction)[1]
      return p + direction * (r * math.min(hit and hit.distance or reach, reach))
    end
  end
  local arm_axis, fore_axis = (joint.elbow - joint.shoulder):unit(), (joint.wrist - joint.elbow):unit()
  local lateral = fore_axis:cross(arm_axis):unit()
  local radial = (joint.index - joint.little):unit()
  local arm = limb(joint.shoulder, joint.elbow, lateral, lateral, 0.62)
  local fore = limb(joint.elbow, joint.wrist, lateral, radial, 0.50)
  local thigh = limb(joint.hip, joint.knee, left, left, 1.00)
  local shin = limb(joint.knee, joint.ankle, left, left, 0.80)

  -- At a height of the trunk, degrees from the front to the left, depth under the skin.
  local function trunk(y, angle, depth)
    local a = skin:raycast({0, y, 10}, -ahead)[1].point
    local b = skin:raycast({0, y, -10}, ahead)[1].point
    local middle = lerp(a, b, 0.5)
    local direction = vec3(math.sin(math.rad(angle)), 0, math.cos(math.rad(angle)))
    return middle + direction * (skin:raycast(middle, direction)[1].distance - depth)
  end

  local pes = on("tibia_l", "pes_anserinus")
  local heel = on("foot_l", "calcaneal_tuberosity_upper")
  local spine_mid = on("scapula_l", "scapular_spine")
  local tuberosity = on("humerus_l", "deltoid_tuberosity")
  local crest = on("humerus_l", "greater_tubercle_crest")
  local lat_end = on("humerus_l", "lesser_tubercle_crest")
  local olecranon, ischium = on("ulna_l", "olecranon"), on("pelvis", "ischial_tuberosity_l")
  local iliac, asis = on("pelvis", "iliac_crest_l"), on("pelvis", "asis_l")
  local ribs = function(k, mark) return on("rib_" .. k, mark .. "_1") end
  local function spinous(name) return on(name, "spinous_1") + left * 0.06 end

  -- Between two points, pushed off the thorax.
  local function over_ribs(a, b, t)
    local p, cage = lerp(a, b, t), solid("rib_5")
    local c = cage:closest(p)
    if not cage:contains(p) and c.distance > 0.07 then return p end
    local out = cage:contains(p) and c.point - p or p - c.point
    return c.point + out:unit() * 0.07
  end

  local function serratus(k)
    local a, b = ribs(k, "lateral_anterior_l"), on("scapula_l", "medial_border_ventral")
    return {a, over_ribs(a, b, 0.35), over_ribs(a, b, 0.7), b}
  end

  local wide, spindle = {1, 2.5, 0.6}, {0.5, 1, 1, 0.6, 0.4}
  local waist, chest = lerp(iliac.y, ribs(10, "lateral_l").y, 0.5), ribs(6, "lateral_l").y
  local armpit = lerp(lat_end, on("scapula_l", "inferior_angle"), 0.45)
  local side = trunk(chest, 100, 0.12)

  return {
    -- head and neck
    {"temporalis_l", {on("skull", "temporal_line_l"), on("skull", "temporal_fossa_l"), on("skull", "zygomatic_arch_l")},
     tissue = 0.6},
    {"masseter_l", {on("skull", "zygoma_l"), on("skull", "jaw_angle_l")}, tissue = 0.7},
    {"sternocleidomastoid_l",
     sheet(on("sternum", "manubrium_anterior_l"), on("skull", "mastoid_l"), 3, 0.13),
     sheet(on("clavicle_l", "sternal_superior"), on("skull", "mastoid_l"), 3, 0.15), tissue = 0.6},
    {"splenius_capitis_l", {spinous("T2"), under(lerp(on("T1", "spinous_1"), on("skull", "mastoid_base_l"), 0.5), 0.20),
                            on("skull", "mastoid_base_l")}, tissue = 0.7},
    {"levator_scapulae_l", {on("C3", "transverse_l_1"), on("scapula_l", "superior_angle")}, tissue = 0.5},
    {"trapezius_l",
     sheet(on("skull", "nuchal_line_lower_l"), spine_mid, 3, 0.10), sheet(spinous("C7"), spine_mid, 2, 0.10),
     sheet(spinous("T4"), spine_mid, 2, 0.09), sheet(spinous("T10"), spine_mid, 3, 0.09), tissue = 0.5,
     frame = {axis = {0, 1, 0}, eigenvalues = wide}, pennation = {kind = "convergent"}},
    -- trunk
    {"pectoralis_major_l",
     sheet(on("clavicle_l", "medial_anterior"), crest, 2, 0.15),
     sheet(on("sternum", "body_anterior_upper_l"), crest, 3, 0.16),
     sheet(on("sternum", "body_anterior_lower_l"), crest, 3, 0.18), tissue = 0.9,
     frame = {axis = {0, 1, 0}, eigenvalues = wide}, pennation = {kind = "convergent"}},
    {"latissimus_dorsi_l",
     {spinous("T9"), trunk(chest, 150, 0.12), side, armpit, lat_end},
     {spinous("L1"), trunk(lerp(vec3(0, waist, 0), vec3(0, chest, 0), 0.5).y, 145, 0.12), side, armpit, lat_end},
     {on("pelvis", "iliac_crest_posterior_l"), trunk(waist, 135, 0.12), trunk(lerp(iliac, side, 0.6).y, 112, 0.12), side,
      armpit, lat_end}, tissue = 0.5, frame = {axis = {0, 1, 0}, eigenvalues = wide}, pennation = {kind = "convergent"}},
    {"serratus_anterior_l", serratus(2), serratus(4), serratus(6), serratus(8), tissue = 0.5},
    {"rectus_abdominis_l", {on("pelvis", "pubic_tubercle_l"), trunk(lerp(asis, iliac, 0.2).y, 14, 0.16), trunk(waist, 16, 0.16),
                            trunk(ribs(10, "lateral_l").y, 17, 0.16), on("sternum", "body_anterior_lower_l")},
     tissue = 0.7, frame = {axis = {1, 0, 0}, eigenvalues = wide}, pennation = {kind = "parallel"}},
    {"external_oblique_l",
     {ribs(6, "lateral_anterior_l"), trunk(waist + 0.3, 48, 0.13), asis},
     {ribs(8, "lateral_l"), trunk(waist, 65, 0.13), asis},
     {ribs(10, "lateral_l"), trunk(waist, 85, 0.13), on("pelvis", "iliac_crest_anterior_l"), asis}, tissue = 0.7,
     frame = {axis = {0, 0, 1}, eigenvalues = wide}, pennation = {kind = "parallel"}},
    {"erector_spinae_l", {on("pelvis", "sacrum_dorsal_l"), trunk(on("L4", "spinous_1").y, 166, 0.22),
                          trunk(on("L1", "spinous_1").y, 165, 0.22), trunk(on("T8", "spinous_1").y, 165, 0.22),
                          on("rib_4", "angle_l_1")}, tissue = 0.8},
    {"quadratus_lumborum_l", {on("pelvis", "iliac_crest_posterior_l"), on("L3", "transverse_l_1") + left * 0.2,
                              ribs(12, "angle_l")}, tissue = 0.6},
    -- shoulder
    {"deltoid_l",
     sheet(on("clavicle_l", "lateral_anterior"), tuberosity, 2, 0.14), sheet(on("scapula_l", "acromion"), tuberosity, 2, 0.14),
     sheet(on("scapula_l", "scapular_spine_lateral"), tuberosity, 2, 0.14), tissue = 1.1, pennation = {kind = "convergent"}},
    {"supraspinatus_l", {on("scapula_l", "supraspinous_fossa"), on("scapula_l", "superior_border") + vec3(0, 0.08, -0.05),
                         on("humerus_l", "greater_tubercle_superior")}, tissue = 0.5},
    {"infraspinatus_l", {on("scapula_l", "infraspinous_fossa"), on("humerus_l", "greater_tubercle_middle")}, tissue = 0.6},
    {"subscapularis_l", {on("scapula_l", "subscapular_fossa"), on("humerus_l", "lesser_tubercle")}, tissue = 0.6},
    {"teres_major_l", {on("scapula_l", "inferior_angle_dorsal"), lerp(on("scapula_l", "lateral_border_lower"), lat_end, 0.5),
                       lat_end}, tissue = 0.6},
    {"rhomboid_l", {spinous("T2"), on("scapula_l", "medial_border")}, {spinous("T4"), on("scapula_l", "medial_border")}, tissue = 0.4},
    -- arm
    {"biceps_brachii_l",
     {on("scapula_l", "supraglenoid_tubercle"), arm(0.08, 15, 0.6), arm(0.4, 20, 0.75), arm(0.65, 10, 0.75), arm(0.92, 0, 0.7),
      on("radius_l", "radial_tuberosity")},
     {on("scapula_l", "coracoid"), arm(0.2, -35, 0.65), arm(0.45, -15, 0.75), arm(0.65, -8, 0.75), arm(0.92, 0, 0.7),
      on("radius_l", "radial_tuberosity")}, tissue = {0.3, 0.5, 1.1, 1.1, 0.5, 0.3}, tendon = {area = 0.03}},
    {"brachialis_l", {on("humerus_l", "shaft_anterior"), arm(0.8, 5, 0.5), on("ulna_l", "ulnar_tuberosity")}, tissue = 1.1},
    {"coracobrachialis_l", {on("scapula_l", "coracoid"), arm(0.25, -65, 0.45), on("humerus_l", "coracobrachialis_insertion")},
     tissue = 0.4},
    {"triceps_brachii_l",
     {on("scapula_l", "infraglenoid_tubercle"), arm(0.35, 215, 0.7), arm(0.65, 195, 0.72), olecranon},
     {on("humerus_l", "shaft_posterior_upper"), arm(0.45, 145, 0.7), arm(0.70, 165, 0.7), olecranon},
     {on("humerus_l", "shaft_posterior"), arm(0.75, 210, 0.55), olecranon}, tissue = {0.7, 1.2, 1.1, 0.5}, tendon = {area = 0.04},
     pennation = {kind = "unipennate", angle = 12}},
    {"brachioradialis_l", {on("humerus_l", "lateral_supracondylar_ridge"), fore(0.1, 55, 0.75), fore(0.35, 55, 0.75),
                           fore(0.7, 70, 0.65), on("radius_l", "styloid_base")}, tissue = spindle, tendon = {area = 0.02}},
    {"pronator_teres_l", {on("humerus_l", "medial_epicondyle_anterior"), fore(0.22, -10, 0.6), on("radius_l", "pronator_tuberosity")},
     tissue = 0.7},
    {"flexor_carpi_radialis_l", {on("humerus_l", "medial_epicondyle_anterior"), fore(0.25, -35, 0.75), fore(0.6, 5, 0.7),
                                 fore(0.9, 20, 0.6), on("hand_l", "metacarpal_2_base_palmar")}, tissue = spindle, tendon = {area = 0.02}},
    {"flexor_digitorum_l", {on("ulna_l", "shaft_anterior_upper"), fore(0.45, -20, 0.6), fore(0.8, 0, 0.55),
                            on("hand_l", "metacarpal_3_palmar")}, tissue = {0.8, 1.2, 0.6, 0.4}, tendon = {area = 0.02}},
    {"flexor_carpi_ulnaris_l", {on("humerus_l", "medial_epicondyle"), fore(0.25, -75, 0.75), fore(0.6, -60, 0.7), fore(0.9, -40, 0.6),
                                on("hand_l", "pisiform")}, tissue = spindle, tendon = {area = 0.02}},
    {"extensor_carpi_radialis_l", {on("humerus_l", "lateral_epicondyle"), fore(0.2, 95, 0.75), fore(0.5, 110, 0.7), fore(0.85, 140, 0.65),
                                   on("hand_l", "metacarpal_2_base_dorsal")}, tissue = spindle, tendon = {area = 0.02}},
    {"extensor_digitorum_l", {on("humerus_l", "lateral_epicondyle_posterior"), fore(0.2, 140, 0.75), fore(0.55, 165, 0.7),
                              fore(0.88, 178, 0.7), on("hand_l", "metacarpal_3_base_dorsal")}, tissue = spindle, tendon = {area = 0.02}},
    {"extensor_carpi_ulnaris_l", {on("humerus_l", "lateral_epicondyle_posterior"), fore(0.25, 185, 0.7), fore(0.6, 215, 0.7),
                                  fore(0.9, 225, 0.65), on("hand_l", "metacarpal_5_base")}, tissue = spindle, tendon = {area = 0.02}},
    -- hip
    {"iliopsoas_l",
     {on("L2", "body_lateral_l_1"), on("L5", "body_lateral_l_1") + vec3(0.2, 0, 0.15), on("pelvis", "iliopubic_eminence_l") + vec3(0.1, 0, 0.18),
      on("femur_l", "lesser_trochanter")},
     {on("pelvis", "iliac_fossa_l"), on("pelvis", "iliopubic_eminence_l") + vec3(0.1, 0, 0.18), on("femur_l", "lesser_trochanter")},
     tissue = 0.8},
    {"gluteus_maximus_l",
     sheet(on("pelvis", "iliac_crest_posterior_l"), on("femur_l", "gluteal_tuberosity"), 2, 0.30),
     sheet(on("pelvis", "sacrum_dorsal_l"), on("femur_l", "gluteal_tuberosity"), 2, 0.34),
     sheet(on("pelvis", "sacrotuberous_l"), on("femur_l", "gluteal_tuberosity"), 2, 0.36), tissue = 1.5},
    {"gluteus_medius_l",
     sheet(on("pelvis", "ilium_lateral_anterior_l"), on("femur_l", "greater_trochanter"), 1, 0.22),
     sheet(on("pelvis", "ilium_lateral_l"), on("femur_l", "greater_trochanter"), 1, 0.22),
     sheet(on("pelvis", "ilium_lateral_posterior_l"), on("femur_l", "greater_trochanter"), 1, 0.30), tissue = 0.9},
    {"tensor_fasciae_latae_l", {on("pelvis", "iliac_crest_anterior_l"), thigh(0.08, 55, 0.85), thigh(0.3, 75, 0.85), thigh(0.65, 85, 0.88),
                                on("tibia_l", "gerdy")}, tissue = {0.6, 0.8, 0.5, 0.2, 0.2}, tendon = {area = 0.03}},
    -- thigh
    {"sartorius_l", {asis, thigh(0.15, 10, 0.85), thigh(0.4, -35, 0.85), thigh(0.65, -70, 0.85), thigh(0.92, -110, 0.8), pes},
     tissue = 0.4, pennation = {kind = "parallel"}},
    {"rectus_femoris_l", {on("pelvis", "aiis_l"), thigh(0.15, 15, 0.75), thigh(0.45, 8, 0.8), thigh(0.75, 3, 0.78), on("patella_l", "base")},
     tissue = {0.4, 1, 1.1, 0.7, 0.4}, tendon = {area = 0.06}, pennation = {kind = "bipennate", angle = 12}},
    {"vastus_lateralis_l",
     {on("femur_l", "greater_trochanter_anterior"), thigh(0.3, 65, 0.65), thigh(0.6, 55, 0.7), thigh(0.85, 35, 0.75),
      on("patella_l", "lateral_border")},
     {on("femur_l", "shaft_lateral"), thigh(0.65, 85, 0.6), on("patella_l", "lateral_border")}, tissue = 1.3},
    {"vastus_intermedius_l", {on("femur_l", "shaft_anterior_upper"), thigh(0.5, 10, 0.42), thigh(0.8, 5, 0.5), on("patella_l", "base_posterior")},
     tissue = 0.9},
    {"vastus_medialis_l",
     {on("femur_l", "intertrochanteric_line"), thigh(0.45, -35, 0.6), thigh(0.75, -42, 0.7), on("patella_l", "medial_border")},
     {on("femur_l", "shaft_medial"), thigh(0.82, -55, 0.75), on("patella_l", "medial_border")}, tissue = 1.2},
    {"pectineus_l", {on("pelvis", "pubic_ramus_superior_l"), on("femur_l", "pectineal_line")}, tissue = 0.7},
    {"adductor_longus_l", {on("pelvis", "pubic_body_l"), thigh(0.25, -60, 0.7), on("femur_l", "linea_aspera_middle")}, tissue = 0.8},
    {"adductor_magnus_l",
     {on("pelvis", "ischial_ramus_l"), thigh(0.25, -110, 0.75), on("femur_l", "linea_aspera_middle")},
     {on("pelvis", "ischial_ramus_l"), thigh(0.3, -105, 0.75), thigh(0.6, -105, 0.6), on("femur_l", "adductor_tubercle")}, tissue = 1.1},
    {"gracilis_l", {on("pelvis", "pubic_ramus_inferior_l"), thigh(0.3, -85, 0.9), thigh(0.6, -95, 0.85), thigh(0.9, -120, 0.8), pes},
     tissue = 0.4},
    {"biceps_femoris_l",
     {ischium, thigh(0.35, 175, 0.75), thigh(0.65, 155, 0.8), thigh(0.92, 135, 0.75), on("fibula_l", "head")},
     {on("femur_l", "linea_aspera_lower"), thigh(0.8, 145, 0.65), thigh(0.92, 130, 0.7), on("fibula_l", "head")}, tissue = 1,
     tendon = {area = 0.04}},
    {"semitendinosus_l", {ischium, thigh(0.35, 195, 0.82), thigh(0.65, 200, 0.82), thigh(0.92, 215, 0.78), pes}, tissue = {0.6, 1, 0.9, 0.4, 0.3},
     tendon = {area = 0.03}},
    {"semimembranosus_l", {ischium, thigh(0.35, 215, 0.65), thigh(0.65, 222, 0.72), thigh(0.92, 222, 0.65),
                           on("tibia_l", "medial_condyle_posterior")}, tissue = 0.9},
    -- leg
    {"gastrocnemius_l",
     {on("femur_l", "medial_condyle_posterior"), shin(0.12, 200, 0.75), shin(0.32, 200, 0.82), shin(0.6, 185, 0.8), heel},
     {on("femur_l", "lateral_condyle_posterior"), shin(0.12, 155, 0.75), shin(0.32, 155, 0.82), shin(0.6, 178, 0.8), heel},
     tissue = {0.7, 1.4, 1.4, 0.5, 0.3}, tendon = {area = 0.06}, pennation = {kind = "unipennate", angle = 15}},
    {"soleus_l",
     {on("fibula_l", "head_posterior"), shin(0.35, 140, 0.55), shin(0.65, 165, 0.65), heel},
     {on("tibia_l", "soleal_line"), shin(0.4, 215, 0.55), shin(0.65, 190, 0.65), heel}, tissue = {0.7, 1.2, 0.8, 0.3},
     tendon = {area = 0.06}},
    {"tibialis_anterior_l", {on("tibia_l", "shaft_lateral_upper"), shin(0.35, 30, 0.65), shin(0.65, 12, 0.65), shin(0.93, -8, 0.72),
                             on("foot_l", "medial_cuneiform")}, tissue = {0.7, 1.1, 0.8, 0.4, 0.3}, tendon = {area = 0.02}},
    {"extensor_digitorum_longus_l", {on("fibula_l", "shaft_anterior_upper"), shin(0.5, 55, 0.65), shin(0.75, 35, 0.65), shin(0.94, 12, 0.72),
                                     on("foot_l", "toe_3_middle_dorsal")}, tissue = {0.6, 0.9, 0.6, 0.4, 0.3}, tendon = {area = 0.02}},
    {"fibularis_longus_l", {on("fibula_l", "shaft_lateral_upper"), shin(0.4, 88, 0.72), shin(0.7, 105, 0.7), on("fibula_l", "malleolar_groove") - ahead * 0.06,
                            on("foot_l", "cuboid_groove")}, tissue = {0.6, 0.9, 0.6, 0.3, 0.3}, tendon = {area = 0.02}},
    {"tibialis_posterior_l", {on("tibia_l", "shaft_posterior"), shin(0.7, 205, 0.4), on("tibia_l", "malleolar_groove") - ahead * 0.06,
                              on("foot_l", "navicular_tuberosity")}, tissue = {0.7, 0.7, 0.3, 0.3}},
  }
end
