#!/usr/bin/env python3
"""pack.py WHEELS OUT.zip: the extension of Blender, with the wheels of a folder for the systems that Blender has:
those of the extension's version."""
import pathlib
import re
import sys
import zipfile

PLATFORMS = {"manylinux2014_x86_64": "linux-x64", "win_amd64": "windows-x64", "arm64": "macos-arm64", "macosx_13_0_x86_64": "macos-x64"}


def main(wheels, out):
    here = pathlib.Path(__file__).resolve().parent
    manifest = (here / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"', manifest, re.M).group(1)
    found = {}
    for wheel in sorted(pathlib.Path(wheels).glob("brio_geometry-%s-*.whl" % version)):
        tag = wheel.stem.split("-")[-1]
        for word, platform in PLATFORMS.items():
            if tag.startswith(word) or tag.endswith("_" + word):
                found[platform] = wheel
    if not found:
        raise SystemExit("%s: no wheels of version %s; make wheels makes them" % (wheels, version))
    manifest = manifest.replace("@PLATFORMS@", ", ".join('"%s"' % p for p in sorted(found)))
    manifest = manifest.replace("@WHEELS@", "".join('  "./wheels/%s",\n' % w.name for w in found.values()))
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        archive.write(here / "__init__.py", "__init__.py")
        for wheel in found.values():
            archive.write(wheel, "wheels/" + wheel.name)
    print("%s: %s" % (out, ", ".join(sorted(found))))


if __name__ == "__main__":
    main(*sys.argv[1:])
