#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# run_tests: runs test programs (make test calls it), shows what they say and how long they took, and closes with one
# line that counts.
#     scripts/check/run_tests.sh PROGRAM...
# Exit status 1 when a test failed, a program died or hung (TEST_SECONDS of the processor, default 1800, or ten times
# that by the clock, because a busy machine may be slow but not wrong), a test was skipped that tests/skips does not
# name, or there was nothing to run.
#
# SEED=n: the programs that STATISTICAL names draw their random numbers anew; one that fails has a second chance, with
# n + 1, because a right program fails at its level of significance.
#
# TEST_JOBS programs run side by side (default: one more than there are processors, because a program also waits, for
# others and for files; at most 4, because each has threads of its own). What a program says is shown when it ends, so
# that nothing is mixed.
#
# Programs find everything from the root of the project and make their files below build/. Each job gives them a root of
# its own, build/run.XXXXXX/N, a copy of all that is here (20 MB, half a second) but for build/, so that two programs
# never meet. It is removed after success, kept and named after a failure. A program that is called by hand works in
# build/ itself.

# run_tests.sh --one ALL PROGRAM: one program in the root of this job, which xargs numbers. What it says goes to the
# screen as a whole, under a lock.
if [ "${1:-}" = --one ]; then
    all=$2
    name=${3##*/}
    root=$all/$JOB
    limit=${TEST_SECONDS:-1800}
    echo "==== $name" >"$all/logs/$name"
    case $3 in
    tests/python/*) set -- "$1" "$2" "${PYTHON:-python3}" -m unittest discover -v -s "${3%/*}" -p "$name" ;;
    esac
    shift 2
    case " $STATISTICAL " in *" $name "*) ;; *) SEED= ;; esac
    status=1
    for seed in ${SEED:-none} ${SEED:+$((SEED + 1))}; do # chance fails one seed, a mistake two
        [ "$status" -ne 0 ] || break
        [ "$seed" = none ] || { export BIS_TEST_SEED="$seed" && echo "SEED=$seed" >>"$all/logs/$name"; }
        (cd "$root" && ulimit -t "$limit" && exec timeout $((10 * limit)) "$@") >>"$all/logs/$name" 2>&1
        status=$?
    done
    sed -i '/ \.\.\. ok$/d' "$all/logs/$name" # unittest names each test, cmocka's names are kept
    [ $status -eq 0 ] || echo "$root/build" >"$all/failed/$name"
    times >"$all/logs/.$name" # of the shell, then of its children: "1m2.34s 0m0.56s"
    seconds=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, "m"); s += 60 * t[1] + t[2] } printf "%.1f", s }' \
        "$all/logs/.$name")
    echo "---- $name: $status after $seconds s of the processor" >>"$all/logs/$name"
    echo "$seconds" >"$all/seconds/$name"
    flock "$all/lock" cat "$all/logs/$name"
    exit
fi

# Threads that wait for each other go to sleep: where the machine has other work, spinning took a program from 6 s to
# 132.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
if [ $# -eq 0 ]; then
    echo "make test: no test program of that name"
    exit 1
fi
here=$(pwd)
mkdir -p build && all=$(mktemp -d build/run.XXXXXX) || exit 1
chmod 755 "$all"
trap 'rm -rf "$all"; exit 130' INT TERM HUP
mkdir "$all/failed" "$all/logs" "$all/seconds"
export BIS_SHARED="${BIS_SHARED:-$here/../shared/data}"
jobs=${TEST_JOBS:-$(($(nproc) + 1))}
[ -n "${TEST_JOBS:-}" ] || [ "$jobs" -le 4 ] || jobs=4
[ "$jobs" -le $# ] || jobs=$#

# Copies, because tests make kits of the tree and change them; a link would let them change what it leads to. What was
# built is only read: links, but for the folder that tests write.
job=0
while [ $job -lt "$jobs" ]; do
    root=$all/$job
    mkdir "$root" || exit 1
    for file in * .[!.]*; do
        case $file in build | .git) ;; *) [ -e "$file" ] && { cp -Rp "$file" "$root/" || exit 1; } ;; esac
    done
    for program in "${BIS_PROGRAM:-build/release/bis}" "$@"; do
        folder=${program%/*}
        folder=${folder%/tests}
        case $folder in build/*) [ ! -d "$root/$folder" ] || continue ;; *) continue ;; esac
        mkdir -p "$root/$folder"
        for file in "$folder"/* "$folder/.flags"; do # with its flags make has nothing to do
            [ "${file##*/}" = assignments ] || ln -s "$here/$file" "$root/$file"
        done
    done
    job=$((job + 1))
done

printf '%s\n' "$@" | xargs -n 1 -P "$jobs" --process-slot-var=JOB sh "$0" --one "$all"

# cmocka: "[       OK ] name" for each, "[  SKIPPED ] 2 test(s), listed below:" once in a program.
# unittest: "Ran 38 tests in 9 s", and "OK (skipped=2)" or "FAILED (failures=1)".
ok=$(cat "$all"/logs/* | awk '/^\[       OK \]/ { n++ } /^Ran [0-9]+ test/ { n += $2 }
    /^FAILED \(|^OK \(/ { while (match($0, /[0-9]+/)) { n -= substr($0, RSTART, RLENGTH)
                                                      $0 = substr($0, RSTART + RLENGTH) } } END { print n + 0 }')
skipped=$(cat "$all"/logs/* | awk '/^\[  SKIPPED \] [0-9]+ test/ { n += $4 }
    /skipped=[0-9]+\)/ { sub(/.*skipped=/, ""); n += $0 + 0 } END { print n + 0 }')
# "[  SKIPPED ] name" of cmocka, "test_name (...) ... skipped 'why'" of unittest; some names stand twice.
for name in $(cat "$all"/logs/* | sed -n 's/^\[  SKIPPED \] \([a-z_A-Z0-9]*\)$/\1/p
    s/^\(test_[a-z_A-Z0-9]*\) .*\.\.\. skipped .*/\1/p' | sort -u); do
    [ ! -f tests/skips ] || grep -qxF -e "$name" tests/skips || unexpected="${unexpected:-} $name"
done
seconds=$(cat "$all"/seconds/* | awk '{ s += $1 } END { printf "%.0f", s }')
# What scripts/check/power.sh makes a page of.
for power in "$all"/*/build/power; do
    [ ! -d "$power" ] || { mkdir -p build/power && cp "$power"/* build/power/; }
done
if [ -n "$(ls "$all/failed")" ]; then
    echo "make test: FAILED:$(cd "$all/failed" && printf ' %s' *) ($# programs, $ok tests passed);" \
        "what they wrote is in $(sort -u "$all"/failed/* | paste -s -d ' ')"
    exit 1
fi
if [ -n "${unexpected:-}" ]; then
    echo "make test: FAILED: skipped, and tests/skips does not say why they may be:$unexpected"
    exit 1
fi
rm -rf "$all"
echo "make test: all passed ($# programs, $ok tests, $skipped skipped, $seconds s of the processor)"
