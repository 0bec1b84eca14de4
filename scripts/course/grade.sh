#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# grade: the points of a handed-in assignment, one line a criterion, and as JSON in FOLDER/grade.json, or in REPORT as
# KIND (gradescope, classroom50: scripts/course/report.awk).
#     scripts/course/grade.sh NAME FOLDER [KIND REPORT]       (make grade A=NAME DEST=FOLDER [FOR=KIND REPORT=FILE])
# FOLDER is a starter kit, or has the files under study in any depth. Nothing else is taken from it. What the points
# are for: docs/assignments/README.md.
# From the root, with what scripts/course/course.mk exports. Exit status 0 when there is a grade, whatever it is.
# For a class: BIS_SHOP, the folder of scripts/course/grade_shop.sh; BIS_RESULT, where "lines" (points, of how many,
# criterion, remark) and "prints" go.
# shellcheck disable=SC2086 # flags are words
name=$1
given=$2
kind=${3:-grade}
report=$4
fail() {
    echo "make grade: $*" >&2
    exit 1
}

[ -d tests/course ] ||
    fail "this is a starter kit; it is marked by the project that it comes from. make test shows the tests"
if [ -z "$name" ] || [ -z "$given" ]; then fail "say which, and whose: make grade A=alias DEST=../alias"; fi
[ -f "tests/course/${name}_blank.c" ] || fail "there is no assignment \"$name\""
[ -e "$given" ] || fail "$given is not there"
case $kind in grade | gradescope | classroom50) ;; *) fail "there is no report for \"$kind\"" ;; esac

. scripts/course/accept.sh
work=$(mktemp -d "${TMPDIR:-/tmp}/grade.XXXXXX") || exit 1
end() {
    [ -z "$child" ] || kill "$child" 2>/dev/null
    rm -rf "$work"
    trap - EXIT
    exit "$1"
}
trap 'end $?' EXIT
trap 'end 130' INT
trap 'end 143' TERM
trap 'end 129' HUP
if [ -z "$BIS_SHOP" ]; then
    BIS_SHOP=$work/shop
    run sh scripts/course/grade_shop.sh "$name" "$BIS_SHOP" || exit 1
fi
shop=$BIS_SHOP
export BIS_SANDBOX="$(cat "$shop/sandbox")" TMPDIR="$work"
secrets=$(sed 's/^/-s /' "$shop/secrets" | tr '\n' ' ')
tool=$BIS_BUILD/grade
result=${BIS_RESULT:-$work}
: >"$result/lines"

# points, of how many, the criterion, a remark
line() {
    printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" >>"$result/lines"
}

# Link $work/$1, the program that answers the claims, of their objects below objects/$2, with the flags that follow.
link_it() {
    program=$work/$1
    prefix=$2
    shift 2
    objects=""
    while IFS= read -r file; do objects="$objects $work/objects/$prefix$file.o"; done <"$shop/units"
    run $BIS_LINK "$@" $refused -Wl,-z,relro,-z,now -o "$program" $BIS_SERVER $objects "$shop/lib.a" \
        $BIS_LIBS >>"$work/messages" 2>&1
}

grade_tests() {
    run "$tool" claims $secrets "$work/mine" "$shop/claims" >"$work/marks"
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
    if run "$tool" speed $secrets "$work/mine" "$shop/ours" "$shop/claims" >"$work/ratio"; then
        ratio=$(cat "$work/ratio")
        line "$(awk -v r="$ratio" 'BEGIN { print r <= 1.5 ? 10 : r <= 3 ? 5 : 0 }')" 10 speed "$ratio times our time"
    else
        line 0 10 speed "$(short "$(cat "$work/ratio")")"
    fi
}

# Paid for in the share of the tests that pass: a body that does nothing leaks nothing.
grade_memory() {
    if ! grep -q '^ok' "$work/marks"; then
        line 0 10 "clean memory" "looked at once a test passes"
        return
    fi
    if [ ! -f "$shop/ours-clean" ]; then
        line 0 0 "clean memory" "not looked at: the sanitizers are not there"
        return
    fi
    while IFS= read -r file; do
        compile "$file" clean/ $BIS_SANITIZE >>"$work/messages" && look_at_object "$file" clean/
    done <"$shop/units"
    if ! link_it clean clean/ $BIS_SANITIZE; then
        line 0 10 "clean memory" "it does not compile with the sanitizers"
        return
    fi
    if ! run "$tool" claims -a $secrets -k "$work/marks" "$work/clean" "$shop/claims" >"$work/clean.marks"; then
        line 0 10 "clean memory" "who marks was ended"
        return
    fi
    found=$(awk -F '\t' '$1 == "wrong" { print $3 ": " $4; exit }' "$work/clean.marks")
    if [ -z "$found" ]; then
        points=$(awk -F '\t' '$1 == "ok" { got += $2 } END { print int(got / 8) }' "$work/marks")
        line "$points" 10 "clean memory" "$([ "$points" -eq 10 ] || echo "in the share of the tests that pass")"
    else
        line 0 10 "clean memory" "$(short "$(echo "$found" | sed 's/ *==[=0-9]*== */ /g; s/   */ /g')")"
    fi
}

