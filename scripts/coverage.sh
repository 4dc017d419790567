#!/bin/sh
# coverage.sh JOBS [OPTION OF CTEST...]: builds with clang's counters, runs the tests whose programs are built here and the
# inputs that fuzzers kept (tests/fuzz/corpus, out/fuzz/corpus), and says which lines and branches of src and cli they reach:
# a table by folder, out/coverage/index.html, and what nothing reached: out/coverage/missed.txt has lines, sides.txt sides of
# branches. Files are read and written in blocks of 256 bytes here (src/io/blocks.h), so that they can fail anywhere.
#
# A test that fails does not end the run. Processes that are killed leave no counts.
set -eu

cd "$(dirname "$0")/.."
jobs=$1
shift
out=$PWD/out/coverage
raw=$out/raw

cmake --preset coverage >/dev/null
cmake --build build-coverage -j "$jobs"
rm -rf "$out"
mkdir -p "$raw"
export LLVM_PROFILE_FILE="$raw/%m.profraw" # a file for each program, which its processes add to

# These tests build programs of their own, or none.
ctest --test-dir build-coverage -j 2 -E '^(architecture|docs|install|interface|peers|python|quality)' "$@" |
    tee "$out/tests.log" | grep -E 'tests passed|Failed|Not Run|Timeout' || true
# What fails in the system, once at each point: no other test reaches what answers that.
/usr/bin/python3 tests/faults/faults.py build-coverage/brio build-coverage/tests/faults/libfault.so --jobs "$jobs" --minutes 10 \
    --kinds "open fails" "read fails" "write, flush, close, rename fails" "another call fails" "short read or write" EINTR \
    >"$out/faults.log" 2>&1 || true
for folder in out/fuzz/corpus/*; do
    program=build-coverage/fuzz_${folder##*/}
    if [ -x "$program" ]; then "$program" "$folder" >/dev/null 2>&1 || echo "coverage: $program stops at an input of $folder"; fi
done

llvm-profdata merge -sparse -o "$out/all.profdata" "$raw"/*.profraw
set -- build-coverage/brio -object build-coverage/fuzz_cli -instr-profile "$out/all.profdata" \
    -ignore-filename-regex '/(tests|include|build-coverage)/'
llvm-cov show "$@" -format=html -show-branches=count -output-dir "$out" -project-title brio >/dev/null
llvm-cov export "$@" >"$out/all.json"
/usr/bin/python3 tests/coverage.py "$out/all.json" "$PWD" "$out"
