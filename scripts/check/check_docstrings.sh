#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_docstrings: what a reader may expect of a source file.
#   - Each function of a header, public (include/bis) or private (src), has a comment above it that begins with the
#     function's name and a verb ("returns"). One comment may serve several functions that follow one another without an
#     empty line, if it names the first of them.
#   - No line of src, include, tests and scripts refers to the SPEC: it is not in the repository. Name the page and the
#     heading.
#   - No line of C, shell, awk, Python, JavaScript or make has more than 120 columns: the Makefile, .ci, src, include,
#     tests, scripts, data/generate and docs/live.
#   - No function of C has more than 60 lines, from its { to its }. Tables are not counted: from a line that ends in
#     "= {" to its "};". That of src, include, tests, scripts and data/generate. No function of Python has more.
#   - No function of src and include has more than six parameters, but for those of flat and of the list below.
#     scripts/check/check_docstrings.sh [ROOT]          ROOT holds include, src, tests and scripts; default: here
cd "${1:-.}" || exit 1
bad=0

# shellcheck disable=SC2046
awk '
    # The name of the function that a line at column 0 declares, or "".
    function declares(line) {
        if (line !~ /^[A-Za-z_]/ || line ~ /^(typedef|struct|enum|union|extern|return)[ {]/) return ""
        gsub(/__attribute__\(\([a-z_]*\)\) */, "", line)
        if (match(line, /[^A-Za-z_]NAMED\([a-z_]+\)\(/)) { # thesis/model_many.h
            line = substr(line, RSTART + 1, RLENGTH - 3)
            sub(/.*\(/, "", line)
            return line
        }
        if (line ~ /^bis_alias_builder [a-z_]+;/) {
            sub(/^bis_alias_builder /, "", line)
            sub(/;.*/, "", line)
            return line
        }
        if (!match(line, /[A-Za-z_0-9]+\(/)) return ""
        return RSTART > 1 ? substr(line, RSTART, RLENGTH - 1) : ""
    }
    # Whether a verb follows the name, an adverb, or the number of an erratum; behind several names it is a plural.
    function says(rest) { return rest ~ /^(,| and | \(E[0-9]+\) [a-z]+s | ([a-z]+ly )?[a-z]+s[ ,:])/ }
    FNR == 1 { comment = ""; open = served = 0 }
    open { comment = comment " " $0; if (/\*\//) open = 0; next }
    /^\/\* \[[a-z-]+\] \*\/$/ { next } # a mark of scripts/check/fragments.sh
    /^\/\*/ { comment = $0; served = 0; if (!/\*\//) open = 1; next }
    /^$/ { if (served) comment = ""; served = 0; next }
    {
        name = declares($0)
        if (name == "") { if (/^[A-Za-z_#]/ && !/^BIS_LANES$/) comment = ""; next }
        functions++
        if (served) next
        text = comment
        gsub(/^\/\*+ */, "", text)
        if (text !~ "^" name "[ ,(]") {
            printf "%s:%d: the comment above %s does not begin with its name\n", FILENAME, FNR, name
            bad = 1
        } else if (!says(substr(text, length(name) + 1))) {
            printf "%s:%d: no verb (\"returns\") follows the name in the comment above %s\n", FILENAME, FNR, name
            bad = 1
        }
        served = 1
    }
    END { if (!functions) print "include/bis: no functions"; exit bad || !functions }
' $(find include/bis src -name '*.h' | sort) || bad=1

if grep -rnIw SPEC src include tests scripts 2>/dev/null | grep -v '^scripts/check/check_docstrings.sh:'; then
    echo "the SPEC is not in the repository: name the page of docs and its heading"
    bad=1
fi

# Lines over 120 columns. Bytes that only continue a character are none.
# shellcheck disable=SC2046
LC_ALL=C awk '
    length($0) > 120 {
        gsub(/[\200-\277]/, "")
        if (length($0) <= 120) next
        printf "%s:%d: %d columns, at most 120 are allowed\n", FILENAME, FNR, length($0)
        bad = 1
    }
    END { exit bad }' $(find Makefile .ci/run src include tests scripts data/generate docs/live -type f \
    \( -name '*.[ch]' -o -name '*.sh' -o -name '*.awk' -o -name '*.py' -o -name '*.js' -o -name '*.mk' \
    -o -name Makefile -o -path .ci/run \) 2>/dev/null | sort) || bad=1

# shellcheck disable=SC2046
awk '
    FNR == 1 { begin = 0 }
    /^[A-Za-z_].*\(/ { name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name) }
    /^\{$/ { begin = FNR; tables = table = 0 }
    begin && /^    [^ ].*= \{$/ { table = FNR }
    begin && table && /^    \};$/ { tables += FNR - table + 1; table = 0 }
    /^\}$/ && begin {
        lines = FNR - begin + 1 - tables
        if (lines > 60) {
            printf "%s:%d: %s has %d lines, at most 60 are allowed\n", FILENAME, begin, name, lines
            bad = 1
        }
        begin = 0
    }
    END { exit bad }' $(find src include tests scripts data/generate -type f -name '*.[ch]' 2>/dev/null | sort) || bad=1

# shellcheck disable=SC2046
awk '
    function judge() {
        if (begin && last - begin >= 60) {
            printf "%s:%d: %s has %d lines, at most 60 are allowed\n", file, begin, name, last - begin + 1
            bad = 1
        }
        begin = 0
    }
    FNR == 1 || (/^ *[^ )]/ && match($0, /[^ ]/) <= column) { judge() }
    !begin && /^ *def / { file = FILENAME; begin = FNR; column = match($0, /d/); name = $2; sub(/\(.*/, "", name) }
    /[^ ]/ { last = FNR }
    END { judge(); exit bad }' $(find tests scripts -type f -name '*.py' 2>/dev/null | sort) /dev/null || bad=1

# shellcheck disable=SC2046
awk -v whole=$(($# == 0)) '
    # Those that may have more, and why.
    BEGIN {
        list = "choose_systematic weigh" # lanes: restrict belongs to a parameter
        list = list " add_em add_brdf" # taught: answers of the course have these heads
        list = list " bis_film_init_thin" # a place or a name for messages beside what is made
        # one caller, for which alone a struct would be filled in
        list = list " add_samples gather bis_pixel_rays_record bis_product_draw"
        list = list " bis_render_part_write"
        n = split(list, names, " ")
        for (i = 1; i <= n; i++) stays[names[i]]
    }
    # The number of parameters in the head of a function.
    function parameters(head,    n, depth, i, c) {
        n = 1
        for (i = index(head, "(") + 1; depth >= 0; i++) {
            c = substr(head, i, 1)
            if (c == "," && !depth) n++
            depth += (c == "(") - (c == ")" || c == "")
        }
        return n
    }
    FNR == 1 { head = "" }
    /^[A-Za-z_][^=]*\(/ && !/^(typedef|enum|struct|union) / { head = ""; line = FNR; begin = 1 }
    begin || head != "" {
        head = head $0
        begin = 0
        text = head
        if (gsub(/\(/, "", text) > gsub(/\)/, "", text)) next
        while (match(head, /NAMED\([a-z_]+\)/)) { # thesis/model_many.h
            name = substr(head, RSTART, RLENGTH - 1)
            sub(/.*\(/, "", name)
            head = substr(head, 1, RSTART - 1) name substr(head, RSTART + RLENGTH)
        }
        name = head
        sub(/\(.*/, "", name)
        sub(/.*[ *]/, "", name)
        n = parameters(head)
        head = ""
        if (n <= 6) next
        if (name in stays) { found[name]; next }
        printf "%s:%d: %s has %d parameters, at most 6 are allowed\n", FILENAME, line, name, n
        bad = 1
    }
    END {
        for (name in stays)
            if (whole && !(name in found)) { print "no function " name " has more than 6 parameters"; bad = 1 }
        exit bad
    }' $(find src include -type f -name '*.[ch]' ! -path '*/flat/*' 2>/dev/null | sort) /dev/null || bad=1
exit $bad
