-- sheet - what the figures share: where they are written, colour maps, plots, and sheets of panels with labels.
--
--     local sheet = dofile((arg[0]:match("^.*/") or "") .. "sheet.lua")
--
-- Places are in pixels from the top left corner, (1, 1), as in img:line and img:text.

local sheet = {
  ink = "#202020",            -- text and axes
  soft = "#707070",           -- what is said by the way
  hair = "#c8c8c8",           -- frames and grid lines
  skin = "#3fb8a9",           -- aquamarine, as in the paper's pictures
}

-- ---- output ----

-- Makes the folder `out` (-D out=FOLDER, else out/figures) before any work is done.
function sheet.folder()
  if not out then
    assert(sinew.folder("out"))
    out = "out/figures"
  end
  return assert(sinew.folder(out))
end

-- Writes the picture into that folder and says where.
function sheet.save(img, name)
  local path = sheet.folder() .. "/" .. name
  assert(img:save(path))
  print(path)
end

-- ---- colours ----

-- "#rrggbb" of {r, g, b} in 0..1.
function sheet.hex(c)
  local function byte(v) return math.floor(255 * math.min(math.max(v, 0), 1) + 0.5) end
  return string.format("#%02x%02x%02x", byte(c[1]), byte(c[2]), byte(c[3]))
end

-- {r, g, b} of "#rrggbb".
function sheet.rgb(hex)
  local r, g, b = hex:match("^#(%x%x)(%x%x)(%x%x)$")
  return {tonumber(r, 16) / 255, tonumber(g, 16) / 255, tonumber(b, 16) / 255}
end

function sheet.mix(a, b, t)
  return {a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]), a[3] + t * (b[3] - a[3])}
end

-- Viridis (Smith and van der Walt 2015, CC0) at nine even steps: its lightness rises evenly from dark to bright.
local viridis = {}
for i, hex in ipairs{"#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30",
                     "#fde725"} do
  viridis[i] = sheet.rgb(hex)
end

-- The colour of t in 0..1.
function sheet.color(t)
  local x = math.min(math.max(t, 0), 1) * (#viridis - 1)
  local i = math.min(math.floor(x), #viridis - 2)
  return sheet.mix(viridis[i + 1], viridis[i + 2], x - i)
end

-- ---- pixel maps ----

-- Sets the pixels x0 + 1 .. x0 + w, y0 + 1 .. y0 + h of img to color(i, j) -> {r, g, b}, or leaves them where it gives
-- nothing. Runs of one colour are filled at once.
function sheet.pixels(img, x0, y0, w, h, color)
  for j = 1, h do
    local first, last
    for i = 1, w + 1 do
      local c = i <= w and color(i, j)
      local hex = c and sheet.hex(c)
      if hex ~= last then
        if last then img:fill{x = x0 + first, y = y0 + j, width = i - first, height = 1, color = last} end
        first, last = i, hex
      end
    end
  end
end

-- ---- panels ----

-- A sheet of panels for {rows=, columns=, panel={w, h}, lines= of text under each panel, title=, note=}:
-- {img=, place(k) -> x, y of the top left pixel, paste(k, img), label(k, text, ...)}.
function sheet.new(o)
  local margin, gap = 36, 24
  local top = margin + 60
  local label_height = 28 + 22 * (o.lines or 1)
  local w, h = table.unpack(o.panel)
  local row = h + label_height
  local s = {img = sinew.image.new{size = {2 * margin + o.columns * w + (o.columns - 1) * gap,
                                           top + o.rows * row + (o.rows - 1) * 4 + margin - 12}}}
  s.img:text{x = margin, y = margin + 16, text = o.title, size = 26, color = sheet.ink}
  s.img:text{x = margin, y = margin + 46, text = o.note, size = 17, color = sheet.soft}

  function s.place(k)
    local i, j = (k - 1) % o.columns, (k - 1) // o.columns
    return margin + i * (w + gap) + 1, top + j * (row + 4) + 1
  end

  function s.paste(k, img)
    local x, y = s.place(k)
    s.img:paste(img, x, y)
  end

  -- The first line in ink, the others softer.
  function s.label(k, ...)
    local x, y = s.place(k)
    for i, text in ipairs{...} do
      s.img:text{x = x + w / 2, y = y + h + 22 * i + (i > 1 and 2 or 0), text = text, align = "center",
                 size = i == 1 and 19 or 16, color = i == 1 and sheet.ink or sheet.soft}
    end
  end

  return s
end

-- A frame of one pixel around the rectangle.
function sheet.frame(img, x, y, w, h, color)
  local right, bottom = x + w - 1, y + h - 1
  img:line{points = {{x, y}, {right, y}, {right, bottom}, {x, bottom}, {x, y}}, color = color or sheet.hair}
end

return sheet
