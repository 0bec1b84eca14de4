#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# same_pictures: do two programs, say of two compilers, make the same bits of every shipped scene?
#     scripts/check/same_pictures.sh BIS OTHER_BIS
# From the root. Small renders of scene.txt and data/scenes, as they are and by each integrator over the grid; a scene
# whose bits differ is named with the figures of `bis compare`. Exit status 1 if there is one.
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
n=0
bad=0

# same SCENE OPTIONS...: one picture by both.
same() {
    n=$((n + 1))
    "$first" "$@" --resolution 64x48 --spp 4 --quiet --outfile "$folder/a.pfm" 2>"$folder/a" || {
        cat "$folder/a"
        exit 1
    }
    "$second" "$@" --resolution 64x48 --spp 4 --quiet --outfile "$folder/b.pfm" 2>"$folder/b" || {
        cat "$folder/b"
        exit 1
    }
    cmp -s "$folder/a.pfm" "$folder/b.pfm" && return
    bad=$((bad + 1))
    echo "$*: $("$first" compare "$folder/a.pfm" "$folder/b.pfm" | tr '\n' ' ')"
}

first=$1
second=$2
for scene in scene.txt data/scenes/*.txt data/scenes/pbrt/*.txt; do same "$scene"; done
for integrator in em brdf mis rejection sir unoccluded; do
    same scene.txt --integrator $integrator --accelerator grid
done
echo "same_pictures: $((n - bad)) of $n pictures have the same bits"
[ $bad -eq 0 ]
