#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_scenes: every word that a scene may hold stands in at least one scene of ours, so that each has been read and
# rendered by somebody.
#     scripts/check/check_scenes.sh [ROOT]    ROOT holds docs/scene-format.md, src/parse, data/scenes and scene.txt
# The words come from two places: the page that describes them (its `code`, outside of examples: `Rotate degrees x y z`,
# `float fov`, `"sobol"`), and what the parser compares with (the quoted words of src/parse). The scenes' own words are
# all that is not a comment. A word that is no word of a scene is named below, with its reason.
cd "${1:-.}" || exit 1
LC_ALL=C exec awk '
BEGIN {
    n = split("integer float bool string rgb color point3 point vector3 vector normal normal3 point2 texture " \
        "spectrum xyz blackbody", word, " ")
    for (i = 1; i <= n; i++) is_type[word[i]] = 1
    # placeholders and numbers of directives (`LookAt ex ey ez ...`), fields and commands of bis, files of other formats
    except("degrees ex ey ez lx ly lz ux uy uz KIND MAP NAME SCENE TYPE WHAT X VERTEX approximated bis envmap errata")
    except("illum mtllib usemtl Ns vt map_Bump map_bump bump norm bm it E6 M F name Ag Al Au Cu MgO TiO2")
    # of pbrt, and an error here: cameras, mappings, other textures
    except("realistic environment spherical cylindrical planar fbm ptex windy wrinkled marble dots bilerp directionmix")
    # an integrator of builds before 0.1.0, and an error here
    except("auto")
    # of the messages and of the lexer
    except("INF Inf Infinity NAN NaN inf infinity nan after before s a strings numbers unknown ignored red green blue")
    except("Colours rough metal- metal-CuZn- gold aluminium")
    # of the list of what was replaced, and of what a plan and a note say
    except("lights shapes materials textures missing version up stdillum- illum- stdillum-D65 End nothing parameter")
    except("wavelengths transformation pbrt-v3 pbrt-v4 60.0f")
    # a type that is known and never read
    except("vector2")
}
function except(words,    w, n, i) { n = split(words, w, " "); for (i = 1; i <= n; i++) no_word[w[i]] = 1 }
function want(w) {
    if (w ~ /^[A-Za-z0-9][A-Za-z0-9.-]*$/ && w !~ /^[0-9.-]+$/ && w !~ /^[b-jm-z]$/ && !(w in wanted)) {
        wanted[w] = FILENAME
        n_wanted[FILENAME ~ /md$/]++
    }
}
# Every quoted string: its last word is the name in "float fov"; then what stands without quotes.
function want_span(span,    q, n, part, i) {
    if (span ~ /^[-.\/]|\.[a-z]|\/|=|\(|:/) return
    while (match(span, /"[^"]*"/)) {
        n = split(substr(span, RSTART + 1, RLENGTH - 2), part, " ")
        if (n) want(part[n])
        span = substr(span, 1, RSTART - 1) " " substr(span, RSTART + RLENGTH)
    }
    gsub(/\[[^]]*\]/, "", span)
    n = split(span, part, /[ ,]+/)
    for (i = 1; i <= n; i++) want(part[i])
}
FILENAME ~ /\.md$/ {
    if (/^```/) in_example = !in_example
    if (in_example) next
    n = split($0, span, "`")
    for (k = 2; k <= n; k += 2) want_span(span[k])
    next
}
FILENAME ~ /\.c$/ {
    if (/^#include/) next
    line = $0
    while (match(line, /"[A-Za-z][A-Za-z0-9.-]*"/)) {
        want(substr(line, RSTART + 1, RLENGTH - 2))
        line = substr(line, RSTART + RLENGTH)
    }
    next
}
{
    sub(/#.*/, "")
    gsub(/[^A-Za-z0-9.-]+/, " ")
    for (k = 1; k <= NF; k++) used[$k] = 1
    scenes[FILENAME] = 1
}
END {
    for (w in wanted)
        if (!(w in used) && !(w in no_word) && !(w in is_type)) {
            print wanted[w] ": \"" w "\" stands in no scene: write it into one of data/scenes/pbrt"
            bad = 1
        }
    for (t in is_type)
        if (!(t in used)) {
            print "the type \"" t "\" stands in no scene"
            bad = 1
        }
    if (!n_wanted[1] || !n_wanted[0]) {
        print "no words found"
        bad = 1
    }
    exit bad
}
' docs/scene-format.md $(find src/parse -name '*.c' ! -name parser_mtl.c | sort) scene.txt \
    $(find data/scenes -type f ! -name '*.spd' | sort)
