#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# coverage: lines and branches of src/ that the tests of a build with --coverage have reached (make coverage calls it).
#     scripts/check/coverage.sh BUILD
# Prints a table, one row a file, the least covered first; the lines that were never run go to BUILD/uncovered.txt.
build=$1
: >"$build/uncovered.txt"
find "$build/src" -name '*.gcno' | sort | while IFS= read -r object; do
    name=${object#"$build"/src/}
    name=${name%.gcno}
    # gcov -b: "taken" per branch; -t: the annotated source to standard output.
    gcov -b -t -r -s "$PWD" "$build/src/$name.gcda" 2>/dev/null | awk -v name="$name" -v list="$build/uncovered.txt" '
        /^ *-: *0:Source:/ { mine = ($0 ~ "src/" name "\\.c$") }
        !mine { next }
        /^ *#####:|^ *=====:/ { lines++; print "src/" name ".c" substr($0, index($0, ":")) >>list; next }
        /^ *[0-9]+\*?:/ { lines++; run++ }
        /^branch .*(taken|never executed)/ {
            if ($0 ~ /\(throw\)/) next
            branches++
            if ($0 !~ /taken 0%|never executed/) taken++
        }
        END {
            if (lines) printf "%6.1f %% of %4d lines   %6.1f %% of %4d branches   src/%s.c\n", 100 * run / lines, lines,
                              branches ? 100 * taken / branches : 100, branches, name
        }'
done | sort -n | awk '
    { print; lines += $4; run += $1 * $4 / 100; branches += $9; taken += $6 * $9 / 100 }
    END {
        if (lines) printf "%6.1f %% of %4d lines   %6.1f %% of %4d branches   in all\n",
            100 * run / lines, lines, 100 * taken / branches, branches
    }'
echo "lines never run: $build/uncovered.txt"
