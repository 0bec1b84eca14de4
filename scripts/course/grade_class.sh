#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# grade_class: the points of a class, as FROM.NAME.csv and FROM.NAME.html beside FROM, and the groups that are alike
# beyond what was given out, with our own solution, which is public, as one more.
#     scripts/course/grade_class.sh NAME FROM JOBS [KIND]     (make grade-class A=NAME FROM=handed-in/ [JOBS=2])
# moodle: FROM.NAME.moodle.csv, too; leaderboard, of "open": FROM.open.leaderboard.csv. What stands in form.txt of a
# hand-in goes to FROM.NAME.form.csv.
# An entry of FROM is a student's: a starter kit, a folder with the file in any depth, or the file, of any name. What
# goes wrong with one is a remark in the table, and the next is marked.
name=$1
from=${2%/}
jobs=${3:-2}
kind=$4
fail() {
    echo "make grade-class: $*" >&2
    exit 1
}

[ -d tests/course ] || fail "this is a starter kit; it is marked by the project that it comes from"
if [ -z "$name" ] || [ -z "$from" ]; then
    fail "say which, and where they are: make grade-class A=alias FROM=handed-in/"
fi
[ -f "tests/course/${name}_blank.c" ] || fail "there is no assignment \"$name\""
[ -d "$from" ] || fail "$from is no folder"
case $kind$name in "$name" | "moodle$name" | leaderboardopen) ;; *) fail "there is no table for \"$kind\"" ;; esac
case $jobs in "" | *[!0-9]* | 0) fail "JOBS is a number from 1 on" ;; esac

work=$(mktemp -d "${TMPDIR:-/tmp}/grade-class.XXXXXX") || exit 1
children=""
end() {
    trap - EXIT INT TERM HUP
    # shellcheck disable=SC2086
    [ -z "$children" ] || { kill $children; wait; } 2>/dev/null
    rm -rf "$work"
    exit "$1"
}
trap 'end $?' EXIT
trap 'end 130' INT
trap 'end 143' TERM
trap 'end 129' HUP

export TMPDIR="$work"
if [ -z "$BIS_SHOP" ]; then
    export BIS_SHOP="$work/shop"
    sh scripts/course/grade_shop.sh "$name" "$BIS_SHOP" &
    children=$!
    wait $children || fail "nothing can be marked"
    children=""
fi

n=0
set --
for entry in "$from"/*; do
    [ -e "$entry" ] || [ -L "$entry" ] || continue
    n=$((n + 1))
    mkdir "$work/$n" && : >"$work/$n/prints" || exit 1
    set -- "$@" "$work/$n/prints"
    printf '%s' "$entry" >"$work/$n/path"
    printf '%s\n' "${entry##*/}" |
        awk 'NR > 1 { printf "\\n" } { gsub(/[\001-\037]/, "?"); printf "%s", $0 }' >"$work/$n/name"
done
[ "$n" -gt 0 ] || fail "$from is empty"

# The next that nobody has taken, until there is none.
worker() {
    one=""
    trap '[ -z "$one" ] || kill "$one"; wait; exit 143' TERM
    trap - EXIT
    for i in $(seq "$n"); do
        mkdir "$work/$i/taken" 2>/dev/null || continue
        path=$(cat "$work/$i/path" && echo x)
        BIS_RESULT="$work/$i" sh scripts/course/grade.sh "$name" "${path%x}" >"$work/$i/said" 2>&1 &
        one=$!
        wait "$one" || {
            printf 'it could not be marked: %s\n' "$(tail -n 1 "$work/$i/said")" >"$work/$i/remarks"
            : >"$work/$i/lines" # no line, no points: not marked
        }
        one=""
        points=$(awk -F '\t' '{ got += $1 } END { print NR ? got + 0 : "not marked" }' "$work/$i/lines")
        printf '%s of %s: %s: %s\n' "$i" "$n" "$(cat "$work/$i/name")" "$points"
    done
}
while [ "$jobs" -gt 0 ]; do
    worker &
    children="$children $!"
    jobs=$((jobs - 1))
done
# shellcheck disable=SC2086
wait $children
children=""

# Everything as lines of one file for the tables.
"$BIS_BUILD/grade" alike 0.5 "$BIS_SHOP/blank.prints" "$@" "$BIS_SHOP/ours.prints" | sort -k2,2nr -k3,3n >"$work/alike"
{
    awk -F '\t' '{ print "C\t" $2 "\t" $3 }' "$BIS_SHOP/ours.marks"
    printf 'C\t10\tspeed\nC\t10\tclean memory\n'
    for i in $(seq "$n"); do
        printf 'N\t%s\n' "$(tr '\t' ' ' <"$work/$i/name")"
        warned='^[0-9]* compiler warnings*$' # behind what failed, because a cell has little room
        sed "/^\$/d; /$warned/d; s/^/R\t/" "$work/$i/remarks" 2>/dev/null
        sed 's/^/L\t/' "$work/$i/lines"
        path=$(cat "$work/$i/path" && echo x)
        form=$(find "${path%x}" -maxdepth 3 -type f -name form.txt | head -n 1)
        [ -z "$form" ] || head -c 4000 "$form" | tr -d '\000-\010\013-\037' | tr '\t' ' ' |
            awk -f scripts/course/form.awk docs/assignments/form.txt -
        sed -n "/$warned/s/^/R\t/p" "$work/$i/remarks" 2>/dev/null
    done
    tr ' ' '\t' <"$work/alike" | sed 's/^/A\t/'
} >"$work/all"
table_awk="-f scripts/course/short.awk -f scripts/course/grade_table.awk"
for table in csv html form.csv ${kind:+$kind.csv}; do
    # shellcheck disable=SC2086
    awk -v assignment="$name" -v kind="${table%.csv}" $table_awk "$work/all" >"$work/table" &&
        cp "$work/table" "$from.$name.$table" || exit 1
done
# shellcheck disable=SC2086
awk -v kind=text $table_awk "$work/all"
echo "$n marked: $from.$name.csv, $from.$name.html"
