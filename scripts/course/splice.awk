# SPDX-License-Identifier: BSD-2-Clause
# splice: the named fragments of a source file, /* [name] */ ... /* [end] */, replaced by those of the same name in
# another.
#     awk -f scripts/course/splice.awk FRAGMENTS SOURCE > RESULT
# The markers stay. A fragment that FRAGMENTS does not hold stays as it is.
function name_of(line) {
    if (line !~ /^ *\/\* \[[a-z0-9-]+\] \*\/$/) return ""
    gsub(/^ *\/\* \[|\] \*\/$/, "", line)
    return line
}
{ name = name_of($0) }
FILENAME == ARGV[1] {
    if (name == "end") inside = ""
    else if (name != "") { inside = name; has[name] = 1 }
    else if (inside != "") body[inside] = body[inside] $0 "\n"
    next
}
name == "end" { inside = "" }
inside != "" && has[inside] { next }
{ print }
name != "" && name != "end" {
    inside = name
    if (has[name]) printf "%s", body[name]
}
