#!/usr/bin/env python3
"""targets.py ROOT OUT PYTHON [--only NAME,...] [--no-units]: brio for every system that it is for, from one machine.

Builds the program and the unit tests for each target of TARGETS with the C cross compiler of the Python package ziglang, which
PYTHON has (scripts/setup.sh targets installs it), without optional libraries. What can run here runs: in emulation where it must. It runs

    units       the suites of tests/unit that the target's C library has the headers for
    contract    files of tests/cli, with the target's program
    checksums   OPERATIONS on the points of KINDS, compared with the program of this machine's compiler, bit by bit

and writes OUT/TABLE.tsv: target, built, ran, passed, failed, checksums. A target that cannot run here says why; of one for macOS the
symbols that the program asks its system for are listed and checked. The exit status is 1 where something fails or differs."""
import argparse
import collections
import contextlib
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

Target = collections.namedtuple('Target', 'name triple system processor runner contract')

LINUX_CONTRACT = ['delaunay', 'hull', 'check', 'wrong_uses', 'output', 'pipes', 'info', 'salvage']
ANY_CONTRACT = ['delaunay', 'hull', 'check', 'info']  # the others ask for files of POSIX: /dev/stdout, modes, links
TARGETS = [
    Target('linux-x86_64-glibc2.17', 'x86_64-linux-gnu.2.17', 'Linux', 'x86_64', '', LINUX_CONTRACT),
    Target('linux-aarch64-glibc2.17', 'aarch64-linux-gnu.2.17', 'Linux', 'aarch64', 'qemu-aarch64', LINUX_CONTRACT),
    Target('linux-x86_64-musl', 'x86_64-linux-musl', 'Linux', 'x86_64', '', LINUX_CONTRACT),
    Target('linux-aarch64-musl', 'aarch64-linux-musl', 'Linux', 'aarch64', 'qemu-aarch64', LINUX_CONTRACT),
    Target('windows-x86_64', 'x86_64-windows-gnu', 'Windows', 'x86_64', 'wine', ANY_CONTRACT),
    Target('windows-aarch64', 'aarch64-windows-gnu', 'Windows', 'aarch64', None, []),
    Target('macos-x86_64', 'x86_64-macos', 'Darwin', 'x86_64', None, []),
    Target('macos-aarch64', 'aarch64-macos', 'Darwin', 'aarch64', None, []),
    Target('wasm32-wasi', 'wasm32-wasi', 'WASI', 'wasm32', 'node', ANY_CONTRACT),
]

KINDS = {'cube': 3000, 'grid': 1000, 'sphere': 1500, 'clusters': 1500, 'depth': 1500, 'torus': 1200}
OPERATIONS = {  # name: arguments; a name that ends with an extension compares the file, any other the report's checksum
    'delaunay': ['delaunay'],
    'regular': ['delaunay', '--weights-mod', '-30'],
    'plane': ['delaunay', '--plane', 'xy'],
    'surface.ply': ['surface', '--ascii'],
    'cells.csv': ['voronoi', '--ascii'],
}
# What a macOS program may ask its system for, apart from the C library that POSIX describes.
MACOS_LIBRARIES = {'/usr/lib/libSystem.B.dylib'}


def write_script(path, text):
    path.write_text('#!/bin/sh\n' + text + '\n')
    path.chmod(0o755)
    return path


def options_of(root, out, python, target):
    """What CMake is told: wrappers of the compiler, which is one program with a word for each tool."""
    tools = out / 'tools'
    tools.mkdir(parents=True, exist_ok=True)
    zig = run([python, '-c', 'import ziglang, os; print(os.path.dirname(ziglang.__file__))'], check=True).stdout.decode().strip() + '/zig'
    compiler = write_script(tools / ('cc-' + target.triple), 'exec %s cc -target %s "$@"' % (zig, target.triple))
    options = {'CMAKE_SYSTEM_NAME': target.system, 'CMAKE_SYSTEM_PROCESSOR': target.processor, 'CMAKE_C_COMPILER': compiler,
               'CMAKE_AR': write_script(tools / 'ar', 'exec %s ar "$@"' % zig),
               'CMAKE_RANLIB': write_script(tools / 'ranlib', 'exec %s ranlib "$@"' % zig),
               'CMAKE_BUILD_TYPE': 'Release', 'CMAKE_C_FLAGS_RELEASE': '-O2 -DNDEBUG',
               'BRIO_USE_ZLIB': 'OFF', 'BRIO_USE_ZSTD': 'OFF', 'BRIO_USE_EXPAT': 'OFF', 'BRIO_USE_CJSON': 'OFF'}
    if shutil.which('ccache'):
        options['CMAKE_C_COMPILER_LAUNCHER'] = 'ccache'
    return options


