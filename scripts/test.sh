#!/bin/sh
# test.sh - sets up a fresh Debian 12 machine, builds, and runs all tests. Arguments go to ctest.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh tests
exec ctest --test-dir build -j "$(nproc)" --output-on-failure "$@"
