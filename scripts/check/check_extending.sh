#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_extending: does docs/extending.md say all that a new integrator needs? The page's example is taken from the
# page: the file that follows "<!-- tests/whole/uniform.c -->", and the changes in its ```diff blocks. They go into a
# copy of the sources; only what changed is compiled, and linked before the present library; then the program has one
# integrator more.
#     scripts/check/check_extending.sh [TEST...]          TEST: programs of tests/ to be linked and run with it, too.
# First a BRDF, by the page's section: its dust, and Phong's files once more under the name "again", each by the page's
# line in parser_world.c. With textures for all that it has, "again" must render the bits of Material "phong".
# EXTENDING_EDIT: a sed script for that copy (a twin). EXTENDING_PAGE: another page. TEST "all": all as make test runs
# them, but this one and those of the course, the pages and what is installed.
# From the root. make gives, in BIS_BUILD, BIS_COMPILE, BIS_LINK, BIS_OBJECTS, BIS_LIBS, how to compile and link
# (scripts/course/course.mk). The copy is $BIS_BUILD/extending. Exit status 1, and a line that says why, where anything
# fails.
root=$BIS_BUILD/extending
say() {
    echo "extending: $*"
    exit 1
}

# library OBJECT...: what a program of these objects measures with (bis pixel, bis trade). The objects come before ours.
version=$(sed -n 's/^.define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
library() {
    # shellcheck disable=SC2086
    mkdir -p "$root/library" && $BIS_LINK -shared -Wl,--allow-multiple-definition \
        -o "$root/library/libbis.so.$version" "$@" \
        -Wl,--whole-archive "$BIS_BUILD/libbis.a" -Wl,--no-whole-archive $BIS_LIBS ||
        say "the library does not link"
}

rm -rf "$root" && mkdir -p "$root" && cp -R src include docs scripts "$root" || exit 1
awk -v root="$root" '
    /^<!-- tests\/whole\/uniform\.c/ { file = root "/src/beyond/uniform.c"; next }
    /^```diff$/ { file = root "/page.diff"; inside = 1; next }
    /^```c$/ && file { inside = 1; next }
    /^```$/ { if (inside) file = ""; inside = 0; next }
    inside && file { print >file }' "${EXTENDING_PAGE:-docs/extending.md}"
test -s "$root/src/beyond/uniform.c" && test -s "$root/page.diff" || say "the page has no example"

# ---- the BRDF ----
for part in .c _many.c _formulas.h; do
    sed -e 's/bis_phong/bis_again/g; s/phong_reach_lanes/again_reach_lanes/g' \
        -e 's/define MODEL phong/define MODEL again/; s/"phong"/"again"/; s|bis/thesis/phong.h|bis/beyond/again.h|' \
        -e 's|thesis/phong_formulas.h|beyond/again_formulas.h|' \
        -e "${EXTENDING_EDIT:-}" "src/thesis/phong$part" >"$root/src/beyond/again$part"
done
sed 's/bis_phong/bis_again/g' include/bis/thesis/phong.h >"$root/include/bis/beyond/again.h"
cp tests/support/beyond/moon*.[ch] "$root/src/beyond"
row=$(grep -o '{"moon", [^}]*}' "${EXTENDING_PAGE:-docs/extending.md}" | sed 's/&/\\&/g')
test -n "$row" || say "the page has no line for materials[]"
{
    echo '#include "bis/beyond/again.h"'
    grep -o '`extern const bis_bsdf_model [^`]*`' "${EXTENDING_PAGE:-docs/extending.md}" | tr -d '`'
    sed "s/^} materials\[\] = {/&\n    $row,\n    $(echo "$row" | sed 's/moon/again/g'),/" src/parse/parser_world.c
} >"$root/src/parse/world_again.c"
grep -q '"again"' "$root/src/parse/world_again.c" || say "parser_world.c has no place for a material"
for file in src/beyond/again src/beyond/again_many src/beyond/moon src/beyond/moon_many src/parse/world_again; do
    (cd "$root" && $BIS_COMPILE -Werror -c -o "$(basename $file).o" "$file.c") ||
        say "$file does not compile without warnings"
done
# shellcheck disable=SC2086
$BIS_LINK -o "$root/bis-again" "$BIS_BUILD/src/cli/main.o" "$root/again.o" "$root/again_many.o" "$root/moon.o" \
    "$root/moon_many.o" "$root/world_again.o" "$BIS_BUILD/libbis.a" $BIS_LIBS ||
    say "the program with a BRDF more does not link"
library "$root/again.o" "$root/again_many.o" "$root/moon.o" "$root/moon_many.o" "$root/world_again.o"
# What scenes may say of dust, and what they may not.
dust() {
    cat <<END
Film "rgb" "integer xresolution" 24 "integer yresolution" 12
WorldBegin
LightSource "infinite" "rgb L" [1 2 3]
Texture "c" "spectrum" "checkerboard" "rgb tex1" [.1 .2 .3] "rgb tex2" [.4 .3 .2]
Material "moon" "texture Kd" "c" $1
Translate 0 0 4 Shape "sphere"
END
}
dust | "$root/bis-again" --spp 4 --outfile "$root/moon.pfm" - 2>"$root/moon.txt" ||
    say "a texture of dust: $(tail -1 "$root/moon.txt")"
! dust '"float Ks" 0.1' | "$root/bis-again" --plan - >"$root/moon.txt" 2>&1 &&
    grep -q 'unknown parameter "Ks" of Material "moon"' "$root/moon.txt" ||
    say "dust has no lobe, and its Ks is not refused"
for model in phong again; do
    cat >"$root/$model-textured.txt" <<END
Film "rgb" "integer xresolution" 24 "integer yresolution" 12 "float cropwindow" [.5 1 0 1]
Camera "perspective" "float fov" 60
Integrator "mis" "integer samples" 8
WorldBegin
LightSource "infinite" "rgb L" [1 2 3]
Texture "c" "spectrum" "checkerboard" "rgb tex1" [.1 .2 .3] "rgb tex2" [.4 .3 .2] "float uscale" 8 "float vscale" 8
Texture "n" "float" "checkerboard" "float tex1" 3 "float tex2" 80 "float uscale" 16 "float vscale" 4
Material "$model" "texture Kd" "c" "rgb Ks" [.5 .2 .2] "float exponent" 5
AttributeBegin Translate 0.6 0 4 Shape "sphere" AttributeEnd
Material "$model" "texture Ks" "c" "texture exponent" "n"
AttributeBegin Translate 2 0 5 Shape "sphere" AttributeEnd
END
    "$root/bis-again" --quiet --spp 4 --outfile "$root/$model.pfm" "$root/$model-textured.txt" 2>"$root/$model.txt" ||
        say "render: $(tail -1 "$root/$model.txt")"
    "$root/bis-again" pixel --repeats 50 --output "$root/pixel-$model" "$root/$model-textured.txt" 13 6 2>&1 |
        grep "^exact" >"$root/$model-exact.txt" ||
        say "pixel of a textured $model has no exact row"
done
cmp "$root/phong.pfm" "$root/again.pfm" ||
    say "the BRDF loses something under a texture: its picture is not that of its twin phong"
cmp "$root/phong-exact.txt" "$root/again-exact.txt" ||
    say "bis pixel: the exact row of the BRDF under a texture is not that of phong"

# ---- the integrator ----
patch -s -p1 -d "$root" <"$root/page.diff" >"$root/patch.txt" 2>&1 ||
    say "the changes on the page do not fit the sources: $(head -3 "$root/patch.txt")"
sh scripts/check/check_layers.sh "$root" || say "it is no layer of ours"

objects=""
for file in src/beyond/uniform.c $(sed -n 's|^+++ b/\(src/.*\.c\)$|\1|p' "$root/page.diff"); do
    object=$(echo "$file" | tr / _).o
    (cd "$root" && $BIS_COMPILE -Werror -c -o "$object" "$file") || say "$file does not compile without warnings"
    objects="$objects $root/$object"
done
# shellcheck disable=SC2086
$BIS_LINK -o "$root/bis" "$BIS_BUILD/src/cli/main.o" $objects "$BIS_BUILD/libbis.a" $BIS_LIBS ||
    say "the program does not link"
# shellcheck disable=SC2086
library $objects

# has NAME TEXT COMMAND...: the command ends well and prints that text.
has() {
    name=$1 text=$2
    shift 2
    "$@" >"$root/$name.txt" 2>&1 || say "$name: $(tail -1 "$root/$name.txt")"
    grep -q -e "$text" "$root/$name.txt" || say "$name has no \"$text\""
}
cat >"$root/of-the-page.txt" <<END
Film "rgb" "integer xresolution" 16 "integer yresolution" 12
Camera "perspective" "float fov" 60
Integrator "uniform" "integer samples" 8
WorldBegin
LightSource "infinite" "rgb L" [1 2 3]
Material "phong" "rgb Kd" [.5 .4 .3] "rgb Ks" [.2 .2 .2] "float exponent" 5
AttributeBegin Translate 0 0 4 Shape "sphere" AttributeEnd
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9]
END
has help "uniform  *directions uniform" "$root/bis" help integrators
has plan "uniform: samples 8" "$root/bis" --plan "$root/of-the-page.txt"
has render "\"integrator\": \"uniform\"" "$root/bis" --quiet --spp 1 --stats - --outfile "$root/out.exr" \
    "$root/of-the-page.txt"
has pixel "^uniform  *8 " "$root/bis" pixel --repeats 50 --output "$root/pixel" "$root/of-the-page.txt" 8 9
has trade "--integrator uniform --samples " "$root/bis" trade --quiet --time 2 --passes 1 --seeds 2 \
    --integrator uniform --output "$root/trade" --resolution 16x12 "$root/of-the-page.txt"
has verify "uniform .*passed" "$root/bis" verify "$root/of-the-page.txt"

if test "$*" = all; then
    # shellcheck disable=SC2046
    set -- $(find tests -name "test_*.c" -exec basename {} .c \; |
        grep -vx "test_extending\|test_assignments\|test_docs\|test_library")
fi
# the tests work in the copy, whose pages are the changed ones
for file in *; do test -e "$root/$file" || ln -s "$PWD/$file" "$root"; done
for other in bis-data bis-mpi; do
    test -e "$root/$other" || test ! -e "$BIS_BUILD/$other" || ln -s "$(readlink -f "$BIS_BUILD/$other")" "$root"
done
failed=""
for test in "$@"; do
    source=$(find tests -name "$test.c")
    cp "$BIS_BUILD/${source%.c}.o" "$root/$test.o" 2>/dev/null ||
        $BIS_COMPILE -c -o "$root/$test.o" "$source" ||
        say "$test does not compile"
    # shellcheck disable=SC2086
    $BIS_LINK -o "$root/$test" "$root/$test.o" $objects $BIS_OBJECTS $BIS_LIBS || say "$test does not link"
    (cd "$root" && env -u BIS_LONG BIS_PROGRAM="$PWD/bis" "./$test" >"$test.txt" 2>&1) ||
        failed="$failed$test ($(grep -m 1 'LINE' "$root/$test.txt")) "
done
test -z "$failed" || say "these fail: $failed"
echo "extending: as it should be"
