-- adaptive - what an adaptive tet mesh costs and what it changes, against the even one with the same edge lengths.
--
--     sinew tests/bench/adaptive.lua                     the dog's hind leg (where its data is)
--     sinew -D edge=0.02 -D bone=0.008 tests/bench/adaptive.lua
--
-- Prints tets, seconds, and for each muscle how far the corners and the middles of the faces of its surface on either
-- mesh lie from the surface on the other: the largest distance and the one that 99 % stay below, in millimetres. Last
-- the same between two even meshes, whose edge lengths differ by 5 %: so much depends on the mesh in any case.

local dog = dofile("tests/real/dog_scene.lua")
if not dog.has_data() then
  print("no data in " .. dog.data .. ": set SINEW_DATA")
  return
end
edge, bone = edge or 0.011, bone or 0.004

local function build(kind, edge_length, bone_edge_length)
  local scene = dog.body()
  dog.add_muscles(scene)
  local report = scene:tetrahedralize{edge_length = edge_length, bone_edge_length = bone_edge_length,
                                      adaptive = kind == "adaptive"}
  local start = sinew.time()
  scene:solve()
  local solved = sinew.time()
  local x = scene:extract()
  print(("%-9s %7d tets %7d vertices  mesh %5.2f s%s  solve %5.2f s  extract %5.2f s  %7d tets extracted"):format(
    kind, report.tets, report.vertices, report.seconds,
    report.seconds_coarse and (" (first %.2f s, %d tets)"):format(report.seconds_coarse, report.coarse_tets) or "",
    solved - start, sinew.time() - solved, x:tet_count()))
  return x, report.tets
end

-- Adds the distances of the corners and face middles of one surface from the other to the list.
local function add_distances(from, to, list)
  for i = 1, from:vertex_count() do list[#list + 1] = to:closest(from:vertex(i)).distance end
  for i = 1, from:face_count() do
    local f, p = from:face(i), {0, 0, 0}
    for k = 1, 3 do
      local q = from:vertex(f[k])
      for c = 1, 3 do p[c] = p[c] + q[c] / 3 end
    end
    list[#list + 1] = to:closest(p).distance
  end
end

local function print_row(name, there, back, rest)
  local function two(list)
    table.sort(list)
    return 1000 * list[#list], 1000 * list[math.ceil(0.99 * #list)]
  end
  local m1, p1 = two(there)
  local m2, p2 = two(back)
  print(("%-34s %9.3f %9.3f   %9.3f %9.3f%s"):format(name, m1, p1, m2, p2, rest or ""))
end

-- One row for each muscle when asked, and one for all.
local function compare(title, a, b, each)
  local all_there, all_back = {}, {}
  print(("%-34s %19s   %19s"):format(title, "there", "back"))
  print(("%-34s %9s %9s   %9s %9s"):format("distance, mm", "largest", "99 %", "largest", "99 %"))
  for _, name in ipairs(a:names()) do
    if name ~= "fat" then
      local s, t, there, back = a:part(name):surface(), b:part(name):surface(), {}, {}
      add_distances(s, t, there)
      add_distances(t, s, back)
      table.move(there, 1, #there, #all_there + 1, all_there)
      table.move(back, 1, #back, #all_back + 1, all_back)
      if each then
        print_row(name, there, back, ("  volume %+.2f %%"):format(
          100 * (b:part(name):volume() / a:part(name):volume() - 1)))
      end
    end
  end
  print_row("all", all_there, all_back)
end

local even, n_even = build("even", edge, bone)
local adaptive, n_adaptive = build("adaptive", edge, bone)
compare("even to adaptive", even, adaptive, true)
print(("half the edge length is %.3f mm; %.2f times fewer tets"):format(500 * edge, n_even / n_adaptive))
compare("even to even, edges 5 % shorter", even, (build("even", 0.95 * edge, 0.95 * bone)))
