#!/bin/sh
# site.sh BUILD: the documentation as a site, in out/site: pages of docs/, the manual of C from the headers (Doxygen), and pages of
# the gallery and of the theory, which the commands of docs/gallery.md, docs/theory.md and docs/start make. With PICTURES=1 also docs/images/gallery, by Chromium.
#
# BUILD is the folder of a build of brio.
set -eu

build=$1
environment=out/site-env
prefix="$PWD/out/site-prefix"

# What the environment is made of: the packages, and the sources of the module, which has the library in it.
made_of=$(cat docs/requirements.txt; find python src include cmake CMakeLists.txt web/page.html -type f ! -name '*.pyc' ! -path '*/build/*' |
    LC_ALL=C sort | xargs sha256sum | sha256sum)
if [ "$made_of" != "$(cat "$environment/made-of" 2>/dev/null)" ]; then
    [ -x "$environment/bin/pip" ] || /usr/bin/python3 -m venv "$environment"
    "$environment/bin/pip" install -q --no-compile -r docs/requirements.txt ./python # a folder is always installed anew
    printf '%s\n' "$made_of" >"$environment/made-of"
fi
cmake --install "$build" --prefix "$prefix" >/dev/null

export BRIO_GALLERY="$PWD/out/gallery" NO_MKDOCS_2_WARNING=1 PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
export PATH="$prefix/bin:$PWD/$environment/bin:$PATH"
rm -rf "$BRIO_GALLERY" out/site
mkdir -p "$BRIO_GALLERY"
/usr/bin/python3 scripts/run_page.py "$BRIO_GALLERY" docs/gallery.md docs/theory.md docs/start/*.md
shown=$(grep -oh 'images/gallery/[a-z_-]*' docs/*.md docs/start/*.md | sed 's|.*/||' | LC_ALL=C sort -u)
# shellcheck disable=SC2086
[ "${PICTURES:-}" != 1 ] || node scripts/pictures.mjs "$BRIO_GALLERY" docs/images/gallery $shown
"$environment/bin/mkdocs" build -q
doxygen docs/Doxyfile
/usr/bin/python3 scripts/site_links.py out/site
echo "Written: out/site; open out/site/index.html in a browser"
