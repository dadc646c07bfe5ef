#!/bin/sh
# test.sh - sets up a fresh Debian 12 machine, builds, and runs all tests; then the unit, Lua and fuzz tests once more
# under the address and undefined-behaviour sanitizers (build/sanitize). Arguments go to the first ctest.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh tests
ctest --test-dir build -j "$(nproc)" --output-on-failure "$@"

cmake -S . -B build/sanitize -DCMAKE_BUILD_TYPE=Release -DSN_SANITIZE=ON >&2
cmake --build build/sanitize -j "$(nproc)" >&2
exec ctest --test-dir build/sanitize -j "$(nproc)" --output-on-failure -R '^(unit|lua|fuzz)/'
