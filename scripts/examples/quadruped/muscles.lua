-- muscles.lua - the muscles of the left side, as curves. Names as in the Nomina Anatomica Veterinaria.
local _, scene = ...
local vec3 = sinew.vec3

-- {name, insertion, head, head ...}; a head is {tissue value of its belly, origin, {x, y, z} in millimetres ...}.
-- Origins and insertions are landmarks, "bone.landmark": of the left bone, or the left one of a bone of the midline.
-- They go along when a bone is moved; the points between give the belly its place. What arises from the ligament of the
-- nape starts at a point.
local muscles = {
  -- head and neck
  {"masseter", "mandible.angle", {1.2, "skull.zygoma", {104, 834, 968}, {96, 822, 925}},
   {1.0, "skull.zygomatic_arch", {100, 843, 945}}},
  {"temporalis", "mandible.coronoid", {0.45, "skull.crest", {40, 958, 902}, {70, 922, 926}},
   {0.6, "skull.temporal_fossa", {70, 912, 926}}, {0.45, "skull.temporal_front", {62, 925, 962}}},
  {"digastricus", "mandible.body", {0.35, "skull.jugular", {48, 815, 880}, {58, 785, 960}}},
  {"splenius", "skull.nuchal_line", {1.1, "withers.spinous_4", {22, 868, 500}, {32, 888, 620}, {42, 915, 740}}},
  {"semispinalis_capitis", "skull.nuchal_line_lower",
   {1.0, "withers.transverse_l_2", {34, 815, 490}, {26, 838, 600}, {24, 872, 710}, {25, 905, 800}}},
  {"longissimus_capitis", "skull.mastoid",
   {0.7, "withers.transverse_l_5", {52, 795, 570}, {56, 818, 680}, {58, 855, 780}}},
  {"longus_capitis", "skull.basilar", {0.6, "cervical.transverse_l_2", {30, 752, 660}, {34, 795, 760}, {24, 838, 845}}},
  {"sternocephalicus", "skull.mastoid",
   {0.5, "sternum.manubrium_anterior", {38, 600, 620}, {66, 700, 700}, {84, 810, 795}}},
  {"brachiocephalicus", "humerus.shaft_anterior_lower",
   {1.0, "skull.nuchal_line", {78, 895, 800}, {102, 815, 700}, {122, 710, 612}, {140, 600, 575}, {136, 510, 495}}},
  {"omotransversarius", "scapula.acromion_posterior",
   {0.7, "cervical.transverse_l_7", {76, 805, 735}, {112, 715, 620}}},
  {"scalenus", "cervical.transverse_l_3", {0.7, "rib_5.lateral", {110, 690, 430}, {80, 700, 540}, {58, 735, 610}}},
  -- shoulder girdle
  {"trapezius", "scapula.scapular_spine", {0.8, {4, 930, 660}, {40, 925, 620}, {80, 905, 580}, {122, 825, 535}},
   {0.8, "thoracic.spinous_7", {46, 905, 300}, {98, 880, 400}, {128, 810, 470}}},
  {"rhomboideus", "scapula.medial_border_upper", {0.8, {4, 915, 720}, {36, 915, 650}, {64, 900, 560}},
   {0.8, "withers.spinous_3", {40, 893, 400}}},
  {"serratus_ventralis", "scapula.medial_border_ventral",
   {0.8, "cervical.transverse_l_4", {66, 785, 600}, {72, 820, 500}},
   {0.6, "rib_3.anterior", {96, 690, 432}, {88, 780, 420}}, {0.6, "rib_5.anterior", {124, 680, 340}, {98, 780, 392}},
   {0.6, "rib_7.anterior", {148, 660, 250}, {112, 770, 350}}},
  {"latissimus_dorsi", "humerus.lesser_tubercle_crest",
   {1.3, "thoracic.spinous_7", {70, 890, 260}, {140, 770, 330}, {148, 650, 410}, {128, 600, 470}},
   {1.3, "thoracic.spinous_4", {80, 885, 140}, {146, 770, 250}, {156, 650, 360}, {138, 595, 440}},
   {1.3, "thoracic.spinous_1", {84, 875, 40}, {150, 750, 160}, {160, 640, 290}, {148, 590, 400}},
   {1.3, "lumbar.spinous_7", {88, 868, -25}, {150, 740, 100}, {162, 635, 240}, {152, 588, 360}},
   {1.2, "lumbar.spinous_5", {90, 862, -90}, {150, 730, 40}, {165, 630, 180}, {155, 585, 310}, {142, 575, 410}}},
  {"pectoralis_superficialis", "humerus.greater_tubercle_crest",
   {0.8, "sternum.manubrium_anterior", {50, 505, 560}, {108, 530, 540}},
   {0.8, "sternum.body_anterior_upper", {50, 475, 470}, {104, 500, 490}}},
  {"pectoralis_profundus", "humerus.lesser_tubercle",
   {0.9, "sternum.body_anterior", {50, 475, 400}, {92, 520, 470}},
   {0.8, "sternum.xiphoid_anterior", {44, 455, 250}, {84, 480, 360}, {98, 540, 460}}},
  {"deltoideus", "humerus.deltoid_tuberosity", {0.8, "scapula.acromion_posterior", {164, 590, 520}},
   {0.8, "scapula.scapular_spine", {150, 690, 478}, {164, 590, 470}}},
  {"supraspinatus", "humerus.greater_tubercle_superior",
   {1.0, "scapula.medial_border_upper", {108, 810, 512}, {118, 735, 540}, {128, 665, 560}}},
  {"infraspinatus", "humerus.greater_tubercle_inferior",
   {1.0, "scapula.medial_border", {110, 800, 434}, {130, 720, 468}, {146, 660, 505}}},
  {"teres_minor", "humerus.greater_tubercle_inferior", {0.5, "scapula.lateral_border_upper", {128, 655, 480}}},
  {"teres_major", "humerus.lesser_tubercle_crest",
   {0.9, "scapula.inferior_angle", {108, 690, 394}, {110, 615, 466}}},
  {"subscapularis", "humerus.lesser_tubercle",
   {0.9, "scapula.medial_border_ventral", {82, 770, 450}, {80, 690, 490}, {90, 620, 540}}},
  -- arm
  {"triceps_brachii", "ulna.olecranon",
   {1.2, "scapula.lateral_border_lower", {118, 640, 376}, {126, 540, 332}, {126, 460, 308}},
   {1.0, "humerus.shaft_posterior_upper", {158, 545, 420}, {156, 470, 350}},
   {0.8, "humerus.shaft_posterior", {104, 490, 390}, {110, 440, 336}}},
  {"biceps_brachii", "radius.radial_tuberosity",
   {0.8, "scapula.supraglenoid_tubercle", {118, 596, 572}, {112, 530, 505}, {108, 460, 446}, {104, 395, 404}}},
  {"brachialis", "ulna.ulnar_tuberosity",
   {0.7, "humerus.surgical_neck", {148, 520, 440}, {148, 460, 418}, {136, 405, 402}}},
  {"coracobrachialis", "humerus.coracobrachialis_insertion", {0.5, "scapula.coracoid", {92, 570, 510}}},
  -- forearm
  {"brachioradialis", "radius.styloid_base",
   {0.5, "humerus.lateral_supracondylar_ridge", {138, 395, 424}, {124, 310, 430}, {122, 210, 430}}},
  {"extensor_carpi_radialis", "carpus.dorsal_medial",
   {0.8, "humerus.lateral_epicondyle_anterior", {146, 360, 405}, {132, 280, 414}, {114, 180, 420}}},
  {"extensor_digitorum_communis", "carpus.dorsal",
   {0.7, "humerus.lateral_epicondyle", {162, 360, 385}, {152, 270, 396}, {134, 180, 412}}},
  {"extensor_digitorum_lateralis", "carpus.dorsal_lateral",
   {0.6, "humerus.lateral_epicondyle", {168, 350, 362}, {160, 260, 374}, {148, 170, 396}}},
  {"extensor_carpi_ulnaris", "metacarpal_5.base_palmar",
   {0.6, "humerus.lateral_epicondyle_posterior", {160, 350, 332}, {154, 260, 344}, {146, 160, 370}}},
  {"pronator_teres", "radius.pronator_tuberosity",
   {0.6, "humerus.medial_epicondyle_anterior", {84, 355, 396}, {96, 300, 414}}},
  {"flexor_carpi_radialis", "metacarpal_2.base_palmar",
   {0.7, "humerus.medial_epicondyle", {80, 350, 372}, {86, 260, 384}, {92, 160, 396}}},
  {"flexor_digitorum_superficialis", "carpus.palmar_medial",
   {0.8, "humerus.medial_epicondyle_posterior", {88, 350, 338}, {94, 260, 350}, {100, 160, 376}}},
  {"flexor_digitorum_profundus", "carpus.palmar",
   {0.8, "ulna.shaft_medial", {110, 240, 368}, {114, 160, 384}}},
  {"flexor_carpi_ulnaris", "carpus.accessory",
   {0.8, "ulna.olecranon_medial", {110, 340, 312}, {116, 250, 330}, {108, 160, 356}}},
  -- trunk
  {"longissimus", "cervical.transverse_l_1",
   {1.2, "pelvis.iliac_crest_posterior", {40, 868, -250}, {42, 858, -80}, {42, 856, 100}, {40, 846, 260},
    {36, 826, 400}, {40, 790, 510}}},
  {"multifidus", "thoracic.spinous_4", {0.8, "pelvis.sacrum_dorsal", {16, 862, -320}, {15, 866, -160}, {14, 862, 0}}},
  {"iliocostalis", "rib_4.angle",
   {0.9, "pelvis.iliac_crest", {78, 836, -220}, {80, 840, -80}, {82, 846, 80}, {84, 840, 220}, {74, 815, 350}}},
  {"rectus_abdominis", "sternum.body_anterior_lower",
   {0.9, "pelvis.pubic_tubercle", {32, 566, -340}, {38, 537, -190}, {40, 494, -10}, {38, 468, 130}, {28, 458, 240}}},
  {"obliquus_externus_abdominis", "pelvis.asis",
   {0.8, "rib_6.anterior", {136, 545, 180}, {132, 545, 40}, {124, 580, -130}, {106, 645, -270}},
   {0.8, "rib_8.lateral", {150, 650, 80}, {142, 630, -50}, {128, 650, -180}},
   {0.8, "rib_10.lateral", {146, 720, 0}, {136, 710, -130}, {116, 715, -250}}},
  {"obliquus_internus_abdominis", "rib_11.anterior", {0.5, "pelvis.aiis", {84, 630, -260}, {100, 600, -120}}},
  {"serratus_dorsalis", "rib_9.lateral", {0.3, "lumbar.spinous_7", {74, 850, 0}, {108, 800, 90}}},
  {"psoas_major", "femur.lesser_trochanter",
   {0.9, "lumbar.transverse_l_6", {36, 780, -190}, {46, 745, -310}, {66, 685, -400}}},
  -- hip and thigh
  {"gluteus_superficialis", "femur.gluteal_tuberosity",
   {0.8, "pelvis.sacral_crest_lower", {72, 812, -500}, {126, 730, -490}}},
  {"gluteus_medius", "femur.greater_trochanter_tip", {1.3, "pelvis.iliac_crest", {100, 805, -370}, {112, 755, -440}}},
  {"gluteus_profundus", "femur.greater_trochanter_anterior", {0.6, "pelvis.ilium_lateral_lower", {102, 720, -430}}},
  {"tensor_fasciae_latae", "patella.lateral_border",
   {0.8, "pelvis.iliac_crest_anterior", {124, 680, -345}, {152, 580, -350}, {154, 500, -322}}},
  {"sartorius", "patella.medial_border",
   {0.8, "pelvis.iliac_crest_anterior", {100, 680, -316}, {108, 590, -310}, {96, 510, -300}}},
  {"rectus_femoris", "patella.base", {1.0, "pelvis.aiis", {112, 620, -375}, {120, 550, -330}}},
  {"vastus_lateralis", "patella.base", {1.0, "femur.greater_trochanter_anterior", {142, 620, -412}, {142, 540, -352}}},
  {"vastus_medialis", "patella.base", {0.9, "femur.intertrochanteric_line", {94, 600, -390}, {96, 530, -340}}},
  {"biceps_femoris", "tibia.gerdy",
   {1.1, "pelvis.ischial_tuberosity_lateral", {130, 640, -530}, {165, 540, -440}, {168, 450, -370}},
   {1.0, "pelvis.ischial_tuberosity", {112, 600, -565}, {140, 480, -490}, {152, 410, -415}}},
  {"semitendinosus", "tibia.pes_anserinus",
   {1.0, "pelvis.ischial_tuberosity", {76, 610, -590}, {96, 500, -530}, {98, 410, -460}}},
  {"semimembranosus", "tibia.medial_condyle", {1.1, "pelvis.ischial_ramus", {66, 580, -530}, {84, 490, -450}}},
  {"adductor", "femur.linea_aspera_lower", {1.0, "pelvis.pubic_ramus_inferior", {58, 600, -480}, {94, 545, -420}}},
  {"pectineus", "femur.linea_aspera_upper", {0.6, "pelvis.pubic_ramus_superior", {72, 625, -430}}},
  {"gracilis", "tibia.shaft_medial", {0.8, "pelvis.pubic_body", {36, 560, -470}, {64, 470, -440}, {88, 390, -420}}},
  -- leg
  {"gastrocnemius", "tarsus.tuber",
   {0.9, "femur.lateral_condyle_posterior", {146, 400, -430}, {130, 330, -535}},
   {0.9, "femur.medial_condyle_posterior", {96, 395, -440}, {108, 330, -540}}},
  {"soleus", "tarsus.tuber_lateral", {0.6, "fibula.head_posterior", {148, 360, -450}, {138, 310, -530}}},
  {"popliteus", "tibia.popliteal_surface", {0.6, "femur.popliteal_groove", {136, 416, -390}}},
  {"tibialis_cranialis", "tarsus.dorsal",
   {0.8, "tibia.shaft_lateral_upper", {128, 340, -395}, {114, 270, -470}, {106, 220, -515}}},
  {"extensor_digitorum_longus", "tarsus.dorsal_lateral",
   {0.7, "femur.lateral_epicondyle", {146, 350, -390}, {132, 280, -468}, {124, 220, -518}}},
  {"fibularis_longus", "tarsus.lateral", {0.6, "fibula.head", {160, 350, -420}, {148, 285, -495}, {140, 225, -545}}},
  {"flexor_digitorum_lateralis", "tarsus.plantar", {0.8, "tibia.shaft_posterior", {116, 310, -500}, {108, 255, -568}}},
  -- tail
  {"sacrocaudalis_dorsalis", "caudal.transverse_l_9",
   {0.6, "pelvis.sacral_crest_lower", {18, 805, -590}, {20, 772, -670}, {18, 700, -752}, {16, 580, -812}}},
  {"sacrocaudalis_ventralis", "caudal.transverse_lower_l_9",
   {0.6, "pelvis.coccyx", {18, 725, -615}, {18, 692, -680}, {16, 610, -748}}},
  {"coccygeus", "caudal.transverse_l_16", {0.6, "pelvis.ischial_spine", {42, 740, -600}}},
}

