#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# verify_alarms: the table of docs/proof.md: how often does `bis verify` accuse what is right? So many seeds on each of
# eleven scenes, the last three with meshes and maps that others measured, where BIS_SHARED names a folder that has
# them. About twenty minutes of one processor for 200.
#     make bis data build/release/verify_alarms && scripts/bench/verify_alarms.sh [build/release [200 [FIRST-SEED]]]
B=${1:-build/release}
runs=${2:-200}
first=${3:-1}
dir=$B/alarms
mkdir -p "$dir" || exit 1

# real NAME MAP MESH MATERIAL ROTATION: a mesh of any size on a floor.
real() {
    test -f "$BIS_SHARED/env/$2" && test -f "$BIS_SHARED/mesh/$3" || return
    cat >"$dir/$1.txt" <<END
Film "rgb" "integer xresolution" 96 "integer yresolution" 72
LookAt 0.4 0.35 3.2  0 0 0  0 1 0
Camera "perspective" "float fov" 36
WorldBegin
AttributeBegin Rotate -90 1 0 0 LightSource "infinite" "string filename" "$BIS_SHARED/env/$2" AttributeEnd
Material "phong" "rgb Kd" [.5 .45 .4] "rgb Ks" [.2 .2 .2] "float exponent" 40
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -0.7 9  9 -0.7 9  9 -0.7 -9  -9 -0.7 -9]
Material $4
AttributeBegin $5 Shape "plymesh" "string filename" "$BIS_SHARED/mesh/$3" AttributeEnd
END
    echo "$dir/$1.txt"
}

cat >"$dir/ball.txt" <<END
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Camera "perspective" "float fov" 60
WorldBegin
AttributeBegin Rotate -90 1 0 0 LightSource "infinite" "string filename" "$PWD/data/maps/lamps.hdr" AttributeEnd
Material "phong" "rgb Kd" [.5 .4 .3] "rgb Ks" [.2 .2 .2] "float exponent" 20
AttributeBegin Translate 0 0 4 Shape "sphere" AttributeEnd
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9]
END
# the same, rendered by all that learns and shares
{
    echo 'Sampler "sobol" "integer pixelsamples" 16 "integer edgesamples" 4'
    echo 'Integrator "sir" "string proposal" "product" "integer candidates" 64' \
        '"integer shadowrays" 16 "bool learn" true'
    cat "$dir/ball.txt"
} >"$dir/ball-product.txt"
scenes="$dir/ball.txt $dir/ball-product.txt"
for name in figure-5.3 outdoor-sun pinpoint coloured-shadows trianglemesh steel-on-paper; do
    scenes="$scenes data/scenes/$name.txt"
done
if test -n "$BIS_SHARED"; then
    scenes="$scenes $(real bunny-uffizi uffizi_256x128.hdr bunny_69k.ply \
        '"microfacet" "rgb Ks" [.9 .8 .4] "float roughness" 0.3' \
        'Translate 0 -0.75 0 Scale 6 6 6')"
    scenes="$scenes $(real dragon-grace grace_new_256x128.hdr dragon_res4_11k_ascii.ply \
        '"phong" "rgb Kd" [.2 .3 .2] "rgb Ks" [.6 .6 .6] "float exponent" 200' \
        'Translate 0 -0.95 0 Scale 6 6 6')"
    scenes="$scenes $(real teapot-wells wells_256x128.hdr teapot_2k_ascii.ply \
        '"diffuse" "rgb reflectance" [.7 .7 .7]' \
        'Rotate -90 1 0 0 Scale 0.25 0.25 0.25')"
else
    for name in overcast-diffuse orthographic crop; do scenes="$scenes data/scenes/$name.txt"; done
fi
OMP_NUM_THREADS=${OMP_NUM_THREADS:-1} exec "$B/verify_alarms" 5 "$first" "$runs" 64 $scenes
