#!/bin/sh
# check_install.sh CMAKE CC ROOT BUILD tested|shared|subproject: installs the library that was built and tested in BUILD, or a
# shared one built here, to a folder of its own, moves that, and builds and runs a program with what is found there: by
# CMake's find_package and by pkg-config. Or builds the program's project with brio as a part of it. What is built here is
# not optimized: where files lie does not depend on that.
set -eu

cmake=$1
cc=$2
root=$3
build=$4
kind=$5
consumer=$root/tests/install

folder=$(mktemp -d)
prefix=$folder/moved

finish() {
    status=$?
    [ $status = 0 ] || tail -n 40 "$folder/log"
    rm -rf "$folder"
    exit $status
}
trap finish EXIT
trap 'exit 1' INT TERM

step() {
    echo "-- $*"
    : >"$folder/log" # of this step only
}

expect_output() {
    output=$("$@")
    [ "$output" = "12 tetrahedra" ] && return
    echo "$1 printed \"$output\", expected \"12 tetrahedra\"" >&2
    exit 1
}

if [ "$kind" = subproject ]; then
    step "FetchContent"
    "$cmake" -S "$consumer" -B "$folder/build" -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=Debug -DBRIO_SOURCE="$root" >>"$folder/log" 2>&1
    "$cmake" --build "$folder/build" >>"$folder/log" 2>&1
    expect_output "$folder/build/consumer"
    # nothing of brio's own is built beside the library, or installed
    [ -z "$(find "$folder/build" -name 'test_*' -o -name brio -type f)" ] || {
        echo "tests or the program are built, too" >&2
        exit 1
    }
    "$cmake" --install "$folder/build" --prefix "$folder/installed" >>"$folder/log" 2>&1
    [ ! -e "$folder/installed/include" ] || {
        echo "brio installs itself" >&2
        exit 1
    }
    exit 0
fi

# expect_line FILE TEXT: the file has it.
expect_line() {
    grep -qF -e "$2" "$1" && return
    echo "$1 is without $2" >&2
    exit 1
}

bin=bin
if [ "$kind" = shared ]; then
    step "what packagers set"
    build=$folder/elsewhere
    "$cmake" -S "$root" -B "$build" -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=Release -DBRIO_TESTS=OFF \
        -DCMAKE_C_FLAGS_RELEASE="-O1 -DFLAG_OF_THE_PACKAGER" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_UNITY_BUILD=ON \
        -DCMAKE_INSTALL_LIBDIR=/far/lib -DCMAKE_INSTALL_INCLUDEDIR=/far/include >>"$folder/log" 2>&1
    expect_line "$build/brio.pc" "libdir=/far/lib"
    expect_line "$build/brio.pc" "includedir=/far/include"
    expect_line "$build/compile_commands.json" "-O1 -DFLAG_OF_THE_PACKAGER"
    expect_line "$build/compile_commands.json" "src/triangulation/delaunay.c"

    step "build"
    build=$folder/build
    bin=libexec/tools/bin
    "$cmake" -S "$root" -B "$build" -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=ON \
        -DCMAKE_INSTALL_BINDIR=$bin -DBRIO_TESTS=OFF >>"$folder/log" 2>&1
    "$cmake" --build "$build" >>"$folder/log" 2>&1
fi

step "install ($kind)"
"$cmake" --install "$build" --prefix "$folder/installed" >>"$folder/log" 2>&1
mv "$folder/installed" "$prefix"
"$prefix/$bin/brio" --version
[ ! -e "$prefix/brio" ] || {
    echo "a module of Python is installed beside the library" >&2
    exit 1
}
for page in man/man1/brio.1 man/man1/brio-surface.1 bash-completion/completions/brio zsh/site-functions/_brio \
    doc/brio/which-method.md doc/brio/LICENSE; do
    [ -s "$prefix/share/$page" ] || {
        echo "share/$page is not installed" >&2
        exit 1
    }
done

step "find_package"
"$cmake" -S "$consumer" -B "$folder/found" -DCMAKE_C_COMPILER="$cc" -DCMAKE_PREFIX_PATH="$prefix" >>"$folder/log" 2>&1
"$cmake" --build "$folder/found" >>"$folder/log" 2>&1
expect_output "$folder/found/consumer"

step "pkg-config"
if ! command -v pkg-config >/dev/null 2>&1; then
    echo "skipped: install.$kind, the part with pkg-config: there is no such program"
    exit 0
fi
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name brio.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046
"$cc" -o "$folder/configured" "$consumer/consumer.c" $(pkg-config --cflags --libs brio)
LD_LIBRARY_PATH=$(pkg-config --variable=libdir brio)
export LD_LIBRARY_PATH
expect_output "$folder/configured"
