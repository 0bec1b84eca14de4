# SPDX-License-Identifier: BSD-2-Clause
# page: a page put into the frame that all pages share (frame.html), with the style sheet and the script that the frame
# loads from docs/live put into it, and without comments of HTML. The Makefile calls it.
#     awk -f scripts/python/pages/page.awk scripts/python/pages/trade.html scripts/python/pages/frame.html
function put(tag, name,    line) {
    print "<" tag ">"
    while ((getline line < ("docs/live/" name)) > 0) print line
    close("docs/live/" name)
    print "</" tag ">"
}
/^<!--/ { comment = 1 }
comment {
    if (/-->/) comment = 0
    next
}
# Of the page: the title, and all lines of its style and its script.
FNR == NR {
    if (/^<title>/) {
        gsub(/<\/?title>/, "")
        command = title = $0
        sub(/: .*/, "", command)
        sub(/^[^:]*: /, "", title)
    }
    if (/^<(style|script)>/) part = toupper(substr($0, 2, length($0) - 2))
    if (part != "") text[part] = text[part] (text[part] == "" ? "" : "\n") $0
    if (/^<\/(style|script)>/) part = ""
    next
}
/^<(link|script).*docs\/live\// {
    name = $0
    sub(/.*docs\/live\//, "", name)
    sub(/".*/, "", name)
    put(/^<link/ ? "style" : "script", name)
    next
}
/^@(STYLE|SCRIPT)@/ {
    print text[substr($0, 2, length($0) - 2)]
    next
}
{
    sub(/@TITLE@/, title)
    sub(/@COMMAND@/, command)
    print
}
