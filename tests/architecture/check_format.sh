#!/bin/sh
# check_format.sh ROOT: every C file is as clang-format leaves it.
set -u

cd "$1" || exit 1
if ! command -v clang-format >/dev/null 2>&1; then
    echo "skipped: architecture.format: there is no clang-format"
    exit 77
fi
clang-format --version
find src cli include tests examples \( -name '*.c' -o -name '*.h' \) -print0 | xargs -0 clang-format --dry-run -Werror
