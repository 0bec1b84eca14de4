#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# figures: every figure of the thesis that is a result or a plot, rendered again into build/figures (with BIS_SHARED:
# build/figures/shared). docs/trust.md says what they show.
#     scripts/figures/figures.sh BUILD_DIR [FIGURE...]        (make figures calls it); all of them by default
#     scripts/figures/figures.sh --list
# Our own model and maps, or, where BIS_SHARED names a folder that has them, the dragon under Grace Cathedral and St
# Peter's. FIGURES_SIZE=88x124 is the size of the thesis's 176x248 pictures (which is the size for figures to be
# measured), FIGURES_REFERENCE=8 processor seconds for each reference: these are kept in build/bench/ref.
set -eu
all="3.3 3.4 3.5 3.6 3.8 3.9 4.1 4.2 4.3 4.4 4.5 5.1 5.2 5.3 5.4 5.5 5.6 5.7-n10 5.7-n50 5.8 5.9 price"
[ "$1" != --list ] || { echo "$all" && exit; }
build=$1
shift
for figure; do
    case " $all " in
    *" $figure "*) ;;
    *) echo "figures.sh: no figure \"$figure\" among: $all" >&2 && exit 2 ;;
    esac
done
command -v node >/dev/null || {
    echo "figures.sh: node draws the figures, and is not here: scripts/setup.sh --web installs it" >&2
    exit 1
}
out=build/figures${BIS_SHARED:+/shared}
mkdir -p "$out" build/bench
size=${FIGURES_SIZE:-88x124}
seconds=${FIGURES_REFERENCE:-8}
width=${size%x*}
height=${size#*x}

# template NAME WIDTH HEIGHT CAMERA TURN MAP SHAPE: a scene with blanks, see scripts/bench/measure.h
template() {
    cat > "$out/$1.scene" <<END_OF_SCENE
Film "rgb" "integer xresolution" $2 "integer yresolution" $3
Sampler "stratified" "integer pixelsamples" 1
@integrator
Option "bool disablepixeljitter" true
$4
WorldBegin
AttributeBegin
$5 LightSource "infinite" "string filename" "$6"
AttributeEnd
$7
END_OF_SCENE
}
if [ -n "${BIS_SHARED:-}" ]; then
    shared=$(realpath "$BIS_SHARED")
    map=$shared/env/derived/grace_1024x512.exr
    place='LookAt 0 0.16 0.55  -0.006 0.122 0  0 1 0'
    near="$place Camera \"perspective\" \"float fov\" 17"
    far="$place Camera \"perspective\" \"float fov\" 23"
    shape="Material \"phong\" @material Shape \"plymesh\" \"string filename\" \"$shared/mesh/dragon_871k.ply\""
    turn="Rotate -90 1 0 0"
    column=$((width * 7 / 22)) # on the dragon's back, in the light: its normal, too, points at the horizon
    row=$((height * 13 / 31))
    other_turn=$turn
    other=$shared/env/derived/stpeters_1024x512.exr
else
    map=$PWD/data/maps/interior.hdr
    place='Scale -1 1 1 LookAt -2.0 -7.4 0.25   0 0 -0.28   0 0 1'
    near="$place Camera \"perspective\" \"float fov\" 29"
    far="$place Camera \"perspective\" \"float fov\" 40"
    shape="MakeNamedMaterial \"figure\" \"string type\" \"phong\" @material Include \"$PWD/data/scenes/statue.inc\""
    turn="Rotate -25 0 0 1"
    other_turn="Rotate 150 0 0 1"
    other=$PWD/data/maps/studio.hdr
    column=$((width / 2))
    row=$((height * 9 / 10)) # the front of the pedestal: its normal points at the horizon, as in the thesis
fi
template hall "$width" "$height" "$near" "$turn" "$map" "$shape"
template other "$width" "$height" "$near" "$other_turn" "$other" "$shape"
template unzoomed $((width * 228 / 176)) $((height * 272 / 248)) "$far" "$turn" "$map" "$shape"
template whole $((width * 268 / 176)) $((height * 220 / 248)) "$far" "$turn" "$map" "$shape"

maps() {
    rm -rf "$out/map"
    mkdir "$out/map"
    "$build/bis" envmap "$map" --outdir "$out/map" > "$out/map/report"
    mv "$out/map/report" "$out/3.6.txt"
    for f in "$out"/map/*; do
        case $f in
        *-importance.png) mv "$f" "$out/3.5.png" ;;
        *-regions.png) mv "$f" "$out/3.6.png" ;;
        *-levels.png) mv "$f" "$out/3.6-levels.png" ;;
        esac
    done
}

# Figures 4.1 and 4.2 for the point in that pixel: exponent 50, ks 1.
pixel() {
    sed -e 's/@integrator/Integrator "sir" "integer candidates" 800 "integer shadowrays" 15/' \
        -e 's/@material/"float Ks" 1 "float Kd" 0 "float exponent" 50/' "$out/hall.scene" > "$out/pixel.txt"
    "$build/bis" pixel "$out/pixel.txt" "$column" "$row" --repeats 200 --html --output "$out/pixel" > "$out/4.1.part"
    cp "$out/pixel/pixel.html" "$out/4.1.html" # both figures
    mv "$out/4.1.part" "$out/4.1.txt"
}

chapter5() {
    echo "== $1"
    "$build/figures" chapter5 "$seconds" "$out" "$1" "$out/$2.scene" > "$out/$1.part"
    mv "$out/$1.part" "$out/$1.txt"
    node scripts/figures/still.js "$out/$1.json"
    awk -f scripts/figures/figures.awk "$out/$1.txt"
}

plots=
[ $# -gt 0 ] || set -- $all
for figure; do
    case $figure in
    3.3 | 3.4 | 3.8 | 3.9 | 4.3 | 4.4 | 4.5) plots="$plots $figure" ;;
    3.5 | 3.6) [ -r "$out/3.6.txt" ] && [ "$out/3.6.txt" -nt "$out/hall.scene" ] || maps ;;
    4.1 | 4.2) [ -r "$out/4.1.txt" ] && [ "$out/4.1.txt" -nt "$out/hall.scene" ] || pixel ;;
    5.4) chapter5 5.4 other ;;
    5.6) chapter5 5.6 unzoomed ;;
    5.9) chapter5 5.9 whole ;;
    5.*) chapter5 "$figure" hall ;;
    price)
        "$build/figures" price "$seconds" "$out/hall.scene" > "$out/price.part"
        mv "$out/price.part" "$out/price.txt"
        awk -f scripts/figures/figures.awk "$out/price.txt"
        ;;
    esac
done
if [ -n "$plots" ]; then
    # shellcheck disable=SC2086 # names
    "$build/figures" still "$out" $plots
    for figure in $plots; do node scripts/figures/still.js "$out/$figure.json"; done
fi
echo "pictures and numbers: $out"
