-- anisotropy.lua - what anisotropic muscles cost, in factorizations of the tissue matrix measured in the same run.
--
--     build/sinew tests/bench/anisotropy.lua            the dog where its data is, else S (see scenes.lua)
--
-- A factorization is that of the first solve of a new scene (median of three), where the pages of its memory are made.
-- Beside it: what three frames add to such a first solve (median of three), what they take when a solved scene sees them
-- for the first time, and when they are turned (median of five). An edit of a curve makes no factor.

local median = dofile("tests/bench/measure.lua").median
local scenes = dofile("tests/bench/scenes.lua")

local function new_scene() return (scenes.make(scenes.dog_or("S"))) end

local function turn(scene, angle)
  for i = 1, 3 do scene:muscles()[i]:set_frame{angle = angle, eigenvalues = {1, 4, 0.4}} end
end

local function timed_solve(scene)
  local t0 = sinew.time()
  local r = scene:solve()
  return sinew.time() - t0, r
end

-- First solves.
local factor, plain, framed, report = {}, {}, {}, nil
for i = 1, 3 do
  plain[i], report = timed_solve(new_scene())
  factor[i] = report.seconds_factor
  local scene = new_scene()
  turn(scene, 0)
  framed[i] = timed_solve(scene)
end
local f, p, t = median(factor), median(plain), median(framed)

-- Later ones: a control point moves back and forth, frames turn.
local scene = new_scene()
scene:solve()
local muscles = scene:muscles()
local mover, edited, turned = muscles[#muscles], {}, {}
local home = mover:point(2)
for i = 1, 5 do
  mover:set_point(2, home + {0, 0, (i % 2) * 1e-4 * mover:length()})
  edited[i], report = timed_solve(scene)
end
turn(scene, 0)
local seen = timed_solve(scene)
for i = 1, 5 do
  turn(scene, 10 * i)
  turned[i] = timed_solve(scene)
end
local lt = median(turned)

print(string.format("%s: %d unknowns, %d threads", scene:name(), report.unknowns, sinew.threads()))
print(string.format("first solve, all isotropic                %.3f s, of it a factorization %.3f s", p, f))
print(string.format("first solve, three frames, longer by      %.3f s  %.1f factorizations", t - p, (t - p) / f))
print(string.format("an edit of a curve, all isotropic         %.3f s", median(edited)))
print(string.format("three frames first seen by a solved scene %.3f s  %.1f factorizations", seen, seen / f))
print(string.format("three frames, turned                      %.3f s  %.1f factorizations", lt, lt / f))
