#!/usr/bin/env python3
"""targets.py ROOT OUT [--only NAME,...] [--no-units] [--again]: tries brio on every system that it is for, from one machine.

Builds the program and the unit tests for each target of scripts/cross.py. What can run here runs: in emulation where it must. It runs

    units       the suites of tests/unit that the target's C library has the headers for
    contract    files of tests/cli, with the target's program
    checksums   OPERATIONS on the points of KINDS, compared with the program of this machine's compiler, bit by bit

and writes OUT/TABLE.tsv: target, built, ran, passed, failed, checksums; the row of a target is there as soon as it was tried. In
emulation suites and files run in so much time as is allowed: one that needs more is stopped and named in OUT/TARGET/left-out. What failing
tests print is in OUT/TARGET/failures. Of what cannot run the libraries and symbols that the program asks its system for are checked; so
are the versions of symbols of glibc. The exit status is 1 where something fails or differs.

OUT/TARGET/made-of is the hash of the sources whose program the row is about: scripts/release.sh asks for both. OUT/TARGET/tried is that of
the programs and of what tried them. A target that has neither changed nor failed since keeps its row, except with --again: what was cut off
goes on where it was."""
import argparse
import concurrent.futures
import contextlib
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / 'scripts'))
import cross  # noqa: E402

# What runs programs here that this machine's system does not run as they are: the program that must be there, and the words.
RUNNERS = {
    'old root': ('unshare', 'sh {root}/tests/targets/old_root.sh {root}/out/old-root-amd64 {root}'),
    'qemu-aarch64': ('qemu-aarch64', 'qemu-aarch64 -L {root}/out/old-root-arm64'),
    'wine': ('wine', 'wine'),
    # with threads of its own, which compile and collect garbage, Node 20 crashed after some programs had ended
    'node': ('node', 'node --no-warnings --single-threaded {root}/tests/targets/wasi.mjs'),
}
EMULATED = {'qemu-aarch64', 'wine', 'node'}
# What runs the programs of a target here, and the files of tests/cli that it must pass. Others ask for files of POSIX.
LINUX_CONTRACT = ['delaunay', 'hull', 'check', 'wrong_uses', 'output', 'pipes', 'info', 'salvage', 'tiles']
ANY_CONTRACT = ['delaunay', 'hull', 'check', 'info']
RUNS = {
    'linux-x86_64-glibc2.17': ('old root', LINUX_CONTRACT),
    'linux-aarch64-glibc2.17': ('qemu-aarch64', LINUX_CONTRACT),
    'linux-x86_64-musl': ('', LINUX_CONTRACT),
    'linux-aarch64-musl': ('qemu-aarch64', LINUX_CONTRACT),
    'windows-x86_64': ('wine', ANY_CONTRACT + ['tiles']),
    'wasm32-wasi': ('node', ANY_CONTRACT),
}

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


def has_old_root(root, runner='old root'):
    """Whether scripts/setup.sh has fetched the old Linux of a runner, and this process may go into it: that is tried, since a container
    may forbid to root what that needs."""
    if runner == 'qemu-aarch64':
        return (root / 'out/old-root-arm64/bin/sh').exists()
    needed, words = RUNNERS['old root']
    return (root / 'out/old-root-amd64/bin/sh').exists() and shutil.which(needed) is not None and run(
        [*words.format(root=root).split(), '/bin/sh', '-c', '']).returncode == 0


def runner_of(root, folder, target, name):
    """A script that runs a program of the target here, or None and why not."""
    program = next((folder / (name + end) for end in ('', '.exe', '.wasm') if (folder / (name + end)).is_file()), None)
    if program is None:
        return None, 'no %s' % name
    if target.name not in RUNS:
        return None, 'nothing runs it here'
    runner = RUNS[target.name][0]
    needed, words = RUNNERS.get(runner if runner != 'old root' or has_old_root(root) else '', ('sh', ''))
    if not shutil.which(needed):
        return None, '%s is missing' % needed
    if runner == 'qemu-aarch64' and 'glibc' in target.name and not has_old_root(root, runner):
        return None, 'no old Linux for it: scripts/setup.sh targets'
    return cross.write_script(folder / ('run-' + name), 'exec %s %s "$@"' % (words.format(root=root), program)), ''


