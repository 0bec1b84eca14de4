# SPDX-License-Identifier: BSD-2-Clause
# starts: what of OBJECT runs before or after main, a line each: sections, and functions that choose others when the
# program is loaded. For scripts/course/given.sh and scripts/course/accept.sh, which read this file in.
starts() {
    {
        readelf -SW "$1" | grep -o '\.[a-z_]*init[a-z_]*\|\.fini[a-z_]*\|\.ctors\|\.dtors'
        nm "$1" | awk '$2 == "i" { sub(/[.].*/, "", $3); print $3 }' # clang writes NAME.ifunc
    } 2>/dev/null | LC_ALL=C sort
}
