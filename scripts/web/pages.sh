#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# pages: what stands beside bis.wasm in build/web: the scripts of docs/live, the library and the map as base64 in
# assets.js, and a page with all figures. A page that was opened from disk may load scripts, but neither workers nor
# other files: hence base64.
#     scripts/web/pages.sh BIS FOLDER            (`make web`)
# Figures stand in the order of scripts/web/order.
bis=$1
out=$2
mkdir -p "$out/figures" "$out/maps" || exit 1
cp docs/live/*.js docs/live/live.css "$out" && cp docs/live/figures/*.js "$out/figures" || exit 1
# The hall, and coloured lamps for E6; pictures are made under smaller ones still, which the page makes.
"$bis" envmap data/maps/interior.hdr --to latlong --width 128 --out "$out/maps/interior.hdr" >/dev/null || exit 1
"$bis" envmap data/maps/lamps.hdr --to latlong --width 64 --out "$out/maps/lamps.hdr" >/dev/null || exit 1
{
    printf 'var bisAssets = {\n'
    printf '"bis.wasm.gz": "%s",\n' "$(gzip -9nc "$out/bis.wasm" | base64 -w 0)"
    for map in interior lamps; do
        printf '"maps/%s.hdr.gz": "%s",\n' $map \
            "$(gzip -9nc "$out/maps/$map.hdr" | base64 -w 0)"
    done
    printf '};\n'
} >"$out/assets.js" || exit 1
scripts="" figures=""
for name in $(cat scripts/web/order); do
    [ -f "docs/live/figures/$name.js" ] || continue
    scripts="$scripts<script src=\"figures/$name.js\"></script>"
    figures="$figures<figure class=\"live\" data-figure=\"$name\"></figure>\\
"
done
sed "s|@SCRIPTS@|$scripts|; s|@FIGURES@|$figures|" docs/live/page.html >"$out/index.html" || exit 1
echo "make web: $out/index.html," \
    "$(cat "$out"/*.js "$out"/figures/*.js "$out/live.css" | gzip -9c | wc -c) bytes by gzip"
