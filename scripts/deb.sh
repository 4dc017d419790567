#!/bin/sh
# deb.sh: makes Debian packages of what is committed, in out/deb, and asks lintian what it thinks of them.
set -eu

cd "$(dirname "$0")/.."
version=$(sed -n '1s/.*(\(.*\)-.*).*/\1/p' packaging/debian/changelog)
folder=out/deb
rm -rf $folder
mkdir -p "$folder/brio-$version"
git archive HEAD | tar -x -C "$folder/brio-$version"
tar -C $folder -czf "$folder/brio_$version.orig.tar.gz" "brio-$version"
cp -r "$folder/brio-$version/packaging/debian" "$folder/brio-$version/debian"
(cd "$folder/brio-$version" && dpkg-buildpackage -us -uc -b) >$folder/log 2>&1 || {
    tail -n 40 $folder/log >&2
    exit 1
}
ls $folder/*.deb
# a package that is not in Debian closes no report of a wish for it
lintian --fail-on error,warning --suppress-tags initial-upload-closes-no-bugs $folder/*.changes
