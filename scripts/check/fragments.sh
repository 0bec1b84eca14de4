#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# fragments: code on the pages is pasted in by reference. A page says
#     <!-- src/thesis/alias.c [alias-sample] -->
# and what stands in the block of code below it is what stands between /* [alias-sample] */ and the next /* [end] */
# of that file, to the letter.
#     scripts/check/fragments.sh [ROOT]              writes the blocks anew
#     scripts/check/fragments.sh --check [ROOT]      exit status 1 where a block differs or its fragment is gone; part
#                                                    of `make lint`
check=no
[ "$1" = --check ] && check=yes && shift
cd "${1:-.}" || exit 1
fresh=$(mktemp) || exit 1
trap 'rm -f "$fresh"' EXIT
status=0
for page in $(find README.md docs -name '*.md' | sort); do
    awk -v page="$page" '
        function paste(file, name,    line, n, inside, closed) {
            while ((getline line < file) > 0) {
                if (inside && line ~ /^ *\/\* \[end\] \*\/$/) { closed = 1; break }
                if (inside) { print line; n++ }
                if (line ~ "^ */\\* \\[" name "\\] \\*/$") inside = 1
            }
            close(file)
            if (closed && n) return
            printf "%s:%d: %s has no fragment [%s]\n", page, NR, file, name > "/dev/stderr"
            bad = 1
        }
        reference && /^```/ { if (block) reference = block = 0; else block = 1; next }
        reference && block { next }
        reference { printf "%s:%d: the block of code is missing\n", page, NR > "/dev/stderr"; bad = 1; reference = 0 }
        { print }
        /^<!-- [^ ]+ \[[a-z0-9-]+\] -->$/ {
            print "```c"
            paste($2, substr($3, 2, length($3) - 2))
            print "```"
            reference = 1
        }
        END { exit bad }' "$page" >"$fresh" || { status=1; continue; }
    cmp -s "$fresh" "$page" && continue
    if [ $check = yes ]; then
        echo "$page: code differs from its source: sh scripts/check/fragments.sh writes it anew" >&2
        diff "$page" "$fresh" | head -20 >&2
        status=1
    else
        cat "$fresh" >"$page" && echo "$page"
    fi
done
exit $status
