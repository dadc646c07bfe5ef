#!/bin/sh
# golden_test.sh SINEW SCENE KEEP - runs tests/golden/SCENE.lua and compares its pictures and numbers with those beside it.
# What differs stays in KEEP. SN_UPDATE_GOLDEN=1 takes what was made as the new expectation: look at it first.
#
# Limits: no more than 0.5 % of the pixels differ by more than 12 of 255 in a channel. Code that llvmpipe makes for
# another processor moves single pixels on edges; a missing curve or muscle is thousands of pixels. For numbers see
# numbers.awk.
set -eu
sinew=$1 scene=$2 keep=$3
here=$(dirname "$0")
rm -rf "$keep"
mkdir -p "$keep"
"$sinew" -q --renderer osmesa -D out="$keep" "$here/$scene.lua" >"$keep/$scene.txt"
status=0
for actual in "$keep"/*.png "$keep"/*.txt; do
    expected="$here/$(basename "$actual")"
    if [ "${SN_UPDATE_GOLDEN:-}" = 1 ]; then
        cp "$actual" "$expected"
    elif [ ! -f "$expected" ]; then
        echo "missing: $expected" >&2
        status=1
    elif [ "${actual%.txt}" != "$actual" ]; then
        awk -f "$here/numbers.awk" "$expected" "$actual" >&2 || status=1
    else
        "$sinew" compare "$expected" "$actual" --diff "$keep/diff_$(basename "$actual")" --max 12 --count 800 >&2 || status=1
    fi
done
exit $status
