-- The written reference is what the program says of itself today.
dofile("tests/lua/harness.lua")

test("lua/REFERENCE.md is up to date", function()
  local lines = {}
  local real_print = print
  print = function(text) lines[#lines + 1] = text end
  dofile("scripts/reference.lua")
  print = real_print
  local file = assert(io.open("lua/REFERENCE.md"))
  local written = file:read("a")
  file:close()
  check(written == table.concat(lines, "\n") .. "\n", "run: build/sinew scripts/reference.lua > lua/REFERENCE.md")
end)

test("every text starts with a signature that names the function", function()
  for name, text in pairs(sinew.help_text) do
    local last = name:match("[%w_]+$")
    check(text:find(last, 1, true), name .. ": " .. text)
  end
end)

finish()
