#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# assignment: the starter kit of an assignment (docs/assignments/README.md): a copy of the project in which the bodies
# under study are blank, the handout, and the tests that mark it, in the place of all others.
#     scripts/course/assignment.sh NAME FOLDER        (make assignment A=NAME DEST=FOLDER)
# From the root. FOLDER must be new or empty. ASSIGNMENT.md in it is the handout, form.txt asks for hours; `assignment`
# holds the name, and the files to hand in.
name=$1
kit=$2
all=$(ls tests/course 2>/dev/null | sed -n 's/_blank\.c$//p' | tr '\n' ' ')
fail() {
    echo "make assignment: $*" >&2
    exit 1
}

[ -n "$all" ] || fail "this is a starter kit; new ones are made by the project that it comes from"
if [ -z "$name" ] || [ -z "$kit" ]; then
    fail "say which, and where to: make assignment A=alias DEST=../alias (there are: $all)"
fi
[ -f "tests/course/${name}_blank.c" ] || fail "there is no assignment \"$name\" (there are: $all)"
[ ! -e "$kit" ] || [ -z "$(ls -A "$kit" 2>/dev/null)" ] || fail "$kit exists and is not empty; name a new folder"

mkdir -p "$kit/tests" "$kit/data" || exit 1
cp -Rp Makefile LICENSE README.md scene.txt include src scripts docs "$kit" || exit 1
cp -Rp data/scenes data/generate "$kit/data" && cp -Rp tests/support "$kit/tests" || exit 1
# They quote what is blank, or have it right beside the wrong.
rm -f "$kit"/scripts/*/*errata*
sh scripts/course/given.sh "$name" "$kit/tests/given" || exit 1
cp "tests/course/$name.c" "$kit/tests/test_assignment.c" &&
    sed 's|](written|](docs/assignments/written|' "docs/assignments/$name.md" >"$kit/ASSIGNMENT.md" &&
    cp docs/assignments/form.txt "$kit" || exit 1
without() { # a page to which others lead
    echo "This page is left out of this kit, because it shows what is yours to write. The project has it." >"$kit/$1"
}
without docs/assignments/answers.md

blanks=$(mktemp -d) || exit 1
trap 'rm -rf "$blanks"' EXIT
echo "$name" >"$kit/assignment"
while IFS= read -r file; do
    cp "$kit/tests/given/blank/$file" "$kit/src/$file" && echo "src/$file" >>"$kit/assignment" || exit 1
done <"$kit/tests/given/files"
# What would show the answer in another form: tests/course/NAME_hidden.c holds harmless fragments in the place of such
# code, and names files that the kit does without. None of that is handed in.
hidden=$(pwd)/tests/course/${name}_hidden.c
if [ -f "$hidden" ]; then
    for file in $(cd "$kit" && sh scripts/course/splice.sh "$hidden" "$blanks"); do
        cp "$blanks/$file" "$kit/src/$file" || exit 1
    done
    for file in $(sed -n 's|^/\* without: \(.*\) \*/$|\1|p' "$hidden"); do
        rm "$kit/$file" || exit 1
        case $file in *.md) without "$file" ;; esac
    done
fi
(cd "$kit" && sh scripts/check/fragments.sh >/dev/null) || exit 1 # pages quote the code as it now stands
echo "$kit: assignment \"$name\". Read $kit/ASSIGNMENT.md; yours to write, between the marked comments:"
for mark in $(sed -n 's|^ */\* \[\([a-z0-9-]*\)\] \*/$|\1|p' "tests/course/${name}_blank.c" | grep -vx end); do
    (cd "$kit" && grep -n "^ */\* \[$mark\] \*/\$" src/*/*.[ch] src/*/*/*.[ch]) |
        sed 's/^\([^:]*\):\([^:]*\):.*/    \1, line \2/'
done
echo "Then: cd $kit && make test; make check shows the points"
