-- picture.lua - what a picture of 640 x 480 costs: the first, after a camera move, after an edit (without the solve).
--
--     build/sinew tests/bench/picture.lua            the dog where its data is, else S (see scenes.lua)
--     build/sinew -D samples=1 tests/bench/picture.lua          with coarser edges, as for moving
--     build/sinew -D zoom=3 -D renderer=egl tests/bench/picture.lua
--
-- Medians. Seconds of the clock, then of all threads together, which says more on a machine that is not idle.

local median = dofile("tests/bench/measure.lua").median
local scenes = dofile("tests/bench/scenes.lua")

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

local scene = scenes.make(scenes.dog_or("S"))
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
local point, step = muscle:point(2), 0.002 * muscle:length()
line("after an edit", timed(9, function() draw(0) end, function(i)
  muscle:set_point(2, {point.x + (i % 2) * step, point.y, point.z})
  scene:solve()
end))
