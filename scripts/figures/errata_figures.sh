#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# errata_figures: the pairs of pictures of docs/errata.md, as printed and right, with one exposure for both:
# docs/figures/errata-E3-printed.png, -right.png, ...
#     scripts/figures/errata_figures.sh BIS [E3...]        (default: all; from the root, some minutes)
# 160 x 120 or 160 x 88 pixels of 8 bits are at most 60 KB, however noisy. What is to be seen in E13, E22 and E27 is
# small or faint, so these are twice as wide and have four times as many samples: at most 120 KB.
bis=$1
shift
[ $# -gt 0 ] || set -- E3 E6 E13 E20 E21 E22 E23 E27 E29 E34
for item; do
    scene=data/scenes/errata/$item.txt
    size=160x120 spp=16
    case $item in
    E3 | E23 | E34) size=160x88 ;; # the scene's own shape
    E13 | E27) size=320x240 spp=64 ;;
    E22) size=320x176 spp=64 ;;
    E21) spp=128 ;;                # noise, much of it: what differs is the mean
    esac
    picture=docs/figures/errata-$item
    set_up="--quiet --exposure 0 --resolution $size --spp $spp"
    "$bis" "$scene" $set_up --outfile "$picture-right.png" || exit 1
    "$bis" --as-printed "$item" "$scene" $set_up --outfile "$picture-printed.png" || exit 1
done
