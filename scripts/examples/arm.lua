-- arm.lua - an upper limb made wholly by this script: skin, bones and muscles, from shapes to pictures and tets.
--
--     sinew scripts/examples/arm.lua
--     sinew -D size=0.007 -D out=/tmp scripts/examples/arm.lua          finer (arm.png here), into another folder
--     sinew -D flexion=45 scripts/examples/arm.lua                      another pose
--
-- Writes into the folder `out`: arm.png, arm_section.png, arm_across.png, arm_fibers.png (pictures), arm.vtu and
-- arm.mesh (all tissues as tets that fit each other, with fibers), arm_muscles (a folder: one OBJ for each tissue) and
-- arm.txt (volumes and fibers, printed too). It is a left arm. Metres; x to the subject's left, y up, z to the front;
-- the shoulder joint is at the origin.

out = out or "out"                -- where the files go; made when missing
size = size or 0.010              -- edge length of the mesh on the skin: smaller is finer and slower
fat = fat or 0.10                 -- value of fat on the skin: larger makes a thicker layer under the skin
abduction = abduction or 68       -- degrees from the hanging to the raised upper arm
rotation = rotation or 60         -- degrees by which the upper arm is turned outwards
flexion = flexion or 78           -- degrees by which the elbow is bent

local start = sinew.time()        -- seconds on the wall clock
assert(sinew.folder(out))         -- a folder that cannot be made is better known now than after the work
local report = assert(io.open(out .. "/arm.txt", "w"))
local shape, vec3 = sinew.shape, sinew.vec3

