#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# test_browser: do the pages of `bis trade`, `bis pixel` and `bis envmap` and the site of `make docs` work in a real
# browser? `make test-browser` calls it; no part of `make test`.
#     scripts/check/test_browser.sh BIS FOLDER
# Measures a small scene into FOLDER, opens report.html#selftest in a headless Chromium without network, and reads what
# the page's script says of itself (scripts/python/pages/trade.html): it draws, the slider's cut moves, the choice of a
# picture works, nothing was fetched. Then two screenshots, wide and narrow, must not be blank. And a twin: the page
# without its script must fail. Without a Chromium it says so and exits with 0.
bis=$1
folder=$2
browser=""
for name in ${CHROMIUM:-} chromium chromium-browser google-chrome; do
    command -v "$name" >/dev/null && browser=$name && break
done
if [ -z "$browser" ]; then
    echo "make test-browser: SKIPPED: no chromium, chromium-browser or google-chrome here;" \
        "scripts/setup.sh --web installs one, CHROMIUM=path names one"
    exit 0
fi
rm -rf "$folder"
mkdir -p "$folder"
"$bis" trade scene.txt --quiet --time 12 --passes 2 --seeds 2 --resolution 96x72 \
    --integrator em --integrator mis --integrator sir --output "$folder/trade" ||
    exit 1
profile=$(mktemp -d) || exit 1
trap 'rm -rf "$profile"' EXIT

# browse OPTIONS... URL: every request that is not for the file itself goes nowhere.
browse() {
    "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$profile" --no-first-run \
        --disable-background-networking \
        --host-resolver-rules="MAP * ~NOTFOUND" --virtual-time-budget=3000 "$@" 2>/dev/null
}

fail() {
    echo "make test-browser: FAILED: $1"
    exit 1
}

page=$(cd "$folder/trade" && pwd)/report.html
expected='data-selftest="cut-moves picture-changes drawn visible fetched-0"'
browse --dump-dom "file://$page#selftest" > "$folder/dom.html"
grep -q "$expected" "$folder/dom.html" || fail "the page says $(grep -o 'data-selftest="[^"]*"' "$folder/dom.html")"
grep -q 'data-selftest="' "$page" && fail "the page claims to have tested itself before it was opened"

sed '/^<script>/,/^<\/script>/d' "$page" > "$folder/twin.html"
browse --dump-dom "file://$(cd "$folder" && pwd)/twin.html#selftest" > "$folder/twin_dom.html"
grep -q 'data-selftest' "$folder/twin_dom.html" && fail "a page without its script passes, too"

"$bis" pixel scene.txt 350 300 --repeats 50 --html --output "$folder/pixel" >/dev/null || exit 1
"$bis" envmap data/maps/interior.hdr --html "$folder/map.html" >/dev/null || exit 1
check_page() { # PAGE EXPECTED
    browse --dump-dom "file://$1#selftest" > "$folder/dom.html"
    grep -q "data-selftest=\"$2\"" "$folder/dom.html" ||
        fail "$1 says $(grep -o 'data-selftest="[^"]*"' "$folder/dom.html")"
}
pixel=$(cd "$folder/pixel" && pwd)/pixel.html
map=$(cd "$folder" && pwd)/map.html
check_page "$pixel" "direction-told method-changes line-marked dot-told fetched-0"
check_page "$map" "region-told level-alone all-again fetched-0"

for width in 1200 390; do
    for shown in "$page" "$pixel" "$map"; do
        browse --window-size=$width,2400 --screenshot="$folder/page_$width.png" "file://$shown"
        [ "$(wc -c < "$folder/page_$width.png")" -gt 30000 ] || fail "at $width pixels $shown is blank"
    done
done
echo "make test-browser: passed ($browser); see $folder/page_1200.png and $folder/page_390.png"

if command -v pandoc >/dev/null; then
    sh scripts/site/site.sh "$folder/site" >/dev/null &&
        sh scripts/check/check_site.sh "$browser" "$folder/site" ||
        exit 1
else
    echo "make test-browser: the site SKIPPED: no pandoc here; scripts/setup.sh --web installs it"
fi
