#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs what Punctum needs to be built and run (with --test: what its tests need as well) on Debian 12,
# Debian 13 and Ubuntu 24.04. Does nothing, and needs no rights, when all of it is there. run.sh and test.sh call it.
set -eu

packages="cmake ninja-build ccache g++ pkg-config
    qt6-base-dev qt6-qpa-plugins libgl-dev libegl-dev libegl1 libgl1-mesa-dri
    libglm-dev libpcl-dev libtbb-dev libepoxy-dev nlohmann-json3-dev libcli11-dev liblaszip-dev libproj-dev
    libtiff-dev libgeotiff-dev zlib1g-dev"
# shellcheck source=/dev/null
distribution=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_CODENAME:-}") || distribution=
for argument in "$@"; do
    case $argument in
    --test)
        packages="$packages xvfb geotiff-bin"
        # The tests of layout and names go by version 14 of these; where there is no such version they are skipped.
        case $distribution in
        "debian bookworm" | "ubuntu noble") packages="$packages clang-14 clang-format-14 clang-tidy-14 python3" ;;
        esac
        ;;
    -h | --help)
        echo "Usage: packaging/setup.sh [--test]"
        echo "Installs what Punctum needs to be built and run; with --test also what its tests need."
        exit 0
        ;;
    *)
        echo "setup: $argument is no option; there is --test, and --help." >&2
        exit 2
        ;;
    esac
done

say() { echo "setup: $*"; }
fail() {
    echo "setup: $*" >&2
    exit 1
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "this system has no apt, so nothing is installed here. Punctum needs a C++20 compiler, CMake 3.25, Ninja,"
    say "Qt 6.4, OpenGL and EGL, GLM, PCL 1.13, TBB, libepoxy, nlohmann-json, CLI11, PROJ, libtiff, libgeotiff,"
    say "zlib and LASzip (tests: Xvfb, listgeo)."
    exit 0
fi

installed() { [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

# A package of its own up to Qt 6.4, part of qt6-base-dev later.
openglHeaders() { ls /usr/lib/*/cmake/Qt6OpenGLWidgets/Qt6OpenGLWidgetsConfig.cmake >/dev/null 2>&1; }

missing=""
for package in $packages; do
    installed "$package" || missing="$missing $package"
done
if [ -z "$missing" ] && openglHeaders; then
    exit 0
fi

if [ "$(id -u)" = 0 ]; then
    asRoot() { env DEBIAN_FRONTEND=noninteractive "$@"; }
elif command -v sudo >/dev/null; then
    asRoot() { sudo env DEBIAN_FRONTEND=noninteractive "$@"; }
else
    fail "missing:${missing:- libqt6opengl6-dev}. Run packaging/setup.sh as root, or install sudo."
fi
apt() { asRoot apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@"; }
available() { apt-cache policy "$1" 2>/dev/null | grep -q 'Candidate: [^(]'; }

source=/etc/apt/sources.list.d/punctum-laszip.sources
pin=/etc/apt/preferences.d/punctum-laszip

# Debian 12 has no LASzip: liblaszip* comes from Debian 13, and nothing else may.
addLaszipSource() {
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    if [ ! -e /usr/share/keyrings/debian-archive-trixie-automatic.gpg ]; then
        say "bringing Debian's archive keys up to date"
        apt install -y --no-install-recommends debian-archive-keyring
    fi
    # The mirror this machine uses already, if it is one of all of Debian.
    # shellcheck disable=SC2016 # apt's own fields
    mirror=$(apt-get indextargets --format '$(RELEASE) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
        awk '$1 ~ /^(bookworm|stable|oldstable|oldoldstable)$/ && $2 == "main" &&
             $3 ~ /^((https?|ftp|file):.*\/debian\/?|mirror\+file:.*)$/ { print $3; exit }')
    mirror=${mirror:-http://deb.debian.org/debian}
    say "Debian 12 has no LASzip: taking liblaszip*, and nothing else, from Debian 13 at $mirror"
    asRoot tee "$pin" >/dev/null <<END
# Written by Punctum's packaging/setup.sh. Remove this file and $source
# before upgrading this machine to Debian 13.
Package: *
Pin: release o=Debian,n=trixie
Pin-Priority: -1

Package: liblaszip*
Pin: release o=Debian,n=trixie
Pin-Priority: 500
END
    asRoot tee "$source" >/dev/null <<END
# Written by Punctum's packaging/setup.sh, for liblaszip* alone: see $pin
Types: deb
URIs: $mirror
Suites: trixie
Components: main
Signed-By: $keyring
END
    asRoot chmod 644 "$pin" "$source"
    apt update -o Dir::Etc::SourceList="$source" -o Dir::Etc::SourceParts=- -o APT::Get::List-Cleanup=0 || true
    if ! available liblaszip-dev; then
        asRoot rm -f "$source" "$pin"
        fail "LASzip could not be had from $mirror. Is the network up? Run this again, or install liblaszip-dev by hand."
    fi
}

# Left over from Debian 12, they would keep a later Debian from its own packages.
if [ "$distribution" != "debian bookworm" ] && { [ -e "$source" ] || [ -e "$pin" ]; }; then
    say "removing the LASzip source that Debian 12 needed"
    asRoot rm -f "$source" "$pin"
fi

say "missing:${missing:- libqt6opengl6-dev}"
say "reading the lists of packages"
apt update || say "some lists could not be read; going on with the others"
if ! openglHeaders && available libqt6opengl6-dev; then
    missing="$missing libqt6opengl6-dev"
fi
case " $missing " in
*" liblaszip-dev "*)
    if [ "$distribution" = "debian bookworm" ] && ! available liblaszip-dev; then
        addLaszipSource
    fi
    ;;
esac
for package in $missing; do
    available "$package" ||
        fail "there is no package $package. Is the network up? On Ubuntu, enable 'universe'. Systems older than Debian 12 will not do."
done

say "installing (about two minutes, longer on a slow network)"
if [ -t 1 ]; then
    # shellcheck disable=SC2086 # a list of words
    apt install -y --no-install-recommends $missing
else
    log=$(mktemp)
    trap 'rm -f "$log"' EXIT
    # shellcheck disable=SC2086
    if ! apt install -y --no-install-recommends $missing >"$log" 2>&1; then
        tail -n 30 "$log" >&2
        fail "apt could not install them; its last words are above."
    fi
fi
say "done"
