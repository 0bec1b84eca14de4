#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# site: README and docs/ as a static site with MathML, and the files that they link to, readable in any browser
# without a network.
#     scripts/site/site.sh FOLDER            (`make docs`; from the root)
# pandoc turns the pages, scripts/site/site.lua their links; sources are wrapped as they stand. Where `make web` has
# made build/web, the figures that live stand where a page says <!-- live: NAME -->. Needs nothing at view
# time.
out=$1
if ! command -v pandoc >/dev/null; then
    echo "make docs: no pandoc here, and it is what typesets the pages: scripts/setup.sh --web, or" >&2
    echo "           https://pandoc.org; the .md files read well without" >&2
    exit 1
fi
rm -rf "$out"
mkdir -p "$out/docs" || exit 1
cp scripts/site/site.css "$out/site.css" || exit 1

live=""
if [ -f build/web/assets.js ]; then
    live=yes
    mkdir -p "$out/live/figures"
    cp build/web/*.js build/web/live.css "$out/live" && cp build/web/figures/*.js "$out/live/figures" || exit 1
fi

# scripts UP FILE.md: what a page with figures that live loads
scripts() {
    printf '<link rel="stylesheet" href="%slive/live.css">\n' "$1"
    for name in plot calls assets engine figure scenes $(sed -n 's|^<!-- live: \([a-z]*\) -->$|figures/\1|p' "$2"); do
        printf '<script src="%slive/%s.js"></script>\n' "$1" "$name"
    done
}

# page FILE.md: its html, README.md as index.html
page() {
    html=$out/$(echo "$1" | sed 's|README\.md$|index.html|; s|\.md$|.html|')
    up=$(dirname "$1" | sed 's|^\.$||; s|[^/][^/]*|..|g; s|$|/|; s|^/$||')
    mkdir -p "$(dirname "$html")"
    head=$out/head.html
    : >"$head"
    [ -z "$live" ] || ! grep -q '^<!-- live: ' "$1" || scripts "$up" "$1" >"$head"
    {
        printf '<nav><a href="%sindex.html">bis</a>' "$up"
        for name in guide theory errata trust; do printf ' · <a href="%sdocs/%s.html">%s</a>' "$up" $name $name; done
        printf ' · <a href="%sdocs/assignments/index.html">assignments</a></nav>\n\n' "$up"
        # without the head that docs/paper.md has for its journal
        awk 'NR == 1 && /^---$/ { head = 1; next } head && /^---$/ { head = 0; next } !head' "$1"
    } |
        if [ -n "$live" ]; then
            sed 's|^<!-- live: \([a-z]*\) -->$|<figure class="live" data-figure="\1"></figure>|'
        else
            cat
        fi |
        pandoc -f gfm+tex_math_dollars -t html5 --mathml -s --no-highlight --lua-filter=scripts/site/site.lua \
            -c "${up}site.css" -H "$head" -M title= -M pagetitle="bis: $(sed -n 's/^# //p' "$1" | head -1)" \
            -o "$html" || exit 1
}

# source FILE: its text, escaped
source() {
    mkdir -p "$out/$(dirname "$1")"
    code=UTF-8 # the page's; a test's scene is Latin-1
    iconv -f UTF-8 "$1" >/dev/null 2>&1 || code=ISO-8859-1
    {
        printf '<!DOCTYPE html>\n<html><head><meta charset="utf-8">'
        printf '<meta name="viewport" content="width=device-width"><title>%s</title>' "$1"
        printf '<style>pre { overflow-x: auto; }</style></head>\n<body><pre>'
        iconv -f $code -t UTF-8 "$1" | sed 's/&/\&amp;/g; s/</\&lt;/g'
        printf '</pre></body></html>\n'
    } >"$out/$1.html" || exit 1
}

for md in $(find README.md CONTRIBUTING.md CHANGELOG.md docs src tests -name '*.md' 2>/dev/null); do page "$md"; done
for picture in bis.png $(find docs -name '*.png' -o -name '*.svg' -o -name '*.gif'); do
    [ -f "$picture" ] && mkdir -p "$out/$(dirname "$picture")" && cp "$picture" "$out/$picture"
done
sources=$(find src include tests scripts docs data/scenes data/generate -name '*.[ch]' -o \
    -name '*.sh' -o -name '*.awk' -o -name '*.js' -o -name '*.txt' -o -name '*.py' -o -name '*.ipynb' -o \
    -path scripts/check/mutants -o -path 'docs/data/*.csv' |
    grep -v '^tests/data/bad/') # some are not UTF-8
for file in LICENSE CITATION.cff codemeta.json docs/paper.bib Makefile scene.txt $sources; do
    [ -f "$file" ] && source "$file"
done
# The page of a folder that a page names: what is in it.
printf '<!DOCTYPE html>\n<meta charset="utf-8"><title>docs/data</title>\n' >"$out/docs/data.html"
for csv in docs/data/*.csv; do
    printf '<p><a href="data/%s.html">%s</a>\n' "${csv##*/}" "${csv##*/}"
done >>"$out/docs/data.html" || exit 1
rm -f "$out/head.html"
echo "make docs: $out/index.html${live:+, with the figures that live}"
