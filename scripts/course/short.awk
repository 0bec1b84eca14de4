# SPDX-License-Identifier: BSD-2-Clause
# short: s in 200 characters at most, which end with a word.
function short(s) {
    if (length(s) <= 200) return s
    s = substr(s, 1, 196)
    sub(/ [^ ]*$/, "", s)
    return s " ..."
}
