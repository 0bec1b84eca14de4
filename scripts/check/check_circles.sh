#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_circles: no two files of src/ need each other, not even by way of others. The symbols of their objects tell.
#     scripts/check/check_circles.sh BUILD          BUILD/src holds the objects
# Prints each circle and exits with 1.
build=$1
arrows=$(mktemp) || exit 1
trap 'rm -f "$arrows"' EXIT
find "$build/src" -name '*.o' | sort | while IFS= read -r object; do
    source=${object#"$build/"}
    [ -f "${source%.o}.c" ] || [ -f "${object%.o}.c" ] || continue # of a file that is no more
    nm "$object" | awk -v file="${object#"$build/src/"}" '
        NF == 3 && $2 ~ /^[TDRBVWi]$/ { print "has", $3, file }
        NF == 2 && $1 == "U" { print "needs", $2, file }'
done | awk '
    $1 == "has" { home[$2] = $3 }
    $1 == "needs" { n++; name[n] = $2; user[n] = $3 }
    END {
        for (i = 1; i <= n; i++) {
            if (!(name[i] in home) || home[name[i]] == user[i]) continue
            if (!seen[user[i], home[name[i]]]++) print user[i], home[name[i]]
        }
    }' >"$arrows"
[ -s "$arrows" ] || { echo "check_circles: no objects in $build/src"; exit 1; }
tsort "$arrows" 2>&1 >/dev/null |
    sed 's/^tsort: .*loop:$/check_circles: these need each other:/; s/^tsort: /    /; s/\.o$/.c/' | tee "$arrows.found"
[ ! -s "$arrows.found" ]; status=$?
rm -f "$arrows.found"
exit $status
