# SPDX-License-Identifier: BSD-2-Clause
# form: the answers of a filled form as lines "F question answer" for scripts/course/grade_table.awk, with tabs between.
#     awk -f scripts/course/form.awk FORM FILLED
# An answer stands behind the question's colon, and on the lines below it.
NR == FNR { if (sub(/:$/, "")) asked[question[++n] = $0] = n; next }
{
    words = tolower(substr($0, 1, index($0, ":") - 1))
    sub(/ +$/, "", words)
    if (words in asked) { at = asked[words]; sub(/[^:]*:/, "") }
    gsub(/^ +| +$/, "")
    if ($0 != "") answer[at] = answer[at] (answer[at] == "" ? "" : " ") $0
}
END { for (i = 1; i <= n; i++) if (answer[i] != "") print "F\t" question[i] "\t" answer[i] }
