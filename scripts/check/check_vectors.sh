#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_vectors: the loops over lanes are vectors. gcc leaves a loop scalar without a word, which is three times as
# slow, if its body has a local array, a result through a pointer, or a branch. Each loop below a plain `#pragma omp
# simd` must become vectors of 16, 32 and 64 bytes (include/bis/base/clones.h) in all its copies; gcc's own report
# tells.
#     scripts/check/check_vectors.sh [FILE...]          default: all files of src/ that have or include such a loop
# From the root. make gives, in BIS_COMPILE, how to compile (scripts/course/course.mk). Prints the loops that are
# scalar, and exits with 1. Where this compiler, with these flags, makes no such vectors even of the simplest loop, it
# says so and exits with 0. Loops with a reduction are not looked at, because gcc leaves them scalar for a processor
# without masks.
: "${BIS_COMPILE:?make lint tells how to compile}"
here=$(mktemp -d) || exit 1
trap 'rm -rf "$here"' EXIT

# judge FILE: prints its scalar loops; exit status 1 if there is one.
judge() {
    # shellcheck disable=SC2086
    $BIS_COMPILE -g0 -fopt-info-vec-optimized-missed="$here/report" -S -o /dev/null "$1" || return 2
    awk -v source="$1" '
        function judge(file, from, to,    i, w, bad, has) {
            for (i = from; i <= to; i++) {
                bad = bad || (file ":" i) in scalar
                for (w = 16; w <= 64; w *= 2) if ((file ":" i, w) in vector) has[w] = 1
            }
            if (!bad && has[16] && has[32] && has[64]) return
            printf "check_vectors: %s:%d: this loop is scalar in %s; has it a local array, a result through a " \
                "pointer, a branch?\n", file, from, source
            wrong = 1
        }
        { split($0, at, ":") }
        /: missed: couldn.t vectorize loop/ { files[at[1]]; scalar[at[1] ":" at[2]] }
        /: optimized: loop vectorized using/ { files[at[1]]; vector[at[1] ":" at[2], $(NF - 2)] }
        END {
            files[source]
            for (file in files)
                for (n = 1; (getline line <file) > 0; n++) {
                    if (below) { # a loop begins
                        from = n
                        indent = line
                        sub(/for .*/, "", indent)
                        if (line !~ /{$/) judge(file, from, n + 1)
                        else inside = 1
                    } else if (inside && index(line, indent "}") == 1) {
                        judge(file, from, n)
                        inside = 0
                    }
                    below = line ~ /^ *#pragma omp simd$/
                }
            exit wrong
        }' "$here/report"
}
if [ "$judging" ]; then judge "$1"; exit; fi

# The simplest loop, because what is not made of it cannot be asked of others.
cat >"$here/simple.c" <<'END'
#include "bis/base/clones.h"
void twice(float *a, unsigned n);
BIS_LANES
static void twice_lanes(float *a, unsigned n)
{
#pragma omp simd
    for (unsigned i = 0; i < n; i++) a[i] = a[i] + a[i];
}
void twice(float *a, unsigned n) { twice_lanes(a, n); }
END
judge "$here/simple.c" >"$here/log" 2>&1 ||
    {
        echo "check_vectors: SKIPPED: this compiler, with these flags, makes or reports no vectors" \
            "of 16, 32 and 64 bytes"
        exit 0
    }
# shellcheck disable=SC2046
[ $# -gt 0 ] || set -- $(grep -lE '^ *#pragma omp simd$|^#include "thesis/model_many.h"' src/*/*.c)
printf '%s\n' "$@" | judging=1 xargs -P 2 -n 1 sh "$0" || [ -f assignment ] || exit 1 # in a starter kit it is advice
