#!/bin/sh
# grade: the points of a handed-in assignment, one line a criterion, and as JSON in FOLDER/grade.json.
#     scripts/grade.sh FOLDER                  (make grade DEST=FOLDER)
# Only the files under study are taken from FOLDER (and its `assignment`, which names it); all else, tests and headers above all, is ours. 100 points:
# 80 for the tests; 10 for speed, once all tests pass: at most 1.5 times our time (5: at most 3 times); 10 when the tests that pass do so under the
# address, leak and undefined-behaviour sanitizers, too. Without these there are 90.
# From the root, with what scripts/course.mk exports. Exit status 0 when there is a grade, whatever it is.
given=$1
fail() {
    echo "make grade: $*" >&2
    exit 1
}

[ -d tests/assignments ] || fail "this is a starter kit; it is marked by the project that it comes from. make test shows the tests"
[ -n "$given" ] || fail "say whose: make grade DEST=../alias"
[ -f "$given/assignment" ] || fail "$given/assignment is not there: is this a folder of make assignment?"
name=$(sed -n 1p "$given/assignment")
case $name in *[!a-z0-9]* | "") fail "$given/assignment names no assignment" ;; esac
[ -f "tests/assignments/${name}_blank.c" ] || fail "$given/assignment: there is no assignment \"$name\""

work=$(mktemp -d "${TMPDIR:-/tmp}/grade.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
: >"$work/lines"

# points, of how many, the criterion, a remark
line() {
    printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" >>"$work/lines"
}

# Compile student's files and the claims, link: $work/$1, with these flags besides.
build() {
    program=$1
    shift
    objects=""
    for file in $files; do
        $BIS_COMPILE "$@" -c -o "$work/$program.${file##*/}.o" "$work/handed-in/${file##*/}" || return 1
        objects="$objects $work/$program.${file##*/}.o"
    done
    $BIS_COMPILE "$@" -c -o "$work/$program.claims.o" "tests/assignments/$name.c" || return 1
    # shellcheck disable=SC2086
    $BIS_LINK "$@" -o "$work/$program" "$work/$program.claims.o" $objects $BIS_OBJECTS $BIS_LIBS
}

grade_tests() {
    "$work/mine" --grade >"$work/marks"
    while IFS='	' read -r verdict points claim message; do
        got=0
        [ "$verdict" = ok ] && got=$points
        line "$got" "$points" "$claim" "$message"
    done <"$work/marks"
}

grade_speed() {
    if grep -q '^wrong' "$work/marks"; then
        line 0 10 speed "measured once all tests pass"
        return
    fi
    # shellcheck disable=SC2086
    $BIS_LINK -o "$work/ours" "$work/mine.claims.o" $BIS_OBJECTS $BIS_LIBS || return
    for round in 1 2 3; do
        echo "mine $("$work/mine" --work)"
        echo "ours $("$work/ours" --work)"
    done >"$work/times"
    if ! grep -q '^mine [0-9]' "$work/times"; then
        line 0 10 speed "no answer"
        return
    fi
    ratio=$(awk 'NF == 2 { if (!($1 in t) || $2 < t[$1]) t[$1] = $2 } END { printf "%.2f", t["mine"] / t["ours"] }' "$work/times")
    line "$(awk -v r="$ratio" 'BEGIN { print r <= 1.5 ? 10 : r <= 3 ? 5 : 0 }')" 10 speed "$ratio times our time"
}

grade_memory() {
    if ! grep -q '^ok' "$work/marks"; then
        line 0 10 "clean memory" "looked at once a test passes"
        return
    fi
    # shellcheck disable=SC2086
    if ! build clean $BIS_SANITIZE >/dev/null 2>&1; then
        line 0 0 "clean memory" "not looked at: the sanitizers are not there"
        return
    fi
    "$work/clean" --grade >"$work/clean.marks"
    found=$(awk -F '\t' 'NR == FNR { ok[$3] = $1; next } ok[$3] == "ok" && $1 != "ok" { print $3 ": " $4; exit }' "$work/marks" "$work/clean.marks")
    if [ -z "$found" ]; then
        line 10 10 "clean memory" ""
    else
        line 0 10 "clean memory" "$(echo "$found" | sed 's/ *==[=0-9]*== */ /g; s/   */ /g' | cut -c1-300)"
    fi
}

# bis trade with the student's material and with ours: both pages stay in FOLDER for a look; no points, since a machine at work is no judge.
trade_pages() {
    [ "$name" = open ] && ! grep -q '^wrong' "$work/marks" || return
    for who in mine ours; do
        objects=""
        [ $who = mine ] && for file in $files; do objects="$objects $work/mine.${file##*/}.o"; done
        # shellcheck disable=SC2086
        $BIS_LINK -o "$work/bis-$who" "$BIS_BUILD/src/cli/main.o" $objects ${BIS_OBJECTS##* } $BIS_LIBS || return
        rm -rf "$given/trade-$who"
        "$work/bis-$who" trade --quick --time 60 --quiet --integrator brdf --integrator sir --output "$given/trade-$who" data/scenes/microfacet.txt >/dev/null || return
    done
    echo "compare $given/trade-mine/report.html with $given/trade-ours/report.html"
}

files=$(sh scripts/splice.sh "tests/assignments/${name}_blank.c" "$work") || exit 1
mkdir "$work/handed-in" || exit 1
for file in $files; do
    [ -f "$given/src/$file" ] || fail "$given/src/$file is missing"
    cp "$given/src/$file" "$work/handed-in" || exit 1 # away from its own headers
done
if build mine >"$work/messages" 2>&1; then
    grade_tests
    grade_speed
    grade_memory
else
    sed "s|$work/handed-in/|src/|g" "$work/messages" >&2
    line 0 100 "it compiles" "see above"
fi
warnings=$(grep -c 'warning:' "$work/messages")

awk -F '\t' -v name="$name" -v warnings="$warnings" '
    { got += $1; all += $2; printf "%3d of %3d  %s%s\n", $1, $2, $3, $4 == "" ? "" : ": " $4 }
    END { printf "%3d of %3d  %s%s\n", got, all, name, warnings ? " (" warnings " compiler warnings)" : "" }' "$work/lines"
awk -F '\t' -v name="$name" -v warnings="$warnings" '
    function quoted(s) {
        gsub(/\\/, "\\\\", s)
        gsub(/"/, "\\\"", s)
        gsub(/[\001-\037]/, " ", s)
        return "\"" s "\""
    }
    { got += $1; all += $2
      criteria = criteria sprintf("%s\n    {\"criterion\": %s, \"points\": %d, \"of\": %d, \"remark\": %s}", NR > 1 ? "," : "", quoted($3), $1, $2, quoted($4)) }
    END { printf "{\n  \"assignment\": %s,\n  \"points\": %d,\n  \"of\": %d,\n  \"warnings\": %d,\n  \"criteria\": [%s\n  ]\n}\n", quoted(name), got, all, warnings, criteria }' \
    "$work/lines" >"$work/grade.json" && mv "$work/grade.json" "$given/grade.json" || exit 1
echo "as JSON: $given/grade.json"
trade_pages
exit 0
