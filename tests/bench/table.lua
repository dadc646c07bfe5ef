-- table.lua - what an edit costs on one scene, beside two references on the same matrices, in Markdown.
--
--     build/sinew-bench tests/bench/table.lua L [ROUNDS]        see scenes.lua for the names of scenes
--
-- Everything is measured in turn in each round, so that a busy machine slows all of it alike. A process of its own
-- measures memory (table.lua L memory: lines of name, MiB in all, MiB more than before), where no reference keeps any
-- while the edits run, and free memory goes back to the system before each call.

local name = assert(arg[1], "which scene?")
local is_memory = arg[2] == "memory"
local huge = 300000                           -- unknowns above which everything is measured once, and LDLT never

local scenes = dofile("tests/bench/scenes.lua")
local measure = dofile("tests/bench/measure.lua")
measure.is_memory = is_memory

-- 1  First solves, and the usual way with its analysis.

local first, usual_first = measure.series("first solve"), measure.series("CHOLMOD, with the analysis")
local difference, quick_difference = 0, 0
local scene, mesh = scenes.make(name)
local report = first:add(scene.solve, scene)
local systems = bench.systems(scene)
local size = systems:size()
local is_huge = size.unknowns > huge
local is_brief = is_memory or is_huge
local rounds = not is_memory and tonumber(arg[2]) or is_brief and 1 or 5
local edits = is_memory and 1 or 3            -- of each kind in a round
local first_scenes = is_brief and 0 or 2      -- scenes made anew for more first solves
local slow_rounds = is_huge and 0 or 1        -- in which SimplicialLDLT takes part

local function check()
  difference = math.max(difference, systems:difference())
end

local function solve_usual_first()
  systems:release()
  usual_first:add(systems.cholmod, systems, 1)
  check()
end

if not is_memory then solve_usual_first() end
for _ = 1, first_scenes do
  local s = scenes.make(name)
  first:add(s.solve, s)
  s:close()
  solve_usual_first()
end

-- 2  The references after an edit.

local usual = {measure.series("CHOLMOD, threads as it chooses"), measure.series("CHOLMOD, one thread")}
local eigen = {measure.series("Eigen CholmodSupernodalLLT"), measure.series("Eigen SimplicialLDLT")}

local function measure_references(round)
  systems:update()
  for i, threads in ipairs{0, 1} do
    usual[i]:add(systems.cholmod, systems, threads)
    check()
  end
  if is_brief then systems:release() end
  eigen[1]:add(systems.eigen, systems, "cholmod")
  if round <= slow_rounds then eigen[2]:add(systems.eigen, systems, "ldlt") end
  check()
end

-- 3  What is measured of sinew: `before` makes ready, `run` is timed, `after` follows. fields: how many it solved for.

local edit = dofile("tests/bench/edits.lua")(scene)
local function solve() return scene:solve() end
local function quick_solve() return scene:solve{quick = true} end
local is_quick = pcall(quick_solve)

local views = 0
local function turn_camera() views = views + 1 end
local function frame()
  return scene:render{size = {640, 480}, camera = {azimuth = 20 + 7 * views, elevation = 15, zoom = 1}}
end

-- Of the first quick solve in a round: how far it is off.
local function finish_quick(i)
  if i == 1 and not is_memory then
    systems:update()
    systems:cholmod(1)
    quick_difference = math.max(quick_difference, systems:difference())
  end
  solve()
end

