# SPDX-License-Identifier: BSD-2-Clause
# page: a page with the style sheets and scripts that it loads from docs/live put into it, and without
# its comments. The Makefile calls it.
#     awk -f src/tools/page.awk src/tools/trade/page.html
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
/^<(link|script).*docs\/live\// {
    name = $0
    sub(/.*docs\/live\//, "", name)
    sub(/".*/, "", name)
    put(/^<link/ ? "style" : "script", name)
    next
}
{ print }
