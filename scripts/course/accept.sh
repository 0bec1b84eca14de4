# SPDX-License-Identifier: BSD-2-Clause
# accept: is a hand-in such that it may be judged? For scripts/course/grade.sh, and for scripts/course/check.sh in a
# starter kit, which read this file in: what the one refuses, the other tells before.
#     in:   name, given (the hand-in: a file or a folder), shop (scripts/course/given.sh; headers/ in it), work (a new
#           folder), tool (the program grade)
#     out:  accept returns 0, or 1 and $reason; in $work: remarks, messages of the compiler, prints, src/, objects/

child=""
. scripts/course/starts.sh
# In the background, so that a signal is answered at once. 75: the machine was busy, and nothing is known of the hand-in
# (scripts/course/grade.c). This is no 0, it is no mark.
run() {
    "$@" &
    child=$!
    wait "$child"
    status=$?
    child=""
    [ $status -ne 75 ] || [ "$marked" ] || fail "not marked: the machine was too busy to judge it; mark it again"
    return $status
}

# What a hand-in makes a tool say, as a line that scripts/course/short.awk cuts. What the judge says is whole: its hint
# may stand at the end.
short() {
    printf '%s' "$*" | tr '\t\n' '  ' | awk "$(cat scripts/course/short.awk) { print short(\$0, 200) }"
}
remark() {
    short "$*" >>"$work/remarks"
}

# Is this a file, and no link, pipe or whatever, of a million bytes at most? Nothing is read before that is known.
small() {
    [ ! -L "$1" ] && [ -f "$1" ] && [ -n "$(find "$1" -prune -size -2049 2>/dev/null)" ]
}

# The hand-in's files that may be looked at, in $work/list, with a 0 byte behind each: few, small, and not deep.
MOST_FILES=2000
MOST_LEVELS=12
list_files() {
    : >"$work/list"
    [ -d "$given" ] && [ ! -L "$given" ] || return
    (ulimit -t 10 && LC_ALL=C find "$given/" -maxdepth $MOST_LEVELS -path '*/tests/given' -prune -o -type f \
        \( \( -name '*.[ch]' -size -2049 \) \
        -o -iregex '.*\.\(zip\|tar\(\.z\)?\|t?[gx]z\|7z\|t?bz2\|zst\|lzma\|rar\)' \) -print0) 2>/dev/null |
        head -z -n $((MOST_FILES + 1)) >"$work/list"
    [ "$(tr -dc '\0' <"$work/list" | wc -c)" -le $MOST_FILES ] ||
        remark "there are more than $MOST_FILES files; only so many are looked at"
}
# Those of the list whose path ends so.
ending() {
    LC_ALL=C grep -z "$(printf '%s' "$1" | sed 's/\./\\./g')\$" "$work/list" # a name may be no UTF-8
}

# Those of a list that have all marks of the file OURS.
with_marks() {
    sed -n 's|^ */\* \[\([a-z0-9-]*\)\] \*/$|\1|p' "$1" | grep -vx end | sed 's|.*|/\\* \\[&\\] \\*/|' >"$work/patterns"
    cat >"$work/having"
    while IFS= read -r pattern; do
        xargs -0 -r grep -lZ -e "$pattern" -- <"$work/having" >"$work/of-these"
        mv "$work/of-these" "$work/having"
    done <"$work/patterns"
    cat "$work/having"
}

