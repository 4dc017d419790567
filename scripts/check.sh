#!/bin/sh
# check.sh JOBS [all]: builds with warnings as errors and runs every test, then both again under the sanitizers,
# and the parallel tests under the thread sanitizer. `all`: also the tests that are too long for every change.
#
# Each suite runs even when one before it fails. The last line is a closing line of the test runner with its numbers,
# and that of a suite that failed if one did.
set -u

cd "$(dirname "$0")/.." || exit 1
build_jobs=${1:-2}
long=OFF
third=threads
[ "${2:-}" != all ] || long=ON third=stress
# One more than there are processors: many tests wait for a process, a file or a signal.
test_jobs=3
# In the build folder: what the runner printed, and what the tests did.
log=check.log
tests_log=Testing/Temporary/LastTest.log

# A compiler cache, where there is one: tests of the installation, of the interface and of the wheel compile the library again.
if command -v ccache >/dev/null 2>&1; then
    export CMAKE_C_COMPILER_LAUNCHER="${CMAKE_C_COMPILER_LAUNCHER:-ccache}" CCACHE_NOHASHDIR=1
fi

# The packages of the tests come while the first suite is built.
sh scripts/setup.sh packages &
packages=$!

suite() {
    rm -f "build-$1/$log" "build-$1/$tests_log"
    echo "== $1: build"
    started=$(date +%s)
    cmake --preset "$1" -DBRIO_LONG=$long -DBRIO_ALL_SUITES=OFF || return 1
    target=all
    [ "$1" != threads ] || target=unit_tests # all that it runs
    cmake --build "build-$1" -j "$build_jobs" --target "$target" || return 1
    built=$(date +%s)
    wait $packages
    echo "== $1: test"
    ctest --test-dir "build-$1" -j $test_jobs --output-on-failure --no-tests=error --output-log "build-$1/$log"
    status=$?
    echo "== $1: $((built - started)) s to build, $(($(date +%s) - built)) s to test"
    return $status
}

# Why tests were skipped: the runner itself does not show it.
skips() { grep -h '^skipped: ' "build-$1/$tests_log" 2>/dev/null; }

closing_line() {
    echo "== $1"
    grep 'tests passed' "build-$1/$log" 2>/dev/null || echo "no test ran: it did not build"
}

passed=
failed=
for preset in ci sanitize $third; do
    if suite "$preset"; then passed="$preset $passed"; else failed="$preset $failed"; fi
done
echo
for preset in $passed $failed; do skips "$preset"; done
for preset in $passed $failed; do closing_line "$preset"; done
[ -z "$failed" ]
