#!/bin/sh
# check_setup.sh SOURCE: `make` installs nothing unless it is asked to. Runs scripts/setup.sh where tools are missing, with an
# apt-get that only writes down how it was called.
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/tools"
for tool in sh sed sort head mktemp rm xargs id cat tail echo printf make; do
    found=$(PATH=/usr/bin:/bin command -v "$tool")
    case $found in /*) ;; *) found=/usr/bin/$tool ;; esac
    ln -s "$found" "$folder/tools/$tool"
done
for tool in apt-get apt-cache; do
    printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\n' "$tool" "$folder" >"$folder/tools/$tool"
    chmod +x "$folder/tools/$tool"
done
failures=0
fail() {
    echo "FAILED $1"
    cat "$folder/said"
    failures=$((failures + 1))
}

cd "$source" || exit 1
PATH=$folder/tools CC=no-compiler make all >"$folder/said" 2>&1 && fail "make all goes on without cmake"
grep -q 'sudo apt-get install .*cmake' "$folder/said" || fail "make all does not say what to install"
[ ! -e "$folder/calls" ] || fail "make all calls apt-get"
if [ "$(id -u)" = 0 ]; then
    PATH=$folder/tools CC=no-compiler make setup >"$folder/said" 2>&1
    grep -q 'apt-get install .*cmake' "$folder/calls" || fail "make setup does not install"
    rm -f "$folder/calls"
    PATH=$folder/tools CC=no-compiler make demo >"$folder/said" 2>&1
    grep -q 'apt-get install .*cmake' "$folder/calls" || fail "make demo does not install"
else
    echo "skipped: make setup and make demo, which install as root only"
fi
[ $failures = 0 ]