# Their FILE below $work/src: of a kit, src/FILE; else the one file of that name in any depth; else the one that has
# the marks of our file.
collect() {
    file=$1
    base=${file##*/}
    to=$work/src/$file
    mkdir -p "${to%/*}" "$work/kept/${file%/*}"
    : >"$work/found"
    if [ -L "$given" ]; then
        remark "a link is not followed"
    elif [ -f "$given" ]; then
        if ! small "$given"; then
            remark "it has more than a million bytes$(is_archive "$given" && echo ", and is an archive: unpack it")"
        elif is_archive "$given"; then
            remark "it is an archive: unpack it, and mark the folder"
        elif [ "$(wc -l <"$shop/files")" -eq 1 ] ||
            printf '%s\0' "$given" | with_marks "$shop/blank/$file" | grep -q .; then
            cp "$given" "$to" && echo x >"$work/found"
        fi
    elif [ ! -L "$given/src" ] && [ ! -L "$given/src/${file%/*}" ] && small "$given/src/$file"; then
        cp "$given/src/$file" "$to" && echo x >"$work/found"
    else
        for end in "/src/$file" "/$base"; do
            [ -s "$work/found" ] || ending "$end" |
                xargs -0 -r -n 1 sh -c 'cp "$2" "$0" && echo x >>"$1"' "$to" "$work/found"
        done
        [ -s "$work/found" ] || ending ".${file##*.}" | with_marks "$shop/blank/$file" |
            xargs -0 -r -n 1 sh -c 'cp "$2" "$0" && echo x >>"$1"' "$to" "$work/found"
    fi
    chmod u+rw "$to" 2>/dev/null
    n=$(wc -l <"$work/found")
    [ "$n" -lt 2 ] || remark "there are $n files $base; the last one found is marked"
    [ "$n" -gt 0 ] && return
    remark "$base is missing (or a link, of more than a million bytes, or deeper than $MOST_LEVELS levels)"
    packed=$(tr '\0\n' '\n?' <"$work/list" | grep -v '\.[ch]$' | head -n 1)
    [ -z "$packed" ] || remark "${packed##*/} is an archive: unpack it, and mark the folder"
    cp "$shop/blank/$file" "$to"
}
# What is packed (zip, gzip, bzip2, xz, 7z, rar, zstd, compress, lzma) is not unpacked here, because it may be of any
# size then. It is named.
is_archive() {
    case $(head -c 6 "$1" | od -A n -t x1 | tr -d ' \n') in
    504b0304* | 1f8b* | 1f9d* | 425a68* | fd377a585a00 | 377abcaf271c | 526172211a07 | 28b52ffd* | 5d0000*) return 0 ;;
    esac
    return 1
}

# Make FILE such that it may be compiled. What is ours in it stays ours: else what stands between the marks is put into
# our own file. A line that is refused is left out. The compiler gets what was looked at, without comments.
MOST_LINES=20
read_it() {
    file=$1
    from=$work/src/$file
    spliced=""
    left_out=0
    while :; do
        said=$("$tool" look "$shop/blank/$file" "$from" "$work/kept/$file.prints" "$work/kept/$file.plain" \
            "$shop/headers/include" "$shop/headers/src" "$shop/headers/src/${file%/*}")
        case $? in
        0)
            cmp -s "$from" "$shop/blank/$file" || changed=yes
            cp "$work/kept/$file.plain" "$from"
            cat "$work/kept/$file.prints" >>"$work/prints"
            return
            ;;
        3)
            [ -z "$spliced" ] || break
            spliced=yes
            tr -d '\r' <"$from" >"$work/kept/$file"
            awk -f scripts/course/splice.awk "$work/kept/$file" "$shop/blank/$file" >"$from" || return 1
            said="$said; marked is what stands between the marks /* [...] */ alone"
            ;;
        5)
            [ $left_out -lt $MOST_LINES ] || break
            left_out=$((left_out + 1))
            sed -i "$(expr "$said" : 'line \([0-9]*\)')s/.*//" "$from"
            said="$said; marked is the rest, without that line"
            ;;
        *) break ;;
        esac
        remark "${file##*/}: $said"
    done
    is_archive "$from" && said="it is an archive: unpack it, and mark the folder"
    remark "${file##*/}: $said"
    return 1
}

# Compile FILE to objects/$2FILE.o with the flags that follow.
compile() {
    file=$1
    object=$work/objects/$2$file.o
    shift 2
    mkdir -p "${object%/*}"
    # shellcheck disable=SC2086
    run "$tool" run -d "$shop/headers" -r "$shop/headers" -r "$work/src" -w "$work/objects" -- \
        $BIS_COMPILE -iquote "$work/src" -iquote "src/${file%/*}" "$@" -c -o "$object" "$work/src/$file"
}

