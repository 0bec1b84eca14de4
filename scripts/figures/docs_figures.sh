#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# docs_figures: every picture that README and docs show, made again: docs/figures/*.svg and *.png.
#     scripts/figures/docs_figures.sh BUILD_DIR [PICTURE...]       chess, methods, live, microfacet, map, pixel,
#                                                          thesis, errata, results (default: all)
#     scripts/figures/docs_figures.sh --list                       the files
# From the root, after make bis data and, for thesis and results, make build/release/figures. What is timed differs from
# run to run, and so does its picture. Two kinds are kept and not made again: the plots of errata without a switch, and
# pbrt-materials.png, a measurement beside Mitsuba.
# Plots are SVG. Pictures of pixels are PNG, also those that stand in an SVG (methods, results) or on a page (pixel,
# live): a headless chromium draws these, because it leaves large pixels sharp. live needs `make web`. bis writes PNG of
# 24 bits; where ImageMagick's convert is there, 192 colours make less than half of that, and none above 300 KB. Those
# of README stay as they are, because their theme is noise; zopflipng, where it is there, makes them smaller.
set -eu
unset BIS_SHARED # our own model and maps
# of errata that have no switch
kept="E1 E2 E4 E5 E8 E9 E10 E11 E12 E14 E15 E17 E18 E19 E24 E25 E26 E28 E30 E31 E32 E33 E35 E36 E37"
if [ "${1:-}" = --list ]; then
    for name in chess methods microfacet pbrt-materials map-importance map-levels map-regions pixel-densities \
        pixel-samples results-5.2 results-5.5 results-5.8; do
        echo $name.png
    done
    echo live-sir.gif
    for name in 3.3 3.4 3.8 3.9 4.3 4.4; do echo thesis-$name.svg; done
    echo results-4.5.svg
    for item in E3 E6 E13 E20 E21 E22 E23 E27 E29 E34; do
        echo errata-$item-printed.png
        echo errata-$item-right.png
    done
    for item in $kept; do echo errata-$item.svg; done
    exit
fi
build=${1:?BUILD_DIR, as build/release}
shift
[ $# -gt 0 ] || set -- chess methods live microfacet map pixel thesis errata results
out=docs/figures
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

# copy FILE.svg NAME: into docs/figures
copy() {
    cp "$1" "$out/$2.svg"
    echo "$out/$2.svg"
}

# browse FILE WIDTH HEIGHT: as a browser shows it, into $tmp/drawn.png
browse() {
    "${CHROMIUM:-chromium}" --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$tmp/profile" \
        --screenshot="$tmp/drawn.png" --window-size="$2,$3" "file://$(realpath "$1")" 2>/dev/null
}

# size_of FILE.svg: its width and height
size_of() { sed -n '1s/.* width="\([0-9]*\)" height="\([0-9]*\)".*/\1 \2/p' "$1"; }

# keep FILE NAME [DITHER [COLOURS]]: into docs/figures as PNG; without dither where areas are flat
keep() {
    case $1 in
    *.svg)
        # shellcheck disable=SC2046 # two words
        browse "$1" $(size_of "$1")
        shift
        set -- "$tmp/drawn.png" "$@"
        ;;
    esac
    if command -v convert >/dev/null; then
        convert "$1" -strip -treedepth 8 -dither "${3:-None}" -colors "${4:-192}" "PNG8:$out/$2.png"
    else
        cp "$1" "$out/$2.png"
    fi
    echo "$out/$2.png"
}

# keep_true FILE NAME: a PNG into docs/figures with all of its colours
keep_true() {
    if command -v zopflipng >/dev/null; then zopflipng -y -m "$1" "$out/$2.png" >/dev/null
    else cp "$1" "$out/$2.png"; fi
    echo "$out/$2.png"
}

# draw_part PART NAME HEIGHT: a part of the page of a pixel, into docs/figures as PNG
draw_part() {
    node scripts/figures/page_part.js "$tmp/pixel/pixel.html" "$1" >"$tmp/part.html"
    browse "$tmp/part.html" 1240 "$3"
    keep "$tmp/drawn.png" "$2"
}

