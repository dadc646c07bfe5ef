-- picture.lua - what a picture of 640 x 480 costs: the first, after a camera move, after an edit (without the solve).
--
--     build/sinew tests/bench/picture.lua            the dog where the data is (see tests/real), else a made body
--     build/sinew -D samples=1 tests/bench/picture.lua          with coarser edges, as for moving
--     build/sinew -D zoom=3 -D renderer=egl tests/bench/picture.lua
--
-- Medians. Seconds of the clock, then of all threads together, which says more on a machine that is not idle.

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
  return scene, 0.002
end

local function dog_scene()
  local dog = dofile("tests/real/dog_scene.lua")
  if not dog.has_data() then return nil end
  local scene = dog.body()
  scene:tetrahedralize{edge_length = 0.011, bone_edge_length = 0.004}
  dog.add_muscles(scene)
  return scene, 0.0005
end

local function median(t) table.sort(t) return t[(#t + 1) // 2] end

-- Medians of `count` calls of f(i), which returns nothing; before(i) is not timed.
local function timed(count, f, before)
  local clock, threads = {}, {}
  for i = 1, count do
    if before then before(i) end
    local t0, c0 = sinew.time(), os.clock()
    f(i)
    clock[i], threads[i] = sinew.time() - t0, os.clock() - c0
  end
  return median(clock), median(threads)
end

local scene, step = dog_scene()
if not scene then scene, step = made_scene() end
scene:solve()

local options = {size = {640, 480}, samples = samples and tonumber(samples), renderer = renderer}
local function draw(i)
  options.camera = {azimuth = 20 + 29 * i, elevation = 10, zoom = tonumber(zoom or 1)}
  scene:render(options)
end

local function line(name, clock, threads) print(string.format("%-24s %7.4f s  %7.4f s", name, clock, threads)) end

print(string.format("%-24s %9s  %9s", "frame", "clock", "threads"))
line("first", timed(1, draw))
line("after a camera move", timed(24, draw))
local muscle = scene:muscles()[1]
local point = muscle:point(2)
line("after an edit", timed(9, function() draw(0) end, function(i)
  muscle:set_point(2, {point.x + (i % 2) * step, point.y, point.z})
  scene:solve()
end))
