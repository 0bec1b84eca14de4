#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# deb: Debian packages of what is committed, in build/deb, with every check that they need (`make deb`).
#     scripts/deb.sh [SUITE]       SUITE: bookworm (Debian 12), trixie (13), ...; default: that of this system
# As root, because it works in chroots of SUITE, which debootstrap makes anew below DEB_FOLDER (default: a temporary
# folder, 2 GB):
#   build   nothing but what scripts/debian/control asks for, and lintian: builds twice, in other folders, time zones,
#           languages and with another number of processors; both must have the same bytes, and lintian no error and no
#           warning
#   test    the packages installed into a bare system: autopkgtest runs scripts/debian/tests
# DEB_BUILD_OPTIONS=nocheck: no tests in the first build, either. Prints seconds, seconds of the processors and
# megabytes. The sources are the tarball of scripts/release.sh and scripts/debian as its debian/. The maintainer of a
# package is who makes it: "$DEBFULLNAME <$DEBEMAIL>", else who made the commit.
set -eu
version=$(sed -n 's/^#define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
say() {
    echo "deb: $*" >&2
    exit 1
}
# fail WHAT: the last lines of the command that failed, and what it was.
fail() {
    tail -n 30 "$folder/log"
    say "$1"
}
[ "$(id -u)" -eq 0 ] || say "chroots need root: please run it by sudo"
for program in debootstrap autopkgtest; do
    command -v $program >/dev/null || say "please install: apt-get install debootstrap autopkgtest"
done
suite=${1:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
mirror=${DEB_MIRROR:-http://deb.debian.org/debian}
out=$(pwd)/build/deb
folder=${DEB_FOLDER:-$(mktemp -d)}
[ -n "${DEB_FOLDER:-}" ] || trap 'rm -rf "$folder"' EXIT
trap 'exit 130' INT TERM HUP
mkdir -p "$folder"
export LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive
unset MAKEFLAGS MAKELEVEL MFLAGS

# in_chroot CHROOT COMMAND: runs a line of shell in it, with /proc and /dev for as long as it takes.
in_chroot() {
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" &&
                    exec chroot "$0" /bin/sh -ec "$1"' \
        "$folder/$1" "$2"
}
megabytes() { du -smx "$folder/$1" | cut -f 1; }
began=$(date +%s)
worked=0
table=""
# row WHAT [MB]: a row of the table, with the seconds since the last one, and those of the processors, because only
# these are the same on a machine that has other work.
row() {
    now=$(date +%s)
    times >"$folder/times" # no pipe, because a subshell has no children yet
    work=$(awk '{ gsub(/[ms]/, " "); seconds = 60 * ($1 + $3) + $2 + $4 } END { printf "%d", seconds }' "$folder/times")
    table="$table$(printf '%-48s %5d s, of processors %5d s %8s' "$1" $((now - began)) $((work - worked)) "${2:+$2 MB}")
"
    began=$now worked=$work
}

sh scripts/release.sh tarball
rm -rf "$out" "$folder/bare" "$folder/build" "$folder/test"
mkdir -p "$out"
row "tarball"
debootstrap --variant=minbase "$suite" "$folder/bare" "$mirror" >"$folder/log" 2>&1 || fail "no chroot of $suite"
cp -a "$folder/bare" "$folder/build"
bare=$(megabytes bare)
mv "$folder/bare" "$folder/test"
row "chroot of $suite" "$bare"

# ---- build, twice ----

maintainer=$(git log -1 --format='%cn <%ce>')
[ -z "${DEBEMAIL:-}" ] || maintainer="${DEBFULLNAME:-$DEBEMAIL} <$DEBEMAIL>"
one=$folder/build/one two=$folder/build/somewhere/else
for place in "$one" "$two"; do
    mkdir -p "$place"
    cp "build/dist/bis-$version.tar.gz" "$place/bis_$version.orig.tar.gz"
    tar -xzf "build/dist/bis-$version.tar.gz" -C "$place"
    cp -r scripts/debian "$place/bis-$version/debian"
    (cd "$place/bis-$version/debian" && sed -i "s|@MAINTAINER@|$maintainer|" control changelog)
done
in_chroot build "apt-get -q update && apt-get -qy install --no-install-recommends build-essential lintian &&
    cd /one/bis-$version && apt-get -qy build-dep --no-install-recommends ./" >"$folder/log" 2>&1 ||
    fail "what the build needs cannot be installed"
row "what the build needs, and lintian" $(($(megabytes build) - bare))
in_chroot build "cd /one/bis-$version && DEB_BUILD_OPTIONS='${DEB_BUILD_OPTIONS:-}' dpkg-buildpackage -us -uc" \
    >"$folder/log" 2>&1 || fail "it does not build"
cp "$folder/log" "$out/build.log"
row "first build${DEB_BUILD_OPTIONS:+, $DEB_BUILD_OPTIONS}"
in_chroot build "cd /somewhere/else/bis-$version && umask 002 &&
    TZ=Pacific/Auckland LC_ALL=C DEB_BUILD_OPTIONS='nocheck parallel=1' dpkg-buildpackage -us -uc" \
    >"$folder/log" 2>&1 || fail "it does not build a second time"
row "second build, nocheck parallel=1"
for file in "$one"/*.deb "$one"/*.dsc "$one"/*.debian.tar.*; do
    cmp "$file" "$two/${file##*/}" || say "two builds differ in ${file##*/}; diffoscope tells where"
    cp "$file" "$out/"
done
cp "$one"/*.changes "$one"/*.orig.tar.gz "$one"/*.buildinfo "$out/"
in_chroot build "cd /one && lintian --allow-root --fail-on error,warning *.changes" || say "lintian complains"
row "lintian"

# ---- install and test ----

mkdir "$folder/test/debs"
cp "$out"/*.deb "$folder/test/debs/"
in_chroot test "apt-get -q update && apt-get clean" >"$folder/log" 2>&1 || fail "there is no list of packages"
before=$(megabytes test)
in_chroot test "cd /debs && rm ./*-dbgsym_*.deb && apt-get -qy install --no-install-recommends ./*.deb &&
    apt-get clean" \
    >"$folder/log" 2>&1 || fail "the packages cannot be installed"
row "all packages and what they need, installed" $(($(megabytes test) - before))
autopkgtest --no-built-binaries "$out"/*.dsc "$out"/*.deb -- chroot "$folder/test" >"$folder/log" 2>&1 ||
    fail "autopkgtest"
cp "$folder/log" "$out/autopkgtest.log"
row "autopkgtest"
echo "$table"
(cd "$out" && du -k ./*.deb)
