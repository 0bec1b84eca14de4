#!/bin/sh
# grade: the points of a handed-in assignment, one line a criterion, and as JSON in FOLDER/grade.json.
#     scripts/course/grade.sh NAME FOLDER             (make grade A=NAME DEST=FOLDER)
# FOLDER is a starter kit, or has the files under study in any depth. Nothing else is taken from it. 100 points: 80
# for the tests; 10 for speed, once all
# tests pass: at most 1.5 times our time (5: at most 3 times); the same share of 10 as of the 80, where what passes
# does so under the address, leak and
# undefined-behaviour sanitizers, too. Without these there are 90.
# From the root, with what scripts/course/course.mk exports. Exit status 0 when there is a grade, whatever it is.
# For a class: BIS_SHOP, the folder of scripts/course/grade_shop.sh; BIS_RESULT, where "lines" (points, of how many,
# criterion, remark) and "prints" go.
name=$1
given=$2
fail() {
    echo "make grade: $*" >&2
    exit 1
}

[ -d tests/course ] ||
    fail "this is a starter kit; it is marked by the project that it comes from. make test shows the tests"
if [ -z "$name" ] || [ -z "$given" ]; then fail "say which, and whose: make grade A=alias DEST=../alias"; fi
case $name in *[!a-z0-9]*) fail "there is no assignment \"$name\"" ;; esac
[ -f "tests/course/${name}_blank.c" ] || fail "there is no assignment \"$name\""
[ -e "$given" ] || fail "$given is not there"

work=$(mktemp -d "${TMPDIR:-/tmp}/grade.XXXXXX") || exit 1
child=""
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
# In the background, so that a signal is answered at once.
run() {
    "$@" &
    child=$!
    wait "$child"
    status=$?
    child=""
    return $status
}

if [ -z "$BIS_SHOP" ]; then
    BIS_SHOP=$work/shop
    run sh scripts/course/grade_shop.sh "$name" "$BIS_SHOP" || exit 1
    [ "$(cat "$BIS_SHOP/sandbox")" = bwrap ] ||
        echo "no sandbox (bwrap, of the package bubblewrap) works here: what is handed in runs with your rights," \
            "filtered (docs/assignments/README.md)"
fi
shop=$BIS_SHOP
export BIS_SANDBOX="$(cat "$shop/sandbox")" TMPDIR="$work"
secrets=$(sed 's/^/-s /' "$shop/secrets" | tr '\n' ' ')
tool=$BIS_BUILD/grade
result=${BIS_RESULT:-$work}
mkdir -p "$work/src" "$work/objects" "$work/kept"
: >"$result/lines"
: >"$result/prints"
: >"$work/remarks"

# points, of how many, the criterion, a remark
line() {
    printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" >>"$result/lines"
}
remark() {
    printf '%s' "$*" | tr '\t\n' '  ' >>"$work/remarks"
    echo >>"$work/remarks"
}

# Is this a file, and no link, pipe or whatever, of a million bytes at most? Nothing is read before that is known.
small() {
    [ ! -L "$1" ] && [ -f "$1" ] && [ -n "$(find "$1" -prune -size -2049 2>/dev/null)" ]
}
# The first 200 characters of each line, up to the end of a word.
short() {
    awk 'length($0) > 200 { $0 = substr($0, 1, 200); sub(/ [^ ]*$/, ""); $0 = $0 " ..." } { print }'
}

# The hand-in's files that may be looked at, in $work/list, with a 0 byte behind each: few, small, and not deep.
MOST_FILES=2000
list_files() {
    : >"$work/list"
    [ -d "$given" ] && [ ! -L "$given" ] || return
    (ulimit -t 10 && find "$given/" -maxdepth 12 -type f \( \( -name '*.[ch]' -size -2049 \) -o -iname '*.zip' \
        -o -iname '*.tar' -o -iname '*.tgz' -o -iname '*.[gx]z' -o -iname '*.7z' -o -iname '*.rar' \) -print0) 2>/dev/null |
        head -z -n $((MOST_FILES + 1)) >"$work/list"
    [ "$(tr -dc '\0' <"$work/list" | wc -c)" -le $MOST_FILES ] ||
        remark "there are more than $MOST_FILES files; only so many are looked at"
}
# Those of the list whose path ends so.
ending() {
    grep -z "$(printf '%s' "$1" | sed 's/\./\\./g')\$" "$work/list"
}