def run(words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, stdin=subprocess.DEVNULL, **{'timeout': 1800, **more})


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


def run_units(script, most_seconds, emulated, failures):
    """Suites that pass, the names of those that fail, and of those that were left out, with the reason. One that skips itself passes
    nothing. In emulation all have most_seconds together, and one a tenth of them. What those that fail print goes to `failures`."""
    begin = time.monotonic()

    def run_suite(suite):
        most = min(most_seconds / 10, most_seconds - (time.monotonic() - begin)) if emulated else 900
        if most <= 0:
            return 'no time was left', None
        try:
            done = run([script, suite], timeout=most)
        except subprocess.TimeoutExpired:
            return 'needs over %d s' % most, None
        return 'skips itself' if done.returncode == 77 else '', done
    suites = run([script]).stdout.decode().split()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(run_suite, suites))
    left_out = ['%s: %s' % (suite, why) for suite, (why, _) in zip(suites, results) if why]
    failed = [(suite, done) for suite, (why, done) in zip(suites, results) if not why and done.returncode]
    for suite, done in failed:
        failures.write(b'== %s: exit %d\n%s%s' % (suite.encode(), done.returncode, done.stdout, done.stderr))
    return len(suites) - len(left_out) - len(failed), [suite for suite, _ in failed], left_out


def run_contract(root, script, subjects, runner, most_seconds, failures):
    """Tests of the command line that pass, the names of those that fail, and of files that were left out since they need more than
    most_seconds in emulation. What those that fail print goes to `failures`."""
    passed, failed, left_out = 0, [], []
    environment = {**os.environ, 'BRIO': str(script), 'BRIO_EMULATED': runner if runner in EMULATED else ''}
    for subject in subjects:
        try:
            done = run([sys.executable, 'test_%s.py' % subject], cwd=root / 'tests/cli', env=environment,
                       timeout=most_seconds if runner in EMULATED else 1800)
        except subprocess.TimeoutExpired as late:
            (left_out if runner in EMULATED else failed).append('test_%s.py: needs over %d s' % (subject, late.timeout))
            continue
        text = done.stderr.decode()
        if done.returncode:
            failures.write(done.stdout + done.stderr)
        found = re.search(r'^Ran (\d+) tests?', text, re.M)
        wrong = re.findall(r'^(?:FAIL|ERROR): (\w+)', text, re.M)
        failed += ['%s.%s' % (subject, name) for name in sorted(set(wrong))] or ([] if found and done.returncode == 0 else [subject])
        skipped = re.search(r'skipped=(\d+)', text)
        passed += max(int(found.group(1)) - len(set(wrong)) - int(skipped.group(1) if skipped else 0), 0) if found else 0
    return passed, failed, left_out


def closed_streams(root, folder, target, script, points):
    """Tests that pass, of one, and the names of those that fail: a program whose standard streams are closed writes none of its messages
    into its output; its report has no place to go, which it says by its status, 6. Where Python cannot close them, as
    tests/cli/test_output.py does, closed_streams.c and wasi.mjs do."""
    environment, words = {**os.environ, 'BRIO_CLOSED': '1'}, [script]
    if target.system == 'Windows':
        launcher = folder / 'closed_streams.exe'
        compiler, part = cross.tools_of(root, target)['cc'], folder / 'closed_streams.o'
        run([compiler, '-O2', '-c', '-o', part, root / 'tests/targets/closed_streams.c'], check=True)
        run([compiler, '-O2', '-nostdlib', '-o', launcher, part, '-lkernel32'], check=True)
        words = ['wine', launcher, folder / 'brio.exe']
    elif target.system != 'WASI':
        return 0, []
    output = folder / 'closed.csv'
    output.unlink(missing_ok=True)
    done = run([*words, 'convert', points / 'cube.ply', output, '--progress'], env=environment)
    lines = output.read_text().split('\n') if output.exists() else []
    good = done.returncode == 6 and len(lines) == KINDS['cube'] + 2 and all(line.count(',') == 2 for line in lines[:-1])
    return int(good), [] if good else ['closed_streams: exit %d' % done.returncode]


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


