-- skin.lua - the skin of a standing lioness, from capsules and ellipsoids blended into each other.
-- Metres; x to the left, y up, z to the head. The left half is written down; the right one is its image.
local here = ...
local kit = dofile(here .. "kit.lua")
local shape, chain, both = sinew.shape, kit.chain, kit.both

-- Trunk and neck are deeper than wide: chains of circles, made narrow.
local trunk = chain{{0, 0.675, 0.58, 0.185}, {0, 0.690, 0.48, 0.230}, {0, 0.675, 0.32, 0.240}, {0, 0.680, 0.05, 0.215},
                    {0, 0.705, -0.22, 0.180}, {0, 0.715, -0.42, 0.175}, {0, 0.720, -0.54, 0.125}}
local neck = chain{{0, 0.720, 0.54, 0.180}, {0, 0.800, 0.70, 0.145}, {0, 0.855, 0.82, 0.125}, {0, 0.88, 0.90, 0.10}}
local axial = shape.union(trunk:transform{scale = {0.70, 1, 1}}, neck:transform{scale = {0.82, 1, 1}})

local head = shape.smooth_union(0.035,
  shape.ellipsoid({0, 0.902, 0.925}, {0.108, 0.090, 0.120}),                                    -- brain and temples
  both(chain{{0.072, 0.850, 0.905, 0.062}, {0.074, 0.840, 0.995, 0.057}}),                      -- cheeks
  chain{{0, 0.905, 0.990, 0.068}, {0, 0.880, 1.090, 0.050}, {0, 0.872, 1.128, 0.042}},          -- bridge of the nose
  both(chain{{0.030, 0.832, 1.060, 0.052}, {0.028, 0.828, 1.112, 0.046}}),                      -- muzzle
  chain{{0, 0.782, 0.980, 0.048}, {0, 0.778, 1.110, 0.042}})                                    -- lower jaw, chin
local nose = shape.ellipsoid({0, 0.872, 1.155}, {0.030, 0.020, 0.022})
local ear = shape.subtract(shape.ellipsoid({0, 0, 0}, {0.042, 0.048, 0.020}),
                           shape.ellipsoid({0, 0.006, 0.020}, {0.028, 0.034, 0.016}))
ear = ear:transform{rotate = {axis = {0, 1, 0}, degrees = 25}, translate = {0.080, 0.992, 0.885}}

local fore = shape.smooth_union(0.05,
  chain{{0.068, 0.840, 0.440, 0.082}, {0.105, 0.690, 0.480, 0.085}, {0.112, 0.610, 0.530, 0.085}},   -- shoulder
  chain{{0.105, 0.640, 0.400, 0.090}, {0.118, 0.500, 0.380, 0.085}, {0.122, 0.410, 0.345, 0.060}},   -- triceps
  chain{{0.112, 0.600, 0.520, 0.085}, {0.122, 0.480, 0.430, 0.075}, {0.124, 0.390, 0.380, 0.068},    -- upper arm
        {0.122, 0.310, 0.380, 0.062}, {0.118, 0.180, 0.392, 0.047}, {0.117, 0.110, 0.396, 0.048},    -- forearm
        {0.117, 0.060, 0.430, 0.040}})
local paw = shape.ellipsoid({0.118, 0.040, 0.462}, {0.056, 0.044, 0.080})
local hind = shape.smooth_union(0.05,
  chain{{0.070, 0.730, -0.460, 0.110}, {0.105, 0.580, -0.410, 0.110}, {0.122, 0.440, -0.345, 0.070}}, -- thigh
  chain{{0.072, 0.700, -0.575, 0.075}, {0.098, 0.540, -0.520, 0.078}, {0.112, 0.400, -0.455, 0.055}}, -- hamstrings
  chain{{0.122, 0.430, -0.340, 0.070}, {0.120, 0.350, -0.420, 0.064}, {0.114, 0.255, -0.535, 0.042},  -- crus
        {0.113, 0.215, -0.560, 0.040}, {0.113, 0.120, -0.515, 0.043}, {0.113, 0.060, -0.485, 0.044}},
  chain{{0.113, 0.380, -0.480, 0.035}, {0.115, 0.275, -0.595, 0.030}, {0.113, 0.230, -0.575, 0.030}}) -- heel
local hind_paw = shape.ellipsoid({0.114, 0.038, -0.448}, {0.052, 0.042, 0.080})
local toes = {}
for i = 0, 3 do
  local x, back = 0.080 + 0.025 * i, (i == 0 or i == 3) and 0.014 or 0
  toes[#toes + 1] = chain{{x, 0.040, 0.490 - back, 0.024}, {x, 0.026, 0.535 - back, 0.024}}
  toes[#toes + 1] = chain{{x - 0.003, 0.038, -0.410 - back, 0.023}, {x - 0.003, 0.025, -0.372 - back, 0.023}}
end

local tail = chain{{0, 0.770, -0.560, 0.075}, {0, 0.745, -0.660, 0.048}, {0, 0.660, -0.750, 0.038},
                   {0, 0.500, -0.815, 0.032}, {0, 0.360, -0.865, 0.029}, {0, 0.280, -0.940, 0.028},
                   {0, 0.268, -1.040, 0.030}}
local tuft = shape.ellipsoid({0, 0.272, -1.080}, {0.042, 0.042, 0.075})

local legs = both(shape.smooth_union(0.030, fore, paw, hind, hind_paw, shape.union(toes)))
return shape.smooth_union(0.012,
  shape.smooth_union(0.055, shape.smooth_union(0.10, axial, tail), legs, head), tuft, nose, both(ear))
