#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_assignments: does each assignment mark as it should? With the blanks, every claim fails; with our own bodies,
# every one holds; each of the typical wrong solutions (NAME_wrong1.c, NAME_wrong2.c ...) is worth some of the points,
# and fails the claims that its line "loses:" names, as each cheat does (handed_in/NAME_cheat1.c ...), by a secret, and
# says what a line "says:" has; right ones (handed_in/NAME_right1.c ...) fail none.
# Only the modules under study are compiled, and linked before the present library.
#     scripts/course/check_assignments.sh [NAME...]        (default: all)
# From the root. make gives, in BIS_BUILD, BIS_COMPILE, BIS_LINK, BIS_OBJECTS, BIS_LIBS, how to compile and link
# (scripts/course/course.mk). Reports go to $BIS_BUILD/assignments/NAME/. Exit status 1 if anything is not as it should.
root=$BIS_BUILD/assignments
if [ $# -ne 1 ]; then
    [ $# -gt 0 ] || set -- $(ls tests/course | sed -n 's/_blank\.c$//p')
    printf '%s\n' "$@" | xargs -P 2 -n 1 sh "$0"
    exit
fi
name=$1
folder=$root/$name
mkdir -p "$folder" || exit 1
say() {
    echo "$name: $*"
    exit 1
}

# 50 variants are compiled, and each answers for seconds at most: the compiler's time counts, not their speed.
quick="-O1 -g0"

fragments() { ls "tests/course/${name}_$1.c" "tests/course/handed_in/${name}_$1.c" 2>/dev/null; }
# Compile the fragments' files, link them with what answers the claims' questions, run: $folder/$1.marks
mark() {
    objects=""
    mkdir -p "$folder/$1/src" || exit 1
    if [ "$1" != original ]; then
        files=$(sh scripts/course/splice.sh "$(fragments "$1")" "$folder/$1/src") || exit 1
        # shellcheck disable=SC2086
        for file in $(sh scripts/course/units.sh $files); do
            source=$folder/$1/src/$file
            echo "$files" | grep -qx "$file" || source=src/$file # of a header
            $BIS_COMPILE $quick -Werror -iquote "$folder/$1/src" -iquote "src/${file%/*}" -c \
                -o "$folder/$1/src/$file.o" "$source" ||
                say "the $1 one does not compile without warnings"
            objects="$objects $folder/$1/src/$file.o"
        done
    fi
    # shellcheck disable=SC2086
    $BIS_LINK -o "$folder/$1/student" $BIS_SERVER $objects ${BIS_OBJECTS##* } $BIS_LIBS ||
        say "the $1 one does not link"
    case $1 in cheat* | right*) by="-s 1d5e1f" ;; *) by="" ;; esac
    # shellcheck disable=SC2086
    "$BIS_BUILD/grade" claims $by "$PWD/$folder/$1/student" "$folder/claims" >"$folder/$1.marks" ||
        say "the marks of the $1 one do not come to an end"
}

# The load that is timed, with this secret: status 8 where the answers are right, 9 where they are not
# (mark_run.h).
load() { # VARIANT SECRET STATUS
    said=$("$folder/claims" --work load "$2" 20 plain "$PWD/$folder/$1/student")
    [ $? -eq "$3" ] || say "the load of the $1 one: $said"
}

prove() {
    # shellcheck disable=SC2086
    $BIS_COMPILE $quick -Werror -c -o "$folder/claims.o" "tests/course/$name.c" &&
        $BIS_LINK -o "$folder/claims" "$folder/claims.o" $BIS_OBJECTS $BIS_LIBS || say "its tests do not compile"
    wrong=$(ls tests/course tests/course/handed_in |
        sed -n "s/^${name}_\(wrong[0-9]*\)\.c\$/\1/p; s/^${name}_\(cheat[0-9]*\|right[0-9]*\)\.c\$/\1/p")
    for variant in original blank $wrong; do
        mark $variant
        case $variant in
        original) load original 0 8 ;;
        right*) load $variant 1d5e1f 8 ;;
        blank) load blank 0 9 ;; # who does nothing is not paid for speed
        esac
        loses=$(sed -n 's|^/\* loses: \(.*\) \*/$|\1|p' $(fragments $variant) </dev/null | paste -sd ' ')
        awk -F '\t' -v name="$name" -v variant=$variant -v loses="$loses" '
            { n++; all += $2 }
            $1 == "ok" { right++; points += $2 }
            $1 != "ok" { lost = lost (lost == "" ? "" : " ") $3 }
            $1 == "ok" && variant == "blank" { printf "%s: the blank one passes %s\n", name, $3 }
            $1 != "ok" && variant == "original" { printf "%s: ours fails %s: %s\n", name, $3, $4 }
            $1 != "ok" && $4 == "" { printf "%s: no message of %s\n", name, $3; bad = 1 }
            END {
                printf "%s: %s: %d of %d points, %d of %d claims\n", name, variant, points, all, right, n
                if (all != 80) { printf "%s: the points of its claims sum to %d, must be 80\n", name, all; bad = 1 }
                if (variant ~ /original|right/ && right < n || variant == "blank" && right > 0) bad = 1
                if (variant ~ /wrong/ && (right == 0 || right == n)) {
                    printf "%s: %s is to be worth some of the points\n", name, variant
                    bad = 1
                }
                if (variant ~ /wrong|cheat/ && lost != loses) {
                    printf "%s: %s loses: %s; must lose: %s\n", name, variant, lost, loses
                    bad = 1
                }
                exit bad
            }' "$folder/$variant.marks" || exit 1
        says=$(sed -n 's|^/\* says: \(.*\) \*/$|\1|p' $(fragments $variant) </dev/null)
        grep -q "$says" "$folder/$variant.marks" || say "$variant does not say: $says"
        case $variant$loses in cheat[0-9]) load "$variant" 1d5e1f 9 ;; esac # its load alone is wrong
    done
}

# Ours holds by hidden seeds and sizes, too: those of one secret, always the same.
prove_hidden() {
    "$BIS_BUILD/grade" claims -s 1d5e1f "$PWD/$folder/original/student" "$folder/claims" >"$folder/hidden.marks" &&
        ! grep '^wrong' "$folder/hidden.marks" && load original 1d5e1f 8
}

(prove && prove_hidden && echo "$name: as it should be") >"$folder/verdict" 2>&1
status=$?
cat "$folder/verdict"
exit $status
