-- humerus - the bone of the upper arm. Origin: the centre of the head.
local kit = dofile((arg[0]:match("^.*/") or "") .. "kit.lua")
local ball, egg, chain, tube, blend, carve = kit.ball, kit.egg, kit.chain, kit.tube, kit.blend, kit.carve

local shaft = tube{{12, -28, 2, 18}, {12, -50, 2, 14.5}, {11, -90, 2, 11.8}, {8, -140, 2, 10.8}, {5, -190, 0, 10.2},
                   {2, -235, -2, 10.2}, {0, -262, -2, 10}}
local upper = blend(7, egg({22, 2, 1}, {11, 17, 15}),                                         -- greater tubercle
  egg({9, -5, 18}, {8, 13, 9}), chain{{4, -4, 0, 19}, {11, -28, 2, 17}})                      -- lesser tubercle
upper = blend(3, upper, ball(0, 0, 0, 23))
-- crests of the tubercles
local ridges = blend(5, tube{{22, -18, 12, 5}, {19, -55, 10, 4}, {15, -95, 8, 3.5}},
                     tube{{7, -22, 18, 5}, {8, -50, 12, 3.5}, {7, -75, 9, 3}})
local lower = kit.fan(6.5, {3, -205, -1}, {{-30, -283, -3}, {-10, -292, -1}, {8, -292, -1}, {24, -282, -2}})
lower = blend(6, lower,
  chain{{-14, -279, -2, 10}, {-30, -285, -5, 8}, {-35, -288, -6, 6.5}},                       -- medial epicondyle
  chain{{15, -280, -1, 9}, {23, -284, -3, 6.5}})                                              -- lateral epicondyle
lower = blend(2.5, lower,
  -- trochlea
  kit.chain{{-25, -302, 1, 13}, {-21, -301, 1, 12.5}, {-11, -300, 1, 8.8}, {-3, -300, 1, 9.8}, {1, -300, 1, 9.8}},
  egg({13, -298, 5}, {9.5, 11, 11}))                                                          -- capitulum
lower = carve(3, lower, {egg({-5, -282, -15}, {12, 11, 11}), egg({-7, -282, 14}, {10, 7.5, 9}), -- olecranon, coronoid,
                         egg({13, -280, 15}, {7, 6, 8})})                                     -- radial fossa
local bone = blend(9, shaft, upper, lower)
bone = blend(8, bone, ridges, tube{{17, -100, 5, 5}, {18.5, -124, 4, 5.5}, {13, -150, 4, 5}})   -- deltoid tuberosity
-- its groove
bone = carve(3, bone, {tube{{16, 22, 20, 3.5}, {16, -5, 21, 3.5}, {14.5, -30, 19, 3}, {12, -75, 16.5, 3}}})

kit.bone{
  name = "humerus", about = "left; origin in the centre of the head", kind = "cylinder",
  shape = bone, cell = 3.4, faces = 2800, from = {0, 0, 0}, to = {0, -300, 0},
  landmarks = {
    {"head", -14, 14, -10, 12}, {"greater_tubercle", 32, 6, 2, 9}, {"greater_tubercle_superior", 20, 19, 6, 6},
    {"greater_tubercle_middle", 26, 16, -6, 6}, {"greater_tubercle_inferior", 27, 4, -12, 6},
    {"lesser_tubercle", 9, -2, 27, 7}, {"bicipital_groove", 14, -8, 17, 5},
    {"greater_tubercle_crest", 19, -55, 14, 9}, {"lesser_tubercle_crest", 7, -55, 15, 8},
    {"surgical_neck", 12, -45, -12, 10}, {"deltoid_tuberosity", 23, -124, 5, 9},
    {"coracobrachialis_insertion", -2, -140, 5, 8}, {"shaft_anterior", 6, -190, 10, 14},
    {"shaft_anterior_lower", 3, -235, 8, 12}, {"shaft_posterior_upper", 12, -75, -11, 10},
    {"shaft_posterior", 6, -160, -9, 12}, {"shaft_posterior_lower", 3, -215, -11, 12},
    {"shaft_lateral", 18, -160, 2, 8}, {"shaft_medial", -4, -170, 2, 8},
    {"lateral_supracondylar_ridge", 17, -248, -2, 8}, {"medial_supracondylar_ridge", -17, -255, -3, 8},
    {"lateral_epicondyle", 29, -285, -3, 6}, {"medial_epicondyle", -41, -289, -6, 6},
    {"lateral_epicondyle_anterior", 25, -286, 4, 5}, {"medial_epicondyle_anterior", -33, -287, 1, 6},
    {"lateral_epicondyle_posterior", 24, -286, -9, 5}, {"medial_epicondyle_posterior", -32, -287, -12, 5},
    {"trochlea", -10, -309, 1, 7}, {"capitulum", 13, -299, 16, 6}, {"olecranon_fossa", -5, -282, -5, 6}},
  joints = {{"shoulder_center", 0, 0, 0}, {"elbow_center", 0, -300, 0}}}
