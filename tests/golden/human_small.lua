-- The example human on a coarse mesh, with the body that it makes itself: what it writes to human.txt is compared.
coarse = true
local folder = out
local say = print
print = function() end -- its times differ from run to run
local human = dofile("scripts/examples/human.lua")
print = say

local function expect(ok, what) if not ok then error(what, 2) end end
local skeleton, scene, half, both = human.skeleton, human.scene, human.half, human.both
local n = #scene:muscles()
expect(n >= 30, "fewer than 30 muscles on a side")
expect(#both:names() == 2 * n + 1, "not every muscle has its image")
for _, x in ipairs{half, both} do
    local c = x:check()
    expect(c.conforming and c.manifold and c.positive and c.volume_error < 1e-9, "the tets do not fit each other")
end
for _, muscle in ipairs(scene:muscles()) do
    local name = muscle:name()
    local v, l = half:part(name):volume(), both:part(name):volume()
    local r = both:part((name:gsub("_l$", "_r"))):volume()
    expect(v > 0, name .. " has no volume")
    expect(math.abs(l - v) < 1e-9 * v and math.abs(r - v) < 1e-9 * v, name .. " differs from its image")
end
local fat = both:part("fat"):volume()
expect(math.abs(fat - 2 * half:part("fat"):volume()) < 1e-9 * fat, "the fat is not doubled")

-- Bones: both sides, inside the skin, the limbs one below the other.
local function center(name)
    local box = skeleton:bone(name):surface():bounds()
    return (box.min + box.max) * 0.5
end
for _, bone in ipairs(skeleton:bones()) do
    local name = bone:name()
    expect(bone:clearance{}.least > 0, name .. " comes out of the skin")
    if name:match("_l$") then
        local c, m = center(name), center((name:gsub("_l$", "_r")))
        expect(math.abs(c.x + m.x) < 1e-9 and math.abs(c.y - m.y) < 1e-9, name .. " has no image")
    end
end
for _, chain in ipairs{{"skull", "C1", "C7", "T1", "T12", "L1", "L5", "pelvis", "femur_l", "patella_l", "tibia_l", "foot_l"},
                       {"clavicle_l", "humerus_l", "radius_l", "hand_l"}} do
    for i = 2, #chain do
        expect(center(chain[i]).y < center(chain[i - 1]).y, chain[i] .. " does not lie below " .. chain[i - 1])
    end
end
for from, to in pairs{["human.txt"] = "human.txt", ["skeleton.png"] = "human_small.png"} do -- where they are compared
    assert(os.rename(folder .. "/human/" .. from, folder .. "/" .. to))
end
print(#skeleton:bones(), 2 * n, #skeleton:joints())
