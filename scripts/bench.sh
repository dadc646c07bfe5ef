#!/bin/sh
# bench.sh - measures edits beside the usual way to solve again, into out/bench.md and on standard output (Markdown).
#     sh scripts/bench.sh [SCENE...]     the scenes of tests/bench/scenes.lua: S, L, XL, dog [L]
#     sh scripts/bench.sh scaling        cost against size, 50 thousand to 4 million tets, 1 to 300 muscles
# Installs Eigen for the references, and what scripts/setup.sh installs. The machine should have nothing else to do.
set -eu
cd "$(dirname "$0")/.."

sh scripts/setup.sh
if ! dpkg-query -W -f '${Status}' libeigen3-dev 2>/dev/null | grep -q "install ok installed"; then
    as_root=""
    [ "$(id -u)" = 0 ] || as_root="sudo"
    $as_root apt-get update -qq
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libeigen3-dev >&2
fi
cmake -S . -B build -DSN_BENCH=ON >&2
cmake --build build -j "$(nproc)" --target sinew-bench >&2

SINEW_BENCH_PACKAGES=$(dpkg-query -W -f '${binary:Package} ${Version}\n' libcholmod3 libmetis5 libopenblas0-pthread \
    libosmesa6 libeigen3-dev 2>/dev/null || true)
export SINEW_BENCH_PACKAGES
mkdir -p out
[ $# -gt 0 ] || set -- L
{
    printf 'sh scripts/bench.sh %s, %s\n\n' "$*" "$(date -u +%Y-%m-%d)"
    build/sinew-bench tests/bench/machine.lua
    for scene; do
        echo "measuring $scene" >&2
        if [ "$scene" = scaling ]; then
            build/sinew-bench tests/bench/scaling.lua
        else
            build/sinew-bench tests/bench/table.lua "$scene"
        fi
    done
} >out/bench.md
cat out/bench.md
