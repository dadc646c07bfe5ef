#!/bin/sh
# bones.sh - makes the bone library anew: assets/bones/NAME.obj and NAME.txt, by the scripts in scripts/bones. The same
# bytes each time. Needs a build; arguments are options of the program (-D only=femur, -D out=FOLDER, --threads 1).
set -eu
cd "$(dirname "$0")/.."
mkdir -p assets/bones
for script in scripts/bones/*.lua; do
    case $script in
    */kit.lua | */simplify.lua) ;;
    *) build/sinew -q "$@" "$script" ;;
    esac
done
