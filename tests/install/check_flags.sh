#!/bin/sh
# check_flags.sh PROGRAM: the program was built as cmake/harden.cmake wants it: at any address, its tables of addresses read-only,
# its stack and the C library's copies checked.
set -u
program=$1
command -v readelf >/dev/null 2>&1 || { echo "skipped: there is no readelf"; exit 77; }
failures=0
# has WHAT PATTERN OPTION: the pattern is in what readelf prints with the option.
has() {
    readelf -W "$3" "$program" | grep -q "$2" && return
    echo "FAILED: $1"
    failures=$((failures + 1))
}
has "position-independent" 'Type: *DYN' -h
has "read-only after relocation" GNU_RELRO -l
has "bound at the start" 'BIND_NOW\|FLAGS_1.*NOW' -d
has "canaries on the stack" __stack_chk_fail -s
has "checked copies" '__[a-z]*_chk' -s
! readelf -W -l "$program" | grep -q 'GNU_STACK.*RWE' || { echo "FAILED: the stack is executable"; failures=$((failures + 1)); }
[ $failures = 0 ]
