#!/bin/sh
# musl_python.sh PROCESSOR CC AR RANLIB ZLIB OUT: CPython 3.11 for musl of a processor, installed in OUT: of Debian's sources in
# out/library-sources, by a C cross compiler, with the zlib of folder ZLIB; OUT/complete says that it is. Nobody packs one that this machine
# can fetch. It lacks what needs other libraries (ssl, ctypes, sqlite3), and calls that musl got in 1.2.5. configure takes the names of
# modules, in which packages for musl say so, from the system that it runs on. Code is -fPIC: where a program has copies of the C library's
# data, the compiler's stand-in for that library, where all data have one address, made one of stdin and stdout. setup.py asks the compiler for
# its folders of headers, and it would name this machine's, which are of another C library.
set -eu

processor=$1 CC=$2 AR=$3 RANLIB=$4 zlib=$5 out=$6
root=$(cd "$(dirname "$0")/../.." && pwd)
sources=$root/build/pythons/sources
if ! [ -d "$sources"/Python-3.11* ]; then
    rm -rf "$sources" "$sources.new"
    mkdir -p "$sources.new"
    tar -C "$sources.new" -xf "$root"/out/library-sources/python3.11_*.orig.tar.gz
    mv "$sources.new" "$sources"
fi
rm -rf "$out" && mkdir -p "$out/build" && cd "$out/build"
printf '#!/bin/sh\n[ "$*" != "-E -v -" ] || exit 0\nexec "%s" "$@"\n' "$CC" >"$out/cc" && chmod +x "$out/cc"
CC=$out/cc
export CC AR RANLIB READELF=/usr/bin/readelf # by its whole name, or configure asks for one of the target
"$sources"/Python-3.11*/configure --host="$processor-linux-musl" --build="$(uname -m)-alpine-linux-musl" --with-build-python=/usr/bin/python3.11 \
    --prefix="$out" --without-ensurepip --disable-test-modules --disable-ipv6 LDFLAGS=-dynamic OPT=-DNDEBUG \
    CFLAGS="-O1 -fPIC -fwrapv -fno-sanitize=undefined -Wno-date-time" ZLIB_CFLAGS="-I$zlib/include/zlib" ZLIB_LIBS="$zlib/lib/libzlib.a" \
    ac_cv_file__dev_ptmx=yes ac_cv_file__dev_ptc=no ac_cv_buggy_getaddrinfo=no ac_cv_func_preadv2=no ac_cv_func_pwritev2=no >log 2>&1
make -j "$(nproc)" >>log 2>&1
make install >>log 2>&1
touch "$out/complete"
