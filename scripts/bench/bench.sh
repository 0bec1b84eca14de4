#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# bench: speed and error as ratios, each with its spread, all on one core. docs/trust.md says how to read the table.
#     scripts/bench/bench.sh BUILD_DIR [SECTION...]        (make bench calls it)
# Sections: references equal resample steps rival table, all by default. Each writes
# build/bench/SECTION.txt, and table reads what is there: one section can be measured again alone. The settings that are
# compared stand on top of scripts/bench/bench_error.c.
# BIS_SHARED (default ../shared/data) has the real meshes and maps; without them only our own scenes are measured.
set -eu
build=$1
shift
out=build/bench
shared=$(realpath -m "${BIS_SHARED:-../shared/data}")
mkdir -p "$out/scenes"

reference_seconds=${BENCH_REFERENCE:-30} # of processor time, once for each scene and material; kept in build/bench/ref
steps_reference_seconds=${BENCH_STEPS_REFERENCE:-160}

# template NAME CAMERA LIGHT SHAPE OPTION: a scene with blanks, see scripts/bench/measure.h
template() {
    cat > "$out/scenes/$1" <<END_OF_SCENE
Film "rgb" "integer xresolution" 176 "integer yresolution" 248
@integrator
$5
$2
WorldBegin
AttributeBegin
$3
AttributeEnd
$4
END_OF_SCENE
}
map() { echo "$1 LightSource \"infinite\" \"string filename\" \"$2\" ${3-}"; }
mesh() { echo "Material \"phong\" @material Shape \"plymesh\" \"string filename\" \"$shared/mesh/$1\""; }

pairs="knot-interior knot-overcast"
centres='Option "bool disablepixeljitter" true'
statue='Scale -1 1 1 LookAt -2.0 -7.4 0.25   0 0 -0.28   0 0 1 Camera "perspective" "float fov" 29'
figure="MakeNamedMaterial \"figure\" \"string type\" \"phong\" @material Include \"$PWD/data/scenes/statue.inc\""
template knot-interior "$statue" "$(map "Rotate -25 0 0 1" "$PWD/data/maps/interior.hdr")" "$figure" "$centres"
template knot-overcast "$statue" "$(map "Rotate 0 0 0 1" "$PWD/data/maps/overcast.hdr")" "$figure" "$centres"
first=knot-interior
if [ -r "$shared/mesh/dragon_871k.ply" ]; then
    dragon='LookAt 0 0.16 0.55  -0.006 0.122 0  0 1 0 Camera "perspective" "float fov" 17'
    armadillo='LookAt 0 0.1 2.6  -0.01 -0.06 0  0 1 0 Camera "perspective" "float fov" 19'
    up="Rotate -90 1 0 0"
    template dragon-grace "$dragon" "$(map "$up" "$shared/env/grace_latlong_fyp_extreme.hdr")" \
        "$(mesh dragon_871k.ply)" "$centres"
    template dragon-stpeters "$dragon" "$(map "$up" "$shared/env/stpeters_latlong_1500x750.hdr")" \
        "$(mesh dragon_871k.ply)" "$centres"
    template armadillo-uffizi "$armadillo" "$(map "$up" "$shared/env/uffizi_latlong_1200x600.hdr")" \
        "$(mesh armadillo_86k.ply)" "$centres"
    template rival "$dragon" "$(map "$up" "$shared/env/grace_latlong_pbrt2.exr" '"bool visible" false')" \
        "$(mesh dragon_871k.ply)" ""
    aside='LookAt -0.09 0.17 0.30  -0.007 0.122 -0.004  0 1 0 Camera "perspective" "float fov" 28'
    swapped="Transform [1 0 0 0  0 0 1 0  0 1 0 0  0 0 0 1]"
    template steps "$aside" "$(map "$swapped" "$shared/env/grace_latlong_pbrt2.exr" '"bool visible" false')" \
        "$(mesh dragon_871k.ply) \"bool smooth\" true" ""
    pairs="dragon-grace dragon-stpeters armadillo-uffizi $pairs"
    first=dragon-grace
else
    echo "real data not found at $shared (set BIS_SHARED): only our own scenes are measured"
fi
pairs=${BENCH_PAIRS:-$pairs} # a part of them, by name
[ -r "$out/scenes/rival" ] && rival=rival || rival=

# keep FILE COMMAND...: its output, which only a complete run replaces
keep() {
    kept=$1
    shift
    "$@" > "$kept.part"
    mv "$kept.part" "$kept"
}
each_pair() { for pair in $pairs; do "$build/bench_error" "$1" "$reference_seconds" "$out/scenes/$pair"; done; }
references() {
    each_pair reference
    [ -z "$rival" ] || "$build/bench_error" reference "$steps_reference_seconds" "$out/scenes/steps"
}
# bis beside Mitsuba 3, on the last core that we may use.
beside_mitsuba() {
    python=${BENCH_PYTHON:-python3}
    if [ ! -r "$shared/mesh/dragon_871k.ply" ] || [ ! -r "$shared/env/grace_latlong_pbrt2.exr" ]; then
        echo "rival is left out: no real data at $shared (set BIS_SHARED)"
    elif ! "$python" -c 'import mitsuba, numpy; mitsuba.set_variant("llvm_ad_rgb")' 2>/dev/null; then
        echo "rival is left out: $python cannot use Mitsuba 3, numpy and LLVM (set BENCH_PYTHON, DRJIT_LIBLLVM_PATH;" \
            "docs/trust.md)"
    else
        core=$(taskset -cp $$ | sed 's/.*[^0-9]//')
        keep "$out/rival.txt" taskset -c "$core" "$python" scripts/bench/rival.py "$build/bis" "$shared" "$out"
        cat "$out/rival.txt"
    fi
}

[ $# -gt 0 ] || set -- references equal resample steps rival table
for section; do
    [ "$section" = table ] || echo "== $section"
    case $section in
    references) keep "$out/references.txt" references ;;
    equal) keep "$out/equal.txt" each_pair equal ;;
    resample) keep "$out/resample.txt" "$build/bench_error" resample "$reference_seconds" "$out/scenes/$first" ;;
    steps)
        if [ "$rival" ]; then
            keep "$out/steps.txt" "$build/bench_error" steps "$steps_reference_seconds" "$out/scenes/steps"
        fi ;;
    rival) beside_mitsuba ;;
    table)
        awk -f scripts/bench/bench_table.awk \
            $(for f in references equal resample steps rival; do
                [ -r "$out/$f.txt" ] && echo "$out/$f.txt"
            done) ;;
    *) echo "bench.sh: no section \"$section\"" >&2 && exit 2 ;;
    esac
done
