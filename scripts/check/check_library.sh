#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# check_library: is what `make install` installs enough for other programs? Installed below a scratch prefix, the
# example of docs/library.md is compiled with pkg-config, with the shared library and with the archive, and run.
#     scripts/check/check_library.sh SCENE MEAN          MEAN: what the example must print for the scene
# LIBRARY_PAGE: another page. From the root; BIS_BUILD and BIS_LINK are those of make test. The prefix is
# build/check_library. Exit status 1, and a line that says why, where anything fails.
scene=$1 mean=$2
prefix=$(pwd)/build/check_library
say() {
    echo "library: $*"
    exit 1
}
rm -rf "$prefix" && mkdir -p "$prefix" || exit 1
DESTDIR='' sh scripts/install.sh "$BIS_BUILD" "$prefix" || say "it cannot be installed"
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
unset LD_LIBRARY_PATH # the page's lines must do without

version=$(pkg-config --modversion bis) || say "pkg-config does not know bis"
[ "$("$prefix/bin/bis" --version | head -n 1)" = "bis $version" ] || say "bis.pc says version $version"
soname=$(readelf -d "$prefix/lib/libbis.so" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')
[ "$soname" = "libbis.so.${version%.*}" ] || say "the soname is $soname"
[ -e "$prefix/lib/$soname" ] || say "there is no $soname"

# Of what is exported, all begins with bis_, and the library does not exit.
nm -D --defined-only "$prefix/lib/libbis.so" | awk '$3 !~ /^bis_/ { print $3 }' >"$prefix/foreign"
[ ! -s "$prefix/foreign" ] || say "it exports $(head -n 3 "$prefix/foreign" | tr '\n' ' ')"
nm -D --undefined-only "$prefix/lib/libbis.so" |
    awk '{ sub(/@.*/, "", $2) } $2 ~ /^(exit|_exit|abort)$/ { print $2 }' >"$prefix/forbidden"
[ ! -s "$prefix/forbidden" ] || say "it calls $(tr '\n' ' ' <"$prefix/forbidden")"

# Each header by itself, as a stranger's compiler sees it.
for header in $(cd "$prefix/include" && find bis -name '*.h'); do echo "#include <$header>"; done >"$prefix/all.c"
echo 'typedef int nothing;' >>"$prefix/all.c"
# shellcheck disable=SC2046
$BIS_LINK -Wall -Wextra -Werror -fsyntax-only $(pkg-config --cflags bis) "$prefix/all.c" ||
    say "the headers do not compile"

awk '/^<!-- example\.c -->$/ { found = 1; next }
    found && /^```c$/ { inside = 1; next } /^```$/ { if (inside) exit }
    inside { print }' \
    "${LIBRARY_PAGE:-docs/library.md}" >"$prefix/example.c"
[ -s "$prefix/example.c" ] || say "the page has no example"
[ "$(wc -l <"$prefix/example.c")" -le 40 ] || say "the example has more than 40 lines"
# The page's own lines, in the folder of the example, with our compiler and flags, and the scratch prefix as its
# $HOME/bis.
awk '/^<!-- compile -->$/ { found = 1; next }
    found && /^```sh$/ { inside = 1; next } /^```$/ { if (inside) exit }
    inside { print }' \
    "${LIBRARY_PAGE:-docs/library.md}" >"$prefix/compile.sh"
grep -q '^cc ' "$prefix/compile.sh" || say "the page does not say how to compile the example"
ln -s "$prefix" "$prefix/bis"
(cd "$prefix" && { echo 'cc() { command $BIS_LINK -Wall -Wextra -Werror "$@"; }' && cat compile.sh; } |
    HOME=$prefix sh -e) ||
    say "the example does not link by the page's lines"
readelf -d "$prefix/example" | grep -q "\[$soname\]" || say "the example does not use the shared library"
! readelf -d "$prefix/example-static" | grep -q "\[$soname\]" ||
    say "the example with the archive wants the shared library, too"
for how in example example-static; do
    "$prefix/$how" data/maps/interior.hdr "$scene" >"$prefix/$how.txt" 2>&1 ||
        say "$how: the example fails: $(cat "$prefix/$how.txt")"
    grep -q "mean $mean\$" "$prefix/$how.txt" || say "$how: no mean of $mean: $(cat "$prefix/$how.txt")"
done

sh scripts/install.sh --remove "$prefix"
left=$(cd "$prefix" && find bin lib include share ! -type d 2>/dev/null)
[ -z "$left" ] && [ ! -e "$prefix/include/bis" ] || say "uninstall leaves something: $left"
echo "library: as it should be"
