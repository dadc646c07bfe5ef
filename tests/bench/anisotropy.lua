-- anisotropy.lua - what anisotropic muscles cost, in factorizations of the tissue matrix measured in the same run.
--
--     build/sinew tests/bench/anisotropy.lua            the dog where the data is (see tests/real), else two muscles in a body
--
-- Prints, as medians of five: a factorization; a solve after three muscles got another frame; the same over the first.

local function median(t) table.sort(t) return t[(#t + 1) // 2] end

local function made_scene()
  local scene, shape = sinew.scene{name = "bench"}, sinew.shape
  scene:set_skin(shape.capsule({0, 0, -1}, {0, 0, 1}, 0.6, 0.6):mesh{cell = 0.05})
  scene:add_bone("lower", shape.sphere({0, 0, -1.1}, 0.25):mesh{cell = 0.04})
  scene:add_bone("upper", shape.sphere({0, 0, 1.1}, 0.25):mesh{cell = 0.04})
  scene:tetrahedralize{edge_length = 0.04}
  for i = 1, 6 do
    local x, y = 0.3 * math.cos(i), 0.3 * math.sin(i)
    scene:add_muscle("muscle" .. i, {points = {{x / 2, y / 2, -0.9}, {x, y, 0}, {x / 2, y / 2, 0.9}}})
  end
  return scene
end

local function dog_scene()
  local dog = dofile("tests/real/dog_scene.lua")
  local file = io.open(dog.data .. "/skin.stl", "rb")
  if not file then return nil end
  file:close()
  local scene = dog.body()
  scene:tetrahedralize{edge_length = 0.011, bone_edge_length = 0.004}
  dog.add_muscles(scene)
  return scene
end

local scene = dog_scene() or made_scene()
local muscles = scene:muscles()
local first = scene:solve()

-- Factorizations: a control point moves back and forth.
local mover, factor, plain = muscles[#muscles], {}, {}
local home = mover:point(2)
for i = 1, 5 do
  mover:set_point(2, home + {0, 0, (i % 2) * 1e-4 * mover:length()})
  local r = scene:solve()
  factor[i], plain[i] = r.seconds_factor, r.seconds
end

local function turn(angle)
  for i = 1, 3 do muscles[i]:set_frame{angle = angle, eigenvalues = {1, 4, 0.4}} end
  local t0 = sinew.time()
  local r = scene:solve()
  return sinew.time() - t0, r
end

local with_first = turn(0)
local turned = {}
for i = 1, 5 do turned[i] = turn(10 * i) end

local f, t = median(factor), median(turned)
print(string.format("%s: %d unknowns, %d threads", scene:name(), first.unknowns, sinew.threads()))
print(string.format("first solve                             %.3f s", first.seconds))
print(string.format("a factorization                         %.3f s", f))
print(string.format("an edit of a curve, all isotropic       %.3f s", median(plain)))
print(string.format("three frames, the first time            %.3f s  %.1f factorizations", with_first, with_first / f))
print(string.format("three frames, turned                    %.3f s  %.1f factorizations", t, t / f))
