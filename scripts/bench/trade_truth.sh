#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# trade_truth: the figures of docs/command-line.md: does the error that `bis trade` promises come out? Each of its three
# advices for each of ten scenes is rendered as a whole picture, with eight seeds; the median of their errors
# (trade_truth.c), relative to a render of twice the final passes, 100 at least, is what comes out. (By a render of 16,
# it came out a third too large on steel-on-paper.) Two seeds would not do: a candle that one camera ray of 180 meets
# past a sphere of glossy-row makes the error of one picture of 45 three times as large. The root mean square, the least
# and the largest tell of it. The last column is the median of the errors that the renders themselves print, and how
# many of them print one. The advice is measured by passes (--passes), so the table hardly depends on how busy the
# machine is: the clock has a say in which setting is advised alone. RESOLUTION, TIME (of the pilot), ERROR (of the
# final picture), SEEDS (how many pictures) and SEED (of the measurement) may be set.
#     make bis build/release/trade_truth data && scripts/bench/trade_truth.sh [build/release [SCENE...]]
B=${1:-build/release}
test $# -gt 0 && shift
dir=$B/trade
size=${RESOLUTION:-140x105}
seconds=${TIME:-20}
runs=$(seq 1 ${SEEDS:-8})
final=${ERROR:-0.12}
test $# -gt 0 || set -- scene.txt data/scenes/overcast-diffuse.txt data/scenes/coloured-shadows.txt \
    data/scenes/louvres.txt data/scenes/orthographic.txt data/scenes/outdoor-sun.txt data/scenes/glossy-row.txt \
    data/scenes/steel-on-paper.txt data/scenes/microfacet.txt data/scenes/pinpoint.txt
mkdir -p "$dir" || exit 1

# scene FILE [INTEGRATOR-LINE [B]]: a copy in $dir, whose name it prints, with absolute paths, perhaps with another
# integrator and area exponent.
scene() {
    copy=$dir/$(basename "$1" .txt)${2:+-advised}.txt
    sed -e "s|\"\.\./|\"$PWD/data/|; s|\"data/|\"$PWD/data/|; s|^Include \"|&$PWD/data/scenes/|" "$1" >"$copy"
    if test -n "$2"; then
        grep -v '^ *Integrator' "$copy" | { echo "$2" && cat; } >"$copy.new" && mv "$copy.new" "$copy"
    fi
    if test -n "$3"; then
        sed -i -e 's/"float areaexponent" *\[* *[0-9.]* *\]*//' \
            -e "s/^\( *LightSource .*\)/\1 \"float areaexponent\" $3/" "$copy"
    fi
    echo "$copy"
}

# percent TEXT: "46%" as 0.46
percent() { echo "$1" | awk '{ sub(/%.*/, ""); print $1 / 100 }'; }

# render "1 2" NAME SCENE OPTIONS...: a picture for each seed, $dir/NAME-1.exr and -2.exr
render() {
    seeds=$1 name=$2 scene=$3
    shift 3
    for k in $seeds; do
        "$B"/bis --quiet --nthreads 1 --resolution $size --seed 77000$k --outfile "$dir/$name-$k.exr" \
            --stats "$dir/$name-$k.json" "$@" "$scene" || exit 1
    done
}

# printed NAME: the median of the figures that the renders of these seeds print, and how many print one
printed() {
    for k in $runs; do
        sed -n 's/.*"estimated_relative_rmse": *\([0-9][0-9.e+-]*\).*/\1/p' "$dir/$1-$k.json"
    done | sort -g | awk '
        { figure[NR] = $1 }
        END {
            if (NR) printf "%.1f %% (%d)", 50 * (figure[int((NR + 1) / 2)] + figure[int(NR / 2) + 1]), NR
            else printf "unknown"
        }'
}

echo "| scene | advice | setting | passes | promised | came out | off by | root mean square, least, largest | printed |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
for original in "$@"; do
    base=$(basename "$original" .txt)
    file=$(scene "$original")
    rm -rf "${dir:?}/$base-trade"
    "$B"/bis trade --quiet --quick --integrator sir --passes 8 --seeds 2 --nthreads 1 \
        --resolution $size --time $seconds --error $final --seed ${SEED:-1} \
        --output "$dir/$base-trade" "$file" >"$dir/$base.said" || exit 1
    for advice in final good preview; do
        line=$(grep "^$advice" "$dir/$base.said") || continue
        promised=$(percent "$(echo "$line" | sed 's/.*error \([0-9.]*%\).*/\1/')")
        passes=${line##*--spp }
        case $line in
        *Integrator*)
            text=Integrator${line#*Integrator}
            text=${text% --spp*}
            b=$(echo "$text" | sed -n 's/.*areaexponent" //p')
            setting=${text%%;*}
            advised=$(scene "$original" "$setting" "$b")
            options=
            ;;
        *)
            setting=--integrator${line#*--integrator}
            setting=${setting% --spp*}
            advised=$file
            options=$setting
            ;;
        esac
        render "$runs" $base-$advice "$advised" $options --spp $passes
        if test $advice = final; then
            long=$((passes > 50 ? 2 * passes : 100))
            render 9 $base-long "$advised" $options --spp $long
        fi
        truth=$("$B"/trade_truth $long "$dir/$base-long-9.exr" $passes \
            $(for k in $runs; do echo "$dir/$base-$advice-$k.exr"; done)) || exit 1
        echo "$base|$advice|$setting|$passes|$promised|$truth|$(printed $base-$advice)" |
            awk -F'|' '{
                split($6, e, " ")
                printf "| %s | %s | `%s` | %d | %.1f %% | %.1f %% | %+.0f %% | %.1f, %.1f, %.1f %% | %s |\n", $1, $2,
                    $3, $4, 100 * $5, 100 * e[1], 100 * ($5 / e[1] - 1), 100 * e[2], 100 * e[3], 100 * e[4], $7
            }'
    done
done