def check_macos(program):
    """What a macOS program asks its system for besides the C library: libraries, by its load commands."""
    libraries = {m.decode() for m in re.findall(rb'(?:/usr/lib|/System)/[\w./+-]+\.dylib', program.read_bytes())}
    return sorted(libraries - MACOS_LIBRARIES)


def check_glibc(program):
    """The versions of glibc's symbols that a program asks for and that came after 2.17."""
    versions = set(re.findall(rb'GLIBC_(2\.\d+)', program.read_bytes()))
    return sorted('GLIBC_' + v.decode() for v in versions if int(v[2:]) > 17)


def check_windows(program):
    """The libraries of a Windows program that do not come with Windows 10."""
    found = {m.decode().lower() for m in re.findall(rb'[\w-]+\.dll', program.read_bytes(), re.I)}
    return sorted(n for n in found if not n.startswith(('api-ms-win-', 'kernel32', 'shell32', 'advapi32', 'ntdll', 'ucrtbase')))


def needs_of(folder, target):
    """What the target's program needs and no system of that kind has."""
    if target.system == 'Darwin':
        return check_macos(folder / 'brio')
    if target.system == 'Windows':
        return check_windows(folder / 'brio.exe')
    return check_glibc(folder / 'brio') if 'glibc' in target.name else []


def run_target(root, folder, target, script, native, points, most_seconds):
    """The row's facts of a target that runs here, and whether something is wrong with it."""
    runner, contract = RUNS[target.name]
    unit_script, _ = runner_of(root, folder, target, 'unit_tests')
    with open(folder / 'failures', 'wb') as failures:
        passed, failed, left_out = run_contract(root, script, contract, runner, most_seconds, failures)
        guarded, open_to = closed_streams(root, folder, target, script, points)
        passed, failed = passed + guarded, failed + open_to
        if unit_script:
            suites, wrong, late = run_units(unit_script, most_seconds, runner in EMULATED, failures)
            passed, failed, left_out = passed + suites, failed + wrong, left_out + late
    (folder / 'left-out').write_text(''.join(line + '\n' for line in left_out))
    found = checksums(script, points, folder)
    different = ['%s of %s' % (name, kind) for (kind, name), value in native.items() if found[kind, name] != value]
    (folder / 'checksums.json').write_text(json.dumps({' '.join(k): v for k, v in found.items()}, indent=1))
    ran = 'yes' if runner != 'old root' or has_old_root(root) else "yes, with this machine's glibc"
    facts = dict(ran=ran, passed=passed, failed=', '.join(failed) or 0,
                 checksums='different: ' + ', '.join(different) if different else '%d equal' % len(found))
    return facts, bool(failed or different)


def hash_of(facts, files):
    """A hash of what is said and of what is in files."""
    digest = hashlib.sha256(repr(facts).encode())
    for file in files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def tried_with(root, folder, target, native, units):
    """A hash of a target's programs, of the tests that they meet, and of the checksums that are expected."""
    tests = [p for name in ('tests/cli', 'tests/targets') for p in sorted((root / name).rglob('*')) if p.suffix in ('.py', '.c', '.mjs', '.sh')]
    programs = [folder / (name + end) for name in ('brio', 'unit_tests') for end in ('', '.exe', '.wasm')]
    return hash_of((units, RUNS.get(target.name), OPERATIONS, sorted(native.items())),
                   [p for p in tests if p.parent.name != 'targets' or p.suffix != '.py'] + [p for p in programs if p.is_file()])


