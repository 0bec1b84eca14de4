#!/bin/sh
# bench: the project's speed and memory as figures and ratios, all from one run on one core.
#     scripts/bench.sh BUILD_DIR        (make bench calls it)
# With the real data (BIS_SHARED, default ../shared/data) the Stanford dragon under Grace; else our own knot under our own interior.
set -eu
build=$1
shared=${BIS_SHARED:-../shared/data}
out=build/bench
mkdir -p "$out"

if [ -r "$shared/mesh/dragon_871k.ply" ]; then
    mesh=$(realpath "$shared/mesh/dragon_871k.ply")
    map=$(realpath "$shared/env/grace_latlong_fyp_extreme.hdr")
    name="Stanford dragon, 871k triangles, under Grace (extreme)"
    camera='LookAt -0.0 0.16 0.55  -0.006 0.122 0  0 1 0 Camera "perspective" "float fov" 17'
else
    echo "real data not found at $shared (set BIS_SHARED): using the project's own knot and interior"
    "$build/bis-data" --knot 871000 "$out/knot.ply"
    mesh=$(realpath "$out/knot.ply")
    map=$(realpath data/maps/interior.exr)
    name="our knot, 871k triangles, under our interior"
    camera='LookAt 0 1 6  0 0 0  0 1 0 Camera "perspective" "float fov" 35'
fi

# material NAME "PARAMETERS": writes $out/NAME.txt
scene() {
    cat > "$out/$1.txt" <<END
$camera
Film "rgb" "integer xresolution" 176 "integer yresolution" 248 "string filename" "$out/$1.exr"
WorldBegin
AttributeBegin
  Rotate -90 1 0 0
  LightSource "infinite" "string filename" "$map"
AttributeEnd
Material "phong" $2
Shape "plymesh" "string filename" "$mesh"
END
}
scene n10 '"rgb Ks" [1 1 1] "rgb Kd" [0 0 0] "float exponent" 10'
scene n50 '"rgb Ks" [1 1 1] "rgb Kd" [0 0 0] "float exponent" 50'
scene mixed '"rgb Ks" [.5 .5 .5] "rgb Kd" [.5 .5 .5] "float exponent" 50'
scene diffuse '"rgb Ks" [0 0 0] "rgb Kd" [1 1 1]'

# value FILE KEY: a number of a --stats file
value() { sed -n "s/.*\"$2\": *\([0-9.eE+-]*\).*/\1/p" "$1" | head -n 1; }

echo "== preparing a 4096 x 2048 map, one thread"
OMP_NUM_THREADS=1 "$build/bench_light" 4096

echo "== rays and builds"
"$build/bench_accel" "$mesh"

echo "== render phase, 176x248, --spp 1, one thread: $name (smallest of 5)"
printf '%-9s %-22s %8s %9s %10s %12s %9s %8s\n' material integrator seconds shadow_k "us/shadow" candidates_k peak_MiB load_s
for m in n10 n50 mixed diffuse; do
    for how in "sir --candidates 800 --shadowrays 15" "rejection --candidates 800 --shadowrays 15" "em --samples 100" "brdf --samples 75" "mis --samples 100"; do
        best=
        for run in 1 2 3 4 5; do
            "$build/bis" --quiet --spp 1 --disable-pixel-jitter --nthreads 1 --integrator $how --stats "$out/stats.json" "$out/$m.txt"
            s=$(value "$out/stats.json" render)
            best=$(printf '%s\n%s\n' "$best" "$s" | grep . | sort -g | head -n 1)
        done
        shadow=$(value "$out/stats.json" shadow)
        cand=$(value "$out/stats.json" candidates_drawn)
        peak=$(value "$out/stats.json" peak_memory_bytes)
        load=$(value "$out/stats.json" load)
        awk -v m="$m" -v h="$(echo "$how" | sed 's/--candidates //; s/--shadowrays //; s/--samples //')" -v s="$best" -v r="$shadow" -v c="${cand:-0}" -v p="$peak" -v l="$load" \
            'BEGIN { printf "%-9s %-22s %8.3f %9.0f %10.3f %12.0f %9.0f %8.3f\n", m, h, s, r / 1e3, s / r * 1e6, c / 1e3, p / 1048576, l }'
    done
done
echo "== threads: sir 15/800, n50"
for n in 1 2; do
    best=
    for run in 1 2 3 4 5; do
        "$build/bis" --quiet --spp 4 --disable-pixel-jitter --nthreads $n --integrator sir --candidates 800 --shadowrays 15 --stats "$out/stats.json" "$out/n50.txt"
        best=$(printf '%s\n%s\n' "$best" "$(value "$out/stats.json" render)" | grep . | sort -g | head -n 1)
    done
    echo "threads $n seconds $best"
done
