#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# given: what a hand-in is compared with, in FOLDER: of the marking (scripts/course/grade_shop.sh), and of a starter
# kit, so that `make check` there refuses what `make grade` does (scripts/course/accept.sh).
#     scripts/course/given.sh NAME FOLDER
# From the root, once its objects are built.
#     files    the files under study, below src/       units                what is compiled of src/ with them
#     blank/   these files as they are given out       refer/FILE.defined   what an object must define
#                                                         refer/FILE.starts    what runs by itself, a line each
#     allowed  what any may use
build=${BIS_BUILD:-build/release}
. scripts/course/starts.sh
folder=$2
mkdir -p "$folder/blank" || exit 1
sh scripts/course/splice.sh "tests/course/${1}_blank.c" "$folder/blank" >"$folder/files" || exit 1
rm "$folder/blank/spliced"
# shellcheck disable=SC2046
sh scripts/course/units.sh $(cat "$folder/files") >"$folder/units" || exit 1

# Of the library: what ours uses, and memory, messages, random numbers, warps; no files and threads.
while IFS= read -r file; do
    object=$build/src/${file%.c}.o
    [ -f "$object" ] || { echo "given: $object is not built: run make first" >&2; exit 1; }
    mkdir -p "$folder/refer/${file%/*}"
    nm -P -g "$object" | awk '$2 != "U" && $2 != "w" { print $1 }' | sort >"$folder/refer/$file.defined"
    starts "$object" >"$folder/refer/$file.starts"  # nothing, but for what a sanitizer adds, and loops for AVX2
    nm -P -g "$object" | awk '$2 == "U" { print $1 }'
done <"$folder/units" >"$folder/uses" || exit 1
for object in "$build"/src/base/*.o "$build/src/thesis/rng.o" "$build/src/thesis/warp.o"; do
    case $object in */file.o | */threads.o) continue ;; esac
    nm -P -g "$object" | awk '$2 != "U" && $2 != "w" { print $1 }'
done | sort -u - "$folder/uses" >"$folder/allowed" && rm "$folder/uses"
