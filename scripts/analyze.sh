#!/bin/sh
# analyze.sh JOBS [FILE...]: clang-tidy (.clang-tidy), cppcheck and gcc's analyzer over the sources, or some of them. Fails on
# findings that scripts/analysis.txt does not explain, and where a tool fails. A tool that is missing is left out, with a line
# that says so. docs/measured/reliability.md: "Analysis".
set -u
cd "$(dirname "$0")/.." || exit 1
jobs=$1
shift
failures=0
everything=
[ $# -gt 0 ] || { everything=all && set -- $(find src cli -name '*.c' | LC_ALL=C sort); }
files=$*
build=build-analyze
cmake -S . -B $build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DBRIO_TESTS=OFF -DBRIO_HARDEN=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null || exit 1

# each TOOL OPTION...: runs the tool with each file, several at once, each with its own log; says how it went.
each() {
    tool=$1
    command -v "$tool" >/dev/null 2>&1 || { echo "skipped: there is no $tool"; return; }
    logs=$build/$tool
    rm -rf $logs && mkdir $logs
    # shellcheck disable=SC2016,SC2086
    printf '%s\n' $files | LC_ALL=C LOGS=$logs xargs -P "$jobs" -I FILE sh -c \
        'file=$1 && shift && "$@" "$file" >"$LOGS/$(echo "$file" | tr / -)" 2>&1 || { echo "$file: $1 failed" && exit 1; }' \
        sh FILE "$@" || failures=$((failures + 1))
    python3 scripts/explained.py "$tool" $logs scripts/analysis.txt $everything || failures=$((failures + 1))
}

each clang-tidy -p $build --quiet
each cppcheck --quiet --std=c11 --suppressions-list=scripts/cppcheck.txt --enable=warning,performance,portability -Iinclude -Isrc \
    '--template={file}:{line}:{column}: {severity}: {message} [{id}]' --template-location=
# 40: at the 8 states of a place that are standard, gcc forgets how often a loop of three or four steps went round
each gcc -fanalyzer --param=analyzer-max-enodes-per-program-point=40 -O1 -std=gnu11 -ffp-contract=off -mavx512f -mavx512dq \
    -mavx512vl -mfma -DBRIO_HAS_ZLIB -DBRIO_HAS_EXPAT -Iinclude -Isrc -Icli -c -o /dev/null
[ $failures = 0 ]
