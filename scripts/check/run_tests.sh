#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# run_tests: runs test programs (make test calls it), shows what they say and how long they took, and closes with one
# line that counts.
#     scripts/check/run_tests.sh PROGRAM...
# Exit status 1 when a test failed, a program died or hung (TEST_SECONDS, default 600), or there was nothing to run.
#
# Programs find everything from the root of the project and make their files below build/. Each run gives them a root of
# its own, build/run.XXXXXX, a copy of all that is here (20 MB, half a second) but for build/, so that two runs never meet. It is
# removed after success, kept and named after a failure. A program that is called by hand works in build/ itself.
# Threads that wait for each other go to sleep: where the machine has other work, spinning took a program from 6 s to 132.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
if [ $# -eq 0 ]; then
    echo "make test: no test program of that name"
    exit 1
fi
here=$(pwd)
mkdir -p build && root=$(mktemp -d build/run.XXXXXX) || exit 1
chmod 755 "$root"
trap 'rm -rf "$root"; exit 130' INT TERM HUP
export BIS_SHARED="${BIS_SHARED:-$here/../shared/data}"

# Copies, because tests make kits of the tree and change them; a link would let them change what it leads to. What was
# built is only read: links, but for the folder that tests write.
for file in * .[!.]*; do
    case $file in build | .git) ;; *) [ -e "$file" ] && { cp -Rp "$file" "$root/" || exit 1; } ;; esac
done
for program in "${BIS_PROGRAM:-build/release/bis}" "$@"; do
    folder=${program%/*}
    folder=${folder%/tests}
    case $folder in build/*) [ ! -d "$root/$folder" ] || continue ;; *) continue ;; esac
    mkdir -p "$root/$folder"
    for file in "$folder"/*; do
        [ "${file##*/}" = assignments ] || ln -s "$here/$file" "$root/$file"
    done
done

log=$here/$root/log
failed=""
for program in "$@"; do
    name=${program##*/}
    echo "==== $name"
    begin=$(date +%s)
    # The exit status of the test program itself, through the pipe.
    { (cd "$root" && timeout "${TEST_SECONDS:-600}" "$program" 2>&1); echo "status $?"; } | tee -a "$log" | grep -v '^status [0-9]*$'
    status=$(tail -n 1 "$log")
    [ "$status" = "status 0" ] || failed="$failed $name"
    echo "---- $name: ${status#status } after $(($(date +%s) - begin)) s"
done
# cmocka: "[       OK ] name" for each, "[  SKIPPED ] 2 test(s), listed below:" once in a program.
ok=$(grep -c '^\[       OK \]' "$log")
skipped=$(awk '/^\[  SKIPPED \] [0-9]+ test/ { n += $4 } END { print n + 0 }' "$log")
# What scripts/check/power.sh makes a page of.
[ -d "$root/build/power" ] && mkdir -p build/power && cp "$root"/build/power/* build/power/
if [ -n "$failed" ]; then
    echo "make test: FAILED:$failed ($# programs, $ok tests passed); what they wrote is in $root/build"
    exit 1
fi
rm -rf "$root"
echo "make test: all passed ($# programs, $ok tests, $skipped skipped)"