# Their FILE below $work/src: of a kit, src/FILE; else the one file of that name in any depth; else the one that has
# the marks of our file.
collect() {
    file=$1
    base=${file##*/}
    to=$work/src/$file
    mkdir -p "${to%/*}" "$work/kept/${file%/*}"
    : >"$work/found"
    if [ -L "$given" ]; then
        remark "a link is not followed"
    elif [ -f "$given" ]; then
        if ! small "$given"; then
            remark "it has more than a million bytes$(is_archive "$given" && echo ", and is an archive: unpack it")"
        elif is_archive "$given"; then
            remark "it is an archive: unpack it, and mark the folder"
        elif of_marks "$given" "$file" || [ "$(wc -l <"$shop/files")" -eq 1 ]; then
            cp "$given" "$to" && echo x >"$work/found"
        fi
    elif [ ! -L "$given/src" ] && [ ! -L "$given/src/${file%/*}" ] && small "$given/src/$file"; then
        cp "$given/src/$file" "$to" && echo x >"$work/found"
    else
        for end in "/src/$file" "/$base"; do
            [ -s "$work/found" ] || ending "$end" |
                xargs -0 -r -n 1 sh -c 'cp "$2" "$0" && echo x >>"$1"' "$to" "$work/found"
        done
        [ -s "$work/found" ] || ending ".${file##*.}" | xargs -0 -r -n 1 sh -c \
            'sh scripts/course/grade_marks.sh "$0" "$3" "$1" "$2" || true' "$file" "$to" "$work/found"
    fi
    chmod u+rw "$to" 2>/dev/null
    n=$(wc -l <"$work/found")
    [ "$n" -lt 2 ] || remark "there are $n files $base; the last one found is marked"
    [ "$n" -gt 0 ] && return
    remark "$base is missing"
    name_archives
    cp "$shop/blank/$file" "$to"
}
# What is packed (zip, gzip, xz, 7z, rar) is not unpacked here, because it may be of any size then. It is named.
is_archive() {
    case $(head -c 6 "$1" | od -A n -t x1 | tr -d ' \n') in
    504b0304* | 1f8b* | fd377a585a00 | 377abcaf271c | 526172211a07) return 0 ;;
    esac
    return 1
}
name_archives() {
    packed=$(tr '\0\n' '\n?' <"$work/list" | grep -v '\.[ch]$' | head -n 1)
    [ -z "$packed" ] || remark "${packed##*/} is an archive: unpack it, and mark the folder"
}
of_marks() {
    : >"$work/marks-found"
    sh scripts/course/grade_marks.sh "$2" "$1" "$work/of-marks" "$work/marks-found"
    [ -s "$work/marks-found" ]
}

# Is FILE such that it may be compiled? What is ours in it stays ours: else what stands between the marks is put
# into our own file.
read_it() {
    file=$1
    said=$("$tool" look "$shop/ours-src/$file" "$work/src/$file" "$work/kept/$file.prints")
    case $? in
    0) return 0 ;;
    3) ;;
    *)
        remark "${file##*/}: $said"
        return 1
        ;;
    esac
    tr -d '\r' <"$work/src/$file" >"$work/kept/$file"
    awk -f scripts/course/splice.awk "$work/kept/$file" "$shop/blank/$file" >"$work/src/$file" || return 1
    remark "${file##*/}: $said; marked is what stands between the marks /* [...] */ alone"
    said=$("$tool" look "$shop/ours-src/$file" "$work/src/$file" "$work/kept/$file.prints") && return 0
    remark "${file##*/}: $said"
    return 1
}

# Compile FILE to objects/$2FILE.o with the flags that follow.
compile() {
    file=$1
    object=$work/objects/$2$file.o
    shift 2
    mkdir -p "${object%/*}"
    # shellcheck disable=SC2086
    run "$tool" run -d "$shop/headers" -r "$shop/headers" -r "$work/src" -w "$work/objects" -- \
        $BIS_COMPILE -iquote "$work/src" -iquote "src/${file%/*}" "$@" -c -o "$object" "$work/src/$file"
}

