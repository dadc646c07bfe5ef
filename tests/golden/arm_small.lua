-- The example arm on a coarser mesh. Its pictures are compared, and the numbers that it writes to arm.txt.
size = 0.012
local say = print
print = function() end -- its times differ from run to run
dofile("scripts/examples/arm.lua")
print = say
os.remove(out .. "/arm_fibers.png") -- lines that end a pixel earlier on another processor; fibers.lua has few of them
