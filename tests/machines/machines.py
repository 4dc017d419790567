#!/usr/bin/env python3
"""machines.py ROOT OUT: brio on other processors, systems and compilers: the same bits everywhere.

Builds the program for each machine of MACHINES whose compiler is there, static and without optional libraries, lets it
do what RUNS says, in emulation where it must, and compares with the build of the default compiler: checksums of
triangulations, and every byte of surfaces. Prints a table in Markdown; the exit status is 1 where something differs or
does not build. A machine whose tools are missing is named with the packages that it needs, and skipped; so is a set of
instructions that this processor does not have, which the library would ignore."""
import collections
import hashlib
import json
import os
import shutil
import subprocess
import sys

Machine = collections.namedtuple('Machine', 'name packages emulator options environment')


def machine(name, packages='', emulator='', environment='', **options):
    return Machine(name, packages, emulator.split(), options, dict(pair.split('=') for pair in environment.split()))


def cross(processor, packages, emulator=''):
    return machine(f'{processor}, gcc', packages, emulator, CMAKE_SYSTEM_NAME='Linux',
                   CMAKE_SYSTEM_PROCESSOR=processor, CMAKE_C_COMPILER=f'{processor}-linux-gnu-gcc')


MACHINES = [
    machine('default'),
    machine('default, plain', environment='BRIO_INSTRUCTIONS=plain'),
    machine('default, avx2', 'avx2 fma', environment='BRIO_INSTRUCTIONS=avx2'),
    machine('default, avx512', 'avx512f avx512dq avx512vl', environment='BRIO_INSTRUCTIONS=avx512'),
    # a release has flags of the project's own
    machine('gcc -O0, asserts', CMAKE_BUILD_TYPE='Debug', CMAKE_C_FLAGS_DEBUG='-O0'),
    machine('gcc -O3 -march=native', CMAKE_BUILD_TYPE='MinSizeRel', CMAKE_C_FLAGS_MINSIZEREL='-O3 -DNDEBUG -march=native'),
    machine('clang', 'clang', CMAKE_C_COMPILER='clang'),
    machine('musl', 'musl-tools', CMAKE_C_COMPILER='musl-gcc'),
    cross('aarch64', 'gcc-aarch64-linux-gnu qemu-user', 'qemu-aarch64'),
    cross('s390x', 'gcc-s390x-linux-gnu qemu-user', 'qemu-s390x'),  # its bytes are the other way round
]

# name: points of the kind, and what follows `brio delaunay` besides
TRIANGULATIONS = {'cube': ('3000', []), 'grid': ('1000', []), 'sphere': ('1500', []), 'clusters': ('2000', []),
                  'depth': ('2000', []), 'moment': ('150', []), 'torus': ('1000', ['--weights-mod', '-30']),
                  'ball': ('2000', ['--plane', 'xy'])}
SURFACES = [['--method', 'labeled-delaunay'], ['--method', 'power-crust'], ['--method', 'tight-cocone']]


def build(root, out, m):
    """The program of a machine; what went wrong in a RuntimeError."""
    folder = os.path.join(out, (m.name.split(',')[0] if m.environment else m.name).replace(' ', '_'))
    program = os.path.join(folder, 'brio')
    if m.environment and os.path.exists(program): return program
    options = {'BRIO_TESTS': 'OFF', 'BRIO_USE_ZLIB': 'OFF', 'BRIO_USE_ZSTD': 'OFF', 'BRIO_USE_EXPAT': 'OFF',
               'BRIO_USE_CJSON': 'OFF', 'CMAKE_EXE_LINKER_FLAGS': '-static', **m.options}
    if m.emulator: options['CMAKE_CROSSCOMPILING_EMULATOR'] = m.emulator[0]
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, 'log'), 'w') as log:
        for command in (['cmake', '-S', root, '-B', folder] + [f'-D{k}={v}' for k, v in options.items()],
                        ['cmake', '--build', folder, '--target', 'brio-cli', '-j', str(os.cpu_count())]):
            if subprocess.run(command, stdout=log, stderr=log).returncode:
                raise RuntimeError(f'does not build, see {log.name}')
    return program


def hash_of(path):
    with open(path, 'rb') as f:
        return hashlib.sha256(f.read()).hexdigest()[:16]


def results(m, program, points, folder):
    """name: what the machine's program makes of the points, which another machine's program has written."""
    def brio(*words):
        done = subprocess.run(m.emulator + [program, *words], env={**os.environ, **m.environment}, capture_output=True)
        if done.returncode: raise RuntimeError(f'brio {" ".join(words)}: {done.stderr.decode().strip()}')
        return done.stdout
    found = {}
    for kind, (_, options) in TRIANGULATIONS.items():
        report = json.loads(brio('delaunay', points[kind], '--json', *options))
        found[f'{kind} {" ".join(options)}'.strip()] = report['checksum']
    output = os.path.join(folder, 'surface.ply')
    for options in SURFACES:
        brio('surface', points['scan'], '-o', output, '--ascii', *options)  # binary: in the machine's order of bytes
        found[f'surface {" ".join(options)}'] = hash_of(output)
    own = os.path.join(folder, 'own.ply')
    for kind in ('clusters', 'depth'):  # a scan takes sines from the mathematical library
        brio('generate', kind, '-n', '500', '-o', own, '--ascii')
        found[f'generate {kind}'] = hash_of(own)
    return found


def missing_tools(m):
    if m.environment and m.packages:
        with open('/proc/cpuinfo') as f:
            flags = next((line.split() for line in f if line.startswith('flags')), [])
        return [flag for flag in m.packages.split() if flag not in flags]
    tools = [m.options.get('CMAKE_C_COMPILER', 'cc')] + m.emulator
    return [tool for tool in tools if not shutil.which(tool)]


def main(root, out):
    out = os.path.abspath(out)
    os.makedirs(out, exist_ok=True)
    points, expected, failed = {}, None, 0
    print('| machine | triangulations | surfaces | what differs |')
    print('|---|---|---|---|', flush=True)
    for m in MACHINES:
        if missing_tools(m):
            print(f'| {m.name} | skipped | skipped | needs {m.packages} |')
            continue
        try:
            program = build(root, out, m)
            for kind, n in [(k, n) for k, (n, _) in TRIANGULATIONS.items()] + [('scan', '1500')]:
                if kind in points: continue
                points[kind] = os.path.join(out, f'{kind}.ply')
                subprocess.run([program, 'generate', kind, '-n', n, '-o', points[kind]], check=True, capture_output=True)
            found = results(m, program, points, out)
        except RuntimeError as error:
            print(f'| {m.name} | | | {error} |')
            failed += 1
            continue
        expected = expected or found
        different = [name for name in expected if found[name] != expected[name]]
        failed += bool(different)
        both = [hashlib.sha256(''.join(v for k, v in found.items() if k.startswith('surface') == surface).encode())
                .hexdigest()[:8] for surface in (False, True)]
        print(f'| {m.name} | {both[0]} | {both[1]} | {", ".join(different) or "nothing"} |', flush=True)
    return failed > 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
