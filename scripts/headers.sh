#!/bin/sh
# headers: what a hand-in may include and no line more: include/ and the headers of src/ and of the tests' helpers,
# in FOLDER.
#     scripts/headers.sh FOLDER
mkdir -p "$1" || exit 1
cp -Rp include "$1" || exit 1
find src -name '*.h' | while IFS= read -r file; do
    mkdir -p "$1/${file%/*}" && cp -p "$file" "$1/$file" || exit 1
done
