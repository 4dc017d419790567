#!/bin/sh
# release.sh: gathers in build/release what a release has, of what is committed: the sources, the Python packages (make wheels),
# the npm package and the page that takes a file (make npm, make page), the Debian packages (make deb), the programs of
# build/targets (make targets), unless the sources are younger, the extension of Blender, and SHA256SUMS of them all. It signs nothing and uploads
# nothing: docs/release.md says what is left to do.
set -eu

cd "$(dirname "$0")/.."
version=$(sed -n 's/^__version__ = "\(.*\)"/\1/p' python/src/brio/_version.py)
release=build/release
rm -rf "$release"
mkdir -p "$release"

if [ -n "$(git status --porcelain --untracked-files=no)" ]; then
    echo "release: what is changed is not committed" >&2
    exit 1
fi
git archive --prefix="brio-$version/" HEAD | gzip -9n >"$release/brio-$version.tar.gz"
cp build/wheels/brio_geometry-"$version"*.whl build/wheels/brio_geometry-"$version".tar.gz "$release/"
cp out/npm/brio-"$version".tgz "$release/brio-$version-npm.tgz"
cp out/brio.html "$release/brio-$version.html"
cp out/deb/*.deb "$release/" 2>/dev/null || echo "release: no Debian packages; make deb makes them" >&2
changed=$(git log -1 --format=%ct -- src cli include cmake CMakeLists.txt)
left_out=
for target in $(python3 scripts/cross.py --names); do
    folder=build/targets/$target/ found=
    for program in brio brio.exe brio.wasm; do
        [ -f "$folder$program" ] && [ "$(stat -c %Y "$folder$program")" -ge "$changed" ] || continue
        found=1
        archive=brio-$version-$target
        mkdir -p "build/release-parts/$archive"
        cp "$folder$program" LICENSE README.md "build/release-parts/$archive/"
        python3 scripts/cross.py "build/release-parts/$archive" "$target"
        tar -C build/release-parts --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 -cf - "$archive" | gzip -9n >"$release/$archive.tar.gz"
    done
    [ "$found" ] || left_out="$left_out $target"
done
rm -rf build/release-parts
[ -z "$left_out" ] || echo "release: left out, since make targets has not built them of these sources:$left_out" >&2
python3 integrations/blender/pack.py build/wheels "$release/brio-blender-$version.zip"
(cd "$release" && sha256sum -- * >SHA256SUMS)
cat "$release/SHA256SUMS"
