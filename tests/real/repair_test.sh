#!/bin/sh
# repair_test.sh SINEW KEEP - an artist's human and the bones of gait2392 become closed, manifold, outward surfaces without
# self-intersections, within the tolerances asked for. Exit 77 (skipped) without the data.
set -eu
sinew=$1 keep=$2
data=${SINEW_DATA:-../shared/data}
if [ ! -d "$data/human" ] || [ ! -d "$data/gait2392/posed" ]; then
    echo "no data in $data (set SINEW_DATA): skipped"
    exit 77
fi
rm -rf "$keep"
mkdir -p "$keep"
"$sinew" -q -D out="$keep" tests/real/repair.lua >"$keep/log" 2>/dev/null || { cat "$keep/log"; exit 1; }
cat "$keep/log"
grep -q "^0 surfaces are not as wanted" "$keep/log"
