#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_errata: each item of docs/errata.md has its test, named after it, and one that its wrong variant does not pass.
#     scripts/check/check_errata.sh [ROOT]          ROOT holds docs/errata.md and tests; default: here
# The page tells items by headings ("**E17. ..."), and it or tests/thesis/errata.md tests by a table:
# | E17 | `test` | `twin` | what the twin is |, and where an item has more tests, rows below it that begin | |.
# Two columns hold names of tests that a program registers; all have the item's number as a word of their name (..._E17,
# E17_...). "the same" for a twin: the first column's tests run both directions. "none" needs its reason in the last
# column. A test of a number that is no item is found, too.
cd "${1:-.}" || exit 1
exec awk '
function complain(message) { print message; bad = 1 }
function names(cell, item, page,    n, i, part, found) {
    n = split(cell, part, "`")
    for (i = 2; i <= n; i += 2) {
        found++
        if (!(part[i] in test)) complain(page ": " item ": no test " part[i])
        else if (("_" part[i] "_") !~ ("_" item "_"))
            complain(page ": " item ": " part[i] " is not named after it")
    }
    return found
}
FILENAME ~ /\.c$/ && match($0, /cmocka_unit_test[a-z_]*\([A-Za-z0-9_]+/) {
    name = substr($0, RSTART, RLENGTH)
    sub(/.*\(/, "", name)
    test[name] = FILENAME
    next
}
FILENAME ~ /\.md$/ && match($0, /^\*\*E[0-9]+\./) {
    item = substr($0, 3, RLENGTH - 3)
    if (item != "E" (items + 1)) complain("docs/errata.md: " item " follows E" items + 0)
    is_item[item] = 1
    items++
}
FILENAME ~ /\.md$/ && /^\| E[0-9]+ \|/ {
    split($0, cell, " *[|] *")
    row[++rows] = cell[2]
    file[rows] = FILENAME
    right[rows] = cell[3]
    twin[rows] = cell[4]
    what[rows] = cell[5]
    seen[cell[2]]++
}
FILENAME ~ /\.md$/ && /^\| \|/ && file[rows] == FILENAME { # more of the item above
    split($0, cell, " *[|] *")
    right[rows] = right[rows] " " cell[3]
    if (cell[4] != "") twin[rows] = twin[rows] " " cell[4]
    what[rows] = what[rows] cell[5]
}
END {
    for (i = 1; i <= items; i++)
        if (seen["E" i] != 1) complain("docs/errata.md: E" i " has " seen["E" i] + 0 " rows in the table of tests")
    for (i = 1; i <= rows; i++) {
        if (!(row[i] in is_item)) complain(file[i] ": a row for " row[i] ", which is no item")
        if (!names(right[i], row[i], file[i])) complain(file[i] ": " row[i] " has no test")
        if (!names(twin[i], row[i], file[i]) && twin[i] != "the same" && twin[i] != "none")
            complain(file[i] ": " row[i] " has no twin")
        if (what[i] == "") complain(file[i] ": " row[i] ": what is the twin, or why is there none?")
    }
    for (name in test) {
        n = split(name, word, "_")
        for (k = 1; k <= n; k++)
            if (word[k] ~ /^E[0-9]+$/ && !(word[k] in is_item))
                complain(test[name] ": " name ": " word[k] " is no item")
    }
    if (!items) complain("docs/errata.md: no items")
    exit bad
}
' $(find tests -name 'test_*.c' -o -name errata.md | sort) docs/errata.md
