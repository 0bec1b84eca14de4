# SPDX-License-Identifier: BSD-2-Clause
# help_scene: the tables of docs/scene-format.md as the array bis_help_rows (help.h), so that what a parameter is stands
# once. The Makefile calls it.
#     awk -f src/cli/help_scene.awk docs/scene-format.md
# A row whose first cell is `code` is an entry: its term is that cell. Of four cells the second is the default, the
# third the range. What a scene has that names no sampler and no integrator is a scene there, and given line by line.
function plain(s,    link) {
    while (match(s, /\[[^]]*\]\([^)]*\)/)) {
        link = substr(s, RSTART + 1, RLENGTH - 1)
        sub(/\]\(.*/, "", link)
        s = substr(s, 1, RSTART - 1) link substr(s, RSTART + RLENGTH)
    }
    gsub(/`/, "", s)
    return s
}
function string(s) {
    gsub(/[\\"?]/, "\\\\&", s)
    return "\"" s "\""
}
function entry(term, text) { print "    {" string(section) ", {" string(term) ", " text "}}," }
function join(a, between, b) { return a (a != "" && b != "" ? between : "") b }
BEGIN { print "#include \"cli/help.h\"\nconst bis_help_row bis_help_rows[] = {" }
/^```/ {
    in_scene = !in_scene
    next
}
in_scene {
    if (section ~ /^A scene without/ && !/^#/) entry($0, "NULL")
    next
}
/^#+ / {
    section = $0
    sub(/^#+ /, "", section)
}
/^\| `/ {
    sub(/^\| /, "")
    sub(/ *\|$/, "")
    n = split($0, cell, /[^\\]\|/) # the blank before a bar is part of it; \| is none
    for (i = 1; i <= n; i++) gsub(/^ +| +$/, "", cell[i])
    if (cell[1] ~ /^`"/) gsub(/"/, "", cell[1])
    text = n == 4 ? join("(" join(cell[2], "; ", cell[3]) ")", " ", cell[4]) : join(cell[2], ": ", cell[3])
    entry(plain(cell[1]), string(plain(text)))
}
/^## What `bis` does not model/ { exit }
END { print "    {NULL, {NULL, NULL}},\n};" }
