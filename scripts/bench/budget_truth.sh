#!/bin/sh
# budget_truth: the tables of docs/budgets.md: does `--error E` keep its word? Small pictures, 40 runs a row, plain and
# adaptive, then harder scenes: small lamps, narrow lobes. The truth is the mean of two renders by sir with the
# proposal "product", which one row alone uses. Pictures and scenes go to BUILD/budgets; references that are there
# are taken again. Six minutes of one processor.
#     make bis build/release/budget_truth data && scripts/bench/budget_truth.sh [build/release [easy|hard]]
B=${1:-build/release}
which=${2:-easy hard}
dir=$B/budgets
mkdir -p "$dir" || exit 1

# scene FILE [INTEGRATOR-LINE]: a copy in $dir, whose name it prints, with absolute paths and perhaps another integrator.
scene() {
    copy=$dir/$(basename "$1" .txt)$(echo "$2" | tr -dc 'a-z0-9').txt
    sed -e "s|\"\.\./|\"$PWD/data/|; s|\"data/|\"$PWD/data/|; s|^Include \"|&$PWD/data/scenes/|" ${2:+-e "/^Integrator/d" -e "1iIntegrator $2"} "$1" >"$copy"
    echo "$copy"
}

# truth NAME SPP WxH SCENE: two references, $dir/NAME-1.pfm and -2.
truth() {
    for k in 1 2; do
        test -f "$dir/$1-$k.pfm" ||
            "$B"/bis --quiet --nthreads 1 --resolution $3 --integrator sir --proposal product --candidates 64 --shadowrays 16 --spp $2 \
                --seed 100000$k --outfile "$dir/$1-$k.pfm" "$4" &
    done
    wait
}

# row NAME TRUTH E SCENE [--adaptive]
row() { "$B"/budget_truth $5 "$1" 40 $3 "$dir/$2-1.pfm" "$dir/$2-2.pfm" "$4" || exit 1; }

columns() {
    echo "| scene | E | runs | camera samples | true error / E | at most E | below E/2 | bias / E | bias of a pixel / E, at most | noise of the reference / E |"
    echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
}

easy() {
    columns
    for name in overcast-diffuse coloured-shadows louvres trianglemesh orthographic outdoor-sun; do
        case $name in orthographic|outdoor-sun) spp=2000 ;; *) spp=1000 ;; esac
        truth $name $spp 32x24 data/scenes/$name.txt
        file=$(scene data/scenes/$name.txt)
        row $name $name 0.08 "$file"
        row "$name, adaptive" $name 0.05 "$file" --adaptive
    done
}

# A ball of exponent 100 on a floor, under candles and windows.
glossy_ball() {
    cat <<END
Film "rgb" "integer xresolution" 32 "integer yresolution" 24 "string filename" "ball.exr"
Sampler "stratified" "integer pixelsamples" 4
Integrator "sir" "integer candidates" 24 "integer shadowrays" 3
LookAt 0 -6 2  0 0 0.9  0 0 1
Camera "perspective" "float fov" 30
WorldBegin
LightSource "infinite" "string filename" "../maps/interior.hdr"
Material "phong" "rgb Kd" [0.5 0.4 0.3] "float Ks" 0.2 "float exponent" 20
Shape "disk" "float radius" 20
Material "phong" "rgb Kd" [0.1 0.4 0.3] "float Ks" 0.5 "float exponent" 100
Translate 0 0 1
Shape "sphere" "float radius" 1
END
}

# candles INTEGRATOR-LINE: scene.txt with as many camera samples on outlines as elsewhere.
candles() {
    file=$(scene scene.txt "$1")
    sed -i 's/^Sampler.*/Sampler "stratified"/' "$file"
    echo "$file"
}

hard() {
    glossy_ball >"$dir/glossy-ball.in"
    columns
    truth pinpoint 2000 32x24 data/scenes/pinpoint.txt
    for E in 0.15 0.05; do row "pinpoint, sir 100/8" pinpoint $E "$(scene data/scenes/pinpoint.txt)"; done

    truth scene 5000 32x24 scene.txt
    few='"sir" "integer candidates" 64 "integer shadowrays" 4'
    for E in 0.3 0.15; do row "scene.txt, sir 64/4" scene $E "$(candles "$few")"; done
    row "scene.txt, sir 64/4, adaptive" scene 0.15 "$(candles "$few")" --adaptive
    row "scene.txt, sir product 64/16" scene 0.08 "$(candles '"sir" "string proposal" "product" "integer candidates" 64 "integer shadowrays" 16')"

    truth glossy-row 4000 48x16 data/scenes/glossy-row.txt
    for E in 0.3 0.15; do row "glossy-row, sir 256/8" glossy-row $E "$(scene data/scenes/glossy-row.txt)"; done

    ball=$(scene "$dir/glossy-ball.in")
    truth glossy-ball 2000 32x24 "$ball"
    row "glossy ball, sir 24/3" glossy-ball 0.1 "$ball"
    row "glossy ball, em 4" glossy-ball 0.1 "$(scene "$ball" '"em" "integer samples" 4')"
    row "glossy ball, mis 4" glossy-ball 0.1 "$(scene "$ball" '"mis" "integer samples" 4')"
}

for part in $which; do $part; done
