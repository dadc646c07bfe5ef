#!/bin/sh
# setup.sh - installs what is missing on Debian 12 and builds build/sinew (Release). Run again at will.
#     sh scripts/setup.sh [tests]      with `tests`: also what the tests need
set -eu
cd "$(dirname "$0")/.."

packages="gcc g++ make cmake pkg-config liblua5.4-dev libtet1.5-dev libsuitesparse-dev libopenblas-dev libosmesa6-dev libegl-dev
libpng-dev libcairo2-dev fonts-dejavu-core libreadline-dev libcgal-dev libgmp-dev libmpfr-dev libdune-istl-dev"
testing=OFF
if [ "${1:-}" = tests ]; then
    packages="$packages libcmocka-dev python3"
    testing=ON
fi

missing=""
for p in $packages; do
    status=$(dpkg-query -W -f '${Status}' "$p" 2>/dev/null || true)
    [ "$status" = "install ok installed" ] || missing="$missing $p"
done
if [ -n "$missing" ]; then
    echo "installing:$missing" >&2
    as_root=""
    [ "$(id -u)" = 0 ] || as_root="sudo"
    $as_root apt-get update -qq
    # shellcheck disable=SC2086 # a list of package names
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
fi

cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=$testing -DSN_WERROR=$testing >&2
cmake --build build -j "$(nproc)" >&2
