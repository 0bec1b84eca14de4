#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# elsewhere: reads scenes that other people published, says how many bis accepts, and judges that by a list.
#     scripts/check/elsewhere.sh BIS FOLDER [LIST]        LIST: tests/data/elsewhere.tsv; "-": write one, of all scenes
# FOLDER holds the collections as FOLDER/OWNER/NAME, each a clone of github.com/OWNER/NAME. They are not ours to ship.
# A line of LIST: OWNER/NAME/PATH, the first 16 digits of the file's SHA-256, and what is expected:
#     plain | approximate | refused   accepted as it is; with --approximate; not even then
#     own | sky                       its own light from infinity; the white sky that --approximate lends
#     N/M                             shapes kept of the shapes that it has, with instances
#     K                               files that it names and that its collection, as it was read, does not hold
# A scene that is not there, or whose hash is another, is not judged. A scene without the same K loses or gains shapes:
# then only whether it is accepted is judged. A scene is inside the model (plain) if its errors name missing files
# alone. Scenes that lack no file are rendered, small: a black picture must be announced by a warning. The last lines
# are the score. Exit status 1: a scene is not what the list expects, or fewer than 95 % of those without missing files
# are accepted, or a picture is black and nothing says so. Exit status 3: no scene of the list is there.
bis=$1 folder=$2 list=${3:-tests/data/elsewhere.tsv}
[ -x "$bis" ] && [ -d "$folder" ] || { echo "usage: elsewhere.sh BIS FOLDER [LIST]"; exit 2; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
tab=$(printf '\t')

# read_scene FILE: sets accepted, light, kept, missing, picture.
read_scene() {
    "$bis" --plan "$1" >"$work/plan" 2>"$work/said" </dev/null
    inside=$(grep 'error: ' "$work/said" | grep -cvE 'error: cannot (read|open) ')
    if "$bis" --approximate --plan "$1" >"$work/plan" 2>"$work/said" </dev/null; then
        accepted=approximate
        [ "$inside" -gt 0 ] || accepted=plain
        missing=$(grep -c '^missing ' "$work/plan")
        light=own
        grep -q '^approximated no light from infinity' "$work/plan" && light=sky
        kept=$(awk '$1 == "geometry" { n = $2 }
                       / Shape .*: left out/ { lost += $2 }
                       END { print n + 0 "/" n + lost }' \
                "$work/plan")
    else
        accepted=refused light=- kept=- missing=0
    fi
    picture=-
    if [ $accepted != refused ] && [ "$missing" = 0 ]; then
        if "$bis" --approximate --resolution 32x24 --spp 1 --nthreads 1 --outfile "$work/a.pfm" \
            "$1" >/dev/null 2>"$work/said" </dev/null; then
            picture=lit
            # a PFM's three lines, then numbers: 0 is zero bytes alone
            if [ "$(tail -n +4 "$work/a.pfm" | tr -d '\000' | wc -c)" -eq 0 ]; then
                picture=black
                grep -q 'the picture is black' "$work/said" && picture=told
            fi
        else
            accepted=refused
        fi
    fi
}

hash_of() { sha256sum "$1" | cut -c 1-16; }

if [ "$list" = - ]; then
    (cd "$folder" && find . -name '*.pbrt' | sed 's,^\./,,' | LC_ALL=C sort) | while read -r name; do
        grep -qE '^[[:space:]]*WorldBegin' "$folder/$name" || continue
        read_scene "$folder/$name"
        printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$name" "$(hash_of "$folder/$name")" $accepted $light "$kept" "$missing"
    done
    exit 0
fi

: >"$work/judged"
while IFS="$tab" read -r name hash want want_light want_kept want_missing; do
    [ -f "$folder/$name" ] && [ "$(hash_of "$folder/$name")" = "$hash" ] || { echo absent >>"$work/judged"; continue; }
    read_scene "$folder/$name"
    verdict=same
    [ "$accepted" = "$want" ] || verdict=other
    if [ "$missing" = "$want_missing" ] && [ "$light $kept" != "$want_light $want_kept" ]; then verdict=other; fi
    [ $picture != black ] || verdict=black
    [ $verdict = same ] ||
        echo "$name: $verdict: $accepted $light $kept $missing, expected $want $want_light $want_kept $want_missing"
    whole=part
    [ "$missing" = 0 ] && whole=whole
    echo "$verdict $accepted $whole $picture" >>"$work/judged"
done <"$list"
awk '
$1 == "absent" { absent++; next }
{ read_++; on[$2]++; is[$1]++; seen[$4]++ }
$3 == "whole" { whole++; if ($2 != "refused") passed++ }
END {
    if (!read_) { print "elsewhere: no scene of the list is there"; exit 3 }
    printf "elsewhere: %d scenes read, %d not there: %d pass as they are, %d with --approximate, %d do not\n",
        read_, absent, on["plain"], on["approximate"], on["refused"]
    printf "elsewhere: %d lack no file, of which %d pass (%.1f %%); pictures: %d lit, " \
        "%d black and said to be, %d black by surprise\n",
        whole, passed, whole ? 100 * passed / whole : 100,
        seen["lit"], seen["told"], seen["black"]
    printf "elsewhere: %d are other than the list expects\n", is["other"]
    exit is["other"] || is["black"] || passed < 0.95 * whole
}' "$work/judged"
