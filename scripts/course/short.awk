# SPDX-License-Identifier: BSD-2-Clause
# short: s in `most` characters at most, which end with a word.
function short(s, most) {
    if (length(s) <= most) return s
    s = substr(s, 1, most - 4)
    sub(/ [^ ]*$/, "", s)
    return s " ..."
}
