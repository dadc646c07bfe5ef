-- scaling.lua - cost against size: tets with 10 muscles, muscles in 650,000 tets; and the fitted exponents. Markdown.
--
--     build/sinew-bench tests/bench/scaling.lua             all sizes, each in a process of its own
--     build/sinew-bench tests/bench/scaling.lua EDGE MUSCLES     one: its numbers in a line
--
-- The body and its first muscles are the same at all sizes (limb.lua). Exponent b: the cost grows as size^b, by least
-- squares of the logarithms.

local scenes = dofile("tests/bench/scenes.lua")
local measure = dofile("tests/bench/measure.lua")

local steps = {"mesh", "first", "move", "quick", "extract", "iterative"}   -- seconds of each
local edges, n_muscle = {0.0415, 0.0283, 0.0202, 0.0147, 0.0109, 0.0080, 0.0057}, 10
local muscles, edge = {1, 3, 10, 30, 100, 300}, 0.0120

-- ---- one size ----

local n_move = 7
local most_iterative = 10         -- muscles up to which the iterative solver takes part

-- Median seconds of `run` after a move of a control point; nil where it is not to be had.
local function after_moves(scene, run)
  local edit, series = dofile("tests/bench/edits.lua")(scene), measure.series()
  for _ = 1, n_move do
    edit.move()
    if not pcall(series.add, series, run, scene) then return nil end
    scene:solve()
  end
  return series:median()
end

local function measure_size(edge_length, n)
  local scene, mesh = scenes.limb(edge_length, n)
  local seconds = {mesh = mesh.seconds}
  local report, extraction
  seconds.first, report = measure.seconds(scene.solve, scene)
  seconds.move = after_moves(scene, scene.solve)
  seconds.quick = after_moves(scene, function(s) return s:solve{quick = true} end)
  seconds.extract, extraction = measure.seconds(scene.extract, scene, {})
  local _, peak = bench.memory()
  if n <= most_iterative then
    local series = measure.series()
    local ok = pcall(series.add, series, scene.solve, scene, {solver = "iterative"})
    seconds.iterative = ok and series:median() or nil
  end
  local words = {mesh.tets, n, report.unknowns, report.collocation_points, extraction:tet_count(), peak,
                 report.solver or "direct"}
  for _, step in ipairs(steps) do words[#words + 1] = seconds[step] or "-" end
  print(table.concat(words, " "))
end

if arg[1] then return measure_size(tonumber(arg[1]), tonumber(arg[2])) end

-- ---- all sizes ----

local function run_size(edge_length, n)
  local pipe = assert(io.popen(string.format("'%s' '%s' %g %d", arg[-1], arg[0], edge_length, n)))
  local words = {}
  for word in pipe:read("a"):gmatch("%S+") do words[#words + 1] = tonumber(word) or word end
  local ok, _, code = pipe:close()
  if not ok then
    io.stderr:write(string.format("edge length %g with %d muscles failed (%s)\n", edge_length, n, code))
    return nil
  end
  local size = {tets = words[1], muscles = words[2], unknowns = words[3], rows = words[4], extracted = words[5],
                peak = words[6], solver = words[7]}
  for i, step in ipairs(steps) do size[step] = tonumber(words[7 + i]) end
  return size
end

local function print_sizes(sizes, key)
  local rows, exponents = {}, {"exponent", "", "", "", ""}
  for i, s in ipairs(sizes) do
    local row = {s.solver, tostring(s.tets), tostring(s.muscles), tostring(s.unknowns), tostring(s.rows)}
    for _, step in ipairs(steps) do row[#row + 1] = measure.text(s[step]) end
    rows[i] = table.move({measure.text(1e6 * s.extract / s.tets), measure.text(s.peak)}, 1, 2, #row + 1, row)
  end
  for _, step in ipairs(steps) do
    local xs, ys = {}, {}
    for _, s in ipairs(sizes) do
      if s[step] then xs[#xs + 1], ys[#ys + 1] = s[key], s[step] end
    end
    exponents[#exponents + 1] = #xs > 1 and string.format("%.2f", measure.exponent(xs, ys)) or "-"
  end
  rows[#rows + 1] = table.move({"", ""}, 1, 2, #exponents + 1, exponents)
  measure.print_table({"solver", "tets", "muscles", "unknowns", "points", "mesh, s", "first solve, s", "move, s",
                       "quick move, s", "extract, s", "first, iterative, s", "extract, us a tet", "peak, MiB"}, rows)
end

local function sweep(title, list, size_of, key)
  local sizes = {}
  for _, value in ipairs(list) do sizes[#sizes + 1] = run_size(size_of(value)) end
  print("### " .. title)
  print()
  print_sizes(sizes, key)
end

sweep("Tets", edges, function(e) return e, n_muscle end, "tets")
sweep("Muscles", muscles, function(n) return edge, n end, "muscles")
