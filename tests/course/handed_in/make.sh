#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# make: hand-ins of a class for the assignment alias, as tests/course/test_assignments.c and who works on the marking
# needs them: right, wrong, empty, copied, hostile, as files and as folders.
#     tests/course/handed_in/make.sh FOLDER [N]          N: at least so many; the right and wrong ones come again,
#                                                        renamed
# From the root. The names say what they are: right*, wrong*, copy*, nothing*, attack* (worth nothing), odd*
# (names, places and forms; 2 and 3 are blank, the others right).
to=$1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir -p "$to" || exit 1

# Our file with the fragments of FRAGMENTS, as $to/NAME.
hand_in() { # FRAGMENTS NAME
    rm -rf "$work/out"
    mkdir "$work/out"
    sh scripts/course/splice.sh "$1" "$work/out" >/dev/null && cp "$work/out/thesis/alias.c" "$to/$2"
}
# What is on standard input, in front of the blank functions.
attack() { # NAME
    { echo '/* [alias-build] */' && cat && sed 1d tests/course/alias_blank.c; } >"$work/attack.c"
    hand_in "$work/attack.c" "attack $1.c"
}
# The body of bis_alias_pick, and something in front.
draw() { # NAME BODY
    {
        echo '/* [alias-build] */' && cat
        sed '1d; /\[alias-sample\]/,$d' tests/course/alias_blank.c
        printf '%s\n' '/* [alias-sample] */' \
            'size_t bis_alias_pick(const double *prob, const uint32_t *alias, size_t n, double u)' '{' \
            '    (void)prob, (void)alias, (void)u, (void)n;' "    $2" '    return 0;' '}' '/* [end] */'
    } >"$work/attack.c"
    hand_in "$work/attack.c" "attack $1.c"
}
whole() { # NAME
    cat >"$to/attack $1.c"
}

# ---- right, wrong, nothing ----
for k in 1 2 3 4; do hand_in tests/course/handed_in/right$k.c right$k.c; done
cp src/thesis/alias.c "$to/right5.c"
sed 's|^#include <math.h>|&\n#include <stdlib.h>\n\nstatic double half_of(double x);|
     s|^/\* Sets prob\[i\] = N P_i\. Returns.*|static double half_of(double x) { return abs(1) * x / 2; }\
#define TWICE(x) ((x) + (x))|
     s|prob\[lg\] -= 1 - prob\[sm\];|prob[lg] -= TWICE(half_of(1 - prob[sm]));|' \
    src/thesis/alias.c >"$to/right6, with a helper and an include outside of the marks.c"
hand_in tests/course/alias_wrong1.c wrong1.c
hand_in tests/course/alias_wrong2.c wrong2.c
hand_in tests/course/alias_blank.c nothing1.c
: >"$to/nothing2, empty"
mkdir -p "$to/nothing3, a folder"
head -c 100000 /dev/urandom >"$to/nothing4.c"
ln -s "$PWD/src/thesis/alias.c" "$to/nothing5, a link.c"
mkfifo "$to/nothing6, a pipe"
mkdir -p "$to/nothing7, a link inside/src"
ln -s "$PWD/src/thesis" "$to/nothing7, a link inside/src/thesis"
{ cat src/thesis/alias.c && echo 'int x = ;'; } >"$to/nothing8, does not compile.c"

# ---- odd names and places ----
mkdir -p "$to/odd1, Jürgen Groß/Abgabe 1 (final)/src"
cp "$to/right3.c" "$to/odd1, Jürgen Groß/Abgabe 1 (final)/src/alias.c"
cp "$to/nothing1.c" "$to/odd2, \"quoted\" & <b>it's; \$(touch x) \`touch x\`.c"
cp "$to/nothing1.c" "$to/odd3,
two lines.txt"
sed 's/$/\r/' "$to/right4.c" >"$to/-odd4, lines as in DOS.c"
cp "$to/right4.c" "$to/=odd5.c"
sed 's/^\( *\)/\1\1/; s/, /,/g' "$to/right3.c" >"$to/odd6, other blanks.c"
sed 's/double total;/double total_changed;/; s/pairwise_sum/sum_by_halves/g' "$to/right4.c" \
    >"$to/odd7, changed outside of the marks.c"

# ---- copied: renamed and in another order ----
awk '/\[alias-sample\]/ { later = 1 } { if (later) print; else first = first $0 "\n" } END { printf "%s", first }' \
    tests/course/handed_in/right2.c |
    sed 's/\([^[]\)\<prob\>/\1p/g; s/\([^[]\)\<alias\>/\1other/g; s/\<donor\>/g/g
         s/\<give\>/hand_over/g; s/\<lack\>/gap/g; s/\<j\>/bin/g; s/\<keep\>/stays/g; s|/\* What.*||' >"$work/copy.c"
hand_in "$work/copy.c" "copy of right2.c"
sed 's/\<poor\>/x/g; s/\<rich\>/y/g; s/\<coin\>/frac/g; s|/\*.*still there \*/||' \
    tests/course/handed_in/right1.c >"$work/copy.c"
