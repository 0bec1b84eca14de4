#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check: what `make grade` would refuse or remark of this starter kit, by the same code (make check). Exit status 1
# if it gives no points at all.
#     scripts/course/check.sh
# From the kit's root, with what scripts/course/course.mk exports.
fail() {
    echo "make check: $*" >&2
    exit 1
}
. scripts/course/accept.sh
work=$(mktemp -d "${TMPDIR:-/tmp}/check.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM HUP
name=$(sed -n 1p assignment)
given=.
shop=$work/given
tool=$BIS_BUILD/grade
export BIS_SANDBOX=none
cp -R tests/given "$shop" && sh scripts/course/headers.sh "$shop/headers" || exit 1
accept
sed '/^$/d; s/^/remark: /' "$work/remarks"
[ -z "$reason" ] || { echo "make grade will give no points: $reason"; exit 1; }