# shown METHOD WORDS: its picture and what stands below it, in JSON. All have one exposure.
shown() {
    "$build/bis" convert "$tmp/$1.exr" "$tmp/$1.png" --exposure 0 >/dev/null
    printf '{"name":"%s","words":"%s","png":"data:image/png;base64,%s"}' "$1" "$2" "$(base64 -w 0 "$tmp/$1.png")"
}

# error_of METHOD: its squared error relative to the picture, as `compare` prints it, in two digits
error_of() {
    "$build/bis" compare "$tmp/$1.exr" "$tmp/clean.exr" |
        awk '$1 == "relmse" { printf "%.12g", sprintf("%.2g", $2) + 0 }'
}

# panel: one scene by three methods at equal rays, and the reference, into $tmp/methods.svg
panel() {
    for method in "clean --spp 64" "em --spp 4 --integrator em --samples 4" \
        "brdf --spp 4 --integrator brdf --samples 4" \
        "sir --spp 4 --proposal mix --candidates 800 --learn off --shadowrays 4"; do
        # shellcheck disable=SC2086 # the options of a method
        "$build/bis" scene.txt --quiet --resolution 400x300 ${method#* } --outfile "$tmp/${method%% *}.exr"
    done
    {
        echo '{"pictures":['
        shown em "em, the map alone: relmse $(error_of em)" && echo ,
        shown brdf "brdf, the BRDF alone: relmse $(error_of brdf)" && echo ,
        shown sir "sir, the product: relmse $(error_of sir)" && echo ,
        shown clean "the reference, 96 times as many rays" && echo ']}'
    } >"$tmp/methods.json"
    node scripts/figures/still.js "$tmp/methods.json"
}

for picture; do
    case $picture in
    chess) # the command under the picture in README
        "$build/bis" scene.txt --quiet --spp 16 --candidates 256 --shadowrays 8 \
            --outfile "$tmp/chess.png"
        keep_true "$tmp/chess.png" chess
        ;;
    methods) # the commands of the tour in README; the reference has a number of samples in the place of a time
        panel >/dev/null
        # shellcheck disable=SC2046 # two words
        browse "$tmp/methods.svg" $(size_of "$tmp/methods.svg")
        keep_true "$tmp/drawn.png" methods
        ;;
    live)
        mkdir "$tmp/live"
        python3 scripts/figures/live_frames.py "$tmp/live" sir "M=1;N=1" "M=4;N=4" "M=16;N=8" \
            "M=64;N=8" "M=256;N=8" "M=1024;N=8" "M=1024;N=32"
        convert -delay 200 "$tmp"/live/*.png +dither -colors 40 -layers optimize "$out/live-sir.gif"
        echo "$out/live-sir.gif"
        ;;
    microfacet)
        "$build/bis" data/scenes/microfacet.txt --quiet --resolution 320x160 --outfile "$tmp/microfacet.png"
        keep "$tmp/microfacet.png" microfacet FloydSteinberg
        ;;
    map)
        "$build/bis" envmap data/maps/outdoor.hdr --out "$tmp/sky.png" >/dev/null
        "$build/bis" envmap data/maps/interior.hdr --out "$tmp/hall.png" >/dev/null
        keep "$tmp/sky-importance.png" map-importance
        keep "$tmp/hall-levels.png" map-levels
        keep "$tmp/hall-regions.png" map-regions
        ;;
    pixel)
        "$build/bis" pixel scene.txt 350 300 --proposal mix --candidates 400 --shadowrays 15 --html \
            --output "$tmp/pixel" >/dev/null
        draw_part maps pixel-densities 720
        draw_part samples pixel-samples 1130
        ;;
    thesis)
        for figure in 3.3 3.4 3.8 3.9 4.3 4.4; do
            sh scripts/figures/figures.sh "$build" $figure >/dev/null
            copy build/figures/$figure.svg thesis-$figure
        done
        ;;
    errata)
        sh scripts/figures/errata_figures.sh "$build/bis"
        ;;
    results)
        sh scripts/figures/figures.sh "$build" 4.5 5.2 5.5 5.8 >/dev/null
        copy build/figures/4.5.svg results-4.5
        for figure in 5.2 5.5 5.8; do keep build/figures/$figure-time.svg results-$figure; done
        ;;
    *)
        echo "docs_figures.sh: no picture \"$picture\" among chess, methods, live, microfacet, map," \
            "pixel, thesis, errata, results" >&2
        exit 2
        ;;
    esac
done
