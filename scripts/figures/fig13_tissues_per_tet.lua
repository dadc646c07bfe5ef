-- fig13_tissues_per_tet - how many tissues meet in a tet: the hind leg of a dog beside the paper's lion (Fig. 13).
--
--     sinew scripts/figures/fig13_tissues_per_tet.lua [-D out=FOLDER]         needs the dog's data: see dog_scene.lua
--
-- Writes fig13_tissues_per_tet.png into `out` and prints the numbers.
-- Options: -D skin_edge=METRES, -D bone_edge=METRES.

local here = arg[0]:match("^.*/") or ""
local sheet = dofile(here .. "sheet.lua")
local dog = dofile(here .. "../../tests/real/dog_scene.lua")

if not dog.has_data() then
  print("fig13_tissues_per_tet: skipped, there is no " .. dog.data
        .. " (set SINEW_DATA to the folder that holds dog_hindleg)")
  return
end
sheet.folder()

-- Percentages of the paper's lion: it gives those of 1 and 2 tissues, says that no tet has 6 or more, and leaves 3 to 5
-- as the rest.
local lion = {[1] = 78, [2] = 19, rest = 3, [6] = 0}
local most = 6                    -- the last bar: that many or more

-- ---- numbers ----

local scene = dog.body()
scene:tetrahedralize{edge_length = skin_edge or 0.011, bone_edge_length = bone_edge or 0.004}
dog.add_muscles(scene)
local counts, total = {}, 0
for k, n in ipairs(scene:report().tissues_per_tet) do
  counts[math.min(k, most)] = (counts[math.min(k, most)] or 0) + n
  total = total + n
end
local percent = {}
for k = 1, most do percent[k] = 100 * counts[k] / total end

local function thousands(n)
  local text = tostring(n):reverse():gsub("(%d%d%d)", "%1,"):reverse()
  return (text:gsub("^,", ""))
end

-- Small shares keep a digit, and what is there is never printed as nothing.
local function share(p, n)
  if n == 0 then return "0 %" end
  if p >= 0.1 then return string.format(p >= 1 and "%.1f %%" or "%.2f %%", p) end
  return p >= 0.001 and string.format("%.3f %%", p) or "< 0.001 %"
end

-- ---- chart ----

local w, h = 1200, 830
local left, right, top, bottom = 110, w - 40, 140, h - 150
local color = {dog = "#b05a3c", lion = "#cfc5b4"}
local img = sinew.image.new{size = {w, h}}

local function y_of(p) return bottom - (bottom - top) * p / 100 end

local function bar(x, p, width, fill)
  local y = math.floor(y_of(p) + 0.5)
  if bottom > y then img:fill{x = math.floor(x), y = y, width = width, height = bottom - y, color = fill} end
end

local function text(x, y, s, size, c, align, rotate)
  img:text{x = x, y = y, text = s, size = size, color = c or sheet.ink, align = align or "center", rotate = rotate or 0}
end

text(left, 54, "Tissues per tet", 26, nil, "left")
local muscles = #scene:muscles()
img:fill{x = left, y = 78, width = 18, height = 18, color = color.dog}
text(left + 28, 93, string.format("dog: %d muscles of one hind leg, %s tets", muscles, thousands(total)), 19, nil, "left")
img:fill{x = left + 540, y = 78, width = 18, height = 18, color = color.lion}
text(left + 568, 93, "paper's lion: 39 muscles, 642,224 tets", 19, nil, "left")

for p = 0, 100, 20 do
  img:line{points = {{left, y_of(p)}, {right, y_of(p)}}, color = p == 0 and sheet.ink or "#e4e4e4"}
  text(left - 14, y_of(p) + 6, p .. " %", 18, sheet.soft, "right")
end
text(40, (top + bottom) / 2, "share of all tets", 19, sheet.soft, "center", 90)

-- Over a bar, on white: grid lines stay behind.
local function bar_label(x, p, s, color)
  local size = 19
  local wide = img:text_size{text = s, size = size}
  local y = math.floor(y_of(p) + 0.5)
  img:fill{x = math.floor(x - wide / 2) - 3, y = y - 28, width = math.ceil(wide) + 6, height = 26, color = "white"}
  text(x, y - 10, s, size, color)
end

local step, width = (right - left) / most, 62
for k = 1, most do
  local x = left + (k - 0.5) * step
  bar(x - width - 3, percent[k], width, color.dog)
  bar_label(x - 3 - width / 2, percent[k], share(percent[k], counts[k]))
  if lion[k] then
    bar(x + 3, lion[k], width, color.lion)
    bar_label(x + 3 + width / 2, lion[k], lion[k] .. " %", sheet.soft)
  end
  text(x, bottom + 30, k < most and tostring(k) or most .. " or more", 20)
  text(x, bottom + 54, thousands(counts[k]) .. (counts[k] == 1 and " tet" or " tets"), 16, sheet.soft)
end
-- One bracket for the three bars that the paper does not tell apart.
local a, b, y = left + 2.5 * step + 3, left + 4.5 * step + 3 + width, y_of(lion.rest) - 48
img:line{points = {{a, y + 8}, {a, y}, {b, y}, {b, y + 8}}, width = 1.5, color = sheet.soft}
text((a + b) / 2, y - 12, "lion: 3 to 5 together " .. lion.rest .. " %", 19, sheet.soft)
text((left + right) / 2, h - 56, "tissues (muscles and fat) with a part in the tet", 19, sheet.soft)
text((left + right) / 2, h - 26, "The dog's skin is that of the whole animal: far from the leg each tet is fat alone.",
     16, sheet.soft)

for k = 1, most do
  print(string.format("%d%s  %8d tets  %s", k, k == most and "+" or " ", counts[k], share(percent[k], counts[k])))
end
sheet.save(img, "fig13_tissues_per_tet.png")
