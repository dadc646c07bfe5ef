-- dog_scene - the left hind leg of a dog: skin, bones and muscles between measured attachment sites, as a scene.
--
--     local dog = dofile("tests/real/dog_scene.lua")
--     local scene = dog.body()        skin and bones
--     scene:tetrahedralize{...}
--     dog.add_muscles(scene)
--
-- The data is that of google-deepmind/dm_control (suite/dog_assets). It is looked for in $SINEW_DATA, else in
-- ../shared/data. Metres, z up, head towards +x.

local dog = {data = (os.getenv("SINEW_DATA") or "../shared/data") .. "/dog_hindleg"}

-- Attachment sites by muscle and bone: bone,muscle,x,y,z,radius,faces
local function read_sites(path)
  local sites = {}
  for line in assert(io.lines(path)) do
    local bone, muscle, x, y, z = line:match("^([^,]+),([^,]+),([^,]+),([^,]+),([^,]+)")
    if tonumber(x) then
      sites[muscle] = sites[muscle] or {}
      sites[muscle][bone] = {tonumber(x), tonumber(y), tonumber(z)}
    end
  end
  return sites
end

-- Name, origin, insertion, tissue value, and points between: the middle of the modeller's muscle a third and two
-- thirds of the way. The tissue values bring the volumes near those of the modeller's muscles, as far as that goes
-- without muscles that are not here: where a neighbour is missing, a muscle takes its room.
local muscles = {
  {"m_gluteus_medius_L", "Pelvis", "Femoris_L", 0.58, {{-0.2710, 0.0467, 0.4952}, {-0.2960, 0.0577, 0.4849}}},
  {"m_gluteus_superficialis_major_L", "Sacrum", "Femoris_L", 0.30, {{-0.3020, 0.0247, 0.5122}, {-0.3159, 0.0468, 0.4970}}},
  {"m_sartorius_L", "Pelvis", "Tibia_L", 0.30, {{-0.2857, 0.0470, 0.4091}, {-0.3176, 0.0604, 0.3289}}},
  {"m_sartorius_L(2)", "Pelvis", "Patella_L", 0.30, {{-0.2635, 0.0515, 0.4209}, {-0.2920, 0.0612, 0.3575}}},
  {"m_rectus_femoris_L", "Pelvis", "Patella_L", 0.36, {{-0.3003, 0.0708, 0.4165}, {-0.3063, 0.0774, 0.3604}}},
  {"m_vastus_lat_L", "Femoris_L", "Patella_L", 0.75, {{-0.3146, 0.0831, 0.4043}, {-0.3152, 0.0834, 0.3514}}},
  {"m_vastus_med_L", "Femoris_L", "Patella_L", 0.80, {{-0.3129, 0.0635, 0.3944}, {-0.3148, 0.0689, 0.3480}}},
  {"m_biceps_femoris_L", "Pelvis", "Tibia_L", 1.17, {{-0.3535, 0.0773, 0.4101}, {-0.3663, 0.0884, 0.3484}}},
  {"m_semitendinosus_L", "Pelvis", "Tibia_L", 0.31, {{-0.3806, 0.0493, 0.3848}, {-0.3757, 0.0585, 0.3233}}},
  {"m_gracilis_L", "Pelvis", "Tibia_L", 0.40, {{-0.3511, 0.0337, 0.3790}, {-0.3646, 0.0474, 0.3189}}},
  {"m_adductor_magnus_L", "Pelvis", "Femoris_L", 0.52, {{-0.3478, 0.0345, 0.4193}, {-0.3407, 0.0589, 0.3971}}},
  {"m_pectineus_L", "Pelvis", "Femoris_L", 0.30, {{-0.3215, 0.0429, 0.4230}, {-0.3247, 0.0574, 0.3968}}},
  {"m_quadratus_femoris_L", "Pelvis", "Femoris_L", 0.30, {{-0.3598, 0.0457, 0.4547}, {-0.3499, 0.0559, 0.4526}}},
  {"m_gastrocnemius_L", "Femoris_L2", "Calcaneal_tuber_L", 0.34, {{-0.4155, 0.0772, 0.2906}, {-0.4769, 0.0766, 0.2422}}},
  {"m_popliteus_L", "Femoris_L", "Tibia_L", 0.46, {{-0.3825, 0.0850, 0.2951}, {-0.3885, 0.0724, 0.2821}}},
  {"m_tibialis_cranialis_L", "Fibula_L", "Tarsus_central_L", 0.37, {{-0.4289, 0.0887, 0.2338}, {-0.4843, 0.0714, 0.1873}}},
  {"m_peroneus_longus_L", "Fibula_L", "Tarsus_L_I", 0.30, {{-0.4452, 0.0884, 0.2355}, {-0.5122, 0.0872, 0.1850}}},
}

local bones = {"Pelvis", "Femoris_L", "Patella_L", "Tibia_L", "Fibula_L", "Calcaneal_tuber_L", "Tibial_tarsal_L"}

-- The point at `margin` beyond the surface's point nearest to p, on the side asked for; p itself where it is there already.
local function keep_off(p, surface, want_inside, margin)
  local c, inside = surface:closest(p), surface:contains(p)
  if inside == want_inside and c.distance >= margin or c.distance == 0 then return p end
  local sign, q = inside == want_inside and 1 or -1, {}
  for k = 1, 3 do q[k] = c.point[k] + sign * margin * (p[k] - c.point[k]) / c.distance end
  return q
end

-- Inside the skin and outside of the bones, as far as there is room.
local function in_soft_tissue(p, skin, bones)
  for _ = 1, 6 do
    p = keep_off(p, skin, true, 0.003)
    for _, bone in ipairs(bones) do p = keep_off(p, bone, false, 0.003) end
  end
  return p
end

-- The control points of a muscle: the given ones and two between each pair, all but the ends in the soft tissue.
local function control_points(given, skin, bones)
  local points = {given[1]}
  for i = 2, #given do
    for j = 1, 3 do
      local p = {}
      for k = 1, 3 do p[k] = given[i - 1][k] + (given[i][k] - given[i - 1][k]) * j / 3 end
      local is_end = i == #given and j == 3
      points[#points + 1] = is_end and p or in_soft_tissue(p, skin, bones)
    end
  end
  return points
end

-- Is the data there?
function dog.has_data()
  local file = io.open(dog.data .. "/skin.stl", "rb")
  return file ~= nil and file:close()
end

-- A scene with skin and bones.
function dog.body()
  local scene = sinew.scene{name = "dog hindleg", unit = "m", up = "z"}
  scene:set_skin(assert(sinew.surface.load(dog.data .. "/skin.stl")))
  for _, name in ipairs(bones) do
    scene:add_bone(name, assert(sinew.surface.load(dog.data .. "/bones/" .. name .. ".stl")))
  end
  return scene
end

-- Adds the muscles and sets the fat's value.
function dog.add_muscles(scene)
  local sites = read_sites(dog.data .. "/attachment_sites.csv")
  local skin, surfaces = scene:skin(), {}
  for i, bone in ipairs(scene:bones()) do surfaces[i] = bone:surface() end
  for _, m in ipairs(muscles) do
    local name, origin, insertion, tissue, between = table.unpack(m)
    local given = {sites[name][origin], between[1], between[2], sites[name][insertion]}
    scene:add_muscle(name, {points = control_points(given, skin, surfaces), tissue = tissue})
  end
  scene:set_fat(0.25)
end

return dog
