#!/usr/bin/env python3
"""check.py ROOT OUT: tries the recipes for conda, vcpkg and Homebrew as far as their tools can be had.

    versions   each recipe names the version of include/brio/context.h
    conda      rattler-build, of PyPI, reads the recipe for three platforms, then builds the package and runs its tests. No channel can be
               had, so that what it asks for are empty packages, and the compiler and the libraries are this machine's
    vcpkg      vcpkg.cmake stands for vcpkg: its functions build and install as vcpkg's do, and say what vcpkg would refuse
    homebrew   formula.rb stands for Homebrew, likewise

A recipe whose tool is missing is skipped with a reason. The exit status is 1 where something fails."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

CONDA_PLATFORMS = ['linux-64', 'linux-aarch64', 'osx-arm64']


class Wrong(Exception):
    pass


def run(words, **more):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)
    if done.returncode:
        raise Wrong('%s: exit %d: %s' % (words[0], done.returncode, (done.stdout + done.stderr)[-1500:]))
    return done.stdout


def version_of(root):
    return re.search(r'#define BRIO_VERSION\s+"(.*)"', (root / 'include/brio/context.h').read_text()).group(1)


def versions(root, _):
    version, packaging = version_of(root), root / 'packaging'
    found = {'conda': re.search(r'version: "(.*)"', (packaging / 'conda/recipe.yaml').read_text()).group(1),
             'vcpkg': json.loads((packaging / 'vcpkg/vcpkg.json').read_text())['version'],
             'debian': re.match(r'brio \((.*)-', (packaging / 'debian/changelog').read_text()).group(1)}
    wrong = ['%s has %s' % pair for pair in found.items() if pair[1] != version]
    if wrong:
        raise Wrong('%s, the library %s' % (', '.join(wrong), version))
    return version


def conda(root, out):
    python = root / 'out/recipes-env/bin/python'
    if not python.exists():
        return 'skipped: no rattler-build: scripts/setup.sh recipes'
    return run([python, root / 'packaging/check/conda.py', root / 'packaging/conda', out, *CONDA_PLATFORMS]).splitlines()[-1]


def vcpkg(root, out):
    run(['cmake', '-DCURRENT_PACKAGES_DIR=%s/packages' % out, '-DCURRENT_BUILDTREES_DIR=%s/build' % out,
         '-DPORT=%s/packaging/vcpkg' % root, '-P', root / 'packaging/check/vcpkg.cmake'])
    wanted = ['share/brio/brioConfig.cmake', 'share/brio/copyright', 'tools/brio/brio', 'include/brio/brio.h', 'lib/pkgconfig/brio.pc']
    missing = [name for name in wanted if not (out / 'packages' / name).exists()]
    if missing:
        raise Wrong('not installed: ' + ', '.join(missing))
    return 'built and installed by stand-ins of its functions'


def homebrew(root, out):
    if not shutil.which('ruby'):
        return 'skipped: no ruby: scripts/setup.sh recipes'
    return run(['ruby', root / 'packaging/check/formula.rb', root / 'packaging/homebrew/brio.rb', out], cwd=root).splitlines()[-1]


def main():
    root, out = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
    failed = False
    for check in versions, conda, vcpkg, homebrew:
        folder = out / check.__name__
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            print('%-10s %s' % (check.__name__, check(root, folder)), flush=True)
        except Wrong as wrong:
            failed = True
            print('%-10s FAILED: %s' % (check.__name__, wrong), flush=True)
    return failed


if __name__ == '__main__':
    sys.exit(main())
