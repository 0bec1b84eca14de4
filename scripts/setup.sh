#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# setup: installs what bis needs to build, to render and to test itself, and nothing when all of it is there.
#     scripts/setup.sh [--mpi] [--web] [--python] [--marking] [--all]
# Each option adds what one more part needs: --mpi `make MPI=1` and its tests, --web `make docs`, `make web`, `make
# test-web` and `make test-browser`, --python the tests of the wheel and notebooks; --marking the sandbox of `make
# grade`; --all is all four. As root, or by sudo. For Debian 12 and 13 (there libembree-dev is Embree 4; the source
# takes both) and Ubuntu 24.04.
# UNTRIED: Fedora and Arch, whose names come from documentation.
set -eu

# needed: compiler and build; OpenEXR, libpng and zlib for images; python3, numpy for trade, pixel and envmap; cmocka
# and patch for the tests. light: Embree (rays), which exists for some processors only, and libjpeg (textures); bis does
# without. mpi, web, python: by option.
if command -v dpkg-query > /dev/null && command -v apt-get > /dev/null; then
    system=debian numpy="python3 python3-numpy"
    needed="gcc make pkg-config libc6-dev libopenexr-dev libpng-dev zlib1g-dev libcmocka-dev patch $numpy"
    light="libembree-dev libjpeg-dev"
    mpi="openmpi-bin libopenmpi-dev"
    web="pandoc chromium nodejs clang lld wasi-libc libclang-rt-dev-wasm32"
    python="python3-pip python3-venv" marking="bubblewrap binutils"
elif command -v dnf > /dev/null; then
    system=fedora numpy="python3 python3-numpy"
    needed="gcc make pkgconf-pkg-config glibc-devel openexr-devel libpng-devel zlib-devel libcmocka-devel patch $numpy"
    light="embree-devel libjpeg-turbo-devel"
    mpi="openmpi-devel" web="pandoc chromium nodejs" python="python3-pip" marking="bubblewrap binutils"
elif command -v pacman > /dev/null; then
    system=arch numpy="python python-numpy"
    needed="gcc make pkgconf openexr libpng zlib cmocka patch $numpy"
    light="embree libjpeg-turbo"
    mpi="openmpi" web="pandoc-cli chromium nodejs" python="python-pip" marking="bubblewrap binutils"
else
    echo "setup: this system has none of apt-get, dnf and pacman; please install: a C11 compiler, make, pkg-config," >&2
    echo "       OpenEXR >= 3.1, libpng, zlib, cmocka, python3 with numpy, and (optional) Embree 3 or 4, libjpeg" >&2
    exit 1
fi

for option; do
    case $option in
    --mpi) needed="$needed $mpi" ;;
    --web) needed="$needed $web" ;;
    --python) needed="$needed $python" ;;
    --marking) needed="$needed $marking" ;;
    --all) needed="$needed $mpi $web $python $marking" ;;
    -h | --help)
        sed -n '2,/^# UNTRIED/{/SPDX/d; /^# UNTRIED/d; s/^# \{0,1\}//p;}' "$0"
        exit
        ;;
    *)
        echo "setup: there is no option \"$option\"; there are --mpi, --web, --python, --marking and --all" >&2
        exit 2
        ;;
    esac
done

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }
# shellcheck disable=SC2086 # lists of words
case $system in
fedora)
    as_root dnf install -y $needed $light
    exit
    ;;
arch)
    as_root pacman -S --needed --noconfirm $needed $light
    exit
    ;;
esac

installed() { dpkg-query -W -f '${Status}' "$1" 2> /dev/null | grep -q 'ok installed'; }
known() { apt-cache show "$1" > /dev/null 2>&1; }

missing=""
for package in $needed; do
    # pkg-config is also provided by pkgconf, a compiler by build-essential: ask for the program where it is one.
    case $package in
    gcc | make | pkg-config | patch | python3) command -v "$package" > /dev/null || missing="$missing $package" ;;
    *) installed "$package" || missing="$missing $package" ;;
    esac
done
wanted=""
for package in $light; do installed "$package" || wanted="$wanted $package"; done
[ -n "$missing$wanted" ] || exit 0

if [ "$(id -u)" -ne 0 ] && ! command -v sudo > /dev/null; then
    [ -n "$missing" ] || exit 0 # bis does without
    echo "setup: please run as root: apt-get install$missing$wanted" >&2
    exit 1
fi
export DEBIAN_FRONTEND=noninteractive
as_root apt-get update -q
for package in $wanted; do
    if known "$package"; then missing="$missing $package"; else echo "setup: no $package here; bis does without"; fi
done
# shellcheck disable=SC2086 # a list of words
[ -z "$missing" ] || as_root apt-get install -y -q --no-install-recommends $missing
