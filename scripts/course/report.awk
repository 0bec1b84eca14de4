# SPDX-License-Identifier: BSD-2-Clause
# report: what one hand-in got, as JSON, from its remarks and its lines (points, of how many, criterion, remark, with
# tabs between), in this order. kind: grade; gradescope, its results.json; classroom50, its classroom50/result/v1, with
# what its runner sets in the environment. This has no place for remarks: they stand with the first test.
function quoted(s) {
    gsub(/\\/, "&&", s)
    gsub(/"/, "\\\"", s)
    gsub(/[\001-\037\177-\377]/, " ", s)
    return "\"" s "\""
}
function set(name) { return quoted(ENVIRON[name]) }
FILENAME == ARGV[1] {
    if ($0 == "") next
    remarks = remarks (remarks == "" ? "" : ", ") quoted($0)
    text = text (text == "" ? "" : "; ") $0
    next
}
BEGIN { FS = "\t" }
{
    got += $1
    all += $2
    if (kind == "classroom50" && FNR == 1 && text != "") $4 = $4 ($4 == "" ? "" : "; ") text
    if (kind == "gradescope")
        format = "{\"name\": %s, \"score\": %d, \"max_score\": %d, \"output\": %s, \"output_format\": \"text\", " \
                 "\"visibility\": \"visible\"}"
    else if (kind == "classroom50")
        format = "{\"test-name\": %s, \"score\": %d, \"max-score\": %d, \"remark\": %s, \"passed\": " \
                 ($1 == $2 ? "true" : "false") "}"
    else format = "{\"criterion\": %s, \"points\": %d, \"of\": %d, \"remark\": %s}"
    criteria = criteria sprintf("%s\n    " format, FNR > 1 ? "," : "", quoted($3), $1, $2, quoted($4))
}
END {
    if (kind == "gradescope") {
        printf "{\n  \"score\": %d,\n  \"output\": %s,\n  \"output_format\": \"text\",\n", got, quoted(text)
        printf "  \"visibility\": \"visible\",\n  \"stdout_visibility\": \"hidden\",\n"
        printf "  \"tests\": [%s\n  ]\n}\n", criteria
    } else if (kind == "classroom50") {
        printf "{\n  \"schema\": \"classroom50/result/v1\",\n  \"classroom\": %s,\n", set("CLASSROOM")
        printf "  \"assignment\": %s,\n  \"submission\": %s,\n", set("ASSIGNMENT"), set("SUBMISSION_TAG")
        printf "  \"commit\": %s,\n  \"release\": %s,\n", set("COMMIT_URL"), set("RELEASE_URL")
        printf "  \"review\": %s,\n", set(ENVIRON["REVIEW_URL"] == "" ? "COMMIT_URL" : "REVIEW_URL")
        printf "  \"datetime\": %s,\n  \"score\": %d,\n  \"max-score\": %d,\n", quoted(now), got, all
        printf "  \"tests\": [%s\n  ]\n}\n", criteria
    } else {
        printf "{\n  \"assignment\": %s,\n  \"points\": %d,\n  \"of\": %d,\n", quoted(name), got, all
        printf "  \"warnings\": %d,\n  \"remarks\": [%s],\n  \"criteria\": [%s\n  ]\n}\n", warnings, remarks, criteria
    }
}
