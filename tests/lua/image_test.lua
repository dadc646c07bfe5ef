-- image_test - sinew.image, and pictures of a scene: options, cameras, files, what the pixels show
dofile("tests/lua/harness.lua")
local small_scene = dofile("tests/lua/small_scene.lua")

local nan = 0 / 0
local dir = os.tmpname()
os.remove(dir)
assert(os.execute("mkdir " .. dir))

local function unhex(text) return (text:gsub("%x%x", function(h) return string.char(tonumber(h, 16)) end)) end

local function write(name, bytes)
    local file = assert(io.open(dir .. "/" .. name, "wb"))
    file:write(bytes)
    file:close()
    return dir .. "/" .. name
end

local function read(path)
    local file = assert(io.open(path, "rb"))
    local bytes = file:read("a")
    file:close()
    return bytes
end

-- 2 x 2 pixels: red, green / blue, (10, 20, 30, 128). In the second picture the lower row differs by 5 and by 20.
local png_a = unhex("89504e470d0a1a0a0000000d494844520000000200000002080600000072b60d24000000154944415478da63f8cfc0f01f0c81f47f" ..
                    "2e11b9060040f206b7aa5f28800000000049454e44ae426082")
local png_b = unhex("89504e470d0a1a0a0000000d494844520000000200000002080600000072b60d24000000174944415478da63f8cfc0f01f0c19187ef" ..
                    "de71291cb010040c0069e686cedbd0000000049454e44ae426082")
local png_tall = unhex("89504e470d0a1a0a0000000d494844520000000100000003080600000052dd65820000000f4944415478da63606462fecf0027001" ..
                       "2870310e0eb9fa30000000049454e44ae426082")
local a = assert(sinew.image.load(write("a.png", png_a)))
local b = assert(sinew.image.load(write("b.png", png_b)))

local function pixel(img, x, y) return table.concat({img:pixel(x, y)}, " ") end
local function is_white(img, x, y) return pixel(img, x, y) == "255 255 255 255" end

-- ---- images ----

test("load, pixels", function()
    check(a:width() == 2 and a:height() == 2)
    check(pixel(a, 1, 1) == "255 0 0 255" and pixel(a, 2, 1) == "0 255 0 255")
    check(pixel(a, 1, 2) == "0 0 255 255" and pixel(a, 2, 2) == "10 20 30 128")
    check(tostring(a) == "image: 2 x 2 pixels")
    checkerr("index 0 not in 1..2", a.pixel, a, 0, 1)
    checkerr("bad argument #2 to 'pixel' (index 3 not in 1..2)", function() a:pixel(1, 3) end)
    checkerr("number expected, got no value", a.pixel, a, 1)
    checkerr("number has no integer representation", a.pixel, a, 1.5, 1)
end)

test("save and load again", function()
    check(a:save(dir .. "/c.png") == true)
    local c = sinew.image.load(dir .. "/c.png")
    check(sinew.image.compare(a, c).equal)
    a:save(dir .. "/d.png")
    check(read(dir .. "/c.png") == read(dir .. "/d.png"), "the same bytes")
end)

test("files that cannot be had: nil and a message", function()
    local img, message = sinew.image.load(dir .. "/none.png")
    check(img == nil and message:find("none.png: cannot open: No such file", 1, true), message)
    img, message = sinew.image.load(write("bad.png", "hello"))
    check(img == nil and message:find("bad.png: not a PNG file", 1, true), message)
    img, message = sinew.image.load(write("cut.png", png_a:sub(1, 60)))
    check(img == nil and message:find("cut.png: damaged PNG: the file is cut short", 1, true), message)
    local ok
    ok, message = a:save(dir .. "/no/a.png")
    check(ok == nil and message:find("no/a.png: cannot write: No such file", 1, true), message)
    ok, message = a:save(dir .. "/a.jpg")
    check(ok == nil and message:find("a.jpg: pictures are written as .png, found '.jpg'", 1, true), message)
    checkerr("string expected, got nil", sinew.image.load, nil)
    checkerr("text with a zero byte", a.save, a, "a\0.png")
end)

