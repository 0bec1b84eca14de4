#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# units: the files below src/ that are compiled where FILES are under study: a .c itself; for a header the .c that names
# it.
#     scripts/course/units.sh FILE...          FILE: a path below src/
# From the root.
for file in "$@"; do
    case $file in
    *.h) (cd src && grep -l "\"\(.*/\)*${file##*/}\"" */*.c */*/*.c) ;;
    *) echo "$file" ;;
    esac
done | sort -u
