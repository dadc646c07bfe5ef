-- adaptive_test - adaptive tet meshes from a script: the report, what is refused, edits
dofile("tests/lua/harness.lua")

local made = dofile("tests/lua/small_scene.lua")
local options = {edge_length = 0.2, bone_edge_length = 0.12, adaptive = true}

test("fewer tets, and the report says what they cost", function()
    local s = made()
    local even = s:tetrahedralize{edge_length = 0.2, bone_edge_length = 0.12}
    check(even.coarse_tets == nil and even.seconds_coarse == nil)
    local r = s:tetrahedralize(options)
    check(r.tets < even.tets, "fewer tets")
    check(r.coarse_tets > 0 and 0 < r.seconds_coarse and r.seconds_coarse < r.seconds)
    check(s:report().body.coarse_tets == r.coarse_tets)
    check(s:extract():check().conforming)
    check(s:tetrahedralize{edge_length = 0.2, bone_edge_length = 0.12, adaptive = false}.tets == even.tets)
end)

test("the mesh stays when muscles are edited", function()
    local s = made()
    local r = s:tetrahedralize(options)
    s:muscle("flexor"):set_point(2, {0.2, -0.3, 0.5})
    check(s:solve().meshed == false)
    check(s:tetrahedralize(options).tets ~= r.tets, "another mesh")
end)

test("refused", function()
    local s = made("bones")
    checkerr("an adaptive mesh is fine where muscles meet, and the scene has none: add_muscle first",
             function() s:tetrahedralize(options) end)
    checkerr("option 'adaptive': boolean expected", function() s:tetrahedralize{adaptive = 1} end)
    check(s:tetrahedralize{edge_length = 0.4}.tets > 0)
end)

finish()
