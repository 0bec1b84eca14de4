#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# envelope: writes docs/trust.md anew (make envelope calls it): what stands above the line `<!-- tables -->` is kept,
# the tables come from the tests.
#     scripts/check/envelope.sh PROGRAM...
# A bound that does not hold ends it, and the page stays as it was.
set -e
page=docs/trust.md
rm -f build/envelope/?.md
for program in "$@"; do
    BIS_LONG=1 BIS_ENVELOPE_WRITE=1 "$program" || {
        echo "make envelope: a bound does not hold; $page is as it was"
        exit 1
    }
done
sed '/^<!-- tables -->$/q' $page > $page.tmp
{ echo; cat build/trust.md; } | sed '$d' >> $page.tmp
mv $page.tmp $page
echo "make envelope: wrote $page"
