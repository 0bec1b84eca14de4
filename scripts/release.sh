#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# release: the tarball of what is committed, and the proof that it needs nothing else.
#     scripts/release.sh tarball           build/dist/bis-VERSION.tar.gz and its hash beside it (`make tarball`)
#     scripts/release.sh release           the same, then build, test, install and uninstall from the tarball alone
#                                          (`make release`)
# From the root. RELEASE_TEST=alias: only these tests (as T= of make test), for a trial; RELEASE_TEST=none: no test.
# The bytes depend on the commit alone, because names, order and times are the commit's and gzip keeps no time.
set -eu
version=$(sed -n 's/^#define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
name=bis-$version
dist=$(pwd)/build/dist
say() {
    echo "release: $*" >&2
    exit 1
}

git rev-parse HEAD >/dev/null 2>&1 || say "a tarball is made of a git commit, and here is none"
[ -z "$(git status --porcelain)" ] || echo "release: what is not committed is left out" >&2
mkdir -p "$dist"
git archive --format=tar --prefix="$name/" HEAD | gzip -9n >"$dist/$name.$$.tmp"
mv "$dist/$name.$$.tmp" "$dist/$name.tar.gz" # whole or not at all, because make deb may read it now
(cd "$dist" && sha256sum "$name.tar.gz" >"$name.tar.gz.sha256" && cat "$name.tar.gz.sha256")
[ "$1" = release ] || exit 0

# ---- the proof ----

began=$(date +%s)
folder=$(mktemp -d) # outside of the tree, so that nothing of it is found
trap 'rm -rf "$folder"' EXIT
trap 'exit 130' INT TERM HUP
step() { echo "release: $(($(date +%s) - began)) s: $*"; }
tar -xzf "$dist/$name.tar.gz" -C "$folder"
cd "$folder/$name"
unset MAKEFLAGS MAKELEVEL MFLAGS # those of `make release` are no part of the proof

# Behind the tag: scripts/check/weight.sh --keep, for the next one.
sh scripts/check/check_release.sh || say "the files do not agree on the version, or lack a line"
step "build"
make >"$folder/log" 2>&1 || { cat "$folder/log"; say "it does not build"; }
! grep -i "warning:" "$folder/log" || say "it builds with warnings"
step "test"
case ${RELEASE_TEST:-} in
none) ;;
"") make test test-tools || say "a test fails" ;;
*) make test T="$RELEASE_TEST" || say "a test fails" ;;
esac
step "install"
prefix=$folder/prefix
make install PREFIX="$prefix" >"$folder/log" 2>&1 || { cat "$folder/log"; say "it cannot be installed"; }
"$prefix/bin/bis" --version | head -n 1 | grep -qx "bis $version" || say "the program is not of version $version"
"$prefix/bin/bis" verify --bits || say "the bits differ"
"$prefix/bin/bis" scene.txt --resolution 80x60 --spp 1 --quiet --outfile "$folder/picture.png" ||
    say "it does not render"
make uninstall PREFIX="$prefix"
left=$(find "$prefix" ! -type d)
[ -z "$left" ] || say "make uninstall leaves $left"
step "done: $name.tar.gz, $(($(wc -c <"$dist/$name.tar.gz") / 1000)) kB, builds, tests, installs and uninstalls"
