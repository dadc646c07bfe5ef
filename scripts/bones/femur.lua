-- femur - the thigh bone. Origin: the centre of the head.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve

local shaft = tube({{47, -62, -8, 16}, {43, -100, -3, 14}, {36, -160, 7, 12.8}, {26, -230, 11, 12.5},
                    {16, -300, 8, 13.5}, {7, -355, 1, 17}, {2, -392, -3, 21}})
local upper = blend(9,
  chain{{44, -64, -8, 16}, {50, -48, -10, 15}},
  chain{{2, -2, 0, 15}, {24, -20, -4, 14}, {46, -42, -8, 15}},                               -- neck
  tube{{54, -16, -20, 7}, {58, -22, -14, 11}, {61, -38, -9, 11}, {57, -58, -7, 10}})         -- greater trochanter
-- its tip, over the fossa
upper = blend(5, upper, tube{{58, -14, -18, 7}, {53, -11, -22, 5.5}})
upper = carve(6, upper, {ball(44, -18, -25, 9)})                                             -- trochanteric fossa
upper = blend(4, upper, chain{{54, -30, -24, 4.5}, {42, -55, -24, 4}, {31, -70, -23, 5}})     -- intertrochanteric crest
upper = blend(7, upper, chain{{36, -76, -14, 10}, {27, -73, -23, 7.5}})                      -- lesser trochanter
upper = blend(3, upper, ball(0, 0, 0, 24))                                                   -- head
local lower = blend(12,
  egg({-24, -424, -8}, {15, 24, 30}, {0, 1, 0}, 7), egg({25, -422, -8}, {15.5, 23, 31}, {0, 1, 0}, -4),
  egg({2, -410, 8}, {29, 22, 19}), chain{{2, -385, -4, 19}, {2, -405, -4, 22}})
lower = blend(8, lower, ball(-36, -412, -6, 10), ball(36, -414, -8, 9))                       -- epicondyles
lower = carve(5, lower, {
  egg({0, -442, -28}, {11, 24, 30}, {1, 0, 0}, -18),                                         -- intercondylar notch
  tube{{2, -462, 22, 13}, {1, -430, 41, 15}, {1, -395, 42, 14}},                             -- patellar surface
  egg({0, -382, -30}, {17, 24, 12})})                                                        -- popliteal surface
local bone = blend(10, shaft, upper, lower)
local ridge = tube{{51, -80, -19, 3}, {44, -115, -15.5, 3}, {36, -165, -7.5, 3.4}, {26, -230, -3, 3.6},
                   {19, -280, -6, 3.2}, {14, -325, 0, 4}}
local flare = kit.fan(6, {10, -315, -1}, {{-35, -400, -9}, {0, -395, -4}, {36, -402, -9}})
bone = blend(7, blend(14, bone, flare), ridge, ball(-40, -397, -12, 4.5))   -- linea aspera, adductor tubercle

kit.bone{
  name = "femur", about = "left; origin in the centre of the head, y along the mechanical axis", kind = "cylinder",
  shape = bone, cell = 4.2, faces = 3200, from = {0, 0, 0}, to = {0, -430, 0},
  landmarks = {
    {"head", -10, 18, 4, 12}, {"neck", 24, -8, 4, 10}, {"greater_trochanter", 70, -28, -10, 12},
    {"greater_trochanter_tip", 55, -4, -20, 7}, {"greater_trochanter_anterior", 64, -36, 4, 8},
    {"trochanteric_fossa", 46, -16, -17, 5}, {"intertrochanteric_crest", 44, -52, -28, 7},
    {"quadrate_tubercle", 42, -56, -28, 6}, {"intertrochanteric_line", 40, -50, 8, 8},
    {"lesser_trochanter", 25, -73, -29, 8}, {"pectineal_line", 40, -92, -18, 8},
    {"gluteal_tuberosity", 54, -95, -18, 10}, {"linea_aspera_upper", 44, -120, -19, 10},
    {"linea_aspera_middle", 31, -200, -9, 10}, {"linea_aspera_lower", 18, -290, -10, 10},
    {"shaft_anterior_upper", 42, -120, 14, 14}, {"shaft_anterior", 28, -220, 24, 16},
    {"shaft_anterior_lower", 16, -310, 21, 12}, {"shaft_lateral", 42, -200, 8, 14},
    {"shaft_medial", 18, -220, 10, 14}, {"supracondylar_line_medial", -14, -352, -17, 8},
    {"supracondylar_line_lateral", 21, -350, -19, 8}, {"popliteal_surface", 0, -375, -22, 10},
    {"adductor_tubercle", -39, -393, -14, 5}, {"medial_epicondyle", -46, -412, -6, 8},
    {"lateral_epicondyle", 45, -414, -8, 8}, {"medial_condyle", -25, -448, -8, 10},
    {"lateral_condyle", 26, -445, -8, 10}, {"medial_condyle_posterior", -22, -422, -38, 9},
    {"lateral_condyle_posterior", 24, -420, -38, 9}, {"popliteal_groove", 39, -424, -16, 5},
    {"patellar_surface", 1, -418, 26, 10}, {"intercondylar_fossa", 0, -424, -14, 7}},
  joints = {{"hip_center", 0, 0, 0}, {"knee_center", 0, -430, 0}}}