hand_in "$work/copy.c" "copy of right1.c"

# ---- hostile: the compiler is to fetch what it should not ----
echo '#include <alias.c>' | whole "include 1"
echo '#include <thesis/alias.c>' | whole "include 2"
echo '#include "../../src/thesis/alias.c"' | whole "include 3"
echo "#include \"$PWD/src/thesis/alias.c\"" | whole "include 4"
echo '#include "/dev/stdin"' | whole "include 5, stdin"
echo '#include <alias.c>' | attack "include 6, between the marks"
echo "#include \"$PWD/src/thesis/alias.c\"" | attack "include 7, between the marks"
echo '#include "/dev/stdin"' | attack "include 8, stdin between the marks"
printf '??=include "/dev/stdin"\n' | attack "include 9, a trigraph"
printf '%%:include "/dev/stdin"\n' | attack "include 10, a digraph"
printf '#inc\\\nlude "/dev/stdin"\n' | attack "include 11, a folded line"
printf '#define F "/dev/stdin"\n#include F\n' | attack "include 12, a macro"
echo '__asm__(".incbin \"/etc/passwd\"");' | attack "incbin"
printf 'static const char a[] = {\n#embed "/etc/passwd"\n};\n' | attack "embed"

# ---- what was tried against the marking itself ----
for file in tests/course/handed_in/cheats/*.c; do
    hand_in "$file" "attack ${file##*/}"
done
printf '#include <stdlib.h>\n__attr\\\nibute__((constructor)) static void first(void) { exit(8); }\n' |
    attack "constructor, folded"
printf '#include <stdlib.h>\n#define A(x, y) x##y
A(__attri, bute__)((constructor)) static void first(void) { exit(8); }\n' |
    attack "constructor, pasted"
printf '#include <stdlib.h>\nint main(void) { exit(8); }\n' | attack "main"
echo 'int atexit(void (*)(void)); void _exit(int); static void last(void) { _exit(8); }' | draw "atexit" 'atexit(last);'

# ---- to change the judge ----
echo 'void mark_wrong(const char *f, ...); void mark_wrong(const char *f, ...) { (void)f; }' | attack "mark_wrong"
printf '#pragma weak mark_wrong\n' | attack "pragma weak"
echo 'double fabs(double x); double fabs(double x) { return 0 * x; }' | attack "fabs"
echo 'void *memcpy(void *restrict a, const void *restrict b, size_t n);
void *memcpy(void *restrict a, const void *restrict b, size_t n) { (void)b, (void)n; return a; }' | attack "memcpy"
echo 'void bis_rng_init(void *r); void bis_rng_init(void *r) { (void)r; }' | attack "rng"
printf '#define bis_alias_implied_pmf cheat\n' | attack "macro"
sed '/^void bis_alias_implied_pmf/,/^}/d; s|^size_t bis_alias_bytes.*|&\n#undef bis_alias_implied_pmf\
void bis_alias_implied_pmf(const bis_alias *a, double *pmf) {\
for (size_t i = 0; i < a->n; i++) pmf[i] = a->prob[i] / (double)a->n; }|' \
    "$to/nothing1.c" >"$to/attack, another implied_pmf.c"
sed 's|^void bis_alias_implied_pmf|#if 0\n&|; s|^size_t bis_alias_bytes|#endif\
void bis_alias_implied_pmf(const bis_alias *a, double *pmf) {\
for (size_t i = 0; i < a->n; i++) pmf[i] = a->prob[i] / (double)a->n; }\n&|' \
    "$to/nothing1.c" >"$to/attack, if 0.c"
echo 'extern char **environ;' | draw "environ" 'if (environ) return 1;'
printf '#include <stdlib.h>\n' |
    draw "a table of ours" 'extern size_t bis_envmap_lookup(void); return bis_envmap_lookup();'

# ---- to stop the class ----
{
    echo '#define A0 +1'
    for k in $(seq 30); do echo "#define A$k A$((k - 1)) A$((k - 1))"; done
    echo 'static int all(void) { return 0 A30; }'
} | attack "macro bomb"
echo 'static char all[1ull << 40] = {1};' | attack "object bomb"
mkdir -p "$to/attack, another assignment/src/thesis"
cp "$to/nothing1.c" "$to/attack, another assignment/src/thesis/alias.c"
printf 'cdf\nsrc/thesis/cdf.c\n' >"$to/attack, another assignment/assignment"

# ---- as many as asked for ----
n=$(ls "$to" | wc -l)
k=0
while [ "$n" -lt "${2:-0}" ]; do
    k=$((k + 1))
    n=$((n + 1))
    case $((k % 4)) in 0) from=wrong1 ;; *) from=right$((k % 4)) ;; esac
    sed "s/\\<u\\>/u$k/g" "$to/$from.c" >"$to/copy of $from, number $k.c"
done
