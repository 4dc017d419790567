#!/bin/sh
# npm.sh page|pack|test [JOBS]: builds the module of wasm/ with the C cross compiler of scripts/setup.sh npm. `page` makes the page
# that takes a file, out/brio.html; `pack` the npm package, out/npm/brio-VERSION.tgz; `test` also installs that in a fresh folder, runs
# wasm/test there, against the program that BRIO names, and checks the types.
set -eu

what=${1:-pack} jobs=${2:-$(nproc)}
root=$(cd "$(dirname "$0")/.." && pwd)
build=$root/build/wasm package=$root/out/npm/package

wrap() { # NAME WORDS: a script that runs a tool of the compiler
    mkdir -p "$build"
    printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$zig" "$2" >"$build/$1"
    chmod +x "$build/$1"
}
zig=$("$root/out/targets-env/bin/python" -c 'import os, ziglang; print(os.path.dirname(ziglang.__file__))')/zig
wrap cc 'cc -target wasm32-wasi -msimd128'
wrap ar ar
wrap ranlib ranlib
cmake -S "$root" -B "$build" -DCMAKE_SYSTEM_NAME=WASI -DCMAKE_SYSTEM_PROCESSOR=wasm32 -DCMAKE_C_COMPILER="$build/cc" \
    -DCMAKE_AR="$build/ar" -DCMAKE_RANLIB="$build/ranlib" -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE="-O2 -DNDEBUG" \
    -DBRIO_TESTS=OFF -DBRIO_USE_ZLIB=OFF -DBRIO_USE_ZSTD=OFF -DBRIO_USE_EXPAT=OFF -DBRIO_USE_CJSON=OFF >"$build/log" 2>&1 ||
    { tail -n 20 "$build/log" >&2; exit 1; }
cmake --build "$build" -j "$jobs" --target brio-wasm >>"$build/log" 2>&1 || { tail -n 20 "$build/log" >&2; exit 1; }

if [ "$what" = page ]; then
    "$root/out/targets-env/bin/python" "$root/scripts/cross.py" "$build" module
    node "$root/web/build.mjs" "$build/brio-module.wasm" "$root/out/brio.html"
    exit 0
fi

# The package: what its folder holds is what is packed. The version is the library's.
rm -rf "$package" && mkdir -p "$package"
cp "$root"/wasm/*.mjs "$root"/wasm/*.d.ts "$root/wasm/README.md" "$root/LICENSE" "$package/"
"$root/out/targets-env/bin/python" "$root/scripts/cross.py" "$package" module
cp "$build/brio-module.wasm" "$package/brio.wasm" && chmod 644 "$package/brio.wasm"
version=$(sed -n 's/^#define BRIO_VERSION  *"\(.*\)"/\1/p' "$root/include/brio/context.h")
sed "s/\"version\": \"0.0.0\"/\"version\": \"$version\"/" "$root/wasm/package.json" >"$package/package.json"
cd "$root/out/npm" && rm -f ./*.tgz && npm pack --silent ./package
[ "$what" = test ] || exit 0

typescript=5.9.3
rm -rf try && mkdir try && cd try
printf '{ "private": true, "type": "module" }\n' >package.json
npm install --silent --no-audit --no-fund --ignore-scripts ../brio-"$version".tgz typescript@$typescript @types/node@20
cp "$root"/wasm/test/* .
node --expose-gc --test .
node browser.mjs "$root/out/web-env" || [ $? = 77 ]
npx tsc --noEmit --strict --module nodenext --target es2024 --lib es2024,dom --types node types.ts
echo "npm: tests and types hold; $(wc -c <../brio-"$version".tgz) bytes packed"
