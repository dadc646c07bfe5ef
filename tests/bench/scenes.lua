-- scenes.lua - the scenes that are measured, by name.
--
--     local scenes = dofile("tests/bench/scenes.lua")
--     local scene = scenes.make("L")           meshed, with its muscles, not solved
--
--     S     the limb of limb.lua     100,000 tets    12 muscles
--     L     the same                 650,000         40
--     XL    the same               4,000,000         10
--     dog   a dog's hind leg         640,000         17     where the data is (tests/real/dog_scene.lua)

local scenes = {names = {"S", "L", "XL", "dog"}}

local sizes = {S = {edge = 0.0282, muscles = 12}, L = {edge = 0.0120, muscles = 40}, XL = {edge = 0.0055, muscles = 10}}

-- The limb with any edge length on the skin; two thirds of it on the bones.
function scenes.limb(edge, n_muscle)
  local limb = dofile("tests/bench/limb.lua")
  local scene = limb.body()
  local mesh = scene:tetrahedralize{edge_length = edge, bone_edge_length = edge / 1.5, time_limit = 1800}
  limb.add_muscles(scene, n_muscle)
  return scene, mesh
end

local function dog_hindleg()
  local dog = dofile("tests/real/dog_scene.lua")
  local scene = dog.body()
  local mesh = scene:tetrahedralize{edge_length = 0.011, bone_edge_length = 0.004}
  dog.add_muscles(scene)
  return scene, mesh
end

-- Is all there that the scene is made of?
function scenes.can_make(name)
  return name ~= "dog" or dofile("tests/real/dog_scene.lua").has_data()
end

-- The name of the scene of real data where that is, else of the other one.
function scenes.dog_or(name) return scenes.can_make("dog") and "dog" or name end

-- The scene, and what tetrahedralize reported.
function scenes.make(name)
  local size = sizes[name]
  if size then return scenes.limb(size.edge, size.muscles) end
  if name == "dog" then return dog_hindleg() end
  error("no scene '" .. tostring(name) .. "' (known: " .. table.concat(scenes.names, ", ") .. ")")
end

return scenes
