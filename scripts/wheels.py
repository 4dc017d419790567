#!/usr/bin/env python3
"""wheels.py ROOT OUT PYTHON [--only NAME,...]: the Python package for every system that it is for, from one machine.

Makes an sdist and a wheel for each target of scripts/cross.py that has a tag: the module, compiled for it; the package's sources; the
licences of the libraries inside. Python's headers are those of PYTHON; that of the system is packaging/python/pyconfig.h. A module asks
Python for functions of the limited API of 3.11 alone; on Windows they are in python3.dll, whose import library is made from the table
in Python's sources. Each wheel is checked:

    size        under MOST_BYTES
    symbols     those of glibc are of 2.17 at the latest; libraries are those that every such system has
    limits      what is asked of Python is in the table of the limited API

The files are in OUT, and OUT/WHEELS.tsv says: file, bytes, what it asks its system for."""
import argparse
import base64
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cross  # noqa: E402

MOST_BYTES = 3_000_000
WHEN = (2020, 1, 1, 0, 0, 0)  # of every file in a wheel, so that the same sources make the same wheel
# Libraries that a system of a kind has, by its name for CMake.
SYSTEMS_OWN = {
    'Linux': r'lib(c|m|pthread|dl|rt)\.so(\.\d+)?|ld-linux[\w.-]*\.so\.\d|libc\.musl-\w+\.so\.1',
    'Windows': r'(kernel32|shell32|advapi32|ntdll|python3|api-ms-win-[\w-]+)\.dll',
    'Darwin': r'/usr/lib/libSystem\.B\.dylib',
}


def run(words, **more):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True, **more).stdout


def limited_api(root):
    """The names of the limited API of Python 3.11: functions and data, by its own table."""
    archive = next((root / 'out/library-sources').glob('python3.11_*.orig.tar.gz'))
    with tarfile.open(archive) as python:
        name = next(n for n in python.getnames() if n.endswith('/PC/python3dll.c'))
        text = python.extractfile(name).read().decode()
    return [set(re.findall(r'^EXPORT_%s\((\w+)\)' % kind, text, re.M)) for kind in ('FUNC', 'DATA')]


def import_library(root, out, target, api):
    """The import library of python3.dll."""
    tools = cross.tools_of(root, target)
    functions, data = api
    definition = out / 'python3.def'
    definition.write_text('LIBRARY python3.dll\nEXPORTS\n' + ''.join('  %s\n' % n for n in sorted(functions)) +
                          ''.join('  %s DATA\n' % n for n in sorted(data)))
    library = out / 'libpython3.a'
    run([tools['dlltool'], '-m', 'i386:x86-64', '-d', definition, '-l', library, '-D', 'python3.dll'])
    return library


def headers(root, out, python):
    """Python's headers with the project's pyconfig.h: that beside Python.h is found first, and is of this system."""
    folder = out / 'include'
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(run([python, '-c', 'import sysconfig; print(sysconfig.get_path("include"))']).strip(), folder)
    shutil.copy(root / 'packaging/python/pyconfig.h', folder / 'pyconfig.h')
    return folder


def compile_module(root, out, target, include, api):
    folder = root / 'build' / ('wheel-' + target.name)  # as deep as tests/targets builds: ccache then knows the objects
    options = {**cross.options_of(root, target), 'BRIO_PYTHON_INCLUDE': include}
    if target.system == 'Windows':
        options['BRIO_PYTHON_LIBRARY'] = import_library(root, out, target, api)
    cross.configure_and_build(root / 'python', folder, options, ['brio-native'])
    return next(p for p in (folder / 'brio').iterdir() if p.name.startswith('_native') and p.suffix in ('.so', '.pyd'))


