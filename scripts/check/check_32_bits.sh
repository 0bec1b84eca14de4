#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_32_bits: would the sources compile without warnings where size_t has 32 bits? A shift of a size_t by 40 is
# undefined there, and no test on this machine sees it. Nothing is linked: 32-bit libraries are not needed, nor the
# header that lists them.
#     scripts/check/check_32_bits.sh [FILE...]          default: all of src/ but what needs MPI
#     scripts/check/check_32_bits.sh --run              (`make test-32`) builds with -m32 and runs the tests of base and
#                                                       thesis
# Conversions are not looked at: a few 64-bit counts become sizes of memory. make gives BIS_COMPILE. Exit status 1 and
# the warnings, or 0 and a word where the compiler has no -m32. --run needs gcc-multilib and, of 32 bits, OpenEXR,
# libpng, zlib and cmocka (on Debian: dpkg --add-architecture i386; libopenexr-dev:i386 ...). Where they stand
# elsewhere, LDFLAGS and LD_LIBRARY_PATH name the folder. It says so and ends with 0 where one is missing.
if [ "$1" = --run ]; then
    compiler="${CC:-cc} -m32" probe=$(mktemp) || exit 1
    for library in OpenEXRCore png z cmocka; do
        echo 'int main(void) { return 0; }' |
            $compiler -x c - -o "$probe" $LDFLAGS -Wl,--no-as-needed -l$library >/dev/null 2>&1 &&
                continue
        rm -f "$probe"
        echo "32 bits: SKIPPED: $compiler cannot link -l$library"
        exit 0
    done
    rm -f "$probe"
    for layer in base thesis; do
        ${MAKE:-make} VARIANT=bits32 EMBREE=0 HAS_MPI= CC="$compiler" LDFLAGS="$LDFLAGS" T=$layer test || exit 1
    done
    exit 0
fi
stubs=$(mktemp -d) || exit 1
trap 'rm -rf "$stubs"' EXIT
mkdir "$stubs/gnu" && : >"$stubs/gnu/stubs-32.h"
compile="${BIS_COMPILE:-cc -std=c11} -m32 -fsyntax-only -Werror -Wno-conversion -Wno-psabi -I$stubs"
compile="$compile -isystem /usr/include/$(uname -m)-linux-gnu"
printf '#include <stdio.h>\n_Static_assert(sizeof(void *) == 4, "");\n' >"$stubs/probe.c"
$compile "$stubs/probe.c" 2>/dev/null || { echo "32 bits: not checked: the compiler has no -m32"; exit 0; }
[ $# -gt 0 ] || set -- $(find src -name "*.c" ! -name "ranks_mpi.c")
bad=0
for file; do
    $compile "$file" || bad=1
done
exit $bad
