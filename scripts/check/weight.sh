#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# weight: how heavy the house is: lines of code and words of pages by folder, beside those of the last release
# (docs/data/weight.csv).
#     scripts/check/weight.sh            prints the table, of folders those that have changed (make lint)
#     scripts/check/weight.sh --keep     keeps today's numbers as those of the release (scripts/release.sh)
kept=docs/data/weight.csv
# "FOLDER,COUNT" for each folder: lines of C, shell, awk, Python, JavaScript and HTML, and words of Markdown.
weigh() {
    find src include tests scripts docs README.md CONTRIBUTING.md CHANGELOG.md -type f ! -path '*/bis/pages/*' \
        \( -name '*.[ch]' -o -name '*.sh' -o -name '*.awk' -o -name '*.py' -o -name '*.js' -o -name '*.html' \
        -o -name '*.md' \) -exec wc -lw {} + | awk '
        $3 == "total" { next }
        {
            n = split($3, part, "/")
            is_page = $3 ~ /\.md$/
            folder = is_page ? "words of pages" : part[1] (n > 2 ? "/" part[2] : "")
            count[folder] += is_page ? $2 : $1
            if (!is_page) count[part[1] " (all)"] += $1
        }
        END { for (folder in count) print folder "," count[folder] }' | LC_ALL=C sort
}
if [ "$1" = --keep ]; then
    { echo "folder,count" && weigh; } >"$kept"
    exit
fi
weigh | awk -F, -v kept="$kept" '
    BEGIN {
        while ((getline line <kept) > 0) { split(line, field, ","); then[field[1]] = field[2] }
        printf "%-20s %8s %8s\n", "lines", "now", "release"
    }
    $1 !~ /\// || $2 != then[$1] { printf "%-20s %8d %8s\n", $1, $2, then[$1] }'
