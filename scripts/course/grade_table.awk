# SPDX-License-Identifier: BSD-2-Clause
# grade_table: the table of a class, from the lines of scripts/course/grade_class.sh, behind scripts/course/short.awk.
# kind: csv; moodle, that of its grading worksheet; html; text, the groups alone; form, what students answer;
# leaderboard, of the times and variances that remarks tell.
#     C points criterion      N name      R remark      L points of criterion message      A least most i j ...
#     F question answer
#     (with tabs between)
function csv(s) {
    if (s ~ /^[=+\-@]/) s = "'" s # a formula, to a spreadsheet
    gsub(/"/, "\"\"", s)
    return "\"" s "\""
}
# Moodle names the folder of a submission NAME_NUMBER_assignsubmission_..., and the student "Participant NUMBER". The
# last such number counts, because NAME, which a student may choose, can look so. Moodle takes the feedback as HTML.
function identifier(s) {
    if (!match(s, /.*_[0-9]+_assignsubmission/)) return s
    s = substr(s, 1, RLENGTH)
    sub(/_assignsubmission$/, "", s)
    sub(/.*_/, "", s)
    return "Participant " s
}
function html(s) {
    gsub(/&/, "\\&amp;", s)
    gsub(/</, "\\&lt;", s)
    gsub(/>/, "\\&gt;", s)
    gsub(/"/, "\\&quot;", s)
    gsub(/'/, "\\&#39;", s)
    return s
}
# The factor in a message "... 1.23 times ...".
function times(s) { return match(s, /[0-9.]+ times/) ? substr(s, RSTART) + 0 : 0 }
function note(i, s) { remark[i, ++n_remarks[i]] = s }
# It comes first, as number 0. The student reads Moodle's, where it is not said.
function note_likeness(i, s) { if (kind != "moodle") remark[i, 0] = remark[i, 0] (remark[i, 0] == "" ? "" : "; ") s }
# A hand-in without a line of points was not marked, which is no 0.
function sum_of(i, otherwise) { return (i, 1) in points ? sum[i] + 0 : otherwise }
function cell(i, c) { return (i, c) in points ? points[i, c] + 0 : "" }
# The remarks on student i: all, or for a cell of a spreadsheet as many as 200 characters hold, and of the first one
# what they hold behind who wrote the same.
function remarks(i, is_cell,    s, j, one) {
    s = remark[i, 0]
    for (j = 1; j <= n_remarks[i]; j++) {
        one = remark[i, j]
        if (is_cell && j == 1 && length(s) < 150) one = short(one, s == "" ? 200 : 198 - length(s))
        if (is_cell && s != "" && length(s) + 2 + length(one) > 200) break
        s = s (s == "" ? "" : "; ") one
    }
    return (is_cell ? short(s, 200) : s) (j <= n_remarks[i] ? "; and " n_remarks[i] - j + 1 " more, in the .html" : "")
}
BEGIN { FS = "\t" }
$1 == "C" { of[++n_criteria] = $2; criterion[n_criteria] = $3; all += $2 }
$1 == "N" { name[++n] = $2; k = 0 }
$1 == "R" { note(n, $2) }
$1 == "L" { points[n, ++k] = $2; sum[n] += $2; message[n, k] = $5; if ($5 != "") note(n, $4 ": " $5) }
$1 == "L" && $4 ~ /^it_is_nearly_as_good/ { variance[n] = times($5) }
$1 == "L" && $4 == "speed" { product[n] = variance[n] * times($5) }
$1 == "F" && !asked[$2]++ { question[++n_questions] = $2 }
$1 == "F" { answer[n, $2] = $3 }
$1 == "A" {
    name[n + 1] = "our own solution"
    n_groups++
    share[n_groups] = $2 == $3 ? $2 " %" : $2 " to " $3 " %"
    for (k = 4; k <= NF; k++) {
        members[n_groups, k] = name[$k]
        size[n_groups] = NF
        others = NF == 5 ? name[$(9 - k)] : (NF - 4) " others: group " n_groups
        note_likeness($k, share[n_groups] " like " others)
    }
}
END {
    if (kind == "moodle") {
        printf "Identifier,Grade,Maximum Grade,Last modified (grade),Feedback comments\r\n"
        for (i = 1; i <= n; i++) {
            feedback = ""
            for (c = 1; c <= n_criteria; c++)
                if ((i, c) in points) feedback = feedback points[i, c] + 0 " of " of[c] "  " html(criterion[c]) "<br>"
            printf "%s,%s,%d,,%s\r\n", csv(identifier(name[i])), sum_of(i, ""), all,
                csv(feedback html(remarks(i)))
        }
    } else if (kind == "csv") {
        printf "student,points"
        for (c = 1; c <= n_criteria; c++) printf ",%s", csv(criterion[c] " (" of[c] ")")
        printf ",remarks\r\n"
        for (i = 1; i <= n; i++) {
            printf "%s,%s", csv(name[i]), sum_of(i, "not marked")
            for (c = 1; c <= n_criteria; c++) printf ",%s", cell(i, c)
            printf ",%s\r\n", csv(remarks(i, 1))
        }
    } else if (kind == "form") {
        for (i = 0; i <= n; i++) {
            printf "%s", i ? csv(name[i]) : "student"
            for (q = 1; q <= n_questions; q++) printf ",%s", csv(i ? short(answer[i, question[q]], 400) : question[q])
            printf "\r\n"
        }
    } else if (kind == "leaderboard") {
        printf "place,student,variance times time (visible normals: 1)\r\n"
        for (place = 1; place <= n; place++) {
            best = 0
            for (i = 1; i <= n; i++) if (product[i] > 0 && (!best || product[i] < product[best])) best = i
            if (!best) break
            printf "%d,%s,%.2f\r\n", place, csv(name[best]), product[best]
            delete product[best]
        }
    } else if (kind == "html") {
        print "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" assignment "</title>"
        print "<style>body{font:14px sans-serif}table{border-collapse:collapse;margin:1em 0}"
        print "td,th{border:1px solid #bbb;padding:.2em .5em;vertical-align:top}"
        print "th{text-align:left}td.n{text-align:right}"
        print "td.r{max-width:60em;overflow-wrap:anywhere}</style></head><body>"
        print "<h1>" assignment "</h1>\n<table><tr><th>student</th><th>points of " all "</th>"
        for (c = 1; c <= n_criteria; c++) printf "<th>%s (%d)</th>", html(criterion[c]), of[c]
        print "<th>remarks</th></tr>"
        for (i = 1; i <= n; i++) {
            printf "<tr><td>%s</td><td class=\"n\">%s</td>", html(name[i]), sum_of(i, "not marked")
            for (c = 1; c <= n_criteria; c++) printf "<td class=\"n\" title=\"%s\">%s</td>",
                html(message[i, c]), cell(i, c)
            printf "<td class=\"r\">%s</td></tr>\n", html(remarks(i))
        }
        print "</table>"
        print "<h2>Alike beyond what was given out</h2>"
        print n_groups ? "<table><tr><th>group</th><th>students</th><th>in common</th></tr>" : "<p>None.</p>"
        for (g = 1; g <= n_groups; g++) {
            printf "<tr><td class=\"n\">%d</td><td>", g
            for (k = 4; k <= size[g]; k++) printf "%s%s", (k > 4 ? "<br>" : ""), html(members[g, k])
            printf "</td><td class=\"n\">%s</td></tr>\n", share[g]
        }
        if (n_groups) print "</table>"
        print "</body></html>"
    } else {
        for (g = 1; g <= n_groups; g++) {
            printf "alike, %s:", share[g]
            for (k = 4; k <= size[g]; k++) printf "%s %s", (k > 4 ? "," : ""), members[g, k]
            print ""
        }
    }
}
