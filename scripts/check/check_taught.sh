#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_taught: what is taught is what runs. Each method's picture must run the files of src/thesis that teach it.
#     scripts/check/check_taught.sh BUILD                        BUILD/libbis.a and BUILD/src/cli/main.o are there
#     scripts/check/check_taught.sh BUILD NAME OPTIONS FILES     one claim alone, by the program that the first form has
#     made
# The files of the table are compiled once more, with the compiler's counters (gcov), and linked before the library.
# BIS_COMPILE, BIS_LINK and BIS_LIBS say how (scripts/course/course.mk). Prints the share of lines that the default
# picture runs. Exits with 1 where a method does not reach a file, and with 77 where there is no gcov.
build=$1
[ -n "$build" ] && [ -n "$BIS_COMPILE" ] || {
    echo "check_taught: run by make test T=taught, which tells how to compile"
    exit 2
}
gcov=${GCOV:-gcov}
skip() { echo "check_taught: SKIPPED: $*"; exit 77; }
command -v "$gcov" >/dev/null || skip "there is no $gcov"
case $BIS_COMPILE in *-fsanitize=*) skip "counters and sanitizers do not mix" ;; esac
if ${BIS_COMPILE%% *} --version | grep -qi clang; then skip "$gcov reads what gcc writes"; fi
dir=$build/taught

make_program() {
    rm -rf "$dir" && mkdir -p "$dir" || exit 1
    for file in src/thesis/*.c src/shape/grid*.c; do
        echo "$file $dir/$(basename "$file" .c).o"
    done | xargs -P "$(nproc)" -L 1 sh -c '$BIS_COMPILE --coverage -c -o "$1" "$0"' || exit 1
    # shellcheck disable=SC2086 # lists of words
    $BIS_LINK --coverage -o "$dir/bis" "$dir"/*.o "$build/src/cli/main.o" "$build/libbis.a" $BIS_LIBS || exit 1
}

# reached: the files in which a line has run, and the lines that have run of those that could.
reached() {
    (cd "$dir" && "$gcov" -n ./*.gcda 2>/dev/null) | awk '
        /^File / { split($0, q, "\047"); file = q[2] }
        /^Lines executed:/ && file ~ /^src\/(thesis|shape)\// {
            percent = $2; sub(/executed:/, "", percent); sub(/%.*/, "", percent)
            if (percent > run[file]) run[file] = percent
            lines[file] = $NF
            file = ""
        }
        END { for (f in run) printf "%s %s %s\n", f, run[f], lines[f] }'
}

# A method: the options that choose it, and the files that teach it.
common="thesis/rng.c thesis/sampler.c thesis/envmap.c thesis/importance.c thesis/regions.c thesis/light.c
    thesis/bsdf.c thesis/phong.c
 thesis/phong_formulas.h"
sets="thesis/model_many.h thesis/candidates.c thesis/draw.c thesis/set.c"
bad=0
check() {
    name=$1 options=$2 files=$3
    rm -f "$dir"/*.gcda
    # shellcheck disable=SC2086
    "$dir/bis" scene.txt --quiet --resolution 48x36 --spp 1 --outfile "$dir/picture.pfm" $options >/dev/null || {
        bad=1
        return
    }
    reached >"$dir/reached"
    for file in $files; do
        awk -v f="src/$file" '$1 == f && $2 > 0 { found = 1 } END { exit !found }' "$dir/reached" && continue
        echo "check_taught: $name does not run src/$file, which teaches it"
        bad=1
    done
}
if [ $# -gt 1 ]; then
    check "$2" "$3" "$4"
    exit $bad
fi
make_program
check em "--integrator em" "$common thesis/em.c thesis/proposal.c thesis/importance_table.c thesis/cdf.c"
check brdf "--integrator brdf" "thesis/brdf.c thesis/bsdf.c thesis/phong.c thesis/phong_formulas.h"
check mis "--integrator mis" "$common thesis/mis.c thesis/proposal.c thesis/importance_table.c thesis/cdf.c"
check rejection "--integrator rejection" "$common $sets thesis/rejection.c thesis/importance_table.c thesis/alias.c"
check unoccluded "--integrator unoccluded" "$common $sets thesis/unoccluded.c thesis/importance_curve.c"
check sir "--integrator sir --proposal mix --learn off" \
    "$common $sets thesis/choose.c thesis/sir.c thesis/importance_curve.c"
check grid "--accelerator grid" "shape/grid_build.c shape/grid_walk.c"
check "the default picture" "" \
    "$common $sets thesis/phong_many.c thesis/choose.c thesis/sir.c thesis/importance_curve.c"
awk '$1 ~ /thesis/ { run += $2 * $3 / 100; lines += $3 }
    END { printf "the default picture runs %.0f %% of the %d lines of src/thesis\n",
        100 * run / lines, lines }' "$dir/reached"
exit $bad
