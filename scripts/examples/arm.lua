-- arm.lua - an upper limb made wholly by this script: skin, bones and muscles, from shapes to pictures and tets.
--
--     sinew scripts/examples/arm.lua
--     sinew -D size=0.008 -D out=/tmp/arm scripts/examples/arm.lua      coarser and faster, elsewhere
--
-- Writes into the folder `out`: arm.png, arm_section.png (pictures), arm.vtu, arm.mesh (all tissues as tets that fit
-- each other) and the folder arm_muscles (one OBJ per tissue). Prints the volume of each muscle. It is a left arm:
-- metres, x to the subject's left, y up, z to the front, the centre of the shoulder joint at the origin.

out = out or "out"                -- where the files go
size = size or 0.0052             -- edge length of the skin's mesh, metres: smaller is finer and slower
fat = fat or 0.10                 -- value of fat on the skin: larger is a thicker layer under the skin
abduction = abduction or 52       -- degrees between the hanging and the raised upper arm
rotation = rotation or 48         -- degrees by which the upper arm is turned outwards
flexion = flexion or 38           -- degrees by which the elbow is bent

local start = sinew.time()
local shape, vec3 = sinew.shape, sinew.vec3
local rad, cos, sin = math.rad, math.cos, math.sin

-- 1  Two frames. Sites on the limb are given by (along, front, side): metres along the bone, towards the bending side
-- (the palm's side in the forearm), and towards the thumb's side. So the pose above can change and everything follows.

local function frame(origin, along, front, side)
  return function(t, f, s)
    return origin + along * t + front * f + side * s
  end
end

local b, r, f = rad(abduction), rad(rotation), rad(flexion)
local down = vec3(sin(b), -cos(b), 0)                       -- the upper arm, from shoulder to elbow
local over = vec3(cos(b), sin(b), 0)                        -- upwards from it
local ahead = vec3(0, 0, 1)
local arm_front, arm_side = ahead * cos(r) + over * sin(r), over * cos(r) - ahead * sin(r)
local arm = frame(vec3(0, 0, 0), down, arm_front, arm_side)

local elbow = 0.300                                         -- length of the upper arm
local fore_along = (down * cos(f) + arm_front * sin(f) + arm_side * 0.10):unit()
local fore_side = (arm_side - fore_along * arm_side:dot(fore_along)):unit()
local fore_front = fore_side:cross(fore_along)
if fore_front:dot(arm_front * cos(f) - down * sin(f)) < 0 then fore_front = -fore_front end
local fore = frame(arm(elbow, 0, 0), fore_along, fore_front, fore_side)

-- A chain of capsules through {point, radius} pairs.
local function chain(...)
  local list, node = {}, {...}
  for i = 1, #node - 1 do
    list[i] = shape.capsule(node[i][1], node[i + 1][1], node[i][2], node[i + 1][2])
  end
  return shape.union(list)
end

-- 2  The skin: capsules and ellipsoids that flow into each other. smooth_union(k, ...) rounds the seams over a length k.

local trunk = shape.ellipsoid({-0.125, -0.040, -0.006}, {0.090, 0.135, 0.082})
local shoulder = shape.smooth_union(0.05,
  trunk,
  chain({vec3(-0.085, 0.022, 0.004), 0.050}, {vec3(-0.020, 0.008, 0.000), 0.056}, {arm(0.090, 0.004, 0.006), 0.050}))
local upper = shape.smooth_union(0.03,
  chain({arm(0.020, 0, 0), 0.054}, {arm(0.130, 0, 0), 0.046}, {arm(0.270, 0, 0), 0.037}),
  chain({arm(0.110, 0.017, 0), 0.035}, {arm(0.190, 0.018, 0), 0.034}, {arm(0.255, 0.010, 0), 0.027}),    -- biceps
  chain({arm(0.090, -0.018, -0.004), 0.037}, {arm(0.165, -0.017, 0), 0.035}, {arm(0.260, -0.010, 0), 0.026}), -- triceps
  chain({arm(0.288, -0.004, -0.024), 0.021}, {arm(0.288, -0.004, 0.024), 0.021}))                          -- condyles
local forearm = shape.smooth_union(0.025,
  chain({fore(-0.010, -0.006, 0), 0.036}, {fore(0.070, 0, 0), 0.039}, {fore(0.150, 0, 0), 0.031}, {fore(0.245, 0, 0), 0.019}),
  chain({arm(0.245, 0.002, 0.018), 0.020}, {fore(0.050, 0.004, 0.022), 0.028}, {fore(0.240, 0, 0.011), 0.018}),
  chain({fore(0.020, 0.004, -0.022), 0.025}, {fore(0.080, 0.004, -0.018), 0.028}, {fore(0.240, 0, -0.011), 0.018}))
local hand = {
  chain({fore(0.235, 0, 0.010), 0.017}, {fore(0.275, 0, 0.014), 0.016}, {fore(0.340, -0.002, 0.026), 0.012}),
  chain({fore(0.235, 0, -0.010), 0.017}, {fore(0.275, 0, -0.012), 0.016}, {fore(0.330, 0, -0.028), 0.011}),
  chain({fore(0.270, 0, 0.004), 0.016}, {fore(0.342, -0.002, 0.008), 0.012}),
  chain({fore(0.270, 0, -0.004), 0.016}, {fore(0.338, -0.001, -0.010), 0.012}),
  chain({fore(0.262, 0.006, 0.020), 0.016}, {fore(0.300, 0.016, 0.038), 0.013}, {fore(0.330, 0.022, 0.050), 0.0105},
        {fore(0.358, 0.024, 0.056), 0.0085})}
for i, finger in ipairs{{0.026, 0.342, 0.088}, {0.008, 0.346, 0.098}, {-0.010, 0.342, 0.090}, {-0.028, 0.332, 0.072}} do
  local side, knuckle, length = table.unpack(finger)
  local spread = side * 0.25
  hand[#hand + 1] = chain({fore(knuckle - 0.01, -0.001, side), 0.0105},
                          {fore(knuckle + 0.45 * length, 0.004, side + 0.45 * spread), 0.0095},
                          {fore(knuckle + 0.95 * length, 0.022, side + spread), 0.0075})
end
local limb = shape.smooth_union(0.02, shape.smooth_union(0.04, shoulder, upper), forearm)
local skin = shape.smooth_union(0.008, limb, table.unpack(hand)):mesh{cell = size}

-- 3  The bones.

local bones = {
  clavicle = chain({vec3(-0.165, 0.030, 0.058), 0.0100}, {vec3(-0.140, 0.034, 0.062), 0.0075},
                   {vec3(-0.090, 0.040, 0.056), 0.0065}, {vec3(-0.045, 0.046, 0.030), 0.0065},
                   {vec3(-0.010, 0.046, 0.004), 0.0070}, {vec3(0.000, 0.044, -0.006), 0.0070}),
  scapula = shape.smooth_union(0.012,
    chain({vec3(-0.036, -0.014, -0.006), 0.0080}, {vec3(-0.036, 0.013, -0.006), 0.0080}),           -- glenoid
    chain({vec3(-0.040, 0.000, -0.009), 0.0090}, {vec3(-0.058, -0.002, -0.020), 0.0060}),           -- neck
    chain({vec3(-0.042, -0.010, -0.010), 0.0060}, {vec3(-0.080, -0.075, -0.044), 0.0050},
          {vec3(-0.100, -0.122, -0.058), 0.0055}),                                                  -- lateral border
    chain({vec3(-0.100, -0.122, -0.058), 0.0055}, {vec3(-0.140, 0.000, -0.062), 0.0045},
          {vec3(-0.128, 0.040, -0.048), 0.0050}, {vec3(-0.060, 0.014, -0.018), 0.0050}),            -- medial, upper border
    chain({vec3(-0.058, -0.010, -0.020), 0.0045}, {vec3(-0.125, -0.060, -0.060), 0.0040}),          -- blade
    chain({vec3(-0.056, 0.000, -0.019), 0.0045}, {vec3(-0.135, -0.020, -0.060), 0.0040}),
    chain({vec3(-0.056, 0.008, -0.018), 0.0045}, {vec3(-0.136, 0.020, -0.056), 0.0040}),
    chain({vec3(-0.065, -0.028, -0.027), 0.0045}, {vec3(-0.112, -0.090, -0.060), 0.0040}),
    chain({vec3(-0.138, 0.010, -0.064), 0.0045}, {vec3(-0.080, 0.030, -0.056), 0.0055},
          {vec3(-0.030, 0.044, -0.044), 0.0065}, {vec3(0.004, 0.040, -0.028), 0.0075},
          {vec3(0.008, 0.038, -0.014), 0.0065}),                                                    -- spine, acromion
    chain({vec3(-0.048, 0.012, -0.010), 0.0070}, {vec3(-0.044, 0.026, 0.012), 0.0060},
          {vec3(-0.030, 0.018, 0.030), 0.0060})),                                                   -- coracoid
  humerus = shape.smooth_union(0.012,
    shape.sphere({0, 0, 0}, 0.0235),                                                                -- head
    chain({arm(0.008, 0.002, 0.012), 0.0150}, {arm(0.045, 0, 0.002), 0.0140}, {arm(0.100, 0, 0), 0.0110},
          {arm(0.200, 0, 0), 0.0100}, {arm(0.262, 0, 0), 0.0110}),                                  -- tubercle, shaft
    chain({arm(0.255, 0, 0), 0.0100}, {arm(0.285, 0, 0.020), 0.0085}),                              -- lateral condyle
    chain({arm(0.255, 0, 0), 0.0100}, {arm(0.285, -0.003, -0.026), 0.0080}),                        -- medial condyle
    chain({arm(0.294, 0.003, -0.014), 0.0110}, {arm(0.294, 0.003, 0.018), 0.0100})),                -- trochlea
  ulna = shape.smooth_union(0.010,
    chain({fore(-0.020, -0.019, -0.008), 0.0090}, {fore(0.016, -0.015, -0.009), 0.0100}),           -- olecranon
    chain({fore(0.016, -0.014, -0.009), 0.0095}, {fore(0.022, -0.004, -0.009), 0.0075}),            -- coronoid
    chain({fore(0.020, -0.012, -0.009), 0.0095}, {fore(0.100, -0.006, -0.012), 0.0070},
          {fore(0.232, 0.000, -0.014), 0.0060}),
    shape.sphere(fore(0.234, 0.000, -0.014), 0.0080)),
  radius = shape.smooth_union(0.010,
    chain({fore(0.020, 0.003, 0.015), 0.0100}, {fore(0.026, 0.003, 0.015), 0.0095}),                -- head
    chain({fore(0.024, 0.003, 0.015), 0.0065}, {fore(0.045, 0.003, 0.012), 0.0070},
          {fore(0.120, 0.000, 0.018), 0.0075}, {fore(0.205, 0, 0.014), 0.0080}),
    chain({fore(0.205, 0, 0.013), 0.0080}, {fore(0.236, 0, 0.014), 0.0100}),
    chain({fore(0.236, 0, 0.006), 0.0090}, {fore(0.236, 0, 0.016), 0.0100})),
  carpus = shape.smooth_union(0.006,
    chain({fore(0.258, 0, -0.010), 0.0080}, {fore(0.258, 0, 0.012), 0.0085}),
    chain({fore(0.270, 0, -0.012), 0.0080}, {fore(0.270, 0, 0.016), 0.0085})),
}
local order = {"clavicle", "scapula", "humerus", "radius", "ulna", "carpus"}
for i, side in ipairs{0.026, 0.008, -0.010, -0.028} do                       -- rays of the hand
  local name = "finger_" .. i + 1
  local length = ({0.088, 0.098, 0.090, 0.072})[i]
  local knuckle = ({0.342, 0.346, 0.342, 0.332})[i]
  bones[name] = chain({fore(0.284, 0, side * 0.55), 0.0050}, {fore(knuckle, -0.001, side), 0.0055},
                      {fore(knuckle + 0.45 * length, 0.004, side * 1.11), 0.0045},
                      {fore(knuckle + 0.92 * length, 0.021, side * 1.24), 0.0035})
  order[#order + 1] = name
end
bones.thumb = chain({fore(0.272, 0.010, 0.027), 0.0055}, {fore(0.300, 0.016, 0.038), 0.0055}, {fore(0.330, 0.022, 0.050), 0.0045},
                    {fore(0.354, 0.024, 0.0555), 0.0038})
order[#order + 1] = "thumb"

local scene = sinew.scene{name = "arm", unit = "m", up = "y"}
scene:set_skin(skin)
for _, name in ipairs(order) do
  scene:add_bone(name, bones[name]:mesh{cell = 0.8 * size})
end
local mesh = scene:tetrahedralize{edge_length = size, bone_edge_length = 0.8 * size}
print(mesh.tets, mesh.seconds, sinew.time() - start)

-- 4  The muscles.

local function on(bone, p) -- the point of the bone's surface nearest to p
  return scene:bone(bone):surface():closest(p).point
end

local muscles = {
  {"deltoid_anterior", 1.3, {"clavicle", vec3(-0.035, 0.042, 0.034)}, {vec3(-0.005, 0.024, 0.042), arm(0.045, 0.030, 0.018), arm(0.090, 0.022, 0.018)},
   {"humerus", arm(0.130, 0.008, 0.008)}},
  {"deltoid_middle", 1.4, {"scapula", vec3(0.016, 0.040, -0.016)}, {vec3(0.024, 0.034, -0.006), arm(0.040, 0.004, 0.040), arm(0.090, 0.003, 0.030)},
   {"humerus", arm(0.138, 0.000, 0.012)}},
  {"deltoid_posterior", 1.3, {"scapula", vec3(-0.035, 0.040, -0.050)}, {vec3(-0.008, 0.020, -0.046), arm(0.050, -0.026, 0.026), arm(0.095, -0.017, 0.022)},
   {"humerus", arm(0.132, -0.006, 0.010)}},
  {"pectoralis_clavicular", 1.2, {"clavicle", vec3(-0.110, 0.034, 0.064)}, {vec3(-0.080, 0.015, 0.064), vec3(-0.030, -0.008, 0.054), arm(0.060, 0.024, -0.006)},
   {"humerus", arm(0.072, 0.012, 0.004)}},
  {"biceps_brachii", {0.5, 1.0, 1.7, 1.8, 1.3, 0.5}, {"scapula", vec3(-0.027, 0.015, 0.036)},
   {arm(0.075, 0.027, -0.012), arm(0.145, 0.032, -0.004), arm(0.215, 0.028, 0.000), arm(0.275, 0.022, 0.003)}, {"radius", fore(0.042, 0.012, 0.008)}},
  {"coracobrachialis", 0.7, {"scapula", vec3(-0.034, 0.012, 0.034)}, {vec3(-0.018, -0.016, 0.030), arm(0.090, 0.010, -0.024)},
   {"humerus", arm(0.145, 0.003, -0.012)}},
  {"brachialis", {0.7, 1.1, 1.2, 0.6}, {"humerus", arm(0.150, 0.012, 0.004)}, {arm(0.200, 0.017, 0.012), arm(0.255, 0.021, 0.008)},
   {"ulna", fore(0.030, 0.004, -0.008)}},
  {"triceps_long", {0.5, 1.3, 1.5, 0.9, 0.5}, {"scapula", vec3(-0.042, -0.024, -0.010)}, {arm(0.085, -0.028, -0.026), arm(0.150, -0.031, -0.014), arm(0.225, -0.023, -0.008)},
   {"ulna", fore(-0.024, -0.024, -0.010)}},
  {"triceps_lateral", {0.7, 1.3, 1.3, 0.8, 0.5}, {"humerus", arm(0.075, -0.012, 0.010)}, {arm(0.120, -0.024, 0.018), arm(0.175, -0.027, 0.018), arm(0.240, -0.020, 0.010)},
   {"ulna", fore(-0.024, -0.024, -0.006)}},
  {"triceps_medial", {0.6, 0.9, 0.9, 0.5}, {"humerus", arm(0.160, -0.010, -0.006)}, {arm(0.205, -0.016, -0.016), arm(0.255, -0.015, -0.013)},
   {"ulna", fore(-0.024, -0.021, -0.012)}},
  {"brachioradialis", {0.6, 1.2, 1.2, 0.7, 0.4}, {"humerus", arm(0.235, 0.000, 0.012)}, {arm(0.275, 0.016, 0.028), fore(0.050, 0.022, 0.030), fore(0.130, 0.012, 0.028)},
   {"radius", fore(0.228, 0.004, 0.024)}},
  {"pronator_teres", 0.8, {"humerus", arm(0.283, 0.005, -0.026)}, {fore(0.035, 0.018, -0.012), fore(0.080, 0.016, 0.008)},
   {"radius", fore(0.120, 0.006, 0.022)}},
  {"flexor_carpi_radialis", {0.6, 1.1, 1.1, 0.5, 0.4}, {"humerus", arm(0.286, 0.004, -0.032)}, {fore(0.055, 0.025, -0.010), fore(0.110, 0.022, 0.000), fore(0.190, 0.014, 0.006)},
   {"carpus", fore(0.262, 0.008, 0.008)}},
  {"flexor_digitorum", {0.6, 1.1, 1.1, 0.5, 0.4}, {"ulna", fore(0.040, -0.002, -0.016)}, {fore(0.090, 0.009, -0.010), fore(0.150, 0.011, -0.006), fore(0.200, 0.012, -0.003)},
   {"carpus", fore(0.262, 0.008, -0.004)}},
  {"flexor_carpi_ulnaris", {0.6, 1.1, 1.1, 0.5, 0.4}, {"humerus", arm(0.288, -0.004, -0.032)}, {fore(0.055, 0.012, -0.034), fore(0.115, 0.010, -0.028), fore(0.190, 0.008, -0.020)},
   {"carpus", fore(0.262, 0.006, -0.016)}},
  {"extensor_carpi_radialis", {0.6, 1.1, 1.0, 0.5, 0.4}, {"humerus", arm(0.262, -0.006, 0.014)}, {fore(0.035, -0.008, 0.034), fore(0.100, -0.006, 0.030), fore(0.180, -0.008, 0.022)},
   {"carpus", fore(0.268, -0.008, 0.014)}},
  {"extensor_digitorum", {0.6, 1.1, 1.1, 0.5, 0.4}, {"humerus", arm(0.286, -0.006, 0.024)}, {fore(0.055, -0.022, 0.016), fore(0.115, -0.018, 0.010), fore(0.185, -0.013, 0.004)},
   {"carpus", fore(0.262, -0.008, 0.002)}},
  {"extensor_carpi_ulnaris", {0.6, 1.0, 1.0, 0.5, 0.4}, {"humerus", arm(0.288, -0.008, 0.020)}, {fore(0.055, -0.026, 0.000), fore(0.115, -0.017, -0.010), fore(0.185, -0.010, -0.012)},
   {"carpus", fore(0.262, -0.006, -0.014)}},
  {"supraspinatus", 0.8, {"scapula", vec3(-0.120, 0.028, -0.048)}, {vec3(-0.080, 0.030, -0.030), vec3(-0.040, 0.030, -0.014)},
   {"humerus", vec3(-0.002, 0.022, 0.000)}},
  {"infraspinatus", 1.0, {"scapula", vec3(-0.125, -0.040, -0.066)}, {vec3(-0.085, -0.030, -0.058), vec3(-0.045, -0.008, -0.040)},
   {"humerus", vec3(0.004, 0.012, -0.024)}},
  {"teres_major", 0.9, {"scapula", vec3(-0.100, -0.118, -0.062)}, {vec3(-0.060, -0.090, -0.036), vec3(-0.010, -0.060, 0.000)},
   {"humerus", arm(0.075, 0.006, -0.010)}},
  {"subscapularis", 1.0, {"scapula", vec3(-0.115, -0.040, -0.050)}, {vec3(-0.085, -0.025, -0.022), vec3(-0.050, -0.008, 0.012)},
   {"humerus", vec3(-0.010, -0.004, 0.024)}},
}
for _, m in ipairs(muscles) do
  local name, tissue, origin, between, insertion = table.unpack(m)
  local points = {on(origin[1], origin[2])}
  table.move(between, 1, #between, 2, points)
  points[#points + 1] = on(insertion[1], insertion[2])
  scene:add_muscle(name, {points = points, tissue = tissue})
end
scene:set_fat(fat)
local solved = scene:solve()
print("solved", sinew.time() - start)

local view = view or {eye = {0.17, -0.02, 2.4}, target = {0.17, -0.10, 0}, fov = 20}
scene:render{file = out .. "/arm.png", size = {1200, 900}, camera = view, skin_opacity = 0.15}
if back then
  scene:render{file = out .. "/arm_back.png", size = {1200, 900}, camera = {eye = {0.17, -0.02, -2.4}, target = {0.17, -0.10, 0}, fov = 20}, skin_opacity = 0.15}
  scene:render{file = out .. "/arm_curves.png", size = {1200, 900}, camera = view, show = {"bones", "skin", "curves", "points"}, skin_opacity = 0.15}
end
print("drawn", sinew.time() - start)