local operations, by_name = {}, {}
local function operation(op)
  op.series = measure.series(op.name)
  operations[#operations + 1], by_name[op.name] = op, op
end

local function time(op)
  local done = op.series:add(op.run)
  if op.fields then op.fields[#op.fields + 1] = done.solved end
end

operation{name = "move one control point", before = edit.move, run = solve, fields = {}}
operation{name = "move it again", before = edit.again, run = solve, fields = {}}
operation{name = "move one, quick", before = edit.move, run = quick_solve, after = finish_quick, fields = {},
          is_absent = not is_quick}
operation{name = "move it again, quick", before = edit.again, run = quick_solve, fields = {}, is_absent = not is_quick}
operation{name = "change one tissue value", before = edit.tissue, run = solve, fields = {}}
operation{name = "add a muscle", before = edit.add, run = solve, fields = {}, after = function()
  edit.remove()
  time(by_name["remove a muscle"])
end}
operation{name = "remove a muscle", run = solve, fields = {}, count = 0} -- that one
operation{name = "change fat", before = edit.fat, run = solve, fields = {}}
operation{name = "change an anisotropic frame", count = 1, run = solve, fields = {}, before = function()
  edit.frame() -- the muscle has a frame and a field already
  solve()
  edit.frame()
end, after = function()
  edit.no_frame()
  solve()
end}
operation{name = "extract", count = 1, run = function() scene:extract{}:close() end}
operation{name = "frame after a camera move", before = turn_camera, run = frame}
operation{name = "frame after an edit", before = edit.move, after = solve, run = function()
  if is_quick then quick_solve() end
  frame()
end}

frame() -- what is made once and kept: the OpenGL context, buffers
for round = 1, rounds do
  for _, op in ipairs(operations) do
    for i = 1, op.is_absent and 0 or op.count or edits do
      if op.before then op.before() end
      time(op)
      if op.after then op.after(i) end
    end
  end
  measure_references(round)
end

-- The same scene by conjugate gradients: a first solve, and a control point moved.
local iterative_first, iterative_move = measure.series("first solve, iterative"), measure.series("move one, iterative")
local iterative_fields, iterative_difference = {}, 0
local function solve_iterative() return scene:solve{solver = "iterative"} end
local function measure_iterative(series)
  series:add(solve_iterative)
  iterative_fields = {#scene:muscles() + 1}
  systems:update()
  systems:cholmod(1)
  iterative_difference = math.max(iterative_difference, systems:difference())
end
if pcall(measure_iterative, iterative_first) then
  edit.move()
  measure_iterative(iterative_move)
end

-- 4  Memory.

local references = {usual_first, usual[1], usual[2], eigen[1], eigen[2]}

if is_memory then
  solve_usual_first()
  local function line(s)
    if #s.seconds > 0 then print(string.format("%s\t%.9g\t%.9g", s.name, s.peak, s.grown)) end
  end
  line(first)
  line(iterative_first)
  line(iterative_move)
  for _, op in ipairs(operations) do line(op.series) end
  for _, s in ipairs(references) do line(s) end
  return
end

local memory = {}
local pipe = assert(io.popen(string.format("'%s' '%s' '%s' memory", arg[-1], arg[0], name)))
for line in pipe:lines() do
  local key, peak, grown = line:match("^([^\t]*)\t([^\t]*)\t(.*)$")
  if key then memory[key] = {peak = tonumber(peak), grown = tonumber(grown)} end
end
pipe:close()

local function memory_of(s, what) return measure.text(memory[s.name] and memory[s.name][what]) end

-- 5  The tables.

local text = measure.text
local best = usual[1]:median() < usual[2]:median() and usual[1] or usual[2]
local function ms(seconds) return text(1e3 * seconds) end

local function row(s, fields, reference)
  if #s.seconds == 0 then return {s.name, "-", "-", "-", "-", "-", "-", "-", "-"} end
  local median = s:median()
  local function ratio(other) return fields and #other.seconds > 0 and text(other:median() / median) or "-" end
  return {s.name, ms(median), ms(s:slowest()), fields and text(measure.median(fields)) or "-", ratio(reference or best),
          ratio(eigen[1]), ratio(eigen[2]), memory_of(s, "peak"), memory_of(s, "grown")}
end

print(string.format("### Scene %s: %s", name, scene:name()))
print()
print(string.format("%d tets, %d vertices, %d muscles; %d unknowns, %d collocation points, %d right-hand sides, %d"
                    .. " entries in the factor. %d rounds.", mesh.tets, mesh.vertices, #scene:muscles(),
                    size.unknowns, size.collocation_points, size.right_hand_sides, report.factor_entries, rounds))
print(string.format("Fields differ from those of the references by at most %.1e of the largest value; quick ones by"
                    .. " %s, iterative ones by %s.", difference,
                    is_quick and string.format("%.1e", quick_difference) or "-",
                    #iterative_first.seconds > 0 and string.format("%.1e", iterative_difference) or "-"))
print()
local rows = {row(first, {report.solved}, usual_first)}
for i, op in ipairs(operations) do rows[1 + i] = row(op.series, op.fields) end
rows[#rows + 1] = row(iterative_first, iterative_fields, usual_first)
rows[#rows + 1] = row(iterative_move, iterative_fields)
measure.print_table({"sinew", "median, ms", "slowest, ms", "fields", "(a) / sinew", "(b) supernodal / sinew",
                     "(b) LDLT / sinew", "peak, MiB", "of it new, MiB"}, rows)
rows = {}
for i, s in ipairs(references) do
  local has = #s.seconds > 0
  rows[i] = {s.name, has and ms(s:median()) or "-", has and ms(s:slowest()) or "-", memory_of(s, "grown")}
end
measure.print_table({"reference", "median, ms", "slowest, ms", "new memory, MiB"}, rows)