# An object defines what ours does, and nothing else; uses what ours does, the plain part of the C library, and
# helpers; runs nothing by itself.
look_at_object() {
    file=$1
    object=$work/objects/$file.o
    nm -P -g "$object" | awk '$2 != "U" && $2 != "w" { print $1 }' | sort >"$work/defined"
    other=$(comm -3 "$shop/refer/$file.defined" "$work/defined" | sed 's/^\t/+/; s/^[^+]/-&/' | tr '\n' ' ')
    if [ -n "$other" ]; then
        remark "$file: other functions than ours are global: $other"
        return 1
    fi
    used=$(nm -P -g "$object" | awk '
        NR == FNR { ok[$1]; next }
        $2 != "U" && $2 != "w" || $1 in ok { next }
        { name = $1; sub(/^__/, "", name); sub(/_chk$/, "", name) }
        name ~ /^(mem(cpy|move|set|cmp)|str(len|n?cmp|n?cpy|n?cat|chr))$/ { next }
        name ~ /^(malloc|calloc|realloc|free|aligned_alloc)$/ { next }
        name ~ /^(qsort|bsearch|l?l?abs|abort|exit|rand|srand|errno_location|assert_fail|bcmp|stack_chk_fail)$/ { next }
        name ~ /^(v?f?printf|v?snprintf|puts|putchar|f?putc|fputs|fwrite|fflush|stdout|stderr|perror)$/ { next }
        name ~ /^_?(GLOBAL_OFFSET_TABLE_|mulsc3|muldc3|divsc3|divdc3)$/ { next }
        name ~ /^(a?(cos|sin|tan)h?|sincos|atan2|exp|exp2|expm1|exp10|log|log2|log10|log1p|logb|ilogb)[fl]?$/ { next }
        name ~ /^(pow|sqrt|cbrt|hypot|erfc?|[tl]gamma|ceil|floor|trunc|(l?l)?r(ound|int)|nearbyint)[fl]?$/ { next }
        name ~ /^(fmod|remainder|remquo|fabs|fmax|fmin|fdim|fma|frexp|ldexp|modf|scalbl?n|copysign)[fl]?$/ { next }
        name ~ /^(nan|nextafter|nexttoward)[fl]?$/ { next }
        { print $1 }' "$shop/allowed" -)
    for word in $used; do
        where=$(grep -nw -m 1 -e "$word" "$work/src/$file" | cut -d: -f1)
        remark "$file${where:+, line $where}: \"$word\" is refused"
    done
    [ -z "$used" ] || return 1
    if readelf -SW "$object" 2>/dev/null | grep -q 'init_array\|fini_array\|\.ctors\|\.dtors'; then
        remark "$file: what runs before or after the tests is refused"
        return 1
    fi
}

# Link $work/$1, the program that answers the claims, of their objects below objects/$2, with the flags that follow.
link_it() {
    program=$work/$1
    prefix=$2
    shift 2
    objects=""
    while IFS= read -r file; do objects="$objects $work/objects/$prefix$file.o"; done <"$shop/units"
    # shellcheck disable=SC2086
    run $BIS_LINK "$@" -Wl,-z,relro,-z,now -o "$program" $BIS_SERVER $objects "$shop/lib.a" \
        $BIS_LIBS >>"$work/messages" 2>&1
}

grade_tests() {
    # shellcheck disable=SC2086
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
    if run "$tool" speed -s "$(head -n 1 "$shop/secrets")" "$work/mine" "$shop/ours" "$shop/claims" >"$work/ratio"; then
        ratio=$(cat "$work/ratio")
        line "$(awk -v r="$ratio" 'BEGIN { print r <= 1.5 ? 10 : r <= 3 ? 5 : 0 }')" 10 speed "$ratio times our time"
    else
        line 0 10 speed "no answer"
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
        # shellcheck disable=SC2086
        compile "$file" clean/ $BIS_SANITIZE >>"$work/messages"
    done <"$shop/units"
    # shellcheck disable=SC2086
    if ! link_it clean clean/ $BIS_SANITIZE; then
        line 0 10 "clean memory" "it does not compile with the sanitizers"
        return
    fi
    # shellcheck disable=SC2086
    run "$tool" claims -a $secrets -k "$work/marks" "$work/clean" "$shop/claims" >"$work/clean.marks"
    found=$(awk -F '\t' '$1 == "wrong" { print $3 ": " $4; exit }' "$work/clean.marks")
    if [ -z "$found" ]; then
        points=$(awk -F '\t' '$1 == "ok" { got += $2 } END { print int(got / 8) }' "$work/marks")
        line "$points" 10 "clean memory" "$([ "$points" -eq 10 ] || echo "in the share of the tests that pass")"
    else
        line 0 10 "clean memory" "$(echo "$found" | sed 's/ *==[=0-9]*== */ /g; s/   */ /g' | short)"
    fi
}

# bis trade with the student's material and with ours: both pages are put into FOLDER for a look; no points, since a
# machine at work is no judge.
trade_pages() {
    [ "$name" = open ] && [ -f "$work/marks" ] && ! grep -q '^wrong' "$work/marks" || return
    for who in mine ours; do
        objects=""
        [ $who = mine ] && while IFS= read -r file; do objects="$objects $work/objects/$file.o"; done <"$shop/units"
        # shellcheck disable=SC2086
        $BIS_LINK -o "$work/bis-$who" "$BIS_BUILD/src/cli/main.o" $objects ${BIS_OBJECTS##* } $BIS_LIBS || return
        run "$tool" run -c 120 -r "$work/bis-$who" -r "$PWD/data" -w "$work/kept" -- \
            "$work/bis-$who" trade --quick --time 60 --quiet --integrator brdf --integrator sir \
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
    list_files
    while IFS= read -r file; do collect "$file"; done <"$shop/files"
    if small "$given/assignment" && [ "$(sed -n 1p "$given/assignment" | tr -cd 'a-z0-9')" != "$name" ]; then
        remark "the kit says it is another assignment"
    fi
    while IFS= read -r file; do
        read_it "$file" || { nothing "refused"; return; }
    done <"$shop/files"
    while IFS= read -r file; do
        cat "$work/kept/$file.prints" >>"$result/prints" 2>/dev/null
        cmp -s "$work/src/$file" "$shop/blank/$file" || changed=yes
    done <"$shop/files"
    if [ -z "$changed" ]; then
        nothing "nothing is written"
        return
    fi
    : >"$work/messages"
    while IFS= read -r file; do
        [ -f "$work/src/$file" ] || cp "src/$file" "$work/src/$file" || return
        if ! compile "$file" "" >>"$work/messages"; then
            first=$(sed "s|$work/src/||g" "$work/messages" | grep -m 1 'error\|out of memory\|stopped' | short)
            remark "it does not compile: $first"
            [ -n "$BIS_RESULT" ] || sed "s|$work/src/|src/|g" "$work/messages" >&2
            nothing "it does not compile"
            return
        fi
        look_at_object "$file" || { nothing "refused"; return; }
    done <"$shop/units"
    warnings=$(grep -c 'warning:' "$work/messages")
    if ! link_it mine ""; then
        remark "it does not link: $(grep -m 1 'undefined\|multiple' "$work/messages" | short)"
        nothing "it does not link"
        return
    fi
    grade_tests
    grade_speed
    grade_memory
}

warnings=0
changed=""
grade
[ "$warnings" -eq 0 ] || remark "$warnings compiler warnings"
[ -z "$BIS_RESULT" ] || cp "$work/remarks" "$result/remarks"

# The table is ours, and so is the sum: more than it says is nobody's.
awk -F '\t' -v name="$name" '
    { got += $1; all += $2; if ($1 > $2 || $1 < 0) bad = 1 }
    { printf "%3d of %3d  %s%s\n", $1, $2, $3, $4 == "" ? "" : ": " $4 }
    END { printf "%3d of %3d  %s\n", got, all, name; exit bad || got > 100 || all > 100 }' "$result/lines" ||
    fail "the points do not add up"
sed '/^$/d; s/^/remark: /' "$work/remarks"
if [ -n "$BIS_RESULT" ] || [ ! -d "$given" ]; then exit 0; fi
awk -F '\t' -v name="$name" -v warnings="$warnings" '
    function quoted(s) {
        gsub(/\\/, "\\\\", s)
        gsub(/"/, "\\\"", s)
        gsub(/[\001-\037\177-\377]/, " ", s)
        return "\"" s "\""
    }
    FILENAME == ARGV[2] { if ($0 != "") remarks = remarks (remarks == "" ? "" : ", ") quoted($0); next }
    { got += $1; all += $2
      criteria = criteria sprintf("%s\n    {\"criterion\": %s, \"points\": %d, \"of\": %d, \"remark\": %s}",
                                  FNR > 1 ? "," : "", quoted($3), $1, $2, quoted($4)) }
    END {
        printf "{\n  \"assignment\": %s,\n  \"points\": %d,\n  \"of\": %d,\n", quoted(name), got, all
        printf "  \"warnings\": %d,\n  \"remarks\": [%s],\n  \"criteria\": [%s\n  ]\n}\n", warnings, remarks, criteria
    }' "$result/lines" "$work/remarks" >"$work/grade.json" &&
    rm -rf "$given/grade.json" && cp "$work/grade.json" "$given/grade.json" || exit 1
echo "as JSON: $given/grade.json"
trade_pages
exit 0
