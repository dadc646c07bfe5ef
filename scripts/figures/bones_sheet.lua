-- bones_sheet - every bone of the library from the front, from its left side and from behind, on one sheet.
--
--     sinew scripts/figures/bones_sheet.lua
--
-- Writes bones_sheet.png into the folder `out`. -D tile=300 makes the pictures larger.
local sheet = dofile((arg[0]:match("^.*/") or "") .. "sheet.lua")
local size = tile or 210
local assets = (arg[0]:match("^(.*)scripts/figures/") or "") .. "assets/bones/"

local names = {"skull", "sternum", "scapula", "pelvis", "hand", "foot", "patella", "clavicle", "humerus", "ulna",
               "radius", "metacarpal", "phalanx", "femur", "tibia", "fibula", "rib", "rib_pair", "cervical", "thoracic",
               "lumbar", "caudal"}

-- The object `name` of an .obj file with several.
local function object(name)
  local vertices, faces, count, first = {}, {}, 0, nil
  for line in assert(io.lines(assets .. name .. ".obj")) do
    local key, a, b, c = line:match("^(%a) (%S+) ?(%S*) ?(%S*)")
    if key == "o" then first = a == name and count or nil end
    if key == "v" then
      count = count + 1
      if first then vertices[#vertices + 1] = {tonumber(a), tonumber(b), tonumber(c)} end
    elseif key == "f" and first then
      faces[#faces + 1] = {a - first, b - first, c - first}
    end
  end
  return sinew.surface.new(vertices, faces)
end

-- The longest side seen, for the label: pictures fill their panels whatever the size.
local function extent(surface)
  local box = surface:bounds()
  local d = box.max - box.min
  return math.max(d.x, d.y, d.z) * 1e3
end

local views = {"front", "left", "back", {azimuth = 35, elevation = 25}}
local columns = 3
local s = sheet.new{rows = math.ceil(#names / columns), columns = columns, panel = {#views * size, size}, lines = 2,
                    title = "The bone library",
                    note = "each from the front, the left, behind, and from above the front"}
for k, name in ipairs(names) do
  local surface = object(name)
  local scene = sinew.scene{name = name}
  scene:add_bone(name, surface)
  local x, y = s.place(k)
  for i, view in ipairs(views) do
    s.img:paste(scene:render{size = {size, size}, camera = view, show = {"bones"}}, x + (i - 1) * size, y)
  end
  s.label(k, name, string.format("%.0f mm, %d faces", extent(surface), surface:face_count()))
  scene:close()
end
sheet.save(s.img, "bones_sheet.png")
