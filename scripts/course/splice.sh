#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# splice: copies of the files of src/ that hold the fragments of FRAGMENTS, with these in place of theirs
# (scripts/course/splice.awk), into FOLDER.
#     scripts/course/splice.sh FRAGMENTS FOLDER
# Prints the files' paths below src/. Every fragment must be in one file of src/.
here=$(dirname "$0")
for name in $(sed -n 's|^ */\* \[\([a-z0-9-]*\)\] \*/$|\1|p' "$1" | grep -vx end); do
    file=$(grep -l "^ */\* \[$name\] \*/\$" src/*/*.[ch] src/*/*/*.[ch])
    [ "$(echo "$file" | wc -w)" -eq 1 ] || {
        echo "splice: [$name] of $1 is in so many files of src/: $file" >&2
        exit 1
    }
    echo "${file#src/}"
done >"$2/spliced" || exit 1
[ -s "$2/spliced" ] || { echo "splice: $1 holds no fragment" >&2; exit 1; }
sort -u "$2/spliced" | while IFS= read -r file; do
    mkdir -p "$2/$(dirname "$file")" && awk -f "$here/splice.awk" "$1" "src/$file" >"$2/$file" && echo "$file" || exit 1
done
