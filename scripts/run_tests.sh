#!/bin/sh
# run_tests: runs test programs (make test calls it), shows what they say and how long they took, and closes with one
# line that counts.
#     scripts/run_tests.sh PROGRAM...
# Exit status 1 when a test failed, a program died or hung (TEST_SECONDS, default 600), or there was nothing to run.
# Threads that wait for each other go to sleep: where the machine has other work, spinning took a program from 6 s to 132.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
failed=""
for program in "$@"; do
    name=${program##*/}
    echo "==== $name"
    begin=$(date +%s)
    # The exit status of the test program itself, through the pipe.
    { timeout "${TEST_SECONDS:-600}" "$program" 2>&1; echo "status $?"; } | tee -a "$log" | grep -v '^status [0-9]*$'
    status=$(tail -n 1 "$log")
    [ "$status" = "status 0" ] || failed="$failed $name"
    echo "---- $name: ${status#status } after $(($(date +%s) - begin)) s"
done
# cmocka: "[       OK ] name" for each, "[  SKIPPED ] 2 test(s), listed below:" once in a program.
ok=$(grep -c '^\[       OK \]' "$log")
skipped=$(awk '/^\[  SKIPPED \] [0-9]+ test/ { n += $4 } END { print n + 0 }' "$log")
if [ $# -eq 0 ]; then
    echo "make test: no test program of that name"
    exit 1
fi
if [ -n "$failed" ]; then
    echo "make test: FAILED:$failed ($# programs, $ok tests passed)"
    exit 1
fi
echo "make test: all passed ($# programs, $ok tests, $skipped skipped)"
