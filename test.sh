#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs what is missing, builds everything, and runs every test. Arguments go to ctest: ./test.sh -R Las
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
cd "$root"

packaging/setup.sh --test

echo "test: building"
cmake --preset release
cmake --build --preset release

# A display of our own: the tests of the window move the mouse and must not be disturbed. Xvfb picks a free number.
scratch=$(mktemp -d)
xvfb=
tidy() {
    if [ -n "$xvfb" ]; then
        kill "$xvfb" 2>/dev/null || true
        wait "$xvfb" 2>/dev/null || true
    fi
    rm -rf "$scratch"
}
trap tidy EXIT
trap 'exit 130' INT TERM
Xvfb -displayfd 3 -screen 0 1600x1000x24 -nolisten tcp 3>"$scratch/display" >"$scratch/log" 2>&1 &
xvfb=$!
tries=0
while [ ! -s "$scratch/display" ]; do
    tries=$((tries + 1))
    if [ $tries -gt 100 ] || ! kill -0 "$xvfb" 2>/dev/null; then
        echo "test: Xvfb did not start:" >&2
        cat "$scratch/log" >&2
        exit 1
    fi
    sleep 0.1
done
DISPLAY=:$(cat "$scratch/display")
export DISPLAY
unset WAYLAND_DISPLAY

echo "test: running the tests on display $DISPLAY"
ctest --preset release "$@"