def try_target(root, out, target, units, native, points, most_seconds, kept):
    """The row of a target and whether something is wrong with it. The row `kept` stands where nothing has changed since."""
    row = dict(target=target.name, built='no', ran='no', passed='', failed='', checksums='')
    folder = out / target.name
    try:
        emulated = RUNS.get(target.name, ('',))[0] in EMULATED
        options = {**cross.options_of(root, target), 'BRIO_ALL_SUITES': 'ON', 'BRIO_EMULATED': 'ON' if emulated else 'OFF'}
        cross.configure_and_build(root, folder, options, ['brio-cli'] + ['unit_tests'] * (units and target.name in RUNS))
    except RuntimeError as error:
        return {**row, 'failed': str(error)}, True
    mark, tried = folder / 'tried', tried_with(root, folder, target, native, units)
    if kept and mark.is_file() and mark.read_text() == tried:
        return kept, False
    mark.unlink(missing_ok=True)
    needs = needs_of(folder, target)
    if needs:
        return {**row, 'built': 'yes', 'failed': 'needs ' + ' '.join(needs)}, True
    script, why = runner_of(root, folder, target, 'brio')
    if script is None:
        mark.write_text(tried)
        return {**row, 'built': 'yes', 'ran': 'no: ' + why}, False
    facts, wrong = run_target(root, folder, target, script, native, points, most_seconds)
    if not wrong:
        mark.write_text(tried)
    return {**row, 'built': 'yes', **facts}, wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('root', type=pathlib.Path)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('--only', default='', help='names of targets, with commas')
    parser.add_argument('--no-units', action='store_true', help='no unit tests, whose build takes most of the time')
    parser.add_argument('--again', action='store_true', help='targets that have not changed, too')
    parser.add_argument('--native', type=pathlib.Path, help='the program of this machine; built where it is not given')
    parser.add_argument('--minutes', type=float, default=10, help='for the unit tests of a target in emulation, and for each file of tests/cli')
    a = parser.parse_args()
    root, out = a.root.resolve(), a.out.resolve()
    wanted = [t for t in cross.TARGETS if not a.only or t.name in a.only.split(',')]
    native = a.native.resolve() if a.native else out / 'native/brio'
    if not a.native:
        cross.configure_and_build(root, out / 'native', {'BRIO_TESTS': 'OFF', 'CMAKE_BUILD_TYPE': 'Release'}, ['brio-cli'])
    points = out / 'points'
    points.mkdir(parents=True, exist_ok=True)
    for kind, count in KINDS.items():
        run([native, 'generate', kind, '-n', count, '-o', points / (kind + '.ply')], check=True)
    expected = checksums(native, points, points)
    columns, wrong = ['target', 'built', 'ran', 'passed', 'failed', 'checksums'], False
    table = out / 'TABLE.tsv'
    for target in wanted:
        mark, made_of = out / target.name / 'made-of', cross.made_of(root)
        mark.unlink(missing_ok=True)
        rows = {line.split('\t')[0]: line for line in table.read_text().splitlines()[1:]} if table.exists() else {}
        kept = dict(zip(columns, rows[target.name].split('\t'))) if target.name in rows and not a.again else None
        with wine(out) if RUNS.get(target.name, ('',))[0] == 'wine' else contextlib.nullcontext():
            row, bad = try_target(root, out, target, not a.no_units, expected, points, 60 * a.minutes, kept)
        wrong |= bad
        rows[target.name] = '\t'.join(str(row[c]) for c in columns)
        print(rows[target.name], flush=True)
        table.write_text('\n'.join(['\t'.join(columns), *(rows[t.name] for t in cross.TARGETS if t.name in rows)]) + '\n')
        if row['built'] == 'yes':
            mark.write_text(made_of + '\n')
    return wrong


if __name__ == '__main__':
    sys.exit(main())
