#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# spdx: every source file names its licence in the form that tools read (https://spdx.dev/learn/handling-license-info).
#     scripts/check/spdx.sh [ROOT]             writes the line where it is missing, behind #!, <!DOCTYPE>, or on top
#     scripts/check/spdx.sh --check [ROOT]     names the files without it; exit status 1; part of `make lint`
# C, shell, awk, make, Python, Lua, JavaScript, and pages and style sheets, because pages hold scripts. Not the hand-ins
# among the tests, which stand for files of strangers, nor scenes.
check=no
[ "$1" = --check ] && check=yes && shift
cd "${1:-.}" || exit 1
id=SPDX-License-Identifier:
licence="$id BSD-2-Clause"
status=0
list=$(mktemp) || exit 1
trap 'rm -f "$list"' EXIT
find Makefile .ci .github pyproject.toml include src tests scripts docs/live data/generate \
    -type f ! -path '*/handed_in/*.c' ! -path '*/bis/pages/*' 2>/dev/null | sort >"$list"
while IFS= read -r file; do
    case $file in
    *.[ch] | *.js | *.css) line="/* $licence */" ;;
    *.html) line="<!-- $licence -->" ;;
    *.lua) line="-- $licence" ;;
    *.sh | *.awk | *.mk | *.py | *.toml | *.yml | */Makefile | Makefile | */Dockerfile) line="# $licence" ;;
    *) case $(head -c 2 "$file" | tr -d '\0') in '#!') line="# $licence" ;; *) continue ;; esac ;;
    esac
    head -n 3 "$file" | grep -qF -e "$line" && continue
    if [ $check = yes ]; then
        echo "$file: no line \"$line\"; sh scripts/check/spdx.sh writes it"
        status=1
        continue
    fi
    # First comes what must: #! of a script, <!DOCTYPE> of a page.
    awk -v line="$line" 'NR == 1 && !/^(#!|<!D)/ { print line } { print } NR == 1 && /^(#!|<!D)/ { print line }' \
        "$file" >"$file.spdx.tmp" &&
        cat "$file.spdx.tmp" >"$file" # cat keeps the mode
    rm -f "$file.spdx.tmp"
done <"$list"
exit $status
