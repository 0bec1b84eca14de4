#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_release: do all files that name the version name the same one, and can the package's description be read?
#     scripts/check/check_release.sh [ROOT]
# The one place where it is set is include/bis/base/version.h; the tools that read the others want a number of their
# own. Exit status 1 and the files that differ.
cd "${1:-.}" || exit 1
version=$(sed -n 's/^#define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
bad=0
# says FILE REGEXP: its first line that the expression describes holds the version.
says() {
    line=$(grep -m 1 "$2" "$1")
    case $line in
    *"$version"*) ;;
    *) echo "$1: \"$line\" is not of version $version" && bad=1 ;;
    esac
}
[ -n "$version" ] || { echo "include/bis/base/version.h: no version" && exit 1; }
says CITATION.cff '^version:'
says codemeta.json '"version":'
says CHANGELOG.md '^## '
says scripts/debian/changelog '^bis ('
grep -q "^Package: libbis${version%.*}\$" scripts/debian/control ||
    { echo "scripts/debian/control: no package libbis${version%.*}, which the soname asks for" && bad=1; }
# A field that stands twice in a paragraph stops dpkg-buildpackage, which no test runs.
awk -F: '/^$/ { split("", seen) } /^[A-Za-z]/ && seen[$1]++ { print FILENAME ":" NR ": a second " $1; bad = 1 }
    END { exit bad }' scripts/debian/control || bad=1
[ ! -f pyproject.toml ] || ! grep -q '^version *=' pyproject.toml || says pyproject.toml '^version *='
exit $bad
