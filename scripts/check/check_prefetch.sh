#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_prefetch: the compiler has kept the prefetches of bis_geometry_prefetch, which no picture and no other test
# shows.
#     scripts/check/check_prefetch.sh BUILD          BUILD/src holds the objects
# Prints the object without them and exits with 1. Other processors than x86-64 and aarch64 are not looked at.
case $(uname -m) in
x86_64) word=prefetch ;;
aarch64) word=prfm ;;
*) exit 0 ;;
esac
for object in "$1/src/render/wave.o" "$1/src/render/edges.o"; do
    objdump -d "$object" | grep -q "[[:space:]]$word" && continue
    echo "check_prefetch: $object has no prefetch: what a wave hits is then waited for, which takes 7 % of a render"
    exit 1
done
