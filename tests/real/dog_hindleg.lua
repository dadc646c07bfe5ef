-- dog_hindleg.lua - the left hind leg of a dog: real skin, real bones, muscles between measured attachment sites.
--
--     sinew tests/real/dog_hindleg.lua            writes out/dog_hindleg.png, .vtu and .mesh
--
-- The data is that of google-deepmind/dm_control (suite/dog_assets). It is looked for in $SINEW_DATA, else in
-- ../shared/data. Metres, z up, head towards +x. Options: -D out=FOLDER, -D skin_edge=METRES, -D bone_edge=METRES.

out = assert(sinew.folder(out or "out"))
skin_edge = skin_edge or 0.011
bone_edge = bone_edge or 0.004

local dog = dofile((arg[0]:match("^.*/") or "") .. "dog_scene.lua")

local function step(name, t0)
  io.stderr:write(string.format("%-12s %6.2f s\n", name, sinew.time() - t0))
end

local scene = dog.body()
local t0 = sinew.time()
local mesh = scene:tetrahedralize{edge_length = skin_edge, bone_edge_length = bone_edge}
step("mesh", t0)

dog.add_muscles(scene)

t0 = sinew.time()
local solved = scene:solve()
step("solve", t0)

t0 = sinew.time()
local x = scene:extract{}
step("extract", t0)

t0 = sinew.time()
local check = x:check()
step("check", t0)

t0 = sinew.time()
scene:render{file = out .. "/dog_hindleg.png", size = {1200, 1000},
             camera = {eye = {-0.25, 1.3, 0.45}, target = {-0.37, 0.05, 0.33}, up = {0, 0, 1}, fov = 24},
             show = {"muscles", "bones", "skin"}, skin_opacity = 0.12}
step("picture", t0)

t0 = sinew.time()
assert(x:save(out .. "/dog_hindleg.vtu"))
assert(x:save(out .. "/dog_hindleg.mesh"))
step("files", t0)

print(string.format("tets %d, unknowns %d, collocation points %d", mesh.tets, solved.unknowns, solved.collocation_points))
print(string.format("extraction: %d tets; conforming %s, manifold %s, positive %s, volume error %.2g", x:tet_count(),
                    check.conforming, check.manifold, check.positive, check.volume_error))
for _, name in ipairs(x:names()) do
  local part = x:part(name)
  print(string.format("  %-34s %9.2f cm3 %8d tets", name, part:volume() * 1e6, part:tet_count()))
end
