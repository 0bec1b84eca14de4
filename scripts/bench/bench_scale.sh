#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# bench_scale: time against M, N, camera samples, pixels, triangles and map size on both backends; the largest mesh and
# map within 8 GiB.
#     scripts/bench/bench_scale.sh BUILD_DIR [SECTION...]        (make bench-scale calls it)
# Sections: sweep triangles maps peak table, all by default. Writes build/bench/scale-*.txt and, by table, plots:
# build/bench/scale-*.svg.
# BENCH_TRIANGLES and BENCH_WIDTH: the largest of each, 10000000 and 16384. Files that are made (1 GB) stay in
# build/bench/scale.
set -eu
build=$1
shift
out=build/bench
made=$out/scale
largest_mesh=${BENCH_TRIANGLES:-10000000}
largest_map=${BENCH_WIDTH:-16384}
mkdir -p "$made" "$out/scenes"
"$build/bis" --version | grep -qi embree && backends="embree grid" || backends=grid

# scene NAME MESH MAP: a template; our knot without its pedestal
scene() {
    cat > "$out/scenes/$1" <<END_OF_SCENE
Film "rgb" "integer xresolution" 176 "integer yresolution" 248
@integrator
Option "bool disablepixeljitter" true
Scale -1 1 1 LookAt -1.5 -6 0.25   0 0 0   0 0 1
Camera "perspective" "float fov" 33
WorldBegin
LightSource "infinite" "string filename" "$3"
Material "phong" @material
Shape "plymesh" "string filename" "$2"
END_OF_SCENE
}
knot() { [ -r "$made/knot-$1.ply" ] || "$build/bis-data" --knot "$1" "$made/knot-$1.ply"; }
map() { [ -r "$made/map-$1.hdr" ] || "$build/bench_scale" map "$1" "$made/map-$1.hdr"; }
# up_to LARGEST FACTOR FIRST: FIRST, FIRST * FACTOR, ... LARGEST
up_to() { awk -v n="$1" -v f="$2" -v x="$3" 'BEGIN { for (; x < n * 1.01; x *= f) printf "%d ", x + 0.5 }'; }

sweep() {
    scene scale "$PWD/data/models/knot.ply" "$PWD/data/maps/interior.hdr"
    for a in $backends; do "$build/bench_scale" sweep "$out/scenes/scale" "$a"; done
}
triangles() {
    for n in $(up_to "$largest_mesh" 3.16227766 10000); do
        knot "$n"
        scene scale "$PWD/$made/knot-$n.ply" "$PWD/data/maps/interior.hdr"
        for a in $backends; do "$build/bench_scale" build "$out/scenes/scale" "$a" triangles "$n"; done
    done
}
maps() {
    for w in $(up_to "$largest_map" 2 256); do
        map "$w"
        scene scale "$PWD/data/models/knot.ply" "$PWD/$made/map-$w.hdr"
        a=${backends%% *}
        "$build/bench_scale" build "$out/scenes/scale" "$a" maps $((w * w / 2))
    done
}

# value FILE KEY: of --stats; the last of that name, "accel" are seconds first and bytes then
value() { sed -n "s/.*\"$2\": *\([0-9.eE+-]*\).*/\1/p" "$1" | tail -n 1; }
# Own report and the system's, of the program itself, all threads.
peak_of() {
    sed "s/@integrator/Sampler \"stratified\" Integrator \"sir\"/; s/@material/\"float Ks\" 0.5/" \
        "$out/scenes/scale" > "$out/scenes/peak.txt"
    for a in $backends; do
        system=$("$build/bench_scale" peak "$build/bis" --quiet --spp 1 \
            --accelerator "$a" --stats "$made/stats.json" --outfile "$made/peak.pfm" \
            "$out/scenes/peak.txt")
        echo "$1 $a $2 $(value "$made/stats.json" peak_memory_bytes) $system" \
            "$(value "$made/stats.json" mesh) $(value "$made/stats.json" accel) $(value "$made/stats.json" envmap)"
    done
}
peak() {
    n=$(up_to "$largest_mesh" 3.16227766 10000)
    n=$(echo "$n" | awk '{ print $NF }')
    knot "$n"
    scene scale "$PWD/$made/knot-$n.ply" "$PWD/data/maps/interior.hdr"
    peak_of triangles "$n"
    map "$largest_map"
    scene scale "$PWD/data/models/knot.ply" "$PWD/$made/map-$largest_map.hdr"
    peak_of map-width "$largest_map"
}
table() {
    for plot in "candidates M candidates" "shadowrays N shadowrays" "samples camera samples a pixel" \
        "pixels pixels" "triangles triangles" "maps pixels of the map"; do
        what=${plot%% *}
        cat "$out"/scale-sweep.txt "$out"/scale-triangles.txt "$out"/scale-maps.txt 2>/dev/null |
            awk -v what="$what" -v axis="${plot#* }" -v json="$out/scale-$what.json" -f scripts/bench/bench_plot.awk
        [ ! -r "$out/scale-$what.json" ] || ! command -v node >/dev/null ||
            node scripts/figures/still.js "$out/scale-$what.json"
    done
    [ -r "$out/scale-peak.txt" ] || return 0
    printf '\npeak memory, GiB (must: 8 at most, own report within 10%% of the system'\''s)\n'
    awk '{ ok = $5 <= 8 * 2^30 && $4 / $5 > 0.9 && $4 / $5 < 1.1
           printf "%-10s %-7s %9d  own %.2f  system %.2f  mesh %.2f  accelerator %.2f  light %.2f  %s\n", $1, $2, $3,
               $4 / 2^30, $5 / 2^30, $6 / 2^30, $7 / 2^30, $8 / 2^30, ok ? "yes" : "NO" }' "$out/scale-peak.txt"
}

[ $# -gt 0 ] || set -- sweep triangles maps peak table
for section; do
    case $section in
    sweep | triangles | maps | peak)
        echo "== $section"
        "$section" > "$out/scale-$section.part"
        mv "$out/scale-$section.part" "$out/scale-$section.txt" ;;
    table) table ;;
    *) echo "bench_scale.sh: no section \"$section\"" >&2 && exit 2 ;;
    esac
done
