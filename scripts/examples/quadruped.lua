-- quadruped.lua - a lioness made wholly by scripts: skin, skeleton and the muscles of the left side, solved on half of
-- the body and mirrored to the other.
--
--     sinew scripts/examples/quadruped.lua
--     sinew -D size=0.022 -D out=/tmp/lioness scripts/examples/quadruped.lua   finer, into another folder
--     sinew -D coarse=true scripts/examples/quadruped.lua                    coarse: a quick look, no toes, no .vtu
--
-- Writes into the folder `out`: skeleton.png, muscles.png, quarter.png, sections.png (pictures), quadruped.vtu (all
-- tissues of both sides as tets that fit each other) and quadruped.txt (volumes, printed too). Metres; x to the left,
-- y up, z to the head; the ground is y = 0, the plane of symmetry x = 0. Its parts are in the folder quadruped/:
-- skin.lua, skeleton.lua, muscles.lua, and what they share in kit.lua.

local in_folder = out             -- where the files go; made when missing
out = out or "out/quadruped"
size = size or (coarse and 0.050 or 0.026)           -- edge length of the mesh on the skin: smaller is finer and slower
bone_size = bone_size or (coarse and 0.024 or 0.020)  -- edge length of the mesh on the bones
cell = cell or (coarse and 0.036 or 0.022)            -- edge length of the triangles that the skin is made of
fat = fat or 0.08                 -- value of fat on the skin: larger makes a thicker layer under the skin
picture = picture or (coarse and 0.5 or 1)            -- factor on the size of the pictures

local start = sinew.time()        -- seconds on the wall clock
if not in_folder then assert(sinew.folder("out")) end
assert(sinew.folder(out))         -- a folder that cannot be made is better known now than after the work
local report = assert(io.open(out .. "/quadruped.txt", "w"))
local parts = debug.getinfo(1, "S").source:match("^@(.*)%.lua$") .. "/"
local function part(name, ...)
  return assert(loadfile(parts .. name .. ".lua"))(parts, ...)
end
local function line(format, ...)
  local text = string.format(format, ...)
  print(text)
  assert(report:write(text, "\n"))
end

-- 1  The skin: one closed surface, the same on both sides.

local skin = part("skin"):mesh{cell = cell}
local check = skin:check()
assert(check.closed and check.manifold and check.self_intersections == 0 and check.components == 1)
local scene = sinew.scene{name = "lioness", unit = "m", up = "y"}
scene:set_skin(skin)

-- 2  The skeleton: bones of the library, and their images on the right side.

local clearance = part("skeleton", scene)
assert(clearance > 0, "a bone pokes through the skin")
print(string.format("%d bones, %d joints, at least %.1f mm below the skin, after %.1f s", #scene:bones(),
                    #scene:joints(), clearance * 1e3, sinew.time() - start))

local side = {eye = {7, 0.5, 0}, target = {0, 0.5, 0}, fov = 11.2}
local quarter = {eye = {4.6, 1.9, 4.2}, target = {0, 0.48, 0.02}, fov = 12.6}
local function pixels(w, h) return {w * picture // 1, h * picture // 1} end
scene:render{file = out .. "/skeleton.png", size = pixels(1500, 780), camera = side, skin_opacity = 0.25,
             show = {"bones", "skin"}}
local whole = scene:render{size = pixels(1200, 840), camera = quarter, skin_opacity = 0.15, show = {"bones", "skin"}}

-- 3  The viscera are no bone, but as little a muscle: a body that muscles lie on, in chest, belly and throat.

part("viscera", scene)

-- 4  Half a model: muscles are drawn on the left side, and computed there. In the plane x = 0 the tissues are as if the
-- other side were there.

scene:cut{normal = {1, 0, 0}}
local names = part("muscles", scene)
local mesh = scene:tetrahedralize{edge_length = size, bone_edge_length = bone_size}
print(string.format("%d tets after %.1f s", mesh.tets, sinew.time() - start))
scene:set_fat(fat)
local solved = scene:solve()
print(string.format("%d muscles, %d unknowns, residual %.1e, after %.1f s", #names, solved.unknowns, solved.residual,
                    sinew.time() - start))

-- 5  Both sides: mirror joins the half with its image. What is _l on the left is _r on the right.

local half = scene:extract{}
local both = half:mirror{}
local found, joined = half:check(), both:check()
assert(found.conforming and found.manifold and found.positive, "the extracted tets do not fit each other")
assert(joined.conforming and joined.positive, "the mirrored tets do not fit each other")
if not coarse then assert(both:save(out .. "/quadruped.vtu")) end

-- 6  Pictures: the muscles from the side; from the front, laid over the skeleton of both sides (an eye on the left sees
-- the left half in front of the right one); and sections through shoulder, belly and thigh.

scene:render{file = out .. "/muscles.png", size = pixels(1500, 780), camera = side, show = {"muscles", "bones"}}
local left = scene:render{size = pixels(1200, 840), camera = quarter, show = {"muscles", "bones"},
                          background = "transparent"}
assert(whole:paste(left, 1, 1):save(out .. "/quarter.png"))
local sections = sinew.image.new{size = pixels(1260, 780)}
for i, z in ipairs{0.43, -0.05, -0.43} do
  local middle = {0.10, 0.47, z}
  local view = scene:render{size = pixels(420, 780), camera = {eye = {0.10, 0.47, z + 6}, target = middle, fov = 9.8},
                            show = {"muscles", "bones", "skin"}, skin_opacity = 0.1,
                            clip = {point = middle, normal = {0, 0, 1}}}
  sections:paste(view, (i - 1) * view:width() + 1, 1)
end
assert(sections:save(out .. "/sections.png"))

-- 7  The volumes of the left side, and of both.

line("%-32s %10s %8s", "muscle, left side", "cm3", "tets")
local sum, least = 0, math.huge
for _, name in ipairs(names) do
  local muscle = half:part(name)
  local image = both:part((name:gsub("_l$", "_r")))
  local volume = muscle:volume()
  assert(math.abs(image:volume() - volume) < 1e-9 * volume, "the image of a muscle has another volume")
  sum, least = sum + volume, math.min(least, volume)
  line("%-32s %10.1f %8d", name, volume * 1e6, muscle:tet_count())
end
assert(#names >= 39 and least > 0)
line("%-32s %10.1f %8d", "fat, both sides", both:part("fat"):volume() * 1e6, both:part("fat"):tet_count())
line("%-32s %10.1f", string.format("%d muscles, both sides", 2 * #names), 2 * sum * 1e6)
report:close()
print(string.format("%d tets of both sides, %.1f s", both:tet_count(), sinew.time() - start))
return {scene = scene, half = half, both = both, muscles = names}
