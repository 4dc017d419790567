#!/bin/sh
# analyze.sh JOBS [FILE...]: clang-tidy (.clang-tidy), cppcheck and gcc's analyzer over the sources, or some of them. Fails on
# what they find; a tool that is missing is left out, with a line that says so. Findings that are none are explained where they
# are suppressed. docs/reliability.md: "Analysis".
set -u
cd "$(dirname "$0")/.." || exit 1
jobs=$1
shift
failures=0
[ $# -gt 0 ] || set -- $(find src cli -name '*.c' | LC_ALL=C sort)
files=$*
build=build-analyze
cmake -S . -B $build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DBRIO_TESTS=OFF -DBRIO_HARDEN=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null || exit 1

# each TOOL COMMAND...: runs the command with each file, several at once; says how it went.
each() {
    tool=$1
    shift
    command -v "$tool" >/dev/null 2>&1 || { echo "skipped: there is no $tool"; return; }
    log=$build/$tool.log
    # shellcheck disable=SC2086
    if printf '%s\n' $files | xargs -P "$jobs" -n 1 "$@" >$log 2>$log.errors; then
        echo "$tool: nothing found in $(printf '%s\n' $files | wc -l) files"
    else
        cat $log
        grep -h 'error:\|warning:' $log.errors
        echo "$tool: see $log"
        failures=$((failures + 1))
    fi
}

each clang-tidy clang-tidy -p $build --quiet
each cppcheck cppcheck --quiet --std=c11 --inline-suppr --suppressions-list=scripts/cppcheck.txt --error-exitcode=1 \
    --enable=warning,performance,portability -Iinclude -Isrc
each gcc gcc -fanalyzer -Werror -O1 -std=gnu11 -ffp-contract=off -mavx512f -mavx512dq -mavx512vl -mfma -DBRIO_HAS_ZLIB \
    -DBRIO_HAS_EXPAT -Iinclude -Isrc -Icli -c -o /dev/null
[ $failures = 0 ]
