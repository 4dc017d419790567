#!/bin/sh
# check.sh JOBS: builds with warnings as errors and runs every test, then both again under the sanitizers,
# and the parallel tests under the thread sanitizer.
#
# The second suite runs even when the first fails. The last line is a closing line of the test runner with its numbers,
# and that of a suite that failed if one did.
set -u

cd "$(dirname "$0")/.." || exit 1
build_jobs=${1:-2}
# Few at a time, since each test has several threads or processes itself.
test_jobs=2
# In the build folder: what the runner printed, and what the tests did.
log=check.log
tests_log=Testing/Temporary/LastTest.log

suite() {
    rm -f "build-$1/$log" "build-$1/$tests_log"
    echo "== $1: build"
    cmake --preset "$1" && cmake --build "build-$1" -j "$build_jobs" || return 1
    echo "== $1: test"
    ctest --test-dir "build-$1" -j $test_jobs --output-on-failure --no-tests=error --output-log "build-$1/$log"
}

# Why tests were skipped: the runner itself does not show it.
skips() { grep -h '^skipped: ' "build-$1/$tests_log" 2>/dev/null; }

closing_line() {
    echo "== $1"
    grep 'tests passed' "build-$1/$log" 2>/dev/null || echo "no test ran: it did not build"
}

passed=
failed=
for preset in ci sanitize threads; do
    if suite "$preset"; then passed="$preset $passed"; else failed="$preset $failed"; fi
done
echo
for preset in $passed $failed; do skips "$preset"; done
for preset in $passed $failed; do closing_line "$preset"; done
[ -z "$failed" ]
