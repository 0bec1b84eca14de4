#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# bench_auto: Integrator "auto" against the best of a sweep and against stratified mis, scene by scene
# (scripts/bench/bench_auto.c).
#     scripts/bench/bench_auto.sh BUILD_DIR [SCENE...]        default: data/scenes' main ones, scene.txt, and real meshes and
#     maps where BIS_SHARED has them
#     SPP=200 scripts/bench/bench_auto.sh ...     choose as for renders of 200 camera samples a pixel (default: the scene's)
# Prints, for each scene, "auto SCENE mis-seconds S to-best LEAST MEDIAN MOST to-mis LEAST MEDIAN MOST"; everything
# measured is kept in build/bench/auto.
set -eu
build=$1
shift
shared=$(realpath -m "${BIS_SHARED:-../shared/data}")
out=build/bench/auto
mkdir -p "$out"

# real NAME CAMERA MAP MESH MATERIAL: 352 x 496, four camera samples
real() {
    [ -r "$shared/mesh/$4" ] && [ -r "$shared/env/$3" ] || return 0
    cat > "$out/$1.txt" <<END_OF_SCENE
Film "rgb" "integer xresolution" 352 "integer yresolution" 496
Sampler "stratified" "integer pixelsamples" 4
$2
WorldBegin
AttributeBegin
Rotate -90 1 0 0 LightSource "infinite" "string filename" "$shared/env/$3"
AttributeEnd
Material "phong" $5
Shape "plymesh" "string filename" "$shared/mesh/$4"
END_OF_SCENE
    set -- "$out/$1.txt"
    scenes="$scenes $1"
}

scenes=$*
if [ -z "$scenes" ]; then
    scenes=scene.txt
    for s in figure-5.1 figure-5.2 figure-5.3 figure-5.4 figure-5.5 overcast-diffuse outdoor-sun glossy-row louvres coloured-shadows; do
        scenes="$scenes data/scenes/$s.txt"
    done
    dragon='LookAt 0 0.16 0.55  -0.006 0.122 0  0 1 0 Camera "perspective" "float fov" 17'
    armadillo='LookAt 0 0.1 2.6  -0.01 -0.06 0  0 1 0 Camera "perspective" "float fov" 19'
    n10='"float Ks" 1 "float Kd" 0 "float exponent" 10'
    n50='"float Ks" 1 "float Kd" 0 "float exponent" 50'
    diffuse='"float Ks" 0 "float Kd" 1'
    real dragon-grace-n10 "$dragon" grace_latlong_fyp_extreme.hdr dragon_871k.ply "$n10"
    real dragon-grace-n50 "$dragon" grace_latlong_fyp_extreme.hdr dragon_871k.ply "$n50"
    real dragon-grace-diffuse "$dragon" grace_latlong_fyp_extreme.hdr dragon_871k.ply "$diffuse"
    real dragon-stpeters-n10 "$dragon" stpeters_latlong_1500x750.hdr dragon_871k.ply "$n10"
    real armadillo-uffizi-n50 "$armadillo" uffizi_latlong_1200x600.hdr armadillo_86k.ply "$n50"
    real armadillo-uffizi-diffuse "$armadillo" uffizi_latlong_1200x600.hdr armadillo_86k.ply "$diffuse"
fi
for s in $scenes; do
    OMP_NUM_THREADS=1 "$build/bench_auto" 3000 "$s" ${SPP:+"$SPP"} > "$out/$(basename "$s").csv"
    grep '^auto' "$out/$(basename "$s").csv"
done
