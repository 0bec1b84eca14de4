#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# power.sh: what our statistical tests would have found, as CSV. Each test program of the last `make test` left a line
# for each assertion in build/power/PROGRAM.txt (tests/support/stat.c).
#     scripts/check/power.sh             one row for each claim: how often it was tested, on how many values at least,
#                                        and the smallest errors found with 99 % power (least and most, as shares)
#     scripts/check/power.sh --update    one row for each program, into docs/data/power.csv
# Exit status 1 when there is nothing to join.
ls build/power/*.txt >/dev/null 2>&1 || { echo "power.sh: no build/power/*.txt: run make test first"; exit 1; }
[ "$1" != --update ] || exec >docs/data/power.csv
cat build/power/*.txt | LC_ALL=C sort | awk -F '\t' -v claims="$([ "$1" = --update ] || echo 1)" '
    {
        key = $1 "," (claims ? $2 "," : "") $3
        if (!(key in n)) { order[++rows] = key; least[key] = most[key] = $7 + 0; values[key] = $4 + 0 }
        n[key]++
        if ($7 + 0 < least[key]) least[key] = $7 + 0
        if ($7 + 0 > most[key]) most[key] = $7 + 0
        if ($4 + 0 < values[key]) values[key] = $4 + 0
    }
    END {
        print "program," (claims ? "claim," : "") "test,times,values,least,most"
        for (i = 1; i <= rows; i++) {
            key = order[i]
            printf "%s,%d,%d,%.2g,%.2g\n", key, n[key], values[key], least[key], most[key]
        }
    }'
