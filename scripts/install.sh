#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# install: puts the program, its man page and the library below a prefix (make install calls it), or removes them again.
#     [MPI=1] [DESTDIR=folder] scripts/install.sh BUILD PREFIX [LIBDIR]   BUILD holds what make has made; MPI=1:
#     bis-mpi, too
#     [DESTDIR=folder] scripts/install.sh --remove PREFIX [LIBDIR]
# LIBDIR: where libraries go, PREFIX/lib by default; systems of several architectures have another place for each.
# The list below is the whole of it; docs/library.md describes the files.
set -eu
build=$1 prefix=$2 libdir=${3:-}
to=${DESTDIR:-}$prefix
lib=${DESTDIR:-}${libdir:-$prefix/lib}
version=$(sed -n 's/^#define BIS_VERSION "\(.*\)"/\1/p' include/bis/base/version.h)
shared=libbis.so.$version
headers=$(cd include && find bis -name '*.h')

if [ "$build" = --remove ]; then
    rm -f "$lib/libbis.a" "$lib/$shared" "$lib/libbis.so.${version%.*}" "$lib/libbis.so" "$lib/pkgconfig/bis.pc"
    cd "$to"
    rm -f bin/bis bin/bis-mpi share/man/man1/bis.1
    rm -rf libexec/bis
    [ ! -d libexec ] || rmdir libexec 2> /dev/null || true
    # One by one, and folders only if they are empty, because others may have put files there.
    for header in $headers; do rm -f "include/$header"; done
    [ ! -d include/bis ] || find include/bis -type d -empty -delete
    exit 0
fi

mkdir -p "$to/bin" "$to/share/man/man1" "$lib/pkgconfig"
install -m 755 "$build/bis" "$to/bin/bis"
[ "${MPI:-}" != 1 ] || install -m 755 "$build/bis-mpi" "$to/bin/bis-mpi"
install -m 644 "$build/bis.1" "$to/share/man/man1/bis.1"
install -m 644 "$build/library/libbis.a" "$lib/libbis.a"
install -m 755 "$build/library/$shared" "$lib/$shared"
ln -sf "$shared" "$lib/libbis.so.${version%.*}"
ln -sf "libbis.so.${version%.*}" "$lib/libbis.so"
# The instruments: programs of Python, and the library that they load, which is that of the program.
package=$to/libexec/bis/python/bis
for file in $(cd scripts/python && find bis -name '*.py' -o -name py.typed -o -name kit.md -o -name '*.html'); do
    mkdir -p "$to/libexec/bis/python/${file%/*}"
    install -m 644 "scripts/python/$file" "$to/libexec/bis/python/$file"
done
for program in scripts/python/bis-*; do install -m 755 "$program" "$to/libexec/bis/${program##*/}"; done
ln -sf "${libdir:-../../../../lib}/$shared" "$package/libbis.so"
for header in $headers; do
    mkdir -p "$to/include/${header%/*}"
    install -m 644 "include/$header" "$to/include/$header"
done
awk -v prefix="$prefix" -v libdir="$libdir" '/^prefix=/ { $0 = "prefix=" prefix }
    /^libdir=/ && libdir != "" { $0 = "libdir=" libdir }
    { print }' \
    "$build/bis.pc" >"$lib/pkgconfig/bis.pc"
chmod 644 "$lib/pkgconfig/bis.pc"
