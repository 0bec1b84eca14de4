#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# fuzz: runs libFuzzer's targets, one after the other (make fuzz calls it).
#     scripts/check/fuzz.sh BUILD SECONDS [NAME...]          NAME: scene hdr pfm exr png ply obj mtl spd gz map part
#                                                            checkpoint; default: all
# What a target begins with: files that the tests make, tests/data/bad, tests/data/scenes, tests/data/regression and
# data/scenes; what it finds new on the way stays in build/fuzz/corpus/NAME for the next run. A finding is left in
# build/fuzz/found; exit status 1 then.
build=$1 seconds=$2
shift 2
[ $# -gt 0 ] || set -- scene hdr pfm exr png ply obj mtl spd gz map part checkpoint
work=build/fuzz
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
mkdir -p $work/made $work/found
# What OpenMP's threads hold until the end is libomp's, not ours.
echo leak:libomp >$work/suppressions
export LSAN_OPTIONS=suppressions=$work/suppressions:print_suppressions=0
for test in image image_hdr image_pfm image_exr image_png image_screen ply obj gzip part convert; do
    [ -e $work/made/.$test ] ||
        BIS_PROGRAM="$build/bis" BIS_SEEDS=$work/made "$build/tests/test_$test" \
            >$work/seeds.log 2>&1 || {
            cat $work/seeds.log
            exit 1
        }
    touch $work/made/.$test
done
status=0
for name in "$@"; do
    seeds=$work/seeds/$name
    mkdir -p $seeds $work/corpus/$name
    case $name in
    scene)
        cp tests/data/bad/*.txt tests/data/scenes/*.txt tests/foreign/scenes/*.txt $seeds
        cp data/scenes/*.txt data/scenes/pbrt/* $seeds ;;
    map) for f in $work/made/*.pfm $work/made/*.hdr; do { printf 'A\014'; cat "$f"; } >$seeds/"${f##*/}"; done ;;
    mtl)
        {
            printf 'newmtl a\nKd 0.5 0.5 0.5\nKs 0.1\nNs 20\nillum 2\nd 0.5\nKe 1 1 1\nnewmtl b\nillum 1\n'
            printf 'map_Kd -s 2 2 1 -o 0 1 -clamp on a.png\nmap_Bump -bm 0.5 a.png\nnorm -o 1 a.png\n'
        } >$seeds/a.mtl ;;
    checkpoint)
        for spp in 1 2 8 11; do
            "$build/bis" tests/fuzz/checkpoint.txt --spp $spp --checkpoint $seeds/$spp.checkpoint \
                --outfile $work/made/checkpoint.exr --quiet || exit 1
        done ;;
    spd) printf '# a spectrum\n400 0.1, 500 0.2\n\n700\t0.3 # red\n' >$seeds/a.spd ;;
    png) cp $work/made/*.png $work/made/*.jpg $work/made/*.tga $work/made/*.bmp tests/foreign/*/*.jpg \
        tests/foreign/*/*.tga $seeds 2>/dev/null ;;
    *) cp $work/made/*."$name" $seeds 2>/dev/null ;;
    esac
    cp tests/data/regression/*."$name" tests/foreign/*/*."$name" $seeds 2>/dev/null
    echo "==== fuzz_$name: $(ls $seeds | wc -l) seeds, $(ls $work/corpus/$name | wc -l) from runs before, $seconds s"
    # Words of the seeds that are text: what a parser compares with.
    cat $seeds/* | LC_ALL=C grep -aoE '"[a-zA-Z0-9 ]+"|[A-Za-z]{2,30}=?' | tr -d '"' |
        sort -u | sed 's/.*/"&"/' >$work/$name.dict
    "$build/fuzz_$name" -dict=$work/$name.dict -max_total_time="$seconds" -max_len=16384 -timeout=20 \
        -rss_limit_mb=3072 -print_final_stats=1 \
        -artifact_prefix=$work/found/$name- $work/corpus/$name $seeds >$work/$name.log 2>&1 || {
        status=1
        grep -E 'ERROR|runtime error|does not hold|SUMMARY|Test unit written' $work/$name.log
    }
    grep -E 'number_of_executed_units|peak_rss_mb|slowest_unit' $work/$name.log
    grep -E ' cov: ' $work/$name.log | tail -n 1
done
exit $status
