#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_layers: which folder may include which. The folder is the row: a new file needs no entry, a new folder one line.
#     scripts/check/check_layers.sh [ROOT]          ROOT holds include/bis and src; default: here
cd "${1:-.}" || exit 1
exec awk '
BEGIN {
    may["base"]   = ""
    may["shape"]  = "base"
    may["thesis"] = "base shape"
    may["beyond"] = "base shape thesis"
    may["files"]  = "base shape"
    may["scene"]  = "base shape thesis beyond files"
    may["parse"]  = "base shape thesis beyond files scene"
    may["render"] = "base shape thesis beyond scene"
    may["tools"]  = "base shape thesis beyond files scene render"
    may["flat"]   = "base shape thesis beyond files scene parse render tools"
    may["cli"]    = "base shape thesis beyond files scene parse render tools flat"
}
function folder(path) { sub(/^(src|include\/bis|bis)\//, "", path); sub(/\/.*/, "", path); return path }
FNR == 1 {
    mine = folder(FILENAME)
    if (!(mine in may)) {
        print FILENAME ": folder \"" mine "\" has no line in scripts/check/check_layers.sh"
        bad = 1
    }
}
/^[ \t]*#[ \t]*include[ \t]*"[^"]*\// {
    split($0, q, "\"")
    theirs = folder(q[2])
    if (theirs != mine && index(" " may[mine] " ", " " theirs " ") == 0) {
        printf "%s:%d: %s may not include \"%s\"\n", FILENAME, FNR, mine, q[2]
        bad = 1
    }
}
cloned && !/^static / {
    printf "%s:%d: a BIS_LANES function that is not static: clang 14 hides it from other files\n", FILENAME, FNR
    bad = 1
}
cloned && /^static / {
    name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name)
    if (name in file && file[name] != FILENAME) {
        printf "%s:%d: %s has another BIS_LANES function %s\n", FILENAME, FNR, file[name], name
        bad = 1
    }
    file[name] = FILENAME
}
{ cloned = /^BIS_LANES/ }
END { exit bad }
' $(find src include/bis -name "*.[ch]" | sort)
