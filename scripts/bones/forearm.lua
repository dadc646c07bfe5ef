-- forearm - radius and ulna, supinated (the palm to the front).
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve

-- Ulna. Origin: the axis of the elbow in the middle of the trochlea.
local olecranon = blend(7, chain{{0, -30, -13, 10}, {0, -8, -19, 9.5}, {0, 12, -18, 10}}, chain{{0, 14, -16, 9},
  {0, 15, -8, 7}},
  chain{{0, -26, -11, 10}, {-1, -21, 0, 8}, {-1, -17, 9, 6.5}}, egg({9, -20, -8}, {6, 7, 9}))  -- coronoid process
olecranon = carve(2.5, olecranon, {chain{{-30, 0, 0, 13}, {0, 0, 0, 10.2}, {30, 0, 0, 13}},  -- trochlear notch
                                   ball(20, -19, -1, 11)})                                          -- radial notch
local ulna = blend(9, olecranon,
  tube{{0, -34, -12, 9.5}, {1, -60, -11, 8}, {2, -110, -9, 7}, {0, -170, -5, 6}, {-1, -215, -2, 5.2}, {0, -243, 0, 6}})
ulna = blend(5, ulna, chain{{0, -30, 0, 5}, {1, -40, -3, 4}},                                       -- tuberosity
  -- interosseous border
  tube{{2, -35, -8, 3}, {5, -55, -7, 3}, {8, -110, -5, 2.5}, {4, -155, -3, 2.5}, {1, -195, -2, 2.5}},
  -- posterior border
  tube{{0, -10, -27, 3}, {1, -60, -18, 3}, {1, -120, -14, 2.5}, {0, -165, -6, 2.5}})
ulna = blend(3, ulna, egg({0, -249, 0}, {8.5, 6, 8.5}), chain{{-4, -250, -5, 3.5}, {-5, -259, -6, 2.6}})

kit.bone{
  name = "ulna", about = "left, supinated; origin on the axis of the elbow", kind = "cylinder",
  shape = ulna, cell = 2.8, faces = 2000, from = {0, 0, 0}, to = {0, -255, 0},
  landmarks = {
    {"olecranon", 0, 20, -26, 8}, {"olecranon_tip", 0, 24, -16, 6}, {"olecranon_lateral", 10, 4, -19, 6},
    {"olecranon_medial", -10, 4, -19, 6}, {"coronoid_process", -1, -17, 15, 5}, {"ulnar_tuberosity", 0, -36, 5, 6},
    {"trochlear_notch", 0, 0, -10, 6}, {"radial_notch", 10, -19, -4, 4}, {"supinator_crest", 9, -36, -10, 6},
    {"shaft_anterior_upper", 1, -75, -3, 9}, {"shaft_anterior", 0, -120, -2, 9},
      {"shaft_anterior_lower", -1, -205, 4, 8},
    {"shaft_posterior_upper", 1, -60, -21, 9}, {"shaft_posterior", 1, -120, -16, 9},
      {"shaft_posterior_lower", 0, -180, -11, 8},
    {"shaft_medial", -6, -90, -10, 9}, {"interosseous_border", 10, -110, -5, 9}, {"head", 8, -249, 2, 5},
    {"styloid", -5, -262, -6, 3}},
  joints = {{"elbow_center", 0, 0, 0}, {"wrist_center", 10, -262, 0}}}

-- Radius. Origin: the top of the head, on its axis.
local head = carve(2, kit.disc({0, -7, 0}, 11, 5.5, 11, 1.5), {ball(0, 12.5, 0, 14)})
local radius = blend(8,
  tube{{0, -10, 0, 6.5}, {0, -25, 0, 6.3}, {-1, -40, 0, 7}, {3, -75, 0, 7}, {8, -115, 1, 7.2}, {6, -165, 1, 7.5},
       {3, -190, 0, 9.5}, {0, -214, 0, 12.5}},
  chain{{-9, -223, 0, 10}, {8, -221, 0, 11.5}})
radius = blend(4, radius, head, egg({-6, -37, 4}, {5.5, 11, 6}),                                    -- radial tuberosity
  -- interosseous border
  tube{{-4, -55, 0, 3}, {1, -110, 0, 2.5}, {-3, -165, 0, 2.5}, {-9, -205, 0, 3}},
  chain{{11, -215, 0, 9}, {13, -230, 0, 7.5}, {14.5, -238.5, 1, 5.2}}, chain{{3, -216, -11, 3}, {4, -228, -10, 3}})
-- wrist, ulnar notch
radius = carve(3, radius, {egg({-3, -242, 1}, {20, 9.5, 12}, {0, 0, 1}, -12), ball(-27, -225, 0, 10.5)})

kit.bone{
  name = "radius", about = "left, supinated; origin on top of the head", kind = "cylinder",
  shape = radius, cell = 2.8, faces = 2000, from = {0, 0, 0}, to = {0, -236, 0},
  landmarks = {
    {"head", 11, -7, 0, 5}, {"neck", 6, -22, 0, 5}, {"radial_tuberosity", -11, -37, 7, 6},
    {"shaft_anterior_upper", 2, -75, 7, 9}, {"shaft_anterior", 7, -120, 8, 9}, {"shaft_anterior_lower", 2, -195, 9, 10},
    {"shaft_posterior_upper", 3, -80, -7, 9}, {"shaft_posterior", 8, -130, -7, 9},
      {"shaft_posterior_lower", 5, -170, -7, 8},
    {"pronator_tuberosity", 15, -115, 1, 8}, {"shaft_lateral_upper", 9, -70, 1, 8},
      {"shaft_lateral_lower", 14, -190, 1, 8},
    {"interosseous_border", -1, -110, 0, 8}, {"styloid", 19, -245, 1, 4}, {"styloid_base", 21, -226, 1, 5},
    {"dorsal_tubercle", 3, -222, -14, 4}, {"distal_anterior", 0, -225, 10, 8}},
  joints = {{"elbow_center", 0, 0, 0}, {"wrist_center", 0, -236, 0}}}
