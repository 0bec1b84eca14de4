# SPDX-License-Identifier: BSD-2-Clause
# face: what follows from the prototypes of include/bis/flat/*.h. The Makefile calls it.
#     awk -f src/flat/face.awk -v to=h HEADER...   flat/face.h: the functions that do the work, for src/flat to define
#     awk -f src/flat/face.awk -v to=c HEADER...   face.c: bis_flat_NAME around each, and bis_flat_signatures
# A function whose last parameters are (char *say, size_t size) returns a status. bis_flat_NAME looks for a NULL where
# something is due, sets what it opens to NULL, calls bis_do_NAME, which has a bis_diag in their place, and ends with
# the messages. The rest of a signature is in its types and its comment, which must say of each array what it holds:
#     u[n][4]           an array; it may be NULL where n is 0, if n is a size_t of the function
#     value[3], *total  an array, a single number
#     NAME (may be NULL)
#     libm              the last bits are those of the C library: programs compare them with a tolerance
# The letters of a signature are explained at bis_flat_signatures (include/bis/flat/flat.h).
function wrong(words) {
    printf "%s:%d: %s: %s\n", FILENAME, FNR, name, words | "cat >&2"
    bad = 1
}
# The letter of a type.
function letter(type) {
    if (type in letters) return letters[type]
    if (type ~ /^bis_[a-z_]+ \*\*$/) return "O"
    if (type ~ /^(const )?bis_[a-z_]+ \*$/) return "h"
    wrong("no letter for \"" type "\"")
    return "?"
}
# The size_t that says how many items the array `what` has; "" if none does.
function count_of(what,    shape) {
    if (match(doc, "[^A-Za-z_]" what "[[][^]]*]")) {
        shape = substr(doc, RSTART + 1, RLENGTH - 2)
        sub(/^[^[]*[[]/, "", shape)
        return index(sizes, " " shape " ") ? shape : ""
    }
    if (doc !~ "[*]" what "[^A-Za-z_]") wrong("its comment does not say what " what " holds: name[n], name[3], *name")
    return ""
}
# One parameter: into the signature, and what is looked at before the work.
function parameter(text,    type, what, kind, count, may, is_long) {
    gsub(/^ +| +$/, "", text)
    type = sub(/\[[0-9]+\]$/, "", text) ? " *" : "" # its length stands in the prototype
    is_long = type != ""
    match(text, /[A-Za-z_0-9]+$/)
    what = substr(text, RSTART)
    type = substr(text, 1, RSTART - 1) type
    gsub(/ +$/, "", type)
    gsub(/ +/, " ", type)
    kind = letter(type)
    may = kind != "p" && doc ~ "[^A-Za-z_]" what " [(]?may be NULL"
    count = kind ~ /[dfubwDFUBWNI]/ && !is_long ? count_of(what) : ""
    row = row " " what ":" kind (count != "" ? "[" count "]" : "") (may ? "?" : "")
    if (kind ~ /[OT]/) opened = opened "    if (" what ") *" what " = NULL;\n"
    if (kind !~ /[inkqrp]/ && !may)
        looked = looked (looked != "" ? ", " : "") "{\"" what "\", " what ", " (count != "" ? count : 1) "}"
    given = given what ", "
}
function declare(head,    returns, arguments, n, i, list, status) {
    match(head, /bis_flat_[a-z0-9_]+\(/)
    name = substr(head, RSTART + 9, RLENGTH - 10)
    returns = substr(head, 1, RSTART - 1)
    arguments = substr(head, RSTART + RLENGTH)
    sub(/\);.*/, "", arguments)
    gsub(/^ +| +$/, "", returns)
    gsub(/ +/, " ", arguments)
    status = sub(/, *char \*say, *size_t size$/, "", arguments)
    row = opened = looked = given = sizes = ""
    n = arguments == "void" ? 0 : split(arguments, list, ",")
    for (i = 1; i <= n; i++)
        if (list[i] ~ /^ *size_t [a-z_]+$/) sizes = sizes substr(list[i], index(list[i], "size_t") + 6) " "
    for (i = 1; i <= n; i++) parameter(list[i])
    rows = rows "    \"bis_flat_" name " " (status && doc ~ /[^a-z]libm[^a-z]/ ? "~" : "") \
        (status ? "s" : returns == "void" ? "v" : letter(returns)) row "\\n\"\n"
    if (!status) return
    if (to == "h") print "bis_status bis_do_" name "(" arguments ", bis_diag *diag);"
    else printf "\nint bis_flat_%s(%s, char *say, size_t size)\n{\n" \
        "    const bis_flat_pointer given[] = {%s, {NULL, NULL, 0}};\n    bis_diag diag = {0};\n" \
        "    bis_status status = bis_flat_given(given, &diag);\n\n%s" \
        "    if (!status) status = bis_do_%s(%s&diag);\n    return bis_flat_end(status, &diag, say, size);\n}\n",
        name, arguments, looked, opened, name, given
}
BEGIN {
    n_pairs = split("int=i,size_t=n,uint32_t=k,uint64_t=q,double=r,const char *=z,const char *const *=l," \
        "const char **=T,const double *=d,const float *=f,const uint32_t *=u,const uint8_t *=b,const uint64_t *=w," \
        "double *=D,float *=F,uint32_t *=U,uint8_t *=B,char *=B,uint64_t *=W,size_t *=N,int *=I," \
        "const volatile sig_atomic_t *=p,void *=p,bis_flat_watcher *=p", pairs, ",")
    for (i = 1; i <= n_pairs; i++)
        letters[substr(pairs[i], 1, length(pairs[i]) - 2)] = substr(pairs[i], length(pairs[i]))
    print "/* Made by src/flat/face.awk of include/bis/flat. */"
    if (to == "h") print "#pragma once\n"
    for (i = 1; i < ARGC; i++)
        if (ARGV[i] ~ /\.h$/) {
            path = ARGV[i]
            sub(/^include\//, "", path)
            print "#include \"" path "\""
        }
    print to == "h" ? "#include \"flat/say.h\"\n\n#pragma GCC visibility push(hidden)\n" : "#include \"flat/face.h\""
}
/^\/\*/ { doc = ""; inside = 1 }
inside {
    if (/\*\//) inside = 0
    sub(/^ \*/, "")
    doc = doc $0
    next
}
/^(#|typedef|enum|$)/ { next }
{ head = head " " $0 }
/;/ { declare(head); head = "" }
END {
    if (to == "h") print "\n#pragma GCC visibility pop"
    else print "\nconst char *bis_flat_signatures(void)\n{\n    return\n" rows "        ;\n}"
    exit bad
}
