# SPDX-License-Identifier: BSD-2-Clause
# splice: the named fragments of a source file, /* [name] */ ... /* [end] */, replaced by those of the same name in
# another.
#     awk -f scripts/course/splice.awk FRAGMENTS SOURCE > RESULT
# The markers stay. A fragment that FRAGMENTS does not hold stays as it is. One with a line that begins with - or + is
# an edit: "-" and a line that goes, "+" and one that comes, " " and one that stays, in order; SOURCE has the others.
function name_of(line) {
    if (line !~ /^ *\/\* \[[a-z0-9-]+\] \*\/$/) return ""
    gsub(/^ *\/\* \[|\] \*\/$/, "", line)
    return line
}
function add() { while (edit[at] ~ /^\+/) print substr(edit[at++], 2) }
{ name = name_of($0) }
FILENAME == ARGV[1] {
    if (name == "end") inside = ""
    else if (name != "") { inside = name; has[name] = 1 }
    else if (inside != "") { body[inside] = body[inside] $0 "\n"; if (/^[-+]/) edits[inside] = 1 }
    next
}
name == "end" {
    if (edits[inside] && at < n) {
        print "splice: [" inside "] has no line \"" substr(edit[at], 2) "\"" > "/dev/stderr"
        exit 1
    }
    inside = ""
}
inside != "" && edits[inside] {
    stays = at >= n || $0 != substr(edit[at], 2) || edit[at++] ~ /^ /
    if (stays) print
    add()
    next
}
inside != "" && has[inside] { next }
{ print }
name != "" && name != "end" {
    inside = name
    n = split(body[name], edit, "\n")
    at = 1
    if (edits[name]) add()
    else printf "%s", body[name]
}
