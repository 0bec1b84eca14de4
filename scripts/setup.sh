#!/bin/sh
# setup: installs what bis needs to build and to test itself, and nothing when all of it is there.
# For Debian 12, and for Debian 13 and Ubuntu 24.04 (there libembree-dev is Embree 4; the source takes both). As root, or by sudo.
set -eu

# gcc, make and pkg-config; OpenEXR, libpng and zlib for images; cmocka for the tests. Optional: Embree (rays), which exists for some processors
# only, libjpeg (textures), and Open MPI (bis-mpi, docs/many-machines.md), without which its tests are skipped.
needed="gcc make pkg-config libc6-dev libopenexr-dev libpng-dev zlib1g-dev libcmocka-dev"
optional="libembree-dev libjpeg-dev openmpi-bin libopenmpi-dev"

if ! command -v dpkg-query > /dev/null || ! command -v apt-get > /dev/null; then
    echo "setup: this is no Debian or Ubuntu; please install: a C11 compiler, make, pkg-config," >&2
    echo "       OpenEXR >= 3.1, libpng, zlib, cmocka, and (optional) Embree 3 or 4, libjpeg" >&2
    exit 1
fi

installed() { dpkg-query -W -f '${Status}' "$1" 2> /dev/null | grep -q 'ok installed'; }
known() { apt-cache show "$1" > /dev/null 2>&1; }
as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }

missing=""
for package in $needed; do
    # pkg-config is also provided by pkgconf, a compiler by build-essential: ask for the program where it is one.
    case $package in
    gcc | make | pkg-config) command -v "$package" > /dev/null || missing="$missing $package" ;;
    *) installed "$package" || missing="$missing $package" ;;
    esac
done
wanted=""
for package in $optional; do installed "$package" || wanted="$wanted $package"; done
[ -n "$missing$wanted" ] || exit 0

if [ "$(id -u)" -ne 0 ] && ! command -v sudo > /dev/null; then
    [ -n "$missing" ] || exit 0 # what is optional is not worth a failure
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
