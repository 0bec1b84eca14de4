#!/bin/sh
# trade_truth: the table of docs/command-line.md: does the error that `bis trade` promises come out? Each of its three
# advices for each of ten scenes is rendered as a whole picture, with two seeds; their scatter is the error
# (trade_truth.c), relative to a render of four times the final passes, 100 at least: of 16, what is
# divided by its square came out a third too large (steel-on-paper); by themselves, pixels that came out bright would
# hide their own scatter (9.6% for 10.6% on coloured-shadows). The advice is measured by passes (--passes), so the table
# hardly depends on how busy the machine is: the clock has a say in which setting is advised alone. RESOLUTION, TIME (of
# the pilot) and ERROR (of the final picture) may be set.
#     make bis build/release/trade_truth data && scripts/bench/trade_truth.sh [build/release [SCENE...]]
B=${1:-build/release}
test $# -gt 0 && shift
dir=$B/trade
size=${RESOLUTION:-140x105}
seconds=${TIME:-20}
final=${ERROR:-0.12}
test $# -gt 0 || set -- scene.txt data/scenes/overcast-diffuse.txt data/scenes/coloured-shadows.txt data/scenes/louvres.txt data/scenes/orthographic.txt \
    data/scenes/outdoor-sun.txt data/scenes/glossy-row.txt data/scenes/steel-on-paper.txt data/scenes/microfacet.txt data/scenes/pinpoint.txt
mkdir -p "$dir" || exit 1

# scene FILE [INTEGRATOR-LINE [B]]: a copy in $dir, whose name it prints, with absolute paths, perhaps with another integrator
# and area exponent.
scene() {
    copy=$dir/$(basename "$1" .txt)${2:+-advised}.txt
    sed -e "s|\"\.\./|\"$PWD/data/|; s|\"data/|\"$PWD/data/|; s|^Include \"|&$PWD/data/scenes/|" "$1" >"$copy"
    if test -n "$2"; then
        grep -v '^ *Integrator' "$copy" | { echo "$2" && cat; } >"$copy.new" && mv "$copy.new" "$copy"
    fi
    if test -n "$3"; then
        sed -i -e 's/"float areaexponent" *\[* *[0-9.]* *\]*//' -e "s/^\( *LightSource .*\)/\1 \"float areaexponent\" $3/" "$copy"
    fi
    echo "$copy"
}

# percent TEXT: "46%" as 0.46
percent() { echo "$1" | awk '{ sub(/%.*/, ""); print $1 / 100 }'; }

# render "1 2" NAME SCENE OPTIONS...: two pictures, $dir/NAME-1.exr and -2.exr
render() {
    seeds=$1 name=$2 scene=$3
    shift 3
    for k in $seeds; do "$B"/bis --quiet --nthreads 1 --resolution $size --seed 77000$k --outfile "$dir/$name-$k.exr" "$@" "$scene" || exit 1; done
}

echo "| scene | advice | setting | passes | promised | came out | off by |"
echo "| --- | --- | --- | --- | --- | --- | --- |"
for original in "$@"; do
    base=$(basename "$original" .txt)
    file=$(scene "$original")
    rm -rf "${dir:?}/$base-trade"
    "$B"/bis trade --quiet --quick --integrator sir --passes 8 --seeds 2 --nthreads 1 --resolution $size --time $seconds --error $final --output "$dir/$base-trade" "$file" >"$dir/$base.said" || exit 1
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
        render "1 2" $base-$advice "$advised" $options --spp $passes
        if test $advice = final; then
            render 9 $base-long "$advised" $options --spp $((passes > 25 ? 4 * passes : 100))
        fi
        one=$dir/$base-$advice-1.exr two=$dir/$base-$advice-2.exr
        truth=$("$B"/trade_truth 1 "$dir/$base-long-9.exr" "$one" "$two") || exit 1
        echo "$base|$advice|$setting|$passes|$promised|${truth% *}" |
            awk -F'|' '{ printf "| %s | %s | `%s` | %d | %.1f %% | %.1f %% | %+.0f %% |\n", $1, $2, $3, $4, 100 * $5, 100 * $6, 100 * ($5 / $6 - 1) }'
    done
done
