#!/bin/sh
# run.sh PART PYTHON: a part of the package's tests, for ctest: tests, hostile, types, scipys, gallery or wheel. Status 77 where a package
# is missing.
set -eu

part=$1
python=$2
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/.."

needs() {
    for module in "$@"; do
        "$python" -c "import $module" 2>/dev/null || { echo "skipped: $python has no $module"; exit 77; }
    done
}

tests() { "$python" -m pytest -q -p no:cacheprovider "$@"; }

case $part in
tests) needs pytest numpy && tests tests --ignore tests/scipys --ignore tests/test_hostile.py ;;
hostile) needs pytest numpy && tests tests/test_hostile.py ;;
types) needs mypy numpy && "$python" -m mypy --cache-dir /dev/null --config-file pyproject.toml "$BRIO_PYTHON/brio" ;;
scipys) needs pytest scipy && "$python" tests/scipys/run_scipys_tests.py ;;
gallery) needs matplotlib && "$python" gallery/run.py --check ;;
wheel)
    needs build scikit_build_core
    "$python" -m pip download -q --no-deps -d "${TMPDIR:-/tmp}" numpy >/dev/null 2>&1 || { echo "skipped: no PyPI"; exit 77; }
    sh ../scripts/python.sh wheel
    ;;
esac
