#!/bin/sh
# figures.sh - sets up a fresh Debian 12 machine, builds, and draws figures of the paper into out/figures. Run again at
# will. Arguments are options of the program (-D panel=700, --threads 2).
# Figure 13 needs the dog's data (../shared/data, or $SINEW_DATA): without it, it is skipped.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
mkdir -p out/figures
for figure in scripts/figures/fig*.lua; do
    build/sinew -q "$@" -D out=out/figures "$figure"
done
build/sinew -q -D out=out/figures scripts/figures/bones_sheet.lua
