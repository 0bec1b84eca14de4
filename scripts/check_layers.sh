#!/bin/sh
# check_layers: a file includes headers of its own row or of rows below it, never above (README, "Reading order").
#     scripts/check_layers.sh [ROOT]          ROOT holds include/bis and src; default: here
# Every module must have a row. Names ending in * stand for all that begin so; the longest pattern that fits counts.
cd "${1:-.}" || exit 1
exec awk '
BEGIN {
    rows = "0 clock status mem vec file xform stats version grow names errata;" \
           "1 rng sampler warp weights cdf alias marsaglia curve lanes;" \
           "2 image image_* layers envmap envmap_* importance importance_* regions light light_* pool clusters bsdf phong phong_* microfacet;" \
           "3 geometry mesh mesh_* surface quadric triangle rounding camera accel grid grid_* embree embree_* point;" \
           "4 integrator em brdf mis pool candidates resample blocks product batch proposal visibility rejection sir exact unoccluded;" \
           "5 scene scene_* plan lexer parser parser_* ply ply_* obj obj_*;" \
           "6 film film_* render edges auto auto_* gather adapt compare verify verify_* trade trade_* pixel pixel_* canvas palette;" \
           "7 cli cli_* help help_* cmd_* survey survey_* pixel_report pixel_files describe json main"
    n = split(rows, row, ";")
    for (i = 1; i <= n; i++) {
        m = split(row[i], word, " ")
        for (j = 2; j <= m; j++) row_of[word[j]] = word[1]
    }
}
function find(path,    name, stem) {
    name = path
    sub(/.*\//, "", name)
    sub(/\.[ch]$/, "", name)
    if (name in row_of) return row_of[name]
    for (stem = name; stem != ""; stem = substr(stem, 1, length(stem) - 1))
        if ((stem "*") in row_of) return row_of[stem "*"]
    printf "%s: no row; give it one in scripts/check_layers.sh\n", path
    bad = 1
    return 99
}
FNR == 1 { mine = find(FILENAME) }
/^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, part, "\"")
    theirs = find(part[2])
    if (theirs != 99 && mine != 99 && theirs > mine) {
        printf "%s:%d: row %d includes \"%s\" of row %d: arrows only go down\n", FILENAME, FNR, mine, part[2], theirs
        bad = 1
    }
}
END { exit bad }
' $(ls include/bis/*.h src/*.[ch] 2>/dev/null)
