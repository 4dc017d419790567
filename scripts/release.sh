#!/bin/sh
# release.sh: gathers in build/release what a release has, of what is committed: the sources, the Python packages (make wheels),
# the npm package and the page that takes a file (make npm, make page), the Debian packages (make deb), the programs of build/targets that
# make targets built and tried of these sources, unless one failed, the extension of Blender, and SHA256SUMS of them all. It signs nothing
# and uploads nothing: docs/release.md says what is left to do.
set -eu

cd "$(dirname "$0")/.."
if [ -n "$(git status --porcelain --untracked-files=no)" ]; then
    echo "release: what is changed is not committed" >&2
    exit 1
fi
version=$(sed -n 's/^__version__ = "\(.*\)"/\1/p' python/src/brio/_version.py)
release=build/release parts=build/release-parts
rm -rf "$release" "$parts"
mkdir -p "$release" "$parts"

git archive --prefix="brio-$version/" HEAD >"$parts/sources.tar"
gzip -9n <"$parts/sources.tar" >"$release/brio-$version.tar.gz"
cp build/wheels/brio_geometry-"$version"-*.whl build/wheels/brio_geometry-"$version".tar.gz "$release/"
cp out/npm/brio-"$version".tgz "$release/brio-$version-npm.tgz"
cp out/brio.html "$release/brio-$version.html"
cp out/deb/*.deb "$release/" 2>/dev/null || echo "release: no Debian packages; make deb makes them" >&2

tar -C "$parts" -xf "$parts/sources.tar"
made_of=$(python3 "$parts/brio-$version/scripts/cross.py" --made-of) # of what is committed, whatever lies beside it
for target in $(python3 scripts/cross.py --names); do
    folder=build/targets/$target archive=brio-$version-$target
    if [ "$made_of" != "$(cat "$folder/made-of" 2>/dev/null)" ]; then
        echo "release: left out $target: make targets has not built and tried it of these sources" >&2
        continue
    fi
    failed=$(awk -F '\t' -v target="$target" '$1 == target && ($5 !~ /^0?$/ || $6 ~ /^different/) { print $5 ~ /^0?$/ ? $6 : $5 }' build/targets/TABLE.tsv)
    if [ -n "$failed" ]; then
        echo "release: left out $target, which failed: $failed" >&2
        continue
    fi
    mkdir "$parts/$archive"
    for program in brio brio.exe brio.wasm; do
        [ ! -f "$folder/$program" ] || cp "$folder/$program" "$parts/$archive/"
    done
    cp LICENSE README.md "$parts/$archive/"
    python3 scripts/cross.py "$parts/$archive" "$target"
    tar -C "$parts" --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 -cf - "$archive" | gzip -9n >"$release/$archive.tar.gz"
done
rm -rf "$parts"
python3 integrations/blender/pack.py build/wheels "$release/brio-blender-$version.zip"
(cd "$release" && sha256sum -- * >SHA256SUMS)
cat "$release/SHA256SUMS"