def build(root, out, python, target, units):
    """Returns the folder of the target's programs; a RuntimeError names the log."""
    folder = out / target.name
    folder.mkdir(parents=True, exist_ok=True)
    options = options_of(root, out, python, target)
    goals = ['brio-cli'] + ['unit_tests'] * units
    with open(folder / 'log', 'w') as log:
        for command in (['cmake', '-S', root, '-B', folder] + ['-D%s=%s' % pair for pair in options.items()],
                        ['cmake', '--build', folder, '-j', str(os.cpu_count()), '--target', *goals]):
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                raise RuntimeError('does not build, see %s' % log.name)
    return folder


def runner_of(root, folder, target, name):
    """A script that runs a program of the target here, or None and why not."""
    program = next((folder / (name + end) for end in ('', '.exe', '.wasm') if (folder / (name + end)).is_file()), None)
    if program is None:
        return None, 'no %s' % name
    if target.runner is None:
        return None, 'nothing runs it here'
    if target.runner and not shutil.which(target.runner):
        return None, '%s is missing' % target.runner
    words = {'node': 'node --no-warnings %s/tests/targets/wasi.mjs' % root}
    return write_script(folder / ('run-' + name), 'exec %s %s "$@"' % (words.get(target.runner, target.runner), program)), ''


def run(words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, stdin=subprocess.DEVNULL, timeout=1800, **more)