# bis trade with the student's material and with ours: both pages are put into FOLDER for a look; no points, since a
# machine at work is no judge. Their code is in a program with all rights here, so it needs the sandbox.
trade_pages() {
    [ "$name$refused" = open ] && [ -f "$work/marks" ] && ! grep -q '^wrong' "$work/marks" || return
    if [ "$BIS_SANDBOX" != bwrap ]; then
        echo "bis trade is not run: it needs bubblewrap"
        return
    fi
    version=$(sed -n 's/^#define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
    for who in mine ours; do
        objects=""
        [ $who = mine ] && while IFS= read -r file; do objects="$objects $work/objects/$file.o"; done <"$shop/units"
        home=$work/bis-$who
        mkdir -p "$home/library"
        # The program, and its library, which trade loads: theirs comes before ours of the same name.
        $BIS_LINK -o "$home/bis" "$BIS_BUILD/src/cli/main.o" $objects ${BIS_OBJECTS##* } $BIS_LIBS || return
        $BIS_LINK -shared -o "$home/library/libbis.so.$version" $objects -Wl,--allow-multiple-definition \
            -Wl,--whole-archive ${BIS_OBJECTS##* } -Wl,--no-whole-archive $BIS_LIBS || return
        PATH="$PWD/scripts/python:$PATH" run "$tool" run -c 120 -r "$home" -r "$PWD/scripts/python" -r "$PWD/data" \
            -w "$work/kept" -- "$home/bis" trade --quick --time 60 --quiet --integrator brdf --integrator sir \
            --output "$work/kept/trade-$who" "$PWD/data/scenes/microfacet.txt" >"$work/messages" || {
            sed 5q "$work/messages" >&2
            return
        }
        rm -rf "$given/trade-$who"
        cp -R "$work/kept/trade-$who" "$given/trade-$who" || return
    done
    echo "compare $given/trade-mine/report.html with $given/trade-ours/report.html"
}

nothing() { # every criterion, with the reason at the first
    reason=$1
    while IFS='	' read -r verdict points claim message; do
        line 0 "$points" "$claim" "$reason"
        reason=""
    done <"$shop/ours.marks"
    line 0 10 speed ""
    line 0 10 "clean memory" ""
}

grade() {
    accept || { nothing "$reason"; return; }
    warnings=$(grep -c 'warning:' "$work/messages")
    if ! link_it mine ""; then
        remark "it does not link: $(grep -m 1 'undefined\|multiple' "$work/messages")"
        nothing "it does not link"
        return
    fi
    grade_tests
    grade_speed
    grade_memory
}

warnings=0
grade
[ "$warnings" -eq 0 ] || remark "$warnings compiler warning$([ "$warnings" -eq 1 ] || echo s)"
[ -z "$BIS_RESULT" ] || cp "$work/remarks" "$work/prints" "$result"

# The table is ours, and so is the sum: more than it says is nobody's.
awk -F '\t' -v name="$name" '
    { got += $1; all += $2; if ($1 > $2 || $1 < 0) bad = 1 }
    { printf "%3d of %3d  %s%s\n", $1, $2, $3, $4 == "" ? "" : ": " $4 }
    END { printf "%3d of %3d  %s\n", got, all, name; exit bad || got > 100 || all > 100 }' "$result/lines" ||
    fail "the points do not add up"
sed '/^$/d; s/^/remark: /' "$work/remarks"
[ -z "$BIS_RESULT" ] || exit 0
if [ -z "$report" ]; then
    [ -d "$given" ] || exit 0
    report=$given/grade.json
fi
awk -v kind="$kind" -v name="$name" -v warnings="$warnings" -v now="$(date -u +%Y-%m-%dT%H:%M:%SZ)" \
    -f scripts/course/report.awk "$work/remarks" "$result/lines" >"$work/report" &&
    rm -rf "$report" && cp "$work/report" "$report" || exit 1
echo "as JSON: $report"
marked=yes
[ "$kind" != grade ] || trade_pages
exit 0
