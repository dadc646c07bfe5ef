-- measure.lua - what the measurements share: medians, seconds and memory of a call, tables in Markdown.

local measure = {}

function measure.median(t)
  local sorted = table.move(t, 1, #t, 1, {})
  table.sort(sorted)
  local n = #sorted
  return n % 2 == 1 and sorted[n // 2 + 1] or (sorted[n // 2] + sorted[n // 2 + 1]) / 2
end

function measure.seconds(f, ...)
  local start = sinew.time()
  local result = f(...)
  return sinew.time() - start, result
end

-- A row of measurements of one kind: add(f, ...) calls f and keeps its seconds, and the largest memory: peak is that of
-- the process, grown what was more than before the call; MiB. With measure.is_memory all free memory goes back to the
-- system before: then a call takes all that it needs anew.
local series = {}
series.__index = series

function measure.series(name)
  return setmetatable({name = name, seconds = {}, peak = 0, grown = 0}, series)
end

function series:add(f, ...)
  collectgarbage()
  if measure.is_memory then bench.trim() end
  bench.reset_peak()
  local before = bench.memory()
  local seconds, result = measure.seconds(f, ...)
  local _, peak = bench.memory()
  self.seconds[#self.seconds + 1] = seconds
  self.peak, self.grown = math.max(self.peak, peak), math.max(self.grown, peak - before)
  return result
end

function series:median() return measure.median(self.seconds) end
function series:slowest() return math.max(table.unpack(self.seconds)) end

-- A table in Markdown: the names of its columns, and rows of texts. The first column is text, the others numbers.
function measure.print_table(columns, rows)
  local width = {}
  for i, name in ipairs(columns) do
    width[i] = utf8.len(name)
    for _, row in ipairs(rows) do width[i] = math.max(width[i], utf8.len(row[i])) end
  end
  local function line(row)
    local cells = {}
    for i, text in ipairs(row) do
      local room = (" "):rep(width[i] - utf8.len(text))
      cells[i] = i == 1 and text .. room or room .. text
    end
    print("| " .. table.concat(cells, " | ") .. " |")
  end
  line(columns)
  local rule = {}
  for i = 1, #columns do rule[i] = ("-"):rep(width[i] - 1) .. (i == 1 and "-" or ":") end
  print("| " .. table.concat(rule, " | ") .. " |")
  for _, row in ipairs(rows) do line(row) end
  print()
end

-- Three digits, or "-" for nil.
function measure.text(x)
  if not x then return "-" end
  if x == 0 then return "0" end
  local digits = math.max(0, 2 - math.floor(math.log(math.abs(x), 10)))
  return string.format("%." .. math.min(digits, 4) .. "f", x)
end

-- a, b of the line log(y) = a + b log(x) nearest to the points, by least squares.
function measure.exponent(xs, ys)
  local n, sx, sy, sxx, sxy = #xs, 0, 0, 0, 0
  for i = 1, n do
    local x, y = math.log(xs[i]), math.log(ys[i])
    sx, sy, sxx, sxy = sx + x, sy + y, sxx + x * x, sxy + x * y
  end
  return (n * sxy - sx * sy) / (n * sxx - sx * sx)
end

return measure
