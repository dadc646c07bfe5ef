-- skeleton.lua - the bones of the quadruped: the human templates of the library, put where a cat has them, and what
-- a cat has and we have not (its skull, its carpus and its tarsus) from shapes. Left side; mirrored at the end.
local here, scene = ...
local kit = dofile(here .. "kit.lua")
local shape, vec3, chain, both, step = sinew.shape, sinew.vec3, kit.chain, kit.both, kit.step

-- 1  Templates. A template keeps landmarks: muscles hold on to them wherever the bone goes.

local skull = {
  shape.ellipsoid({0, 0.048, 0.062}, {0.047, 0.040, 0.066}),                                     -- braincase
  shape.plate({0, 0.050, -0.012}, {0, 0.092, 0.004}, {0, 0.060, 0.120}, 0.006),
  shape.plate({0, 0.092, 0.004}, {0, 0.100, 0.100}, {0, 0.060, 0.120}, 0.006),                   -- sagittal crest
  both(chain{{0.044, 0.016, -0.002, 0.008}, {0.030, 0.062, -0.010, 0.007}, {0, 0.090, -0.002, 0.008}}), -- nuchal
  both(shape.capsule({0.014, -0.004, 0.004}, {0.016, 0.004, 0.030}, 0.012)),                     -- condyles
  shape.ellipsoid({0, 0.066, 0.145}, {0.044, 0.034, 0.050}),                                     -- frontal bone
  both(chain{{0.036, 0.082, 0.138, 0.009}, {0.058, 0.066, 0.126, 0.006}}),                       -- postorbital
  both(chain{{0.022, 0.030, 0.160, 0.034}, {0.018, 0.022, 0.262, 0.026}}),                       -- maxilla
  chain{{0, 0.064, 0.170, 0.026}, {0, 0.042, 0.262, 0.018}},                                     -- nasal bone
  both(chain{{0.050, 0.012, 0.058, 0.009}, {0.086, 0.008, 0.084, 0.009}, {0.095, 0.010, 0.125, 0.010},
             {0.084, 0.014, 0.160, 0.011}, {0.052, 0.016, 0.192, 0.014}}),                       -- zygomatic arch
  both(shape.ellipsoid({0.026, -0.012, 0.048}, {0.014, 0.013, 0.020})),                          -- bulla
  both(chain{{0.026, 0.000, 0.262, 0.010}, {0.027, -0.044, 0.272, 0.003}}),                      -- canine
  both(chain{{0.036, 0.000, 0.170, 0.010}, {0.033, -0.002, 0.235, 0.008}}),                      -- carnassials
}
kit.template("felid_skull", 0.008, {shape.subtract(shape.smooth_union(0.008, skull),
                                    both(shape.ellipsoid({0.052, 0.044, 0.166}, {0.022, 0.024, 0.026})))},
  {occiput = {0, 0.088, -0.010}, nuchal_line_l = {0.036, 0.050, -0.014}, nuchal_line_lower_l = {0.024, 0.020, -0.010},
   mastoid_l = {0.048, 0.012, 0.002}, jugular_l = {0.030, -0.006, 0.022}, basilar = {0.010, -0.006, 0.040},
   temporal_fossa_l = {0.046, 0.060, 0.050}, temporal_front_l = {0.036, 0.090, 0.110}, crest = {0.006, 0.094, 0.030},
   zygoma_l = {0.088, 0.000, 0.158}, zygomatic_arch_l = {0.100, 0.004, 0.110}, jaw = {0.072, 0.002, 0.062}})
