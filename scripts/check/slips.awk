# SPDX-License-Identifier: BSD-2-Clause
# slips: every small slip that a file of C can have, one a line. scripts/check/mutants draws from them.
#     awk -v file=NAME -f slips.awk FILE
# Prints, separated by tabs: NAME, line, offset in bytes, bytes that go, "in" a function or "out", what comes instead.
# Left alone: text in quotes, asserts (a weaker one is no fault), directives but for the values of #define, sizes of 16
# and more in brackets, arguments that may change places (fmax, dot, bis_alloc, equality by strcmp), numbers in what
# bis_alloc is asked for (more memory is no fault), long hexadecimal numbers (seeds and hashes: others are as good).

function add(offset, token) {
    T[++n] = token; L[n] = NR; P[n] = offset
    if (token ~ /^[([{]$/) open[++depth] = n
    if (token ~ /^[])}]$/ && depth) { M[open[depth]] = n; depth-- }
}

# One line: its tokens, with their offsets in the file.
{
    line = $0; col = 1; size = length(line)
    if (!comment && (continued || line ~ /^[ \t]*#/)) {
        continued = line ~ /\\$/
        col = size + 1
        if (!continued && match(line, /^#define [A-Za-z_0-9]+ /)) { col = RLENGTH + 1; add(begin, "#") }
    }
    while (col <= size) {
        rest = substr(line, col)
        if (comment) {
            end = index(rest, "*/"); comment = !end
            col = end ? col + end + 1 : size + 1
            continue
        }
        if (match(rest, /^[ \t]+/)) { col += RLENGTH; continue }
        if (rest ~ /^\/\*/) { comment = 1; col += 2; continue }
        if (!match(rest, text) && !match(rest, word) && !match(rest, number) && !match(rest, operator)) RLENGTH = 1
        add(begin + col - 1, substr(rest, 1, RLENGTH))
        col += RLENGTH
    }
    begin += size + 1
    all = all line "\n"
}

function words(i, j) {  # tokens i to j as they stand, on one line
    s = substr(all, P[i] + 1, P[j] + length(T[j]) - P[i])
    gsub(/[ \t\n]+/, " ", s)
    return s
}
function slip(i, j, new) {
    print file, L[i], P[i], j < i ? 0 : P[j] + length(T[j]) - P[i], inside[i] ? "in" : "out", new
}
function is_word(t) { return t ~ /^[A-Za-z_]/ && !(t in keyword) }
function is_operand(t) { return t ~ /^[A-Za-z_0-9.)"']/ && !(t in keyword) || t == "]" }
function up_to(i) {     # the semicolon that ends what begins at token i
    while (i <= n && T[i] != ";") i = (i in M) ? M[i] + 1 : i + 1
    return i
}

function swap_arguments(i,    k, from, to, old_from, old_to) {     # of the call whose "(" is token i
    if (M[i] == i + 1 || T[i - 1] ~ /^(fmax|fmin|hypot|strcmp|dot|dot3|bis_alloc)$/) return
    from = i + 1; old_to = 0
    for (k = from; k <= M[i]; k++) {
        if (T[k] == "," || k == M[i]) {
            to = k - 1
            if (old_to && words(old_from, old_to) != words(from, to))
                slip(old_from, to, words(from, to) ", " words(old_from, old_to))
            old_from = from; old_to = to; from = k + 1
        } else if (k in M) k = M[k]
    }
}

BEGIN {
    OFS = "\t"
    text = "^(\"([^\"\\\\]|\\\\.)*\"|'([^'\\\\]|\\\\.)+')"
    word = "^[A-Za-z_][A-Za-z_0-9]*"
    number = "^(0[xX][0-9a-fA-F]*\\.?[0-9a-fA-F]*([pP][-+]?[0-9]+)?|" \
             "([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?)[uUlLfF]*"
    operator = "^(<<=|>>=|\\.\\.\\.|->|\\+\\+|--|<<|>>|<=|>=|==|!=|&&|\\|\\||[-+*/%&|^]=)"
    split("if for while switch return case else do sizeof goto break continue " \
          "const static struct enum union typedef default", list, " ")
    for (i in list) keyword[list[i]] = 1
    m = split("+ -|- +|* /|/ *|% /|< <=|< >|<= <|<= >|> >=|> <|>= >|>= <|== !=|!= ==|&& OR|OR &&|& OR1|OR1 &|^ &|" \
              "<< >>|>> <<|+= -=|+= =|-= +=|-= =|*= /=|*= =|/= *=|/= =|OR= &=|OR= =|&= OR=|<<= >>=|>>= <<=|++ --|-- ++",
              list, "|")
    for (i = 1; i <= m; i++) {
        split(list[i], w, " ")
        for (j = 1; j <= 2; j++) { sub(/^OR$/, "||", w[j]); sub(/^OR1$/, "|", w[j]); sub(/^OR=$/, "|=", w[j]) }
        others[w[1]] = others[w[1]] " " w[2]
    }
}

END {
    # Bodies of functions; what asserts hold.
    for (i = 1; i <= n; i++) {
        if (T[i] == "{" && T[i - 1] == ")" && !inside[i]) for (j = i; j <= M[i]; j++) inside[j] = 1
        if (T[i] ~ /^(_S|s)?tatic_assert$|^assert$/ && T[i + 1] == "(") for (j = i; j <= M[i + 1]; j++) spared[j] = 1
        if (T[i] == "bis_alloc" && T[i + 1] == "(") for (j = i; j <= M[i + 1]; j++) if (T[j] ~ /^[0-9]/) spared[j] = 1
        if (T[i] ~ /^0[xX]/ && length(T[i]) > 7) spared[i] = 1
        if (T[i] == "[" && T[i + 1] ~ /^[0-9]+$/ && T[i + 1] >= 16) spared[i + 1] = 1
    }
    for (i = 1; i <= n; i++) {
        if (spared[i]) continue
        t = T[i]; before = T[i - 1]

        # operators; outside functions in the values of #define alone: * there makes pointers
        if (!inside[i] && T[i] == "#") define = L[i]
        if (!inside[i] && L[i] != define && t !~ /^([0-9]|\.[0-9]|true$|false$)/) continue
        if ((t in others) && (is_operand(before) || t ~ /^(\+\+|--)$/)) {
            m = split(others[t], w, " ")
            for (k = 1; k <= m; k++) slip(i, i, w[k])
        }
        if (t == "!" || t == "~" || (t == "-" && !is_operand(before))) slip(i, i, "")
        if (t == "?") { slip(i, i, "|| 1 ?"); slip(i, i, "&& 0 ?") }

        # constants
        if (t ~ /^\.?[0-9]/) {
            if (t ~ /^0[uUlL]*$/) slip(i, i, "1")
            else {
                slip(i, i, "0")
                slip(i, i, "(2 * " t ")")
                if (t !~ /[.eEpP]/ || t ~ /^0[xX][^.pP]*$/) slip(i, i, "(" t " + 1)")
            }
        }
        if (t == "true") slip(i, i, "false")
        if (t == "false") slip(i, i, "true")
        if (!inside[i]) continue

        # conditions, bounds of loops, returned values
        if ((t == "if" || t == "while") && T[i + 1] == "(") slip(i + 1, M[i + 1], "(!" words(i + 1, M[i + 1]) ")")
        if (t == "for" && T[i + 1] == "(") {
            j = up_to(up_to(i + 2) + 1)
            for (k = i + 2; k < j; k++) if (T[k] ~ /^<=?$/) break
            if (k < j) slip(j, j - 1, " - 1")
        }
        if (t == "return" && T[i + 1] != ";") {
            j = up_to(i + 1) - 1
            if (words(i + 1, j) !~ /^(0|true|false)$/) { slip(i + 1, j, "0"); slip(i + 1, j, "!(" words(i + 1, j) ")") }
        }

        # statements
        if (t == "break" || t == "continue") slip(i, i, "")
        if (before ~ /^([;{})]|else)$/ &&
            (is_word(t) && T[i + 1] ~ /^([(=.[]|->|\+\+|--|[-+*\/%&|^]=|<<=|>>=)$/ || t ~ /^(\*|\+\+|--)$/))
            slip(i, up_to(i) - 1, "")

        # arguments
        if (is_word(t) && T[i + 1] == "(") swap_arguments(i + 1)
    }
}
