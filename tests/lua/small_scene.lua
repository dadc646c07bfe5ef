-- small_scene - a limb of some thousand tets: skin, two bones, two muscles. y is up, the long axis.
local shape = sinew.shape

local skin = shape.ellipsoid({0, 0, 0}, {1, 2, 1}):mesh{cell = 0.3}
local bones = {
    upper = shape.capsule({0, 0.1, 0}, {0, 1.2, 0}, 0.2):mesh{cell = 0.2},
    lower = shape.capsule({0, -1.2, 0}, {0, -0.2, 0}, 0.2):mesh{cell = 0.2},
}
local edge_length = 0.4

-- parts: "skin", "bones", "muscles": how far to build; all by default.
return function(parts)
    local s = sinew.scene{name = "limb", unit = "cm"}
    s:set_skin(skin)
    if parts == "skin" then return s end
    s:add_bone("upper", bones.upper)
    s:add_bone("lower", bones.lower)
    if parts == "bones" then return s end
    s:tetrahedralize{edge_length = edge_length}
    s:add_muscle("flexor", {points = {{0, -1, 0.5}, {0, -0.3, 0.6}, {0, 0.3, 0.6}, {0, 1, 0.5}}})
    s:add_muscle("extensor", {points = {{0, -1, -0.5}, {0, 0, -0.6}, {0, 1, -0.5}}, tissue = {1, 1.5, 1}})
    return s
end