kit.template("felid_mandible", 0.008, {
  chain{{0.020, -0.052, 0.268, 0.015}, {0.040, -0.058, 0.200, 0.016}, {0.062, -0.054, 0.110, 0.015},
        {0.068, -0.044, 0.056, 0.010}},                                                           -- body, angle
  shape.plate({0.062, -0.045, 0.120}, {0.068, -0.040, 0.062}, {0.066, 0.030, 0.088}, 0.007),      -- ramus
  shape.capsule({0.058, 0.000, 0.060}, {0.082, 0.000, 0.060}, 0.008),                             -- condyle
  shape.capsule({0.068, -0.030, 0.068}, {0.070, 0.000, 0.062}, 0.008),
  shape.capsule({0.000, -0.052, 0.272}, {0.020, -0.054, 0.262}, 0.014),                           -- symphysis
  chain{{0.020, -0.046, 0.276, 0.009}, {0.021, -0.008, 0.286, 0.003}}},                           -- canine
  {angle = {0.074, -0.048, 0.062}, masseteric_fossa = {0.074, -0.036, 0.096}, coronoid = {0.070, 0.022, 0.088},
   coronoid_medial = {0.060, 0.014, 0.090}, body = {0.046, -0.072, 0.180}, chin = {0.014, -0.066, 0.262}})
kit.template("felid_carpus", 0.007, {
  shape.capsule({-0.018, -0.008, 0.002}, {0.020, -0.008, 0.002}, 0.014),
  shape.capsule({-0.022, -0.028, 0.006}, {0.024, -0.028, 0.006}, 0.012),
  chain{{-0.014, -0.012, -0.006, 0.009}, {-0.016, -0.018, -0.028, 0.008}}},                        -- accessory carpal
  {dorsal_medial = {-0.014, -0.030, 0.020}, dorsal = {0.002, -0.030, 0.020}, dorsal_lateral = {0.020, -0.030, 0.016},
   palmar = {0.004, -0.030, -0.008}, palmar_medial = {-0.012, -0.030, -0.006}, accessory = {-0.016, -0.014, -0.036}})
kit.template("felid_tarsus", 0.007, {
  chain{{0.006, 0.046, -0.040, 0.014}, {0.006, 0.012, -0.024, 0.013}, {0.010, -0.022, -0.004, 0.013}},  -- calcaneus
  shape.capsule({-0.012, 0.000, 0.000}, {0.012, 0.000, 0.000}, 0.017),                                  -- talus
  chain{{-0.004, -0.004, 0.004, 0.014}, {-0.008, -0.030, 0.010, 0.013}},
  shape.capsule({-0.018, -0.046, 0.012}, {0.018, -0.046, 0.010}, 0.012)},
  {tuber = {0.006, 0.056, -0.050}, tuber_lateral = {0.020, 0.044, -0.040}, plantar = {0.006, -0.012, -0.022},
   dorsal = {-0.008, -0.046, 0.026}, dorsal_lateral = {0.014, -0.046, 0.024}, lateral = {0.022, -0.040, 0.006},
   medial = {-0.020, -0.046, 0.010}})

-- The scapula: its axis upright, the blade long and its fossa in front of the spine as wide as the one behind.
kit.reshape("scapula", "felid_scapula", function(p)
  local up, out = -0.817 * p.x - 0.576 * p.z, 0.576 * p.x - 0.817 * p.z
  local blade = step(0.005, 0.055, up)
  local ahead = p.y * 0.85 + blade * 2.0 * math.max(0, p.y - 0.026) - (1 - blade) * 0.45 * math.max(0, p.y)
  return vec3(out * 1.15 - 0.12 * up, up * (up > 0 and 2.25 or 0.8), ahead + 0.20 * up)
end)

-- The pelvis: long and narrow, the wings of the ilium turned to the side.
kit.reshape("pelvis", "felid_pelvis", function(p)
  local wing = step(0, 0.11, p.y)
  return vec3(p.x * (0.80 - 0.20 * wing), p.y * 1.30, p.z * (1.10 - 0.25 * wing))
end)

kit.reshape("sternum", "felid_sternum", function(p) return vec3(p.x * 0.75, p.y * 2.1, p.z * 1.3) end)

-- The first spinous processes of the thorax are long.
kit.reshape("thoracic", "felid_thoracic", function(p)
  local spine = math.max(0, -0.034 - p.z)
  return vec3(p.x, p.y, p.z - 0.75 * spine)
end, 0.025)

