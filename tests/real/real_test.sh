#!/bin/sh
# real_test.sh SINEW KEEP - the dog from the raw files to picture and tets: at least 400,000 tets, everything true, a second
# run writes the same bytes, and a checker that shares no code with sinew finds the same. Exit 77 (skipped) without the data.
set -eu
sinew=$1 keep=$2
data=${SINEW_DATA:-../shared/data}
if [ ! -d "$data/dog_hindleg" ]; then
    echo "no data in $data (set SINEW_DATA): skipped"
    exit 77
fi
rm -rf "$keep"
mkdir -p "$keep/first" "$keep/second"

"$sinew" -q -D out="$keep/first" tests/real/dog_hindleg.lua >"$keep/first/log" 2>/dev/null
cat "$keep/first/log"
grep -q "conforming true, manifold true, positive true" "$keep/first/log"
tets=$(sed -n 's/^tets \([0-9]*\),.*/\1/p' "$keep/first/log")
[ "$tets" -ge 400000 ] || { echo "only $tets tets, need 400000" >&2; exit 1; }

"$sinew" -q --threads 1 -D out="$keep/second" tests/real/dog_hindleg.lua >/dev/null 2>&1
cmp "$keep/first/dog_hindleg.mesh" "$keep/second/dog_hindleg.mesh"

python3 tests/check_mesh.py "$keep/first/dog_hindleg.mesh"