def needs_of(module, target, api):
    """The libraries and versions that a module asks for, and what of it is wrong."""
    data = module.read_bytes()
    pattern = {'Linux': rb'\0((?:lib|ld-)[\w.+-]+\.so[.\d]*)(?=\0)', 'Windows': rb'([\w-]+\.dll)(?=\0)', 'Darwin': rb'((?:/usr/lib|/System)/[\w./+-]+\.dylib)'}
    libraries = {m.decode() for m in re.findall(pattern[target.system], data, re.I)} - {module.name}
    wrong = ['library ' + n for n in sorted(libraries) if not re.fullmatch(SYSTEMS_OWN[target.system], n, re.I)]
    versions = sorted({v.decode() for v in re.findall(rb'GLIBC_(2\.[\d.]+)', data)}, key=lambda v: int(v.split('.')[1]))
    wrong += ['GLIBC_' + v for v in versions if int(v.split('.')[1]) > 17]
    names = {m.decode() for m in re.findall(rb'(?<!\w)(_{0,2}Py\w*_\w+)(?=\0)', data)}
    # on macOS C's names begin with _, and a call that is far has a local name of the linker's
    asked = {n[1:] for n in names if n[0] == '_' and not n.endswith('__thunk')} if target.system == 'Darwin' else names
    wrong += ['not limited: ' + n for n in sorted(asked - api[0] - api[1] - {'PyInit__native'})]
    return sorted(libraries) + ['GLIBC_' + v for v in versions[-1:]], wrong


def make_sdist(root, out, python):
    run([python, '-m', 'build', '--sdist', '--no-isolation', '--outdir', out, root / 'python'])
    sdist = max(out.glob('brio_geometry-*.tar.gz'), key=lambda p: p.stat().st_mtime)
    with tarfile.open(sdist) as archive:
        facts = archive.extractfile(sdist.name[:-len('.tar.gz')] + '/PKG-INFO').read()
    return sdist, facts


def package_of(root, module, facts, target, version):
    """The files of a wheel, by their names in it."""
    information = 'brio_geometry-%s.dist-info/' % version
    files = {p.relative_to(root / 'python/src').as_posix(): p.read_bytes() for p in sorted((root / 'python/src/brio').rglob('*'))
             if p.suffix in ('.py', '.pyi', '.typed')}
    files['brio/' + module.name] = module.read_bytes()
    tags = ''.join('Tag: cp311-abi3-%s\n' % p for p in target.platform.split('.'))
    files[information + 'METADATA'] = facts
    files[information + 'WHEEL'] = ('Wheel-Version: 1.0\nGenerator: brio\nRoot-Is-Purelib: false\n' + tags).encode()
    files[information + 'licenses/LICENSE'] = (root / 'LICENSE').read_bytes()
    for name, notice in cross.notices_of(root, cross.c_library(target)).items():
        files[information + 'licenses/' + name] = notice
    rows = ['%s,sha256=%s,%d' % (name, base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode(), len(data))
            for name, data in files.items()]
    files[information + 'RECORD'] = ('\n'.join([*rows, information + 'RECORD,,']) + '\n').encode()
    return files


def write_wheel(path, files):
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, WHEN)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('root', type=pathlib.Path)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('python', type=pathlib.Path)
    parser.add_argument('--only', default='', help='names of targets, with commas')
    a = parser.parse_args()
    root, out = a.root.resolve(), a.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    api = limited_api(root)
    include = headers(root, out, a.python)
    sdist, facts = make_sdist(root, out, a.python)
    version = sdist.name[len('brio_geometry-'):-len('.tar.gz')]
    rows, failed = ['%s\t%d\t' % (sdist.name, sdist.stat().st_size)], False
    for target in cross.TARGETS:
        if not target.platform or (a.only and target.name not in a.only.split(',')):
            continue
        module = compile_module(root, out, target, include, api)
        path = out / ('brio_geometry-%s-cp311-abi3-%s.whl' % (version, target.platform))
        write_wheel(path, package_of(root, module, facts, target, version))
        needs, wrong = needs_of(module, target, api)
        size = path.stat().st_size
        wrong += ['%d bytes' % size] * (size >= MOST_BYTES)
        failed |= bool(wrong)
        rows.append('%s\t%d\t%s' % (path.name, size, 'WRONG: ' + ', '.join(wrong) if wrong else ' '.join(needs)))
        print(rows[-1], flush=True)
    table = out / 'WHEELS.tsv'
    named = {line.split('\t')[0] for line in rows}  # those of other targets stay, while their files are there
    kept = [line for line in (table.read_text().splitlines()[1:] if table.exists() else []) if line.split('\t')[0] not in named]
    rows += [line for line in kept if (out / line.split('\t')[0]).exists()]
    table.write_text('\n'.join(['file\tbytes\tneeds', *rows]) + '\n')
    return failed


if __name__ == '__main__':
    sys.exit(main())