test("compare", function()
    local d = sinew.image.compare(a, b)
    check(d.equal == false and d.max == 20 and d.count == 2)
    checknear(d.rmse, math.sqrt((5 ^ 2 + 20 ^ 2) / 16))
    check(d.diff:width() == 2 and d.diff:height() == 2)
    check(sinew.image.compare(a, b, {max = 5}).count == 1 and not sinew.image.compare(a, b, {max = 5}).equal)
    check(sinew.image.compare(a, b, {max = 5, count = 1}).equal and sinew.image.compare(a, b,
                                                                                        {max = 20}).equal)
    check(sinew.image.compare(a, a).equal and sinew.image.compare(a, a).rmse == 0)
    local tall = sinew.image.load(write("tall.png", png_tall))
    checkerr("pictures: one is 2 x 2 pixels, the other 1 x 3", sinew.image.compare, a, tall)
    checkerr("unknown option 'cuont' (did you mean 'count'? known: max, count)", sinew.image.compare, a, b,
             {cuont = 1})
    checkerr("option 'max': whole number from 0 to 2147483647 expected, got -1", sinew.image.compare, a, b,
             {max = -1})
    checkerr("option 'count': whole number from 0 to 2147483647 expected, got 0.5", sinew.image.compare, a,
             b, {count = 0.5})
    checkerr("option 'max': whole number expected, got string", sinew.image.compare, a, b, {max = "1"})
    checkerr("sinew.image expected, got string", sinew.image.compare, "a.png", b)
end)

test("closed images", function()
    local c = sinew.image.load(dir .. "/a.png")
    c:close()
    c:close()
    check(tostring(c) == "image (was closed)")
    checkerr("image was closed", c.width, c)
    checkerr("image was closed", c.save, c, dir .. "/x.png")
    checkerr("image was closed", sinew.image.compare, a, c)
    checkerr("image has no 'widht' (did you mean 'width'?)", function() return a:widht() end)
    for name in pairs(getmetatable(a).__index) do check(sinew.help_text["image:" .. name], name) end
end)

-- ---- figure sheets ----

test("new, fill", function()
    local img = sinew.image.new{size = {8, 6}}
    check(tostring(img) == "image: 8 x 6 pixels" and pixel(img, 8, 6) == "255 255 255 255")
    check(pixel(sinew.image.new{size = {1, 1}, background = "transparent"}, 1, 1):match(" 0$"))
    check(pixel(sinew.image.new{size = {1, 1}, background = "#ff8000"}, 1, 1) == "255 128 0 255")
    check(img:fill{x = 2, y = 3, width = 2, height = 1, color = "black"} == img, "calls can be chained")
    for y = 1, 6 do
        for x = 1, 8 do
            check((pixel(img, x, y) == "0 0 0 255") == (y == 3 and (x == 2 or x == 3)))
        end
    end
    img:fill{x = -1, y = 6, width = 3, color = {1, 0, 0}}
    check(pixel(img, 1, 6) == "255 0 0 255" and pixel(img, 2, 6) == "255 255 255 255")
    img:fill{color = "#102030"}
    check(pixel(img, 1, 1) == "16 32 48 255" and pixel(img, 8, 6) == "16 32 48 255", "all of it")
end)

test("paste", function()
    local img = sinew.image.new{size = {4, 4}}
    check(img:paste(a, 2, 3) == img)
    check(pixel(img, 2, 3) == pixel(a, 1, 1) and pixel(img, 3, 3) == pixel(a, 2, 1) and is_white(img, 1, 3))
    check(pixel(img, 3, 4) == "187 188 188 255", "half over white, in linear light")
    img:paste(a, 0, 0):paste(a, 100, -100)
    check(pixel(img, 1, 1) ~= "255 255 255 255" and is_white(img, 2, 2))
    img:paste(img, 1, 1)
end)

