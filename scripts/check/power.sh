#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# power.sh: what our statistical tests would have found. Each test program of the last `make test` left a line for each
# assertion in build/power/PROGRAM.txt (tests/support/stat.c); this joins them in build/power.txt and prints the table
# of docs/proof.md.
#     scripts/check/power.sh             one row for each claim: how often it was tested, on how many values, and the
#                                        smallest errors found
#     scripts/check/power.sh --update    writes one row for each program into docs/proof.md, between its marks
# Exit status 1 when there is nothing to join.
page=docs/proof.md
ls build/power/*.txt > /dev/null 2>&1 || { echo "power.sh: no build/power/*.txt: run make test first"; exit 1; }
LC_ALL=C sort build/power/*.txt > build/power.txt

# table CLAIMS: a row for each claim (1), or for each program (0)
table() {
    awk -F '\t' -v claims="$1" '
    function percent(e) {
        if (e >= 0.0995) return sprintf("%.0f %%", 100 * e)
        return e >= 0.00995 ? sprintf("%.1f %%", 100 * e) : sprintf("%.2g %%", 100 * e)
    }
    {
        key = $1 "\t" (claims ? $2 : "") "\t" $3
        if (!(key in n)) { order[++rows] = key; least[key] = $7; most[key] = $7; values[key] = $4 }
        n[key]++
        if (!((key, $2) in seen)) n_claims[key]++
        seen[key, $2] = 1
        if ($7 + 0 < least[key] + 0) least[key] = $7
        if ($7 + 0 > most[key] + 0) most[key] = $7
        if ($4 + 0 < values[key] + 0) values[key] = $4
    }
    END {
        print "| program | " (claims ? "claim | test | times | values, at least" : "test | claims") \
            " | finds with 99 % power |"
        print "| --- | --- | " (claims ? "--- | ---: | ---:" : "---:") " | --- |"
        for (i = 1; i <= rows; i++) {
            key = order[i]
            split(key, part, "\t")
            range = percent(least[key])
            if (percent(most[key]) != range) range = range " to " percent(most[key])
            printf "| %s | %s | %s | %s |\n", part[1], claims ? part[2] : part[3],
                claims ? part[3] " | " n[key] " | " values[key] : n_claims[key], range
        }
    }' build/power.txt
}

if [ "$1" != "--update" ]; then
    table 1
    exit
fi
table 0 > build/power.md
awk '/<!-- power -->/ { print; while ((getline line < "build/power.md") > 0) print line; skip = 1 }
     /<!-- end -->/ { skip = 0 }
     !skip' "$page" > build/proof.md && cp build/proof.md "$page"
