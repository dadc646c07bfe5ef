-- human.lua - a whole human body: skeleton from the library, muscles of one side, both sides as conforming tets.
--
--     sinew scripts/examples/human.lua
--     sinew -D made=true scripts/examples/human.lua                      the body that the script makes itself
--     sinew -D size=0.2 -D out=/tmp scripts/examples/human.lua           finer, into another folder
--     sinew -D coarse=true scripts/examples/human.lua                    quick: a coarse mesh of the made body, one picture
--
-- The skin is that of ../shared/data/human (or $SINEW_DATA/human) where it is there, else a mannequin. Writes into the
-- folder out/human: skeleton.png, muscles.png (the half that is computed, from four sides), whole.png (both sides),
-- human.vtu (both sides, all tissues as tets that fit each other) and human.txt (bones, muscles,
-- volumes, printed too). Decimetres; x to the subject's left, y up, z to the front.
--
-- human_body.lua has the skin and the joint centres, human_skeleton.lua the bones, human_muscles.lua the muscles.

out = out or "out"                          -- where the files go; a folder human is made in it
size = size or (coarse and 0.5 or 0.26)     -- edge length of the mesh on the skin: smaller is finer and slower
fat = fat or 0.30                           -- value of fat on the skin: larger makes a thicker layer under the skin

local start = sinew.time()
local here = arg[0]:match("^.*/examples/") or "scripts/examples/"
local data = (os.getenv("SINEW_DATA") or "../shared/data") .. "/human"
assert(sinew.folder(out))
out = assert(sinew.folder(out .. "/human"))
local report = assert(io.open(out .. "/human.txt", "w"))

local function line(format, ...)
  local text = string.format(format, ...)
  print(text)
  assert(report:write(text, "\n"))
end
local function progress(format, ...)
  print(string.format("%6.1f s  ", sinew.time() - start) .. string.format(format, ...))
end

-- 1  The body: a skin and the centres of its joints.

local maker = dofile(here .. "human_body.lua")
local body = not (made or coarse) and maker.load(data) or maker.make(coarse and 0.2 or 0.12)
progress("%s: skin of %d faces", body.has_face and data or "a made body", body.skin:face_count())

-- 2  The skeleton, all of it, in a scene of its own: bones as they are in the library.