test("line, text, text_size", function()
    local img = sinew.image.new{size = {60, 30}}
    check(img:line{points = {{5, 4}, {50, 4}}} == img)
    check(pixel(img, 30, 4) == "0 0 0 255" and is_white(img, 30, 3) and is_white(img, 30, 5))
    img:line{points = {{5, 10}, {50, 10}}, width = 3, color = {0, 0, 1}}
    for y = 9, 11 do check(pixel(img, 30, y) == "0 0 255 255") end
    check(is_white(img, 30, 8) and is_white(img, 30, 12))
    local w, h, ascent = img:text_size{text = "HI", size = 12}
    check(w > 8 and w < 20 and h >= 13 and ascent > 8 and ascent < h)
    check(img:text{x = 10, y = 28, text = "HI", size = 12} == img)
    local lowest, left, right = 0, 60, 0
    for y = 13, 30 do
        for x = 1, 60 do
            if not is_white(img, x, y) then
                lowest, left, right = math.max(lowest, y), math.min(left, x), math.max(right, x)
            end
        end
    end
    check(lowest == 28 and left >= 10 and right <= 10 + w, "on the baseline, within its width")
    check(img:text_size{text = ""} == 0)
    for _, align in ipairs{"left", "center", "right"} do
        img:text{x = 30, y = 28, text = "µ", align = align, rotate = 45, color = "#ff0000"}
    end
end)

test("resize", function()
    local img = sinew.image.new{size = {4, 2}}
    img:fill{x = 1, width = 1, color = "black"}:fill{x = 3, width = 1, color = "black"}
    local small = img:resize(1, 1)
    check(pixel(small, 1, 1) == "188 188 188 255" and img:width() == 4)
    check(sinew.image.compare(img, img:resize(4, 2)).equal)
    check(img:resize(8, 8):height() == 8)
end)

test("figure sheets: wrong use", function()
    local img = sinew.image.new{size = {10, 10}}
    local new = sinew.image.new
    checkerr("option 'size' is missing", new)
    checkerr("option 'size' is missing", new, {})
    checkerr("unknown option 'sice' (did you mean 'size'? known: size, background)", new, {sice = {1, 1}})
    checkerr("option 'size': width is 0, need a whole number of pixels in 1..16384", new, {size = {0, 1}})
    checkerr("option 'size': height is 16385, need", new, {size = {1, 16385}})
    checkerr("option 'size': width is ", new, {size = {nan, 1}})
    checkerr("option 'size': {width, height} expected", new, {size = 5})
    checkerr("option 'background': unknown colour 'mauve'", new, {size = {1, 1}, background = "mauve"})
    checkerr("sinew.image expected, got nil", img.paste, img, nil, 1, 1)
    checkerr("number expected, got string", img.paste, img, a, "1", 1)
    checkerr("x is 1.5, need a whole number of pixels", img.paste, img, a, 1.5, 1)
    checkerr("y is 1e+99, need a whole number of pixels", img.paste, img, a, 1, 1e99)
    checkerr("finite number expected", img.paste, img, a, nan, 1)
    checkerr("option 'color' is missing", img.fill, img, {})
    checkerr("option 'x': ", img.fill, img, {x = "1", color = "black"})
    checkerr("option 'x' is 1.5, need a whole number of pixels", img.fill, img, {x = 1.5, color = "black"})
    checkerr("image: a rectangle of -1 x 10 pixels, need 0 or more", img.fill, img, {width = -1, color = "black"})
    checkerr("option 'color': value 1 is 2, need a number in 0..1", img.fill, img, {color = {2, 0, 0}})
    checkerr("unknown option 'colour' (did you mean 'color'? known: x, y, width, height, color)", img.fill, img, {colour = "black"})
    checkerr("option 'points' is missing", img.line, img, {})
    checkerr("option 'points': list expected, got number", img.line, img, {points = 1})
    checkerr("option 'points': point 2: {x, y} expected", img.line, img, {points = {{1, 1}, {1}}})
    checkerr("option 'points': point 1: coordinate y: number expected, got string", img.line, img, {points = {{1, "1"}}})
    checkerr("option 'points': point 1: coordinate x: finite number expected", img.line, img, {points = {{nan, 1}}})
    checkerr("image: a line of 0 points, need 1 or more", img.line, img, {points = {}})
    checkerr("option 'width': number above 0 expected, got 0", img.line, img, {points = {{1, 1}}, width = 0})
    checkerr("image: a line 20000 pixels wide, need more than 0, at most 16384", img.line, img, {points = {{1, 1}}, width = 20000})
    checkerr("option 'x' is missing", img.text, img, {y = 1, text = "a"})
    checkerr("option 'y' is missing", img.text, img, {x = 1, text = "a"})
    checkerr("option 'text' is missing", img.text, img, {x = 1, y = 1})
    checkerr("option 'text': string expected, got number", img.text, img, {x = 1, y = 1, text = 1})
    checkerr("option 'align': unknown 'middle' (known: left, center, right)", img.text, img, {x = 1, y = 1, text = "a", align = "middle"})
    checkerr("option 'rotate': finite number expected", img.text, img, {x = 1, y = 1, text = "a", rotate = nan})
    checkerr("image: text of size 3000 pixels, need 1..2000", img.text, img, {x = 1, y = 1, text = "a", size = 3000})
    checkerr("need one line of plain text", img.text, img, {x = 1, y = 1, text = "a\nb"})
    checkerr("image: the text is not valid UTF-8", img.text, img, {x = 1, y = 1, text = "\xff"})
    checkerr("option 'text' is missing", img.text_size, img, {})
    checkerr("width is 0, need 1..16384 pixels", img.resize, img, 0, 1)
    checkerr("height is 16385, need 1..16384 pixels", img.resize, img, 1, 16385)
    checkerr("number expected, got no value", img.resize, img, 1)
    local closed = sinew.image.new{size = {1, 1}}
    closed:close()
    for _, name in ipairs{"paste", "fill", "line", "text", "text_size", "resize"} do
        checkerr("image was closed", closed[name], closed, {})
    end
    checkerr("image was closed", img.paste, img, closed, 1, 1)
    check(sinew.image.compare(img, sinew.image.new{size = {10, 10}}).equal, "nothing was drawn")
end)