-- 2  Axial skeleton. Rows run towards the head; front is where a vertebra's body looks: down.

local midline, ventral = {normal = {1, 0, 0}}, {0, -1, 0}
local function row(name, options)
  options.name, options.plane, options.front = name, midline, ventral
  options.template = options.template or name
  return scene:place_bone(options)
end
row("caudal", {count = 18, size = {0.55, 1}, thickness = 1.15,
               along = {{0, 0.272, -1.040}, {0, 0.285, -0.950}, {0, 0.370, -0.860}, {0, 0.510, -0.812},
                        {0, 0.660, -0.745}, {0, 0.742, -0.665}, {0, 0.774, -0.565}}})
row("lumbar", {count = 7, size = {1.1, 1}, fill = 0.7, thickness = 1.0,
               along = {{0, 0.806, -0.368}, {0, 0.800, -0.200}, {0, 0.788, -0.010}}})
local back = {{0, 0.788, -0.010}, {0, 0.772, 0.180}, {0, 0.748, 0.380}, {0, 0.738, 0.545}}
row("thoracic", {count = 7, along = back, range = {0, 7 / 13}, fill = 0.7, thickness = 0.9})
row("withers", {template = "felid_thoracic", count = 6, along = back, range = {7 / 13, 1}, fill = 0.7, thickness = 1.0})
row("cervical", {count = 7, size = {1, 1.1}, fill = 0.7, thickness = 0.8,
                 along = {{0, 0.735, 0.545}, {0, 0.752, 0.620}, {0, 0.800, 0.730}, {0, 0.860, 0.842}}})

scene:place_bone{name = "skull", template = "felid_skull", at = {0, 0.872, 0.850}, size = 1.04,
                 rotate = {axis = {1, 0, 0}, degrees = 8}}
scene:place_bone{name = "mandible_l", template = "felid_mandible", at = {0, 0.872, 0.850}, size = 1.04,
                 rotate = {axis = {1, 0, 0}, degrees = 0}}
scene:place_bone{name = "sternum", template = "felid_sternum", at = {0, 0.496, 0.400},
                 rotate = {axis = {1, 0, 0}, degrees = 79}}

-- Ribs: from the vertebra to the sternum, the last ones to the costal arch. The first vertebra: piece 6 of the withers.
for k = 1, 13 do
  local t, free = (k - 1) / 12, math.max(0, k - 7)
  local vertebra = scene:bone(k <= 6 and "withers" or "thoracic")
  local head = vertebra:landmark("rib_facet_l_" .. (k <= 6 and 7 - k or 14 - k)) + vec3(0.004, 0, 0)
  local tip = vec3(0.026 + 0.006 * k + 0.002 * free, 0.548 - 0.045 * step(0, 0.5, t) + 0.038 * free,
                   head.z - 0.025 - 0.100 * math.min(1, (k - 1) / 7))
  scene:place_bone{name = string.format("rib_%d_l", k), template = "rib", from = head, to = tip, front = {0, 0, 1},
                   thickness = 0.48 + 0.18 * step(0, 0.5, t) - 0.06 * step(0.4, 1, t)}
end

-- 3  Fore limb. Long bones lie between two joints; front is where the template's front looks.

local shoulder, elbow, wrist = vec3(0.112, 0.612, 0.535), vec3(0.120, 0.396, 0.362), vec3(0.117, 0.122, 0.400)
scene:place_bone{name = "scapula_l", template = "felid_scapula", at = shoulder + vec3(-0.004, 0.018, -0.010),
                 rotate = {axis = {1, 0, 0}, degrees = -26}}
scene:place_bone{name = "humerus_l", template = "humerus", from = shoulder, to = elbow, thickness = 1.15}
scene:place_bone{name = "ulna_l", template = "ulna", from = elbow + vec3(0.004, 0.004, -0.004),
                 to = wrist + vec3(0.016, 0.012, -0.012), thickness = 1.35}