local skeleton = sinew.scene{name = "skeleton", unit = "dm", up = "y"}
skeleton:set_skin(body.skin)
local mirrored = dofile(here .. "human_skeleton.lua")(skeleton, body.joints, body.has_face)
progress("%d bones, %d of them mirrored, %d joints", #skeleton:bones(), mirrored.added, #skeleton:joints())

-- Pictures from several sides, side by side.
local function views(scene, file, cameras, options)
  local width, height = 520, 900
  local sheet = sinew.image.new{size = {width * #cameras, height}}
  for i, camera in ipairs(cameras) do
    local o = {size = {width, height}, camera = camera}
    for key, value in pairs(options) do o[key] = value end
    sheet:paste(scene:render(o), (i - 1) * width + 1, 1)
  end
  assert(sheet:save(out .. "/" .. file))
end
views(skeleton, "skeleton.png", coarse and {"front"} or {"front", "left", "back"},
      {show = {"bones", "skin"}, skin_opacity = 0.18})

-- 3  What stands for the bones in the mesh. Muscles need no gap between two ribs and no inside of a skull: groups of
-- bones get one closed wrap, which enters gaps wider than twice alpha and stands off by the offset. Lungs and bowels
-- are no muscles either.

local groups = { -- name, alpha, offset, bones
  {"thorax", 0.40, 0.030, {"sternum"}}, {"lumbar", 0.15, 0.015, {}}, {"cervical", 0.12, 0.015, {}},
  {"skull", 0.25, 0.020}, {"pelvis", 0.15, 0.015}, {"scapula_l", 0.12, 0.015}, {"clavicle_l", 0.10, 0.015},
  {"humerus_l", 0.10, 0.015}, {"ulna_l", 0.10, 0.015}, {"radius_l", 0.10, 0.015}, {"hand_l", 0.15, 0.012},
  {"femur_l", 0.10, 0.015}, {"patella_l", 0.10, 0.015}, {"tibia_l", 0.10, 0.015}, {"fibula_l", 0.10, 0.015},
  {"foot_l", 0.20, 0.012},
}
local group_of, members = {}, {}
for _, group in ipairs(groups) do members[group[1]] = group[4] or {group[1]} end
for k = 1, 12 do
  table.insert(members.thorax, "rib_" .. k)
  table.insert(members.thorax, "T" .. k)
end
for k = 1, 5 do table.insert(members.lumbar, "L" .. k) end
for k = 1, 7 do table.insert(members.cervical, "C" .. k) end
for group, names in pairs(members) do
  for _, name in ipairs(names) do group_of[name] = group end
end

local function merged(names)
  local vertices, faces = {}, {}
  for _, name in ipairs(names) do
    local s, n = skeleton:bone(name):surface(), #vertices
    for i = 1, s:vertex_count() do vertices[n + i] = s:vertex(i) end
    for i = 1, s:face_count() do
      local a, b, c = table.unpack(s:face(i))
      faces[#faces + 1] = {a + n, b + n, c + n}
    end
  end
  return sinew.surface.new(vertices, faces)
end

local solid = {}
for _, group in ipairs(groups) do
  solid[group[1]] = merged(members[group[1]]):repair{wrap = "always", alpha = group[2], offset = group[3], tolerance = 1}
end

-- The room of the bowels: an egg between thorax and pelvis, in front of the spine.
local function viscera()
  local low, high = skeleton:bone("pelvis"):landmark("pubic_symphysis"), skeleton:bone("sternum"):landmark("xiphoid")
  local middle = (low + high) * 0.5
  local front = body.skin:raycast({0, middle.y, 10}, {0, 0, -1})[1].point.z - 0.34
  local back = skeleton:bone("L3"):landmark("body_anterior_1").z + 0.05
  local side = body.skin:raycast({0, middle.y, 0.5 * (front + back)}, {1, 0, 0})[1].distance
  return sinew.shape.ellipsoid({0, middle.y, 0.5 * (front + back)},
                               {0.68 * side, 0.5 * (high.y - low.y), 0.5 * (front - back)}):mesh{cell = 0.2}
end
solid.viscera = viscera()
progress("%d wraps stand for the bones in the mesh", #groups)

-- 4  The muscles: a list of {name, head, head, ..., tissue=, ...}, a head being a list of points.

local muscles = dofile(here .. "human_muscles.lua")(skeleton, body.skin, body.joints,
                                                    function(bone) return solid[group_of[bone]] end)

-- n values along a list of them.
local function spread(values, n)
  if type(values) == "number" then return values end
  local result = {}
  for k = 1, n do
    local at = (k - 1) / (n - 1) * (#values - 1) + 1
    local i = math.min(math.floor(at), #values - 1)
    result[k] = values[i] + (values[i + 1] - values[i]) * (at - i)
  end
  return result
end

local function add_muscle(scene, m)
  local heads = {}
  for i = 2, #m do heads[#heads + 1] = {points = m[i], tissue = spread(m.tissue or 1, #m[i])} end
  local muscle = scene:add_muscle(m[1], {heads = heads})
  if m.frame and not coarse then muscle:set_frame(m.frame) end
  if m.tendon then muscle:set_tendon(m.tendon) end
  if m.pennation then muscle:set_pennation(m.pennation) end
end

-- 5  The model: cut in the middle, the left side only. x:mirror() joins it with its image.

local scene = sinew.scene{name = "human", unit = "dm", up = "y"}
scene:set_skin(body.skin)
for _, group in ipairs(groups) do scene:add_bone(group[1], solid[group[1]]) end
scene:add_bone("viscera", solid.viscera)
scene:cut{normal = {1, 0, 0}}
local mesh = scene:tetrahedralize{edge_length = size, bone_edge_length = 0.75 * size}
for _, m in ipairs(muscles) do add_muscle(scene, m) end
scene:set_fat(fat)
local solved = scene:solve()
progress("left half: %d tets, %d muscles, %d unknowns, residual %.0e", mesh.tets, #scene:muscles(), solved.unknowns,
         solved.residual)
local x = scene:extract{}
local both = x:mirror()
local check = x:check()
assert(check.conforming and check.manifold and check.positive, "the extracted tets do not fit each other")
local joined = both:check()
if not joined.conforming then progress("both sides: %d faces in the middle plane do not fit", joined.bad_faces) end
assert(both:save(out .. "/human.vtu"))
progress("extracted and mirrored: %d tets", both:tet_count())

-- 6  Pictures: the half that was computed, and both sides.

-- Seen from the front and from behind, an eye in the plane of symmetry sees the other side as the image of this one.
local function both_sides(half, file)
  local width, height = 620, 900
  local sheet = sinew.image.new{size = {2 * width, height}}
  for i, z in ipairs{40, -40} do
    local eye = {eye = {0, 0.2, z}, target = {0, 0.2, 0}, up = {0, 1, 0}, fov = 26}
    local right = half:render{size = {width, height}, camera = eye, show = {"muscles", "bones"}}
    local left = sinew.image.new{size = {width // 2, height}}
    if z > 0 then
      left:paste(right:flip(), 1, 1)
      right:paste(left, 1, 1)
    else
      left:paste(right, 1, 1)
      right = right:flip():paste(left, 1, 1)
    end
    sheet:paste(right, (i - 1) * width + 1, 1)
  end
  assert(sheet:save(out .. "/" .. file))
  progress(file)
end

if not coarse then
  views(scene, "muscles.png", {"front", "left", "back", "right"}, {show = {"muscles", "bones"}})
  progress("muscles.png")
  both_sides(scene, "whole.png")
end

-- 7  Bones, muscles, volumes.

line("%-24s %10s", "bone", "cm3")
for _, bone in ipairs(skeleton:bones()) do line("%-24s %10.1f", bone:name(), bone:surface():volume() * 1e3) end
line("%-28s %6s %8s %10s %10s", "muscle", "heads", "tets", "left cm3", "right cm3")
local total = 0
for _, muscle in ipairs(scene:muscles()) do
  local name = muscle:name()
  local l, r = both:part(name), both:part((name:gsub("_l$", "_r")))
  total = total + l:volume() + r:volume()
  line("%-28s %6d %8d %10.1f %10.1f", name, muscle:head_count(), l:tet_count(), l:volume() * 1e3, r:volume() * 1e3)
end
line("%d bones, %d muscles: %.2f dm3 of muscle, %.2f of fat, of %.2f", #skeleton:bones(), 2 * #scene:muscles(), total,
     both:part("fat"):volume(), body.skin:volume())
report:close()
progress("done")
return {skeleton = skeleton, scene = scene, half = x, both = both}