-- ---- pictures ----

local scene = small_scene()
scene:solve()
local function render(o)
    o.size = o.size or {60, 80}
    o.samples = o.samples or 1
    return scene:render(o)
end

test("render: size, background", function()
    local img = render{}
    check(img:width() == 60 and img:height() == 80 and is_white(img, 1, 1) and not is_white(img, 30, 40))
    check(pixel(render{background = "transparent", show = {"bones"}}, 1, 1):match(" 0$"))
    check(pixel(render{background = "#ff8000"}, 1, 1) == "255 128 0 255")
    check(pixel(render{background = {0, 0.2, 1}}, 1, 1) == "0 51 255 255")
    check(pixel(render{background = {1, 0, 0, 0.2}}, 1, 1) == "255 0 0 51")
    check(pixel(render{background = "black"}, 1, 1) == "0 0 0 255")
    check(is_white(render{background = "white"}, 1, 1))
end)

test("render: what is shown", function()
    local all, some = render{show = {"muscles", "bones", "skin", "curves",
                                     "points"}}, render{show = {"muscles"}}
    check(not sinew.image.compare(all, some).equal)
    check(sinew.image.compare(render{}, render{show = {"skin", "muscles", "bones"}}).equal, "the default")
    check(not sinew.image.compare(render{skin_opacity = 1}, render{skin_opacity = 0.1}).equal)
    check(not sinew.image.compare(render{}, render{clip = {point = {0, 0, 0}, normal = {0, 0, 1}}}).equal)
    check(not sinew.image.compare(render{samples = 1}, render{samples = 3}).equal)
end)

test("render: cameras", function()
    local front = render{camera = "front"}
    check(sinew.image.compare(render{}, front).equal)
    check(sinew.image.compare(render{camera = {}}, front).equal)
    check(sinew.image.compare(render{camera = {azimuth = 0, elevation = 0, zoom = 1}}, front).equal)
    for _, name in ipairs{"back", "left", "right", "top", "bottom", "iso"} do
        check(not sinew.image.compare(render{camera = name, show = {"muscles"}},
                                      render{show = {"muscles"}}).equal, name)
    end
    local eye = render{camera = {eye = {0, 0, 9}}}
    local mid = scene:bounds()
    mid = (mid.min + mid.max) / 2
    check(sinew.image.compare(eye,
                              render{camera = {eye = {0, 0, 9}, up = {0, 1, 0}, fov = 30,
                                               target = mid}}).equal)
end)

