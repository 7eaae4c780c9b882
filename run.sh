#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs what is missing, builds Punctum, and opens its window; see -h.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)

usage() {
    cat <<END
Usage: ./run.sh [FILE...]
Installs what is missing, builds Punctum and opens the window with these LAS/LAZ files. With no FILE it shows a
survey of 5 million points, made once in build/. With no display it renders a picture into build/ instead.
The program itself: build/release/bin/punctum --help
END
}
for argument in "$@"; do
    case $argument in
    -h | --help)
        usage
        exit 0
        ;;
    -*)
        echo "run: $argument is no option of run.sh; see ./run.sh -h" >&2
        exit 2
        ;;
    esac
    if [ ! -r "$argument" ] || [ -d "$argument" ]; then
        echo "run: there is no readable file $argument" >&2
        exit 1
    fi
done

"$root/packaging/setup.sh"

build=$root/build/release
punctum=$build/bin/punctum
echo "run: building (some minutes the first time)"
(
    cd "$root"
    if [ ! -e "$build/build.ninja" ] || [ -n "$(find CMakePresets.json -newer "$build/build.ninja")" ]; then
        cmake --preset release
    fi
    cmake --build --preset release --target punctum
)

if [ $# -eq 0 ]; then
    survey=$root/build/survey-5M.laz
    if [ ! -e "$survey" ]; then
        echo "run: making a survey of 5 million points"
        part=$root/build/survey-5M.$$.part.laz
        trap 'rm -f "$part"' EXIT
        "$punctum" sample "$part" --points 5000000 >/dev/null
        mv "$part" "$survey"
        trap - EXIT
    fi
    set -- "$survey"
fi

if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    echo "run: opening the window"
    exec "$punctum" "$@"
fi
picture=$root/build/punctum.png
echo "run: there is no display, so the picture is rendered into a file"
"$punctum" render "$@" -o "$picture" --point-size 2
echo "run: the picture is $picture"