local skin, bones, surfaces = scene:skin(), {}, {}
for _, bone in ipairs(scene:bones()) do bones[bone:name()] = bone end

-- "bone.landmark" -> the nearest place of the bone's surface, half a millimetre off it. The surface is that of the
-- half model: landmarks of the midline move a little to the left.
local function site(text)
  local name, mark = text:match("^(.*)%.(.*)$")
  local bone = bones[name .. "_l"] or bones[name]
  local found, p = pcall(bone.landmark, bone, mark .. "_l")
  p = found and p or bone:landmark(mark)
  p = vec3(math.max(p.x, 0.004), p.y, p.z)
  surfaces[name] = surfaces[name] or bone:surface()
  local q = surfaces[name]:closest(p).point
  return q + (p - q):unit() * 0.0005
end

-- {x, y, z} in millimetres -> a point that is at least 12 mm below the skin.
local function below_skin(mm)
  local p = vec3(table.unpack(mm)) * 0.001
  local near = skin:closest(p)
  local inside = skin:contains(p)
  if inside and near.distance >= 0.012 then return p end
  return near.point + (inside and p - near.point or near.point - p):unit() * 0.012
end

local names = {}
for _, m in ipairs(muscles) do
  local heads = {}
  for i = 3, #m do
    local belly, origin = m[i][1], m[i][2]
    local points = {type(origin) == "string" and site(origin) or below_skin(origin)}
    local tissue = {0.6 * belly}
    for k = 3, #m[i] do
      points[#points + 1], tissue[#tissue + 1] = below_skin(m[i][k]), belly
    end
    points[#points + 1], tissue[#tissue + 1] = site(m[2]), 0.5 * belly
    heads[#heads + 1] = {points = points, tissue = tissue}
  end
  names[#names + 1] = m[1] .. "_l"
  scene:add_muscle(m[1] .. "_l", {heads = heads})
end
return names