test("render: the same again gives the same bytes", function()
    render{file = dir .. "/1.png"}
    render{file = dir .. "/2.png"}
    check(read(dir .. "/1.png") == read(dir .. "/2.png"))
end)

test("render: pictures of a scene that changes are those of a new scene", function()
    local o = {camera = {azimuth = 40, elevation = 15}, size = {90, 60}, renderer = "osmesa"}
    local before = scene:render(o)
    o.camera.azimuth = 110
    scene:render(o)
    o.camera.azimuth = 40
    check(sinew.image.compare(before, scene:render(o)).equal, "back where it was")
    check(sinew.image.compare(before, scene:render{camera = o.camera, size = o.size, renderer = "auto"},
                              {max = 12, count = 40}).equal, "auto draws the same")
end)

test("render: texts in the file give the camera back", function()
    local img = render{file = dir .. "/t.png", camera = {azimuth = 30, elevation = 20, zoom = 1.5}}
    local bytes = read(dir .. "/t.png")
    check(bytes:find("tEXtSoftware\0sinew " .. sinew.version, 1, true))
    check(bytes:find("tEXtRenderer\0", 1, true))
    local text = check(bytes:match("tEXtCamera\0({eye = {[^\0]-}, fov = [%d.e+-]+})"))
    local camera = load("return " .. text)()
    check(#camera.eye == 3 and #camera.target == 3 and #camera.up == 3 and camera.fov > 1)
    check(sinew.image.compare(img, render{camera = camera}, {max = 1}).equal)
    check(img:save(dir .. "/u.png") and read(dir .. "/u.png") == bytes, "also by save")
end)

test("render: wrong options", function()
    local function bad(pattern, o) checkerr(pattern, scene.render, scene, o) end
    bad("unknown option 'sise' (did you mean 'size'? known: file, size, camera, show, clip, background, skin_opacity, samples, fiber_count, renderer)",
        {sise = {1, 1}})
    bad("option 'size': {width, height} expected", {size = 800})
    bad("option 'size': {width, height} expected", {size = {800}})
    bad("option 'size': {width, height} expected", {size = {1, 2, 3}})
    bad("option 'size': width is 0, need a whole number of pixels in 1..16384", {size = {0, 10}})
    bad("option 'size': height is 16385, need a whole number of pixels in 1..16384", {size = {10, 16385}})
    bad("option 'size': width is 1.5, need", {size = {1.5, 10}})
    bad("option 'size': width is 10, need", {size = {"10", 10}})
    bad("option 'size': height is ", {size = {10, nan}})
    bad("option 'show': list expected, got string", {show = "skin"})
    bad("option 'show': list of names expected, item 1 is a number", {show = {1}})
    bad("option 'show': unknown 'muscle' (did you mean 'muscles'? known: muscles, bones, skin, curves, points, fibers, frames)", {show = {"muscle"}})
    bad("option 'background': unknown colour 'mauve' (known: transparent, white, black, #rrggbb)",
        {background = "mauve"})
    bad("option 'background': unknown colour '#12345g'", {background = "#12345g"})
    bad("option 'background': unknown colour '#fff'", {background = "#fff"})
    bad("option 'background': {r, g, b} or {r, g, b, a} in 0..1", {background = {1, 1}})
    bad("option 'background': {r, g, b} or {r, g, b, a} in 0..1", {background = 1})
    bad("option 'background': value 2 is 255, need a number in 0..1", {background = {0, 255, 0}})
    bad("option 'background': value 3 is ", {background = {0, 0, nan}})
    bad("option 'background': value 1 is 1, need a number", {background = {"1", 0, 0}})
    bad("option 'skin_opacity': number in 0..1 expected, got 2", {skin_opacity = 2})
    bad("option 'skin_opacity': finite number expected", {skin_opacity = nan})
    bad("option 'samples': 1..4 per pixel side expected, got 5", {samples = 5})
    bad("option 'samples': 1..4 per pixel side expected, got 0", {samples = 0})
    bad("option 'renderer': unknown 'opengl' (known: auto, osmesa, egl)", {renderer = "opengl"})
    bad("option 'renderer': string expected, got number", {renderer = 1})
    bad("option 'clip': table expected, got boolean", {clip = true})
    bad("option 'point' is missing", {clip = {normal = {1, 0, 0}}})
    bad("option 'normal' is missing", {clip = {point = {1, 0, 0}}})
    bad("option 'normal': has no length", {clip = {point = {1, 0, 0}, normal = {0, 0, 0}}})
    bad("unknown option 'offset' (known: point, normal)", {clip = {offset = 1}})
    bad("option 'file': string expected, got number", {file = 1})
    bad("table of options expected, got string", "out.png")
end)

test("render: wrong cameras", function()
    local function bad(pattern, camera) checkerr(pattern, scene.render, scene, {camera = camera}) end
    bad("unknown view 'frnt' (known: front, back, left, right, top, bottom, iso)", "frnt")
    bad("option 'camera': name of a view or table expected, got number", 1)
    bad("unknown option 'azimut' (did you mean 'azimuth'? known: eye, target, up, fov, azimuth, elevation, zoom)", {azimut = 1})
    bad("eye, target, up, fov or azimuth, elevation, zoom expected, not both", {eye = {0, 0, 9}, zoom = 2})
    bad("option 'eye' is missing", {target = {0, 0, 0}})
    bad("option 'eye': coordinate z: number expected, got nil", {eye = {0, 0}})
    bad("option 'fov': number above 0 expected, got 0", {eye = {0, 0, 9}, fov = 0})
    bad("camera: field of view is 171 degrees, need 1..170", {eye = {0, 0, 9}, fov = 171})
    bad("camera: eye and target are the same point", {eye = {0, 0, 9}, target = {0, 0, 9}})
    bad("is parallel to the view or zero", {eye = {0, 9, 0}, target = {0, 0, 0}})
    bad("camera: elevation is 91 degrees, need -90..90", {elevation = 91})
    bad("camera: zoom is 21, need 0.05..20", {zoom = 21})
    bad("option 'azimuth': finite number expected", {azimuth = nan})
end)

test("render: the file is checked before the drawing", function()
    local s = small_scene() -- not solved: a render that begins would show in its revision of the fields
    checkerr("/no/such/a.png: cannot write: No such file", s.render, s, {file = dir .. "/no/such/a.png"})
    checkerr("option 'file': " .. dir .. "/a.jpg: pictures are written as .png, found '.jpg'", s.render, s,
             {file = dir .. "/a.jpg"})
    checkerr("pictures are written as .png, found '.'", s.render, s, {file = dir})
    assert(os.execute("mkdir " .. dir .. "/folder.png"))
    checkerr("folder.png: cannot write: Is a directory", s.render, s, {file = dir .. "/folder.png"})
    check(s:solve().factorized == true, "nothing was solved")
    local list = io.popen("ls -a " .. dir)
    check(not list:read("a"):find("png%.%w%w%w%w%w%w"), "no temporary file stays")
    list:close()
end)

test("render: nothing to show", function()
    local s = sinew.scene()
    checkerr("render: the scene has nothing to show", s.render, s)
    checkerr("render: the scene has nothing to show", s.render, s, {camera = {eye = {0, 0, 1}}})
end)

test("render: stages of a scene", function()
    check(not is_white(small_scene("skin"):render{size = {20, 20}}, 10, 10))
    check(not is_white(small_scene("bones"):render{size = {20, 20}}, 10, 10))
    local s = sinew.scene()
    s:add_muscle("m", {points = {{0, 0, 0}, {0, 1, 0}}})
    check(not is_white(s:render{size = {21, 21}, show = {"curves"}}, 11, 11))
end)

test("render: a flat picture is a warning", function()
    local first = 0
    while arg[first - 1] do first = first - 1 end
    local path = write("flat.lua", ([[
        local s = sinew.scene()
        s:set_skin(sinew.shape.sphere({0, 0, 0}, 1):mesh{cell = 0.5})
        s:render{file = "DIR/flat.png", size = {16, 16}, show = {"bones"}}]]):gsub("DIR", dir))
    local run = io.popen(arg[first] .. " " .. path .. " 2>&1")
    local out = run:read("a")
    check(run:close(), out)
    check(out:find("warning: " .. dir .. "/flat.png: picture is one flat colour", 1, true), out)
end)

os.execute("rm -rf " .. dir)
finish()
