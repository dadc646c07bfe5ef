#!/bin/sh
# demo.sh - sets up a fresh Debian 12 machine, builds, and makes an arm: skin, bones and muscles from one script.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
build/sinew scripts/examples/arm.lua
echo "out/arm.png          the picture"
echo "out/arm_section.png  a section through the upper arm"
echo "out/arm_fibers.png   the fibers"
echo "out/arm.vtu, .mesh   all tissues as tets (ParaView, MEDIT)"
echo "out/arm_muscles/     one surface for each muscle"
