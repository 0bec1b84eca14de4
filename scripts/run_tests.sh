#!/bin/sh
# run_tests: runs test programs (make test calls it), shows what they say, and closes with one line that counts.
#     scripts/run_tests.sh PROGRAM...
# Exit status 1 when a test failed, a program died, or there was nothing to run.
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
failed=""
: > "$log"
for program in "$@"; do
    # The exit status of the test program itself, through the pipe.
    { "$program" 2>&1; echo "status $?"; } | tee -a "$log" | grep -v '^status [0-9]*$'
    tail -n 1 "$log" | grep -q '^status 0$' || failed="$failed ${program##*/}"
done
# cmocka: "[       OK ] name", "[  SKIPPED ] name" and "[  FAILED  ] name"; the last two are said again in a list at the end, so count each once.
ok=$(grep -c '^\[       OK \]' "$log")
skipped=$(grep '^\[  SKIPPED \] [a-zA-Z_]' "$log" | sort -u | grep -c .)
echo "----"
if [ $# -eq 0 ]; then
    echo "make test: no test program of that name"
    exit 1
fi
if [ -n "$failed" ]; then
    echo "make test: FAILED:$failed ($# programs, $ok tests passed, $skipped skipped)"
    exit 1
fi
echo "make test: all passed ($# programs, $ok tests, $skipped skipped)"