scene:place_bone{name = "radius_l", template = "radius", from = elbow + vec3(-0.004, -0.012, 0.020),
                 to = wrist + vec3(-0.006, 0.004, 0.004), thickness = 1.25, twist = 60}
scene:place_bone{name = "carpus_l", template = "felid_carpus", at = wrist}

-- Digits 2 to 5: metacarpal or metatarsal, and two phalanges (not in the coarse model).
local function digits(of, foot, bases, knuckle, forward)
  for i = 2, 5 do
    local side = i - 3.5
    local short = (i == 2 or i == 5) and 0.012 or 0
    local a = bases + vec3(side * 0.0135, 0, 0)
    local b = knuckle + vec3(side * 0.0225, 0, -short)
    local c, d = b + vec3(side * 0.002, 0.010, 0.040), b + vec3(side * 0.003, -0.012, forward)
    scene:place_bone{name = of .. i .. "_l", template = "metacarpal", from = a, to = b, front = {0, 0, -1},
                     thickness = foot and 0.62 or 0.95}
    if not coarse then
      local toe = (foot and "toe_" or "finger_") .. i
      scene:place_bone{name = toe .. "_l", template = "phalanx", from = b, to = c, front = ventral, thickness = 1.2}
      scene:place_bone{name = toe .. "_middle_l", template = "phalanx", from = c, to = d, front = ventral,
                       thickness = 1.2}
    end
  end
end
digits("metacarpal_", false, vec3(0.119, 0.084, 0.412), vec3(0.118, 0.036, 0.462), 0.072)

-- 4  Hind limb.

local hip, knee, hock = vec3(0.070, 0.700, -0.470), vec3(0.120, 0.430, -0.325), vec3(0.113, 0.228, -0.556)
local pelvis = scene:place_bone{name = "pelvis", template = "felid_pelvis", at = {0, hip.y, hip.z},
                                rotate = {axis = {1, 0, 0}, degrees = 66}}
scene:place_bone{name = "femur_l", template = "femur", from = pelvis:landmark("hip_center_l"), to = knee,
                 thickness = 0.95}
scene:place_bone{name = "tibia_l", template = "tibia", from = knee, to = hock + vec3(-0.002, 0.004, 0.004),
                 thickness = 0.95}
scene:place_bone{name = "fibula_l", template = "fibula", from = knee + vec3(0.026, -0.030, -0.040),
                 to = hock + vec3(0.014, 0.014, -0.002), thickness = 0.95}
scene:place_bone{name = "patella_l", template = "patella", at = knee + vec3(0.000, 0.026, 0.026), size = 1.0,
                 rotate = {axis = {1, 0, 0}, degrees = 20}}
scene:place_bone{name = "tarsus_l", template = "felid_tarsus", at = hock}
digits("metatarsal_", true, vec3(0.113, 0.176, -0.545), vec3(0.113, 0.036, -0.458), 0.066)

-- 5  Joints, and the right side.

local function joint(name, parent, child, center)
  scene:add_joint{name = name, parent = parent, child = child, center = center}
end
joint("jaw_l", "skull", "mandible_l", scene:bone("skull"):landmark("jaw"))
joint("shoulder_l", "scapula_l", "humerus_l", shoulder)
joint("elbow_l", "humerus_l", "ulna_l", elbow)
joint("wrist_l", "radius_l", "carpus_l", wrist)
joint("hip_l", "pelvis", "femur_l", scene:bone("pelvis"):landmark("hip_center_l"))
joint("knee_l", "femur_l", "tibia_l", knee)
joint("hock_l", "tibia_l", "tarsus_l", hock)
scene:mirror_bones{}

-- The least distance of a bone from the skin.
local least = math.huge
for _, bone in ipairs(scene:bones()) do
  if not bone:name():match("_r$") then least = math.min(least, bone:clearance().least) end
end
return least
