-- viscera.lua - what fills chest, belly, pelvis and throat, as one body.
local here, scene = ...
local chain = dofile(here .. "kit.lua").chain
local organs = chain{{0, 0.800, 0.845, 0.022}, {0, 0.745, 0.740, 0.026}, {0, 0.680, 0.620, 0.034},
                     {0, 0.640, 0.490, 0.062}, {0, 0.632, 0.360, 0.098}, {0, 0.628, 0.200, 0.120},
                     {0, 0.632, 0.040, 0.122}, {0, 0.660, -0.150, 0.104}, {0, 0.690, -0.330, 0.070},
                     {0, 0.735, -0.480, 0.032}}
scene:add_bone("viscera", organs:transform{scale = {0.92, 1, 1}}:mesh{cell = 0.025})
