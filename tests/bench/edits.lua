-- edits.lua - edits of a scene like those that a user makes, of one muscle after another.
--
--     local edit = dofile("tests/bench/edits.lua")(scene)
--     edit.move()      a control point in a muscle's middle, by one per cent of its length
--     edit.again()     the same point once more, as while it is dragged
--     edit.tissue()    the value at one point       edit.add()  edit.remove()   a muscle beside another
--     edit.fat()       edit.frame()                 the frame of one muscle turns; edit.no_frame()
--
-- Nothing is solved here. The same calls give the same scenes.

return function(scene)
  local edit, count, muscle = {}, 0, nil

  local function next_muscle()
    local all = scene:muscles()
    count = count + 1
    muscle = all[(7 * count) % #all + 1]
    return muscle
  end

  -- Along one axis after another, first this way and then back: no two edits undo each other at once.
  local axes = {sinew.vec3(1, 0, 0), sinew.vec3(0, 1, 0), sinew.vec3(0, 0, 1)}
  local function sign() return count // 3 % 2 == 0 and 1 or -1 end
  local function aside(m) return axes[count % 3 + 1] * (0.01 * sign() * m:length()) end

  local function move_middle(m)
    local i = (m:point_count() + 1) // 2
    m:set_point(i, m:point(i) + aside(m))
  end

  function edit.move() move_middle(next_muscle()) end

  function edit.again()
    count = count + 1
    move_middle(muscle)
  end

  function edit.tissue()
    local m = next_muscle()
    local i = count % m:point_count() + 1
    m:set_tissue(i, m:tissue(i) * (1 + 0.1 * sign()))
  end

  function edit.add()
    local m, points = next_muscle(), {}
    local n = m:point_count()
    for i = 1, n do
      points[i] = (i == 1 or i == n) and m:point(i) or m:point(i) + aside(m)
    end
    scene:add_muscle("added", {points = points})
  end

  function edit.remove() scene:remove_muscle("added") end

  function edit.fat()
    count = count + 1
    scene:set_fat(count % 2 == 0 and 0.25 or 0.22)
  end

  local framed
  function edit.frame()
    framed = framed or next_muscle()
    count = count + 1
    framed:set_frame{angle = 10 * count, eigenvalues = {1, 4, 0.4}}
  end

  function edit.no_frame()
    framed:set_frame(nil)
    framed = nil
  end

  return edit
end
