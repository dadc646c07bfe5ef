-- machine.lua - what it was measured on, in Markdown. $SINEW_BENCH_PACKAGES: lines of "package version", by bench.sh.

local m = bench.machine()
print(string.format("%s, %d cores, %.1f GiB of memory; sinew %s with %d threads.", m.cpu, m.cores, m.memory / 1024,
                    sinew.version, sinew.threads()))
print(string.format("CHOLMOD %s, Eigen %s, %s; %s.", m.cholmod, m.eigen, m.openblas:gsub("%s+$", ""), m.renderer))
local packages = os.getenv("SINEW_BENCH_PACKAGES")
if packages then print("Packages: " .. packages:gsub("%s*\n%s*", ", "):gsub(",%s*$", "") .. ".") end
print()