# An object defines what ours does, and uses what ours does, the plain part of the C library, and helpers; runs nothing
# by itself. Other functions become local. A call of what is refused becomes one of bis_refused
# (scripts/course/server.c), which ends the test: $refused is for the linker. $2: "", or "clean/" of the sanitized one.
look_at_object() {
    file=$1
    object=$work/objects/$2$file.o
    nm -P -g "$object" | awk '$2 != "U" && $2 != "w" { print $1 }' | sort >"$work/defined"
    lacks=$(comm -23 "$shop/refer/$file.defined" "$work/defined" | tr '\n' ' ')
    if [ -n "$lacks" ]; then
        remark "$file: not there, or static: $lacks"
        return 1
    fi
    other=$(comm -13 "$shop/refer/$file.defined" "$work/defined")
    used=$(nm -P -g "$object" | awk -v clean="${2:+^(a|ub)san_}" '
        NR == FNR { ok[$1]; next }
        $2 != "U" && $2 != "w" || $1 in ok { next }
        { name = $1; sub(/^__/, "", name); sub(/_chk$/, "", name) }
        name !~ /memory_region|default|set_(death|error)|describe|_is_/ && clean != "" && name ~ clean { next }
        name ~ /^(GOMP|kmpc|omp)_/ || name ~ /^(popcount|clz|ctz|mul|u?div|u?mod|float|fix)[a-z]*[0-9]$/ { next }
        name ~ /^(mem(cpy|move|set|cmp)|str(len|n?cmp|n?cpy|n?cat|chr))$/ { next }
        name ~ /^(malloc|calloc|realloc|free|aligned_alloc)$/ { next }
        name ~ /^(qsort|bsearch|l?l?abs|abort|exit|rand|srand|errno_location|assert_fail|bcmp|stack_chk_fail)$/ { next }
        name ~ /^(v?f?printf|v?sn?printf|puts|putchar|f?putc|fputs|fwrite|fflush|stdout|stderr|perror)$/ { next }
        name ~ /^_?(GLOBAL_OFFSET_TABLE_|mulsc3|muldc3|divsc3|divdc3)$/ { next }
        name ~ /^(a?(cos|sin|tan)h?|sincos|atan2|exp|exp2|expm1|exp10|log|log2|log10|log1p|logb|ilogb)[fl]?$/ { next }
        name ~ /^(pow|sqrt|cbrt|hypot|erfc?|[tl]gamma|ceil|floor|trunc|(l?l)?r(ound|int)|nearbyint)[fl]?$/ { next }
        name ~ /^(fmod|remainder|remquo|fabs|fmax|fmin|fdim|fma|frexp|ldexp|modf|scalbl?n|copysign)[fl]?$/ { next }
        name ~ /^(nan|nextafter|nexttoward)[fl]?$/ { next }
        { print $1; if (++n == 10) exit }' "$shop/allowed" -)
    flags=""
    for word in $other; do flags="$flags -L $word"; done
    for word in $used; do
        flags="$flags --redefine-sym $word=refused_$word"
        refused="$refused -Wl,--defsym=refused_$word=bis_refused"
        grep -q "\"$word\" is refused" "$work/remarks" && continue
        where=$(grep -nw -m 1 -e "$word" "$work/src/$file" | cut -d: -f1)
        remark "$file${where:+, line $where}: \"$word\" is refused; a test that calls it ends there"
    done
    # shellcheck disable=SC2086
    [ -z "$flags" ] || objcopy $flags "$object" || return 1
    [ -z "$2" ] || return 0
    for word in $other; do remark "$file: \"$word\" is not static; it is marked as if it were"; done
    if [ -n "$(starts "$object" | LC_ALL=C comm -13 "$shop/refer/$file.starts" -)" ]; then
        remark "$file: what runs before or after the tests is refused"
        return 1
    fi
}

# Everything before a test is run.
accept() {
    changed=""
    reason=""
    refused=""
    : >"$work/remarks"
    : >"$work/prints"
    mkdir -p "$work/src" "$work/objects" "$work/kept"
    list_files
    while IFS= read -r file; do collect "$file"; done <"$shop/files"
    if small "$given/assignment" && [ "$(sed -n 1p "$given/assignment" | tr -cd 'a-z0-9')" != "$name" ]; then
        remark "the kit says it is another assignment"
    fi
    while IFS= read -r file; do
        read_it "$file" || { reason="refused"; return 1; }
    done <"$shop/files"
    if [ -z "$changed" ]; then
        reason="nothing is written"
        return 1
    fi
    : >"$work/messages"
    while IFS= read -r file; do
        [ -f "$work/src/$file" ] || cp "src/$file" "$work/src/$file" || return 1
        if ! compile "$file" "" >>"$work/messages"; then
            first=$(sed "s|$work/src/||g" "$work/messages" | grep -m 1 'error\|memory\|stopped')
            remark "it does not compile: ${first:-the compiler says nothing}"
            [ -n "$BIS_RESULT" ] || sed "s|$work/src/|src/|g" "$work/messages" >&2
            reason="it does not compile"
            return 1
        fi
        look_at_object "$file" "" || { reason="refused"; return 1; }
    done <"$shop/units"
}
