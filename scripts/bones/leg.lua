-- leg - tibia and fibula.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve
local shape = sinew.shape

-- Tibia. Origin: the centre of the knee, between the condyles of the femur.
local top = blend(12, egg({-20, -38, -5}, {20, 17, 23}), egg({20, -38, -6}, {19, 17, 22}), egg({0, -44, 2},
  {26, 18, 20}),
  chain{{0, -50, -3, 22}, {0, -80, -4, 15}})
top = blend(8, top, tube{{3, -66, 14, 8}, {4, -76, 15, 7.5}, {4, -95, 10, 6}},                       -- tuberosity
  egg({27, -44, 8}, {8, 7, 8}), egg({29, -44, -16}, {8, 7, 7}))                                     -- Gerdy's tubercle
-- plateau at y = -25
top = shape.smooth_subtract(3, top, shape.box({0, 0, 0}, {80, 25, 80}))
top = carve(3, top, {egg({-20, -17, -4}, {17, 10, 20}), egg({20, -17, -4}, {15, 9.5, 18}),            -- its hollows
                     ball(0, -36, -36, 14)})
top = blend(4, top, chain{{-5, -27, -3, 4.5}, {-5, -22, -3, 2.2}}, chain{{5, -27, -2, 4.5}, {5, -22.5, -2, 2.2}})
local shaft = blend(9,
  tube{{0, -75, -4, 13.5}, {1, -120, -6, 10.5}, {1, -180, -5, 9.5}, {0, -240, -3, 9}, {0, -290, -1, 10.5},
    {0, -325, 0, 13},
       {-1, -358, 0, 17}},
  -- anterior border
  tube{{4, -92, 11, 4.5}, {2, -125, 9, 4}, {-1, -180, 9, 3.5}, {-4, -240, 9, 3.5}, {-6, -295, 6, 4.5},
    {-3, -330, 2, 5}},
  -- medial border
  tube{{-13, -85, -8, 5}, {-10, -140, -10, 4.5}, {-9, -200, -8, 4.5}, {-8, -280, -5, 4.5}, {-5, -325, -1, 5}},
  -- interosseous
  tube{{13, -80, -10, 5}, {11, -140, -9, 3.5}, {10, -200, -7, 3.5}, {9, -280, -3, 4}, {6, -325, 0, 5}})
local ankle = blend(8, shape.box({-3, -359, 0}, {21, 12, 16}, 8), chain{{-19, -354, 2, 9.5}, {-22, -372, 4, 8},
  {-21, -384, 4, 6}})
ankle = carve(4, ankle, {chain{{-13, -387, 1, 17}, {30, -388, 1, 19}}, chain{{29, -325, -2, 7}, {28, -380, -2, 10}}})
local tibia = blend(12, top, shaft, ankle)

kit.bone{
  name = "tibia", about = "left; origin in the centre of the knee", kind = "cylinder",
  shape = tibia, cell = 4, faces = 2600, from = {0, 0, 0}, to = {0, -388, 0},
  landmarks = {
    {"medial_condyle", -38, -38, -4, 9}, {"lateral_condyle", 37, -40, -4, 8}, {"medial_plateau", -20, -27, -4, 9},
    {"lateral_plateau", 20, -27, -4, 9}, {"intercondylar_eminence", 0, -24, -3, 5},
      {"tibial_tuberosity", 4, -76, 24, 7},
    {"gerdy", 30, -44, 16, 6}, {"pes_anserinus", -11, -95, 5, 8}, {"medial_condyle_posterior", -20, -42, -27, 8},
    {"fibular_facet", 34, -46, -19, 5}, {"soleal_line", -2, -100, -18, 9}, {"popliteal_surface", -6, -85, -19, 9},
    {"shaft_lateral_upper", 12, -100, 0, 10}, {"shaft_lateral", 9, -160, 2, 12}, {"shaft_medial", -9, -180, 2, 12},
    {"shaft_posterior", 0, -160, -16, 12}, {"shaft_posterior_medial", -8, -200, -12, 10},
      {"anterior_border", -2, -180, 13, 8},
    {"interosseous_border", 14, -180, -8, 10}, {"shaft_anterior_lower", -3, -310, 11, 9},
      {"distal_posterior", -4, -355, -15, 8},
    {"medial_malleolus", -29, -374, 4, 6}, {"malleolar_groove", -19, -374, -5, 5}, {"fibular_notch", 19, -355, -1, 6},
    {"plafond", 0, -370, 0, 8}},
  joints = {{"knee_center", 0, 0, 0}, {"ankle_center", 0, -388, 0}}}

-- Fibula. Origin: the facet on the head for the tibia.
local fibula = blend(6,
  -- head with its apex
  egg({2, -6, -1}, {11, 12, 12}), chain{{4, -2, -4, 7}, {5, 6, -5, 4.5}},
  tube{{2, -14, -1, 7.5}, {1, -35, -1, 5.8}, {2, -90, -4, 6.2}, {2, -170, -5, 6.4}, {1, -250, -3, 6}, {1, -300, 0, 6},
       {2, -325, 1, 7.5}},
  -- anterior border
  tube{{1, -30, 0, 2.2}, {1, -50, 4, 2.2}, {0, -110, 3, 2.2}, {0, -190, 2, 2.2}, {2, -270, 5, 2.2}, {5, -320, 6, 2}},
  tube{{2, -40, -2, 2.2}, {5, -65, -8, 2.2}, {8, -150, -9, 2.2}, {6, -240, -8, 2.2}, {3, -290, -2, 2.2}})
fibula = blend(6, fibula, chain{{3, -328, 1, 9}, {4, -345, 0, 9.5}, {4, -358, -2, 7}, {4, -364, -3, 5}})
fibula = carve(4, fibula, {shape.box({-30, -345, 0}, {28, 26, 40}), ball(-2, -356, -10, 4)})

kit.bone{
  name = "fibula", about = "left; origin at the joint with the tibia below the knee", kind = "cylinder",
  shape = fibula, cell = 3, faces = 1800, from = {0, 0, 0}, to = {0, -346, 0},
  landmarks = {
    {"head", 12, -5, 0, 7}, {"apex", 5, 10, -5, 4}, {"head_anterior", 3, -6, 11, 5},
      {"head_posterior", 3, -8, -13, 5}, {"neck", 7, -28, 0, 5},
    {"shaft_lateral_upper", 8, -70, -3, 9}, {"shaft_lateral", 9, -150, -5, 9}, {"shaft_lateral_lower", 7, -230, -4, 9},
    {"shaft_anterior_upper", 1, -100, 5, 8}, {"shaft_anterior", 0, -170, 4, 8}, {"shaft_anterior_lower", 2, -250, 6, 8},
    {"shaft_posterior_upper", 3, -65, -9, 8}, {"shaft_posterior", 3, -150, -11, 9},
      {"shaft_posterior_lower", 2, -220, -10, 9},
    {"shaft_medial", -5, -150, -4, 8}, {"lateral_malleolus", 14, -348, -1, 6}, {"malleolus_tip", 4, -369, -3, 4},
    {"malleolar_groove", 4, -352, -9, 4}},
  joints = {{"tibiofibular", 0, 0, 0}, {"ankle_center", -20, -350, 0}}}
