#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_guide: the table of equations in docs/guide.md tells the truth: every file that it links to for an equation
# says "eq. N" in a comment, and has the functions named after it; and none of the thesis's equations, 3.1 to 3.17 and
# 4.1 to 4.9, is missing. And every section of chapters 3 and 4 has something to do: a paragraph that begins with
# "*Do:*", and behind it the answer, hidden in <details>.
# The tables of src/README.md tell the truth, too: where a row says "`NAME` in `FILE`", FILE has NAME.
# No empty line cuts a table of any page: the rows behind it would be shown as text, because they have no head.
#     scripts/check/check_guide.sh [ROOT]
# From the thesis to the code is the table; from the code back to the thesis is a search for "eq. 3.16".
cd "${1:-.}" || exit 1
bad=0
awk -F '|' '
    function end_section() {
        if (section == "") return
        if (!asks) { printf "docs/guide.md:%d: section %s has no *Do:*\n", at, section; bad = 1 }
        else if (!answers) {
            printf "docs/guide.md:%d: section %s hides no answer in <details> below its *Do:*\n", at, section
            bad = 1
        }
        else if (answers > closes) {
            printf "docs/guide.md:%d: section %s does not close its <details>\n", at, section
            bad = 1
        }
    }
    /^## / {
        end_section()
        section = ""
        asks = answers = closes = 0
        if ($0 ~ /^## [34]\.[0-9]/) { sections++; section = substr($0, 4); sub(/ .*/, "", section); at = NR }
    }
    /^\*Do:\*/ { asks = 1 }
    asks && /^<details>$/ { answers++ }
    /^<\/details>$/ { closes++ }
    /^\| [34]\.[0-9]+ \|/ {
        equation = $2
        gsub(/ /, "", equation)
        rows++
        listed[equation] = 1
        rest = $3
        while (match(rest, /[34]\.[0-9]+/)) {
            listed[substr(rest, RSTART, RLENGTH)] = 1
            rest = substr(rest, RSTART + RLENGTH)
        }
        n = split($4, part, /\[`/)
        for (i = 2; i <= n; i++) {
            file = part[i]
            sub(/`.*/, "", file)
            if (file !~ /^(src|include)\//) continue
            files++
            text = ""
            while ((getline line < file) > 0) { gsub(/^ *\*+ */, " ", line); text = text " " line }
            close(file)
            pattern = equation
            sub(/\./, "\\.", pattern)
            if (text !~ "[Ee]q\\. +" pattern "[^0-9]") {
                printf "docs/guide.md:%d: %s never says eq. %s\n", NR, file, equation
                bad = 1
            }
            rest = part[i]
            sub(/^[^)]*\)/, "", rest)
            while (match(rest, /`[^`]+`/)) {
                name = substr(rest, RSTART + 1, RLENGTH - 2)
                rest = substr(rest, RSTART + RLENGTH)
                if (index(text, name) == 0) { printf "docs/guide.md:%d: %s has no %s\n", NR, file, name; bad = 1 }
            }
        }
    }
    END {
        end_section()
        if (sections < 2) { printf "docs/guide.md: no sections of chapters 3 and 4\n"; bad = 1 }
        for (i = 1; i <= 17 + 9; i++) {
            equation = i <= 17 ? "3." i : "4." i - 17
            if (!(equation in listed)) { printf "docs/guide.md: eq. %s is not in the table\n", equation; bad = 1 }
        }
        if (rows < 1 || files < rows / 2) { printf "docs/guide.md: no table of equations\n"; bad = 1 }
        exit bad
    }' docs/guide.md || bad=1
grep -no '`[a-z_]*` in `[a-z_/]*\.[ch]`' src/README.md 2>/dev/null | tr -d '`' | {
    while IFS=': ' read -r line name _ file; do
        grep -qsw "$name" "$file" || { echo "src/README.md:$line: $file has no $name"; bad=1; }
    done
    exit $bad
} || bad=1
# shellcheck disable=SC2046
awk '
    FNR == 1 { last = above = "" }
    FNR > 2 && above == "" && last ~ /^\|/ && !/^\| ?:?--/ {
        printf "%s:%d: an empty line cuts this table\n", FILENAME, FNR - 1
        bad = 1
    }
    { above = last; last = $0 }
    END { exit bad }' $(find . -path ./build -prune -o -name '*.md' -print | sort | cut -c 3-) || bad=1
exit $bad