@contextlib.contextmanager
def wine(out):
    """Wine's own processes, which start once: they would hold the pipes of the program that starts them."""
    if not shutil.which('wine'):
        yield
        return
    os.environ.update(WINEPREFIX=str(out / 'wine'), WINEDEBUG='-all')
    server = next((p for p in ('/usr/lib/wine/wineserver64', '/usr/lib/wine/wineserver') if os.path.exists(p)), 'wineserver')
    quiet = dict(stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    subprocess.run([server, '-p'], **quiet)
    subprocess.run(['wine', 'wineboot'], timeout=600, **quiet)
    try:
        yield
    finally:
        subprocess.run([server, '-k'], **quiet)


def run_units(script):
    """Suites that pass, and the names of those that fail."""
    passed, failed = 0, []
    for suite in run([script]).stdout.decode().split():
        code = run([script, suite]).returncode
        passed += code == 0
        if code not in (0, 77):
            failed.append(suite)
    return passed, failed


def run_contract(root, script, subjects):
    """Tests of the command line that pass, and the names of those that fail."""
    passed, failed = 0, []
    for subject in subjects:
        done = run([sys.executable, 'test_%s.py' % subject], cwd=root / 'tests/cli', env={**os.environ, 'BRIO': str(script)})
        text = done.stderr.decode()
        found = re.search(r'^Ran (\d+) tests?', text, re.M)
        wrong = re.findall(r'^(?:FAIL|ERROR): (\w+)', text, re.M)
        failed += ['%s.%s' % (subject, name) for name in sorted(set(wrong))] or ([] if found and done.returncode == 0 else [subject])
        passed += max(int(found.group(1)) - len(set(wrong)), 0) if found else 0
    return passed, failed


def checksums(script, points, folder):
    """The checksum or the file's hash of each operation on each kind of points."""
    found = {}
    for kind in KINDS:
        for name, (command, *options) in OPERATIONS.items():
            output = folder / ('own-' + name)
            output.unlink(missing_ok=True)
            words = [script, command, points / (kind + '.ply'), '--json', '--threads', 2, *options]
            done = run(words + (['-o', output] if '.' in name else []))
            if '.' in name and output.exists():
                found[kind, name] = hashlib.sha256(output.read_bytes()).hexdigest()[:16]
            else:
                try:
                    report = json.loads(done.stdout)
                    found[kind, name] = report.get('checksum') or report.get('error')
                except ValueError:
                    found[kind, name] = 'exit %d: %s' % (done.returncode, done.stderr.decode()[:200])
    return found


def check_macos(program, log):
    """What is wrong with the symbols of a macOS program: libraries besides the system's, by its load commands."""
    data = program.read_bytes()
    libraries = {m.decode() for m in re.findall(rb'(?:/usr/lib|/System)/[\w./+-]+\.dylib', data)}
    log.write_text('\n'.join(sorted(libraries)) + '\n')
    return sorted(libraries - MACOS_LIBRARIES)


def try_target(root, out, python, target, units, native, points):
    """The row of a target and whether something is wrong with it."""
    row = dict(target=target.name, built='no', ran='no', passed='', failed='', checksums='')
    try:
        folder = build(root, out, python, target, units)
    except RuntimeError as error:
        return {**row, 'failed': str(error)}, True
    row['built'] = 'yes'
    if target.system == 'Darwin':
        more = check_macos(folder / 'brio', folder / 'libraries')
        return {**row, 'ran': 'no: nothing runs it here', 'failed': 'needs ' + ' '.join(more) if more else ''}, bool(more)
    script, why = runner_of(root, folder, target, 'brio')
    if script is None:
        return {**row, 'ran': 'no: ' + why}, False
    row['ran'] = 'yes'
    tests, failed = run_contract(root, script, target.contract)
    unit_script, why = runner_of(root, folder, target, 'unit_tests')
    if unit_script:
        suites, wrong = run_units(unit_script)
        tests, failed = tests + suites, failed + wrong
    found = checksums(script, points, folder)
    different = ['%s of %s' % (name, kind) for (kind, name), value in native.items() if found[kind, name] != value]
    (folder / 'checksums.json').write_text(json.dumps({' '.join(k): v for k, v in found.items()}, indent=1))
    row.update(passed=tests, failed=', '.join(failed) or 0, checksums='different: ' + ', '.join(different) if different else '%d equal' % len(found))
    return row, bool(failed or different)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('root', type=pathlib.Path)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('python', type=pathlib.Path)
    parser.add_argument('--only', default='', help='names of targets, with commas')
    parser.add_argument('--no-units', action='store_true', help='no unit tests, whose build takes most of the time')
    parser.add_argument('--native', type=pathlib.Path, help='the program of this machine; built where it is not given')
    a = parser.parse_args()
    root, out = a.root.resolve(), a.out.resolve()
    wanted = [t for t in TARGETS if not a.only or t.name in a.only.split(',')]
    native = a.native.resolve() if a.native else out / 'native/brio'
    if not a.native:
        subprocess.run(['cmake', '-S', root, '-B', out / 'native', '-DBRIO_TESTS=OFF', '-DCMAKE_BUILD_TYPE=Release'], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(['cmake', '--build', out / 'native', '-j', str(os.cpu_count()), '--target', 'brio-cli'], check=True, stdout=subprocess.DEVNULL)
    points = out / 'points'
    points.mkdir(parents=True, exist_ok=True)
    for kind, count in KINDS.items():
        run([native, 'generate', kind, '-n', count, '-o', points / (kind + '.ply')], check=True)
    expected = checksums(native, points, points)
    columns, wrong = ['target', 'built', 'ran', 'passed', 'failed', 'checksums'], False
    rows = {}
    table = out / 'TABLE.tsv'
    if table.exists():  # rows of targets that are not tried now stay
        rows = {line.split('\t')[0]: line for line in table.read_text().splitlines()[1:]}
    for target in wanted:
        with wine(out) if target.runner == 'wine' else contextlib.nullcontext():
            row, bad = try_target(root, out, a.python, target, not a.no_units, expected, points)
        wrong |= bad
        rows[target.name] = '\t'.join(str(row[c]) for c in columns)
        print(rows[target.name], flush=True)
        table.write_text('\n'.join(['\t'.join(columns), *(rows[t.name] for t in TARGETS if t.name in rows)]) + '\n')
    return wrong


if __name__ == '__main__':
    sys.exit(main())
