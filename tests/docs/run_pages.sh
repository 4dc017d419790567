#!/bin/sh
# run_pages.sh SOURCE BUILD PYTHON PAGE...: the commands of pages, as they stand, with brio as it is installed and the Python package of the
# build. A page whose commands need what is missing is left out, and said.
set -eu

source=$1
build=$2
python=$3
shift 3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/prefix" >/dev/null
mkdir "$folder/bin" "$folder/pages"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >"$folder/bin/python3"
chmod +x "$folder/bin/python3"
PKG_CONFIG_PATH=$(dirname "$(find "$folder/prefix" -name brio.pc)")
export PKG_CONFIG_PATH PYTHONPATH="$build/python" PATH="$folder/bin:$folder/prefix/bin:$PATH"

for page; do
    case $page in
    docs/start/c.md) command -v pkg-config >/dev/null || { echo "skipped: $page: there is no pkg-config"; continue; } ;;
    README.md) command -v pkg-config >/dev/null && python3 -c 'import brio' 2>/dev/null ||
        { echo "skipped: $page: there is no pkg-config, or no Python package"; continue; } ;;
    docs/start/python.md) python3 -c 'import brio' 2>/dev/null || { echo "skipped: $page: there is no Python package"; continue; } ;;
    esac
    /usr/bin/python3 "$source/scripts/run_page.py" "$folder/pages" "$source/$page"
done
