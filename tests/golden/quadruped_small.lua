-- The example lioness on a coarse mesh: how many muscles there are, that they fit each other, and that the other side
-- is the image of this one. Of the pictures the skeleton is compared, of the volumes those of large muscles.
coarse = true
local say = print
print = function() end -- its times differ from run to run
local made = dofile("scripts/examples/quadruped.lua")
print = say
assert(os.rename(out .. "/skeleton.png", out .. "/quadruped_skeleton.png"))
for _, name in ipairs{"muscles.png", "quarter.png", "sections.png", "quadruped.txt"} do
  os.remove(out .. "/" .. name)
end

local half, both = made.half:check(), made.both:check()
print("muscles on one side", #made.muscles)
print("half fits", half.conforming, half.manifold, half.positive, half.volume_error < 1e-9)
print("both fit", both.conforming, both.positive, both.volume_error < 1e-9)
local all, images = true, true
for _, name in ipairs(made.muscles) do
  local volume = made.half:part(name):volume()
  local image = made.both:part((name:gsub("_l$", "_r"))):volume()
  all = all and volume > 0
  images = images and math.abs(image - volume) < 1e-9 * volume
end
print("every muscle has a volume, its image the same", all, images)
local fat = made.both:part("fat"):volume() / made.half:part("fat"):volume()
print("fat of both sides over fat of one", string.format("%.6f", fat))
for _, name in ipairs{"latissimus_dorsi_l", "obliquus_externus_abdominis_l", "biceps_femoris_l", "longissimus_l",
                      "rectus_abdominis_l", "pectoralis_profundus_l", "triceps_brachii_l"} do
  print(name, string.format("%.0f cm3", made.half:part(name):volume() * 1e6))
end
assert(#made.muscles >= 39)
