-- reference.lua - writes the reference of the scripting interface from the help texts of the program:
--
--     build/sinew scripts/reference.lua > lua/REFERENCE.md

local groups = {
  {"General", {"sinew%.[%w_]+$", "sinew$", "vec3:"}, "Points go in as `{x, y, z}`, `{x=, y=, z=}` or a vec3 and come out as a vec3."},
  {"Surfaces", {"sinew%.surface%.", "surface:"}, "Closed surfaces turn outwards. Files: OBJ, PLY, STL, OFF, by extension."},
  {"Shapes", {"sinew%.shape%.", "shape:"}, "Implicit shapes, for skins and bones that a script makes."},
  {"Scene", {"scene:"}, "Solve, render and extract first bring up to date whatever is stale."},
  {"Bones", {"sinew%.bones%.", "bone:"}, "Templates of the library are in metres, of the left side in the anatomical position: +x lateral, +y up, +z to the front."},
  {"Muscles", {"muscle:", "head:"}, "Points and tissue values are counted from 1. The first point is the origin, the last the insertion."},
  {"Pictures", {"sinew%.image%.", "image:"}},
  {"Extraction and tet meshes", {"extraction:", "part:", "sinew%.tets%.", "tets:"},
   "Tissue 0 is fat; muscles follow in the order the script added them. That number is the material id in `.vtu`; in `.mesh` and `.msh`, where 0 means none, it is one more."},
}

print([[
# The scripting interface

Written by `build/sinew scripts/reference.lua` from the texts that `help()` shows in the REPL. Options in `{}` are tables;
a value after `=` is the default.

- Lengths are in the scene's unit, volumes in its cube, angles in degrees. No result depends on the unit.
- Indices start at 1. An index out of range, a wrong type, a NaN or an option key that is not known raises an error that names
  the argument and lists what is known.
- Files that cannot be read or written return `nil, message`. Computations that fail raise.
- Exit codes of a script: 0 ok, 1 script error, 2 usage, 3 input file, 4 meshing, 5 solver, 6 rendering, 7 pictures differ,
  8 a limit was reached, 130 interrupted.
- Sources of the methods: `core/REFERENCES.md`.
]])

local taken = {}
for _, group in ipairs(groups) do
  local title, patterns, intro = table.unpack(group)
  local names = {}
  for name in pairs(sinew.help_text) do
    for _, p in ipairs(patterns) do
      if not taken[name] and name:find("^" .. p) then
        taken[name] = true
        names[#names + 1] = name
      end
    end
  end
  table.sort(names)
  print("## " .. title .. "\n")
  if intro then print(intro .. "\n") end
  for _, name in ipairs(names) do
    local signature, text = sinew.help_text[name]:match("^(.-)  (.*)$")
    print("- `" .. (signature or sinew.help_text[name]) .. "`" .. (text and "  \n  " .. text or ""))
  end
  print("")
end

local left = {}
for name in pairs(sinew.help_text) do
  if not taken[name] then left[#left + 1] = name end
end
if #left > 0 then
  table.sort(left)
  error("no group for: " .. table.concat(left, ", "))
end