-- 1  Frames. Places on the limb are given as (along, front, side): metres from the joint along the bone, towards the
-- side it bends to (in the forearm: the palm's), and towards the thumb's side. So they follow the pose. A vec3 knows
-- + - * and has the methods dot, cross and unit.

local function frame(origin, along, front, side)
  return function(t, f, s)
    return origin + along * t + front * f + side * s
  end
end

local function sin(degrees) return math.sin(math.rad(degrees)) end
local function cos(degrees) return math.cos(math.rad(degrees)) end
local down = vec3(sin(abduction), -cos(abduction), 0)
local over = vec3(cos(abduction), sin(abduction), 0)
local ahead = vec3(0, 0, 1)
local front, side = ahead * cos(rotation) + over * sin(rotation), over * cos(rotation) - ahead * sin(rotation)
local arm = frame(vec3(0, 0, 0), down, front, side)

local along = (down * cos(flexion) + front * sin(flexion) + side * 0.10):unit()   -- 0.10: the carrying angle
local radial = (side - along * side:dot(along)):unit()
local fore = frame(arm(0.300, 0, 0), along, along:cross(radial), radial)

-- 2  Shapes. A chain of capsules (cones with round ends) runs through {point, radius} pairs.

local function chain(...)
  local list, node = {}, {...}
  for i = 1, #node - 1 do
    list[i] = shape.capsule(node[i][1], node[i + 1][1], node[i][2], node[i + 1][2])
  end
  return shape.union(list)
end

-- Digits: name, knuckle, middle joint, tip, in the frame of the forearm.
local digits = {
  {"finger_2", {0.342, -0.001, 0.026}, {0.382, 0.004, 0.029}, {0.424, 0.020, 0.032}},
  {"finger_3", {0.346, -0.001, 0.008}, {0.391, 0.004, 0.010}, {0.438, 0.021, 0.010}},
  {"finger_4", {0.342, -0.001, -0.010}, {0.383, 0.004, -0.012}, {0.426, 0.021, -0.012}},
  {"finger_5", {0.332, -0.001, -0.028}, {0.365, 0.004, -0.032}, {0.399, 0.018, -0.035}},
  {"thumb", {0.304, 0.016, 0.040}, {0.332, 0.022, 0.052}, {0.358, 0.024, 0.059}},
}

-- 3  The skin. smooth_union(k, ...) rounds the seams between shapes over the length k; subtract(a, b) cuts b off a;
-- shape:mesh{cell=} makes a closed surface with triangles of about that edge length.

local trunk = shape.subtract(shape.ellipsoid({-0.150, -0.034, -0.008}, {0.118, 0.142, 0.100}),
                             shape.box({-0.350, 0, 0}, {0.200, 0.400, 0.400}))
local shoulder = chain({vec3(-0.110, 0.018, -0.006), 0.050}, {vec3(-0.020, 0.008, -0.002), 0.056},
                       {arm(0.070, 0.003, 0.012), 0.047})
local upper_arm = shape.smooth_union(0.03,
  chain({arm(0.020, 0, 0), 0.050}, {arm(0.130, 0, 0), 0.040}, {arm(0.270, 0, 0), 0.034}),
  chain({arm(0.115, 0.014, 0), 0.030}, {arm(0.170, 0.032, 0), 0.034}, {arm(0.195, 0.027, 0), 0.033},
        {arm(0.250, 0.010, 0), 0.026}),                                                       -- biceps
  chain({arm(0.090, -0.019, -0.004), 0.034}, {arm(0.160, -0.020, 0), 0.032},
        {arm(0.260, -0.010, 0), 0.025}),                                                      -- triceps
  chain({arm(0.286, -0.004, -0.024), 0.022}, {arm(0.286, -0.004, 0.024), 0.022}))             -- condyles
local forearm = shape.smooth_union(0.025,
  chain({fore(-0.010, -0.006, 0), 0.034}, {fore(0.065, 0, 0), 0.036}, {fore(0.150, 0, 0), 0.028},
        {fore(0.245, 0, 0), 0.019}),
  chain({arm(0.245, 0.002, 0.018), 0.022}, {fore(0.050, 0.004, 0.022), 0.027}, {fore(0.240, 0, 0.011), 0.018}),
  chain({fore(0.020, 0.004, -0.020), 0.025}, {fore(0.075, 0.004, -0.016), 0.027}, {fore(0.240, 0, -0.011), 0.018}))
local hand = {
  chain({fore(0.235, 0, 0.010), 0.017}, {fore(0.275, 0, 0.014), 0.016}, {fore(0.340, -0.002, 0.026), 0.012}),
  chain({fore(0.235, 0, -0.010), 0.017}, {fore(0.275, 0, -0.012), 0.016}, {fore(0.330, 0, -0.028), 0.012}),
  chain({fore(0.270, 0, 0.004), 0.016}, {fore(0.342, -0.002, 0.008), 0.012}),
  chain({fore(0.270, 0, -0.004), 0.016}, {fore(0.338, -0.001, -0.010), 0.012}),
  chain({fore(0.262, 0.006, 0.020), 0.017}, {fore(0.304, 0.016, 0.038), 0.014}),
}
for _, digit in ipairs(digits) do
  local _, knuckle, middle, tip = table.unpack(digit)
  hand[#hand + 1] = chain({fore(table.unpack(knuckle)), 0.0115}, {fore(table.unpack(middle)), 0.0100},
                          {fore(table.unpack(tip)), 0.0080})
end
local limb = shape.smooth_union(0.02, shape.smooth_union(0.05, trunk, shoulder, upper_arm), forearm)
local skin = shape.smooth_union(0.008, limb, table.unpack(hand)):mesh{cell = 1.25 * size}

-- 4  The bones, in the same way.

local scapula = {
  chain({vec3(-0.036, -0.014, -0.006), 0.0080}, {vec3(-0.036, 0.013, -0.006), 0.0080}),       -- glenoid
  chain({vec3(-0.040, 0.000, -0.009), 0.0090}, {vec3(-0.058, -0.002, -0.020), 0.0060}),       -- neck
  chain({vec3(-0.042, -0.010, -0.010), 0.0060}, {vec3(-0.076, -0.075, -0.044), 0.0055},
        {vec3(-0.098, -0.116, -0.054), 0.0060}),                                              -- lateral border
  chain({vec3(-0.136, 0.008, -0.060), 0.0045}, {vec3(-0.085, 0.024, -0.062), 0.0055},
        {vec3(-0.030, 0.039, -0.043), 0.0065}, {vec3(0.008, 0.043, -0.032), 0.0075},
        {vec3(0.014, 0.042, -0.014), 0.0065}),                                                -- spine, acromion
  chain({vec3(-0.048, 0.012, -0.010), 0.0070}, {vec3(-0.044, 0.026, 0.012), 0.0060},
        {vec3(-0.030, 0.018, 0.030), 0.0060}),                                                -- coracoid
}
local rim = {vec3(-0.100, -0.114, -0.055), vec3(-0.112, -0.090, -0.059), vec3(-0.123, -0.064, -0.061),
             vec3(-0.132, -0.036, -0.061), vec3(-0.138, -0.008, -0.059), vec3(-0.137, 0.018, -0.055),
             vec3(-0.126, 0.038, -0.047), vec3(-0.094, 0.028, -0.034)}
for i, p in ipairs(rim) do                                                                    -- blade, a fan
  local q = rim[i + 1] or p
  scapula[#scapula + 1] = chain({vec3(-0.058, -0.006, -0.020), 0.0050}, {p, 0.0055}, {q, 0.0055})
  scapula[#scapula + 1] = shape.capsule({-0.070, -0.012, -0.026}, (p + q) * 0.5, 0.0045, 0.0055)
end

local bones = {
  {"scapula", shape.smooth_union(0.012, scapula)},
  {"clavicle", chain({vec3(-0.138, 0.032, 0.058), 0.0095}, {vec3(-0.122, 0.036, 0.062), 0.0075},
                     {vec3(-0.085, 0.041, 0.054), 0.0065}, {vec3(-0.045, 0.048, 0.028), 0.0065},
                     {vec3(-0.012, 0.049, 0.002), 0.0070}, {vec3(0.002, 0.047, -0.010), 0.0070})},
  {"sternum", chain({vec3(-0.136, 0.008, 0.066), 0.0095}, {vec3(-0.136, -0.110, 0.054), 0.0080})},  -- its left half
  {"humerus", shape.smooth_union(0.012,
    shape.sphere({0, 0, 0}, 0.0235),                                                          -- head
    chain({arm(0.008, 0.002, 0.012), 0.0150}, {arm(0.045, 0, 0.002), 0.0140}, {arm(0.100, 0, 0), 0.0110},
          {arm(0.200, 0, 0), 0.0100}, {arm(0.262, 0, 0), 0.0110}),                            -- tubercle and shaft
    chain({arm(0.255, 0, 0), 0.0100}, {arm(0.285, 0, 0.022), 0.0085}),                        -- lateral condyle
    chain({arm(0.255, 0, 0), 0.0100}, {arm(0.284, -0.003, -0.028), 0.0080}),                  -- medial condyle
    chain({arm(0.294, 0.003, -0.014), 0.0110}, {arm(0.294, 0.003, 0.018), 0.0100}))},         -- trochlea
  {"ulna", shape.smooth_union(0.010,
    chain({fore(-0.020, -0.019, -0.008), 0.0090}, {fore(0.016, -0.015, -0.009), 0.0100}),     -- olecranon
    chain({fore(0.016, -0.014, -0.009), 0.0095}, {fore(0.022, -0.004, -0.009), 0.0075}),      -- coronoid
    chain({fore(0.020, -0.012, -0.009), 0.0095}, {fore(0.100, -0.006, -0.012), 0.0070},
          {fore(0.232, 0, -0.014), 0.0060}),
    shape.sphere(fore(0.234, 0, -0.014), 0.0080))},                                           -- head
  {"radius", shape.smooth_union(0.010,
    chain({fore(0.020, 0.003, 0.015), 0.0100}, {fore(0.026, 0.003, 0.015), 0.0095}),          -- head
    chain({fore(0.024, 0.003, 0.015), 0.0065}, {fore(0.045, 0.003, 0.012), 0.0070},           -- neck, tuberosity
          {fore(0.120, 0, 0.018), 0.0075}, {fore(0.205, 0, 0.014), 0.0080}, {fore(0.236, 0, 0.014), 0.0100}),
    chain({fore(0.236, 0, 0.006), 0.0090}, {fore(0.236, 0, 0.016), 0.0100}))},                -- wrist end
  {"carpus", shape.smooth_union(0.006,
    chain({fore(0.257, 0, -0.011), 0.0075}, {fore(0.257, 0, 0.012), 0.0085}),
    chain({fore(0.270, 0, -0.013), 0.0075}, {fore(0.270, 0, 0.017), 0.0080}))},
}
for _, digit in ipairs(digits) do
  local name, knuckle, middle, tip = table.unpack(digit)
  local base = name == "thumb" and fore(0.275, 0.009, 0.028) or fore(0.286, 0, 0.55 * knuckle[3])
  local a, m, z = fore(table.unpack(knuckle)), fore(table.unpack(middle)), fore(table.unpack(tip))
  bones[#bones + 1] = {name, shape.smooth_union(0.004, chain({base, 0.0060}, {a, 0.0046}, {m, 0.0042}, {z, 0.0036}),
                                                shape.sphere(a, 0.0064), shape.sphere(m, 0.0056))}
end

-- 5  The scene holds skin, bones and muscles and all that is computed from them.

local scene = sinew.scene{name = "arm", unit = "m", up = "y"}
scene:set_skin(skin)
for _, bone in ipairs(bones) do
  scene:add_bone(bone[1], bone[2]:mesh{cell = 0.7 * size})
end

-- 6  tetrahedralize fills the skin around the bones with tets: coarse or fine as the edge lengths on both say.

local mesh = scene:tetrahedralize{edge_length = size, bone_edge_length = 0.8 * size}
print(string.format("%d tets after %.1f s", mesh.tets, sinew.time() - start))

-- 7  The muscles. A muscle has one head or more, each a curve through points: its origin, its belly, and the insertion
-- that it shares with the other heads. A fan, like the deltoid, is several heads that come together. There is a tissue
-- value for each point; where it is larger, the muscle takes more of the room that it shares with its neighbours.

local belly, spindle = {0.5, 1.2, 1.2, 0.5}, {0.6, 1.1, 1.2, 0.7, 0.5, 0.4}
local muscles = { -- name, insertion, and for each head {tissue values, origin, belly}
  {"biceps_brachii", {"radius", fore(0.044, 0.014, 0.008)},
    {{0.3, 0.3, 0.4, 0.8, 1.1, 0.9, 0.4, 0.3}, {"scapula", vec3(-0.036, 0.022, 0.000)},                 -- long head
     {vec3(-0.012, 0.022, 0.019), arm(0.030, 0.024, 0.006), arm(0.090, 0.027, 0.008), arm(0.150, 0.035, 0.008),
      arm(0.210, 0.029, 0.005), arm(0.272, 0.024, 0.004)}},
    {{0.4, 0.5, 1.2, 1.2, 0.9, 0.4, 0.3}, {"scapula", vec3(-0.026, 0.014, 0.038)},                      -- short head
     {arm(0.040, 0.026, -0.024), arm(0.090, 0.029, -0.014), arm(0.150, 0.034, -0.012), arm(0.210, 0.029, -0.006),
      arm(0.272, 0.024, 0.003)}},
    tendon = {area = 8e-4}},
  {"deltoid", {"humerus", arm(0.140, 0.004, 0.016)},
    {{0.5, 1.6, 2.0, 1.7, 0.7}, {"clavicle", vec3(-0.055, 0.046, 0.038)},
     {vec3(-0.022, 0.024, 0.050), arm(0.045, 0.032, 0.012), arm(0.095, 0.021, 0.017)}},
    {{0.5, 1.4, 1.7, 1.5, 0.7}, {"clavicle", vec3(-0.012, 0.052, 0.010)},
     {vec3(0.008, 0.038, 0.030), arm(0.045, 0.018, 0.036), arm(0.095, 0.013, 0.026)}},
    {{0.5, 1.4, 1.7, 1.5, 0.7}, {"scapula", vec3(0.024, 0.044, -0.014)},
     {vec3(0.026, 0.036, -0.008), arm(0.045, 0.000, 0.042), arm(0.095, 0.003, 0.031)}},
    {{0.5, 1.2, 1.5, 1.4, 0.7}, {"scapula", vec3(-0.028, 0.034, -0.062)},
     {vec3(-0.008, 0.018, -0.048), arm(0.050, -0.024, 0.028), arm(0.095, -0.013, 0.025)}},
    pennation = {kind = "parallel"}},
  {"brachioradialis", {"radius", fore(0.226, 0.010, 0.024)},
    {{0.6, 1.2, 1.3, 0.9, 0.5, 0.4}, {"humerus", arm(0.232, 0.006, 0.014)},
     {arm(0.275, 0.018, 0.028), fore(0.050, 0.022, 0.030), fore(0.110, 0.014, 0.030), fore(0.165, 0.011, 0.028)}},
    tendon = {area = 4e-4}, pennation = {kind = "parallel"}},
  {"triceps_brachii", {"ulna", fore(-0.034, -0.020, -0.006)},
    {{0.5, 1.3, 1.5, 0.9, 0.4}, {"scapula", vec3(-0.020, -0.032, -0.008)},                              -- long head
     {arm(0.075, -0.030, -0.026), arm(0.145, -0.034, -0.014), arm(0.225, -0.025, -0.010)}},
    {{0.7, 1.3, 1.4, 0.8, 0.4}, {"humerus", arm(0.055, -0.018, 0.008)},                                 -- lateral head
     {arm(0.120, -0.026, 0.018), arm(0.175, -0.029, 0.017), arm(0.240, -0.023, 0.006)}},
    {{0.6, 0.9, 0.9, 0.4}, {"humerus", arm(0.110, -0.012, -0.006)},                                     -- medial head
     {arm(0.180, -0.017, -0.012), arm(0.250, -0.018, -0.014)}},
    tendon = {area = 6e-4}, pennation = {kind = "unipennate", angle = 12}},
  {"brachialis", {"ulna", fore(0.032, 0.008, -0.008)},
    {{1.0, 1.7, 1.5, 0.5}, {"humerus", arm(0.140, 0.012, 0.006)},
     {arm(0.195, 0.015, 0.006), arm(0.255, 0.019, 0.004)}}},
  {"pectoralis_major", {"humerus", arm(0.062, 0.017, -0.004)},
    {{0.7, 0.8, 0.8, 0.6, 0.4}, {"clavicle", vec3(-0.105, 0.036, 0.070)},
     {vec3(-0.078, 0.016, 0.062), vec3(-0.034, -0.008, 0.052), arm(0.054, 0.028, -0.006)}},
    {{0.7, 0.8, 0.8, 0.6, 0.4}, {"sternum", vec3(-0.126, -0.020, 0.076)},
     {vec3(-0.098, -0.022, 0.064), vec3(-0.044, -0.026, 0.050), arm(0.050, 0.026, -0.014)}},
    {{0.7, 0.8, 0.8, 0.6, 0.4}, {"sternum", vec3(-0.126, -0.080, 0.070)},
     {vec3(-0.098, -0.068, 0.056), vec3(-0.050, -0.046, 0.044), arm(0.048, 0.023, -0.024)}},
    frame = {axis = {0, 1, 0}, eigenvalues = {1, 2, 0.5}}, pennation = {kind = "convergent"}},
  {"coracobrachialis", {"humerus", arm(0.145, 0.005, -0.016)},
    {{0.4, 0.5, 0.4, 0.3}, {"scapula", vec3(-0.034, 0.010, 0.036)},
     {vec3(-0.018, -0.014, 0.032), arm(0.090, 0.004, -0.022)}}},
  {"pronator_teres", {"radius", fore(0.122, 0.012, 0.018)},
    {{0.8, 1.0, 1.0, 0.8}, {"humerus", arm(0.278, 0.010, -0.032)},
     {fore(0.035, 0.018, -0.012), fore(0.080, 0.017, 0.008)}}},
  {"flexor_carpi_radialis", {"carpus", fore(0.256, 0.016, 0.008)},
    {spindle, {"humerus", arm(0.282, 0.014, -0.038)},
     {fore(0.055, 0.026, -0.012), fore(0.115, 0.022, 0.000), fore(0.185, 0.016, 0.006), fore(0.235, 0.0150, 0.007)}},
    tendon = {area = 3.8e-4}, pennation = {kind = "bipennate", angle = 12}},
  {"flexor_digitorum", {"carpus", fore(0.256, 0.016, -0.004)},
    {{0.6, 1.5, 1.5, 0.9, 0.5, 0.4}, {"ulna", fore(0.050, 0.006, -0.014)},
     {fore(0.085, 0.014, -0.014), fore(0.150, 0.014, -0.007), fore(0.200, 0.013, -0.004), fore(0.235, 0.0135, -0.004)}},
    tendon = {area = 3.4e-4}},
  {"flexor_carpi_ulnaris", {"carpus", fore(0.255, 0.014, -0.014)},
    {{0.5, 0.8, 0.8, 0.6, 0.5, 0.4}, {"humerus", arm(0.288, 0.006, -0.044)},
     {fore(0.055, 0.008, -0.036), fore(0.115, 0.006, -0.030), fore(0.185, 0.009, -0.022), fore(0.232, 0.0125, -0.018)}},
    tendon = {area = 3.6e-4}, pennation = {kind = "unipennate", angle = 15}},
  {"thenar", {"thumb", fore(0.312, 0.026, 0.042)},
    {belly, {"carpus", fore(0.268, 0.012, 0.016)}, {fore(0.282, 0.020, 0.026), fore(0.296, 0.024, 0.034)}}},
  {"hypothenar", {"finger_5", fore(0.322, 0.009, -0.028)},
    {belly, {"carpus", fore(0.268, 0.012, -0.014)}, {fore(0.285, 0.010, -0.019), fore(0.305, 0.009, -0.024)}}},
  {"extensor_carpi_radialis", {"carpus", fore(0.256, -0.016, 0.012)},
    {spindle, {"humerus", arm(0.282, 0.006, 0.042)},
     {fore(0.035, 0.000, 0.036), fore(0.100, -0.008, 0.031), fore(0.185, -0.013, 0.020), fore(0.235, -0.0145, 0.013)}},
    tendon = {area = 2.9e-4}},
  {"extensor_digitorum", {"carpus", fore(0.256, -0.016, 0.002)},
    {spindle, {"humerus", arm(0.286, -0.004, 0.042)},
     {fore(0.030, -0.014, 0.034), fore(0.090, -0.023, 0.013), fore(0.170, -0.017, 0.006), fore(0.235, -0.0145, 0.003)}},
    tendon = {area = 3.4e-4}},
  {"extensor_carpi_ulnaris", {"carpus", fore(0.256, -0.014, -0.012)},
    {{0.5, 0.8, 0.8, 0.6, 0.5, 0.4}, {"humerus", arm(0.287, -0.008, 0.044)},
     {fore(0.024, -0.022, 0.031), fore(0.080, -0.026, -0.004), fore(0.165, -0.016, -0.013),
      fore(0.232, -0.0130, -0.016)}},
    tendon = {area = 3.6e-4}},
  {"infraspinatus", {"humerus", vec3(0.008, 0.012, -0.030)},
    {{0.6, 0.8, 0.8, 0.6}, {"scapula", vec3(-0.115, -0.045, -0.072)},
     {vec3(-0.085, -0.034, -0.062), vec3(-0.036, -0.006, -0.044)}}},
  {"supraspinatus", {"humerus", vec3(0.004, 0.032, -0.004)},
    {{0.5, 0.8, 0.8, 0.5}, {"scapula", vec3(-0.115, 0.022, -0.060)},
     {vec3(-0.085, 0.036, -0.044), vec3(-0.040, 0.036, -0.022)}}},
  {"subscapularis", {"humerus", vec3(-0.010, -0.004, 0.030)},
    {{0.6, 0.8, 0.8, 0.6}, {"scapula", vec3(-0.110, -0.050, -0.042)},
     {vec3(-0.078, -0.036, -0.020), vec3(-0.046, -0.014, 0.012)}}},
  {"teres_major", {"humerus", arm(0.080, 0.000, -0.018)},
    {{0.6, 0.7, 0.7, 0.6}, {"scapula", vec3(-0.088, -0.112, -0.060)},
     {vec3(-0.060, -0.090, -0.044), arm(0.030, -0.020, -0.040)}}},
}

-- {bone, point} -> the nearest place on the bone, and half a millimetre off it: the meshes are only so exact.
local function site(place)
  local bone, p = table.unpack(place)
  local q = scene:bone(bone):surface():closest(p).point
  return q + (vec3(p) - q):unit() * 0.0005
end

-- Three more wishes. A frame makes a muscle flat: its tissue spreads at the rates of the eigenvalues along the curve,
-- along the axis, and across both. A tendon is what lies outwards of where the cross-section first reaches its area.
-- Pennation says how the fibers run: along the muscle when nothing is said, together as in a fan (convergent), straight
-- as in a strap (parallel), or at an angle to the curve, to one side (unipennate) or two (bipennate).
for _, m in ipairs(muscles) do
  local heads = {}
  for i = 3, #m do
    local tissue, origin, between = table.unpack(m[i])
    local points = {site(origin), table.unpack(between)}
    points[#points + 1] = site(m[2])
    heads[#heads + 1] = {points = points, tissue = tissue}
  end
  local muscle = scene:add_muscle(m[1], {heads = heads})
  if m.frame then muscle:set_frame(m.frame) end
  if m.tendon then muscle:set_tendon(m.tendon) end
  if m.pennation then muscle:set_pennation(m.pennation) end
end

-- 8  solve computes the tissue functions: one for each muscle and one for fat. set_fat sets the value of fat on the
-- skin. The function that is largest at a place says what is there.

scene:set_fat(fat)
local solved = scene:solve()
print(string.format("%d unknowns, %d collocation points, residual %.1e", solved.unknowns, solved.collocation_points,
                    solved.residual))

-- 9  extract cuts the tets along the borders of the tissues. check() tests what came out. save() goes by the extension
-- of the path; without one it makes a folder.

local x = scene:extract{}
local check = x:check()
assert(check.conforming and check.manifold and check.positive, "the extracted tets do not fit each other")
assert(check.volume_error < 1e-9, "the tissues do not fill the limb")
assert(x:save(out .. "/arm.vtu"))
assert(x:save(out .. "/arm.mesh"))
assert(x:save(out .. "/arm_muscles"))

-- 10  render draws the scene: here through its skin, cut open, and with its fibers. clip takes away what lies on the
-- side that its normal points to, and shows the tissues on the cut: along the limb, and across the upper arm seen from
-- the elbow.

local view = {eye = {-0.35, 0.20, 2.4}, target = {0.172, 0.040, 0}, fov = 12.8}
local middle = arm(0.170, 0.005, 0)
scene:render{file = out .. "/arm.png", size = {1200, 800}, camera = view, skin_opacity = 0.15}
scene:render{file = out .. "/arm_section.png", size = {1200, 800}, camera = view, skin_opacity = 0.15,
             clip = {point = arm(0, 0, -0.006), normal = -side}}
scene:render{file = out .. "/arm_across.png", size = {720, 640}, skin_opacity = 0.15,
             camera = {eye = middle + down * 1.5, target = middle, up = front, fov = 5.6},
             clip = {point = middle, normal = down}}
scene:render{file = out .. "/arm_fibers.png", size = {1200, 800}, camera = view, skin_opacity = 0.15,
             show = {"fibers", "bones", "skin"}, fiber_count = 200}

-- 11  The volumes and the fibers, on the screen and in a file. The physiological cross-section (pcsa) is the volume by
-- the length of the fibers: the force that a muscle can exert is proportional to it.

local function line(format, ...)
  local text = string.format(format, ...)
  print(text)
  assert(report:write(text, "\n"))
end
line("%-26s %8s %8s %10s %10s", "tissue", "cm3", "tets", "fibers cm", "pcsa cm2")
for _, name in ipairs(x:names()) do
  local part = x:part(name)
  if name == "fat" then
    line("%-26s %8.1f %8d", name, part:volume() * 1e6, part:tet_count())
  else
    local fibers = part:architecture()
    line("%-26s %8.1f %8d %10.1f %10.1f", name, part:volume() * 1e6, part:tet_count(), fibers.fiber_length * 1e2,
         fibers.pcsa * 1e4)
  end
end
report:close()
print(string.format("%d tets of soft tissue, %d after extraction, %.1f s", mesh.tets, x:tet_count(),
                    sinew.time() - start))
