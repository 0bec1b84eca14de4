#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# grade_shop: all that the marking of an assignment needs and that no hand-in changes, made once for one student or
# a class (scripts/course/grade.sh).
#     scripts/course/grade_shop.sh NAME FOLDER
# From the root, with what scripts/course/course.mk exports. In FOLDER, which is an absolute path:
#     what scripts/course/given.sh says
#     sandbox       "bwrap" or "none"                          secrets     two numbers, by both of which ours is right
#     headers/      all that a hand-in may include             lib.a       the library without ours of these files
#     claims        the claims, which ask a student's program  ours        such a program, with our own code
#     ours-clean    the same, sanitized, where possible        ours.marks  its marks
#     blank.prints, ours.prints  of the files as they are given out, and as we have them
# shellcheck disable=SC2086 # flags are words
name=$1
shop=$2
fail() {
    echo "make grade: $*" >&2
    exit 1
}

mkdir -p "$shop/ours-src" "$shop/objects" || exit 1
sh scripts/course/given.sh "$name" "$shop" || exit 1
sh scripts/course/headers.sh "$shop/headers" || exit 1

sandbox=${BIS_SANDBOX:-$(BIS_SANDBOX=bwrap "$BIS_BUILD/grade" run -- true >/dev/null 2>&1 && echo bwrap || echo none)}
compile() { # SOURCE OBJECT FLAGS...: as a hand-in is
    source=$1
    object=$2
    shift 2
    BIS_SANDBOX=$sandbox "$BIS_BUILD/grade" run -d "$shop/headers" -r "$shop/headers" -r "$shop/ours-src" \
        -w "${object%/*}" -- $BIS_COMPILE -iquote "$shop/ours-src" -iquote "src/$folder" "$@" -c -o "$object" "$source"
}
while IFS= read -r file; do
    folder=${file%/*}
    mkdir -p "$shop/ours-src/$folder"
    cp "src/$file" "$shop/ours-src/$file" || exit 1
    case $file in *.h) cp "$shop/blank/$file" "$shop/headers/src/$file" || exit 1 ;; esac # ours is the answer
    "$BIS_BUILD/grade" look "$shop/blank/$file" "$shop/blank/$file" "$shop/prints" >/dev/null ||
        fail "what is blank in src/$file would be refused"
    cat "$shop/prints" >>"$shop/blank.prints"
    "$BIS_BUILD/grade" look "$shop/blank/$file" "$shop/ours-src/$file" "$shop/prints" >/dev/null
    cat "$shop/prints" >>"$shop/ours.prints"
done <"$shop/files"
while IFS= read -r file; do
    folder=${file%/*}
    [ -f "$shop/ours-src/$file" ] || cp "src/$file" "$shop/ours-src/$file" || exit 1
    mkdir -p "$shop/objects/$folder"
    # a compiler that the sandbox does not hold works without
    compile "$shop/ours-src/$file" "$shop/objects/$file.o" >"$shop/messages" || {
        sandbox=none
        compile "$shop/ours-src/$file" "$shop/objects/$file.o" >"$shop/messages"
    } || fail "our own src/$file does not compile: $(cat "$shop/messages")"
done <"$shop/units"
[ "$sandbox" = bwrap ] ||
    echo "no sandbox (bwrap, of the package bubblewrap) works here: what is handed in runs with your rights," \
        "filtered (docs/assignments/README.md)"
echo "$sandbox" >"$shop/sandbox"
export BIS_SANDBOX="$sandbox"

cp "${BIS_OBJECTS##* }" "$shop/lib.a" && $BIS_COMPILE -c -o "$shop/claims.o" "tests/course/$name.c" || exit 1
$BIS_LINK -o "$shop/claims" "$shop/claims.o" $BIS_OBJECTS $BIS_LIBS || exit 1
$BIS_LINK -o "$shop/ours" $BIS_SERVER "${BIS_OBJECTS##* }" $BIS_LIBS || exit 1
$BIS_LINK $BIS_SANITIZE -o "$shop/ours-clean" $BIS_SERVER "${BIS_OBJECTS##* }" $BIS_LIBS 2>/dev/null
# shellcheck disable=SC2046
ar d "$shop/lib.a" $(sed 's|.*/||; s|\.c$|.o|' "$shop/units") || exit 1

# A secret that our own code is right by. Statistical tests have a level; 1 secret in 1000 may be an unlucky one.
: >"$shop/secrets"
for try in 1 2 3 4 5 6; do
    [ "$(wc -l <"$shop/secrets")" -lt 2 ] || break
    secret=$(od -A n -N 8 -t x8 /dev/urandom | tr -d ' ')
    [ -z "$BIS_GRADE_SECRET" ] || secret=$(printf '%x' $((0x$BIS_GRADE_SECRET + try)))
    "$BIS_BUILD/grade" claims -s "$secret" "$shop/ours" "$shop/claims" >"$shop/ours.marks" || exit 1
    grep -q '^wrong' "$shop/ours.marks" || echo "$secret" >>"$shop/secrets"
done
# The sanitizers of this system may want what the filter of scripts/course/server.c refuses.
if [ -f "$shop/ours-clean" ] && [ -s "$shop/secrets" ] &&
    "$BIS_BUILD/grade" claims -a -s "$(sed -n 1p "$shop/secrets")" "$shop/ours-clean" "$shop/claims" |
    grep -q '^wrong'; then
    rm "$shop/ours-clean"
fi
[ -s "$shop/secrets" ] || fail "our own code fails: $(grep '^wrong' "$shop/ours.marks")"
awk -F '\t' '{ all += $2 } END { exit all != 80 }' "$shop/ours.marks" ||
    fail "the points of tests/course/$name.c do not sum to 80"
