-- harness - test(name, fn), check, checkerr, checknear; finish() at the end of a file prints the sum and sets the
-- exit code. SN_GC_STRESS in the environment makes the collector run nearly all the time.
local passed, failed = 0, 0

if os.getenv("SN_GC_STRESS") then collectgarbage("incremental", 1, 10000) end

function test(name, fn)
    local ok, message = xpcall(fn, debug.traceback)
    if ok then passed = passed + 1 return end
    failed = failed + 1
    io.stderr:write("FAILED ", name, ": ", tostring(message), "\n")
end

function check(value, what)
    if not value then error((what or "check") .. " failed", 2) end
    return value
end

-- Calls f(...), which must raise a message with the pattern (or plain text) in it.
function checkerr(pattern, f, ...)
    local ok, message = pcall(f, ...)
    if ok then error("no error, expected '" .. pattern .. "'", 2) end
    message = tostring(message)
    if not (message:find(pattern, 1, true) or message:find(pattern)) then
        error("the error '" .. message .. "' does not say '" .. pattern .. "'", 2)
    end
end

function checknear(got, want, tolerance, what)
    if not (math.abs(got - want) <= (tolerance or 1e-12)) then
        error(string.format("%s is %.17g, expected %.17g", what or "value", got, want), 2)
    end
end

function finish()
    print(passed .. " passed, " .. failed .. " failed")
    if failed > 0 then os.exit(1, true) end
end
