"""What builds brio for other systems from one machine: the table of targets, the C cross compiler, the libraries that come along.

The compiler is clang in the Python package ziglang (scripts/setup.sh targets installs it). zlib, expat, cJSON and libzstd are
compiled from Debian's sources, which setup.sh puts into out/library-sources, and are linked into what is built; where the sources
cannot be had the targets are without them. tests/targets/targets.py tests what comes out, scripts/wheels.py packs it for Python."""
import collections
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys

# platform: what a wheel for Python says of the system, or None where there is no wheel
Target = collections.namedtuple('Target', 'name triple system processor platform')
TARGETS = [
    Target('linux-x86_64-glibc2.17', 'x86_64-linux-gnu.2.17', 'Linux', 'x86_64', 'manylinux2014_x86_64.manylinux_2_17_x86_64'),
    Target('linux-aarch64-glibc2.17', 'aarch64-linux-gnu.2.17', 'Linux', 'aarch64', 'manylinux2014_aarch64.manylinux_2_17_aarch64'),
    Target('linux-x86_64-musl', 'x86_64-linux-musl', 'Linux', 'x86_64', 'musllinux_1_1_x86_64'),
    Target('linux-aarch64-musl', 'aarch64-linux-musl', 'Linux', 'aarch64', 'musllinux_1_1_aarch64'),
    Target('windows-x86_64', 'x86_64-windows-gnu', 'Windows', 'x86_64', 'win_amd64'),
    Target('windows-aarch64', 'aarch64-windows-gnu', 'Windows', 'aarch64', None),
    Target('macos-x86_64', 'x86_64-macos', 'Darwin', 'x86_64', 'macosx_13_0_x86_64'),
    Target('macos-aarch64', 'aarch64-macos', 'Darwin', 'aarch64', 'macosx_13_0_arm64'),
    Target('wasm32-wasi', 'wasm32-wasi', 'WASI', 'wasm32', None),
]

# A library: its archive, its sources, what they are compiled with, its headers and what CMake calls it.
Library = collections.namedtuple('Library', 'name archive sources flags headers cmake')
ZLIB_SOURCES = ['%s.c' % n for n in 'adler32 compress crc32 deflate inffast inflate inftrees trees uncompr zutil'.split()]
LIBRARIES = [
    Library('zlib', 'zlib_*.orig.tar.*', ZLIB_SOURCES, ['-include', 'stdio.h'], {'zlib.h': '', 'zconf.h': ''}, 'ZLIB'),
    Library('expat', 'expat_*.orig.tar.*', ['expat/lib/xml%s.c' % n for n in ('parse', 'role', 'tok')],
            ['-DXML_NS=1', '-DXML_DTD=1', '-DXML_CONTEXT_BYTES=1024'],
            {'expat/lib/expat.h': '', 'expat/lib/expat_external.h': ''}, 'EXPAT'),
    Library('cjson', 'cjson_*.orig.tar.*', ['cJSON.c'], [], {'cJSON.h': 'cjson'}, 'CJSON'),
    Library('zstd', 'libzstd_*.orig.tar.*', ['lib/%s/*.c' % f for f in ('common', 'compress', 'decompress')], ['-DZSTD_DISABLE_ASM=1'],
            {'lib/zstd.h': '', 'lib/zstd_errors.h': ''}, 'ZSTD'),
]
# Where expat gets the number from that a hostile file must not guess.
ENTROPY = {'Linux': '-DXML_DEV_URANDOM', 'Darwin': '-DHAVE_ARC4RANDOM_BUF', 'Windows': '-DWIN32_LEAN_AND_MEAN', 'WASI': '-DHAVE_ARC4RANDOM_BUF'}


def write_script(path, text):
    """Writes a program for the shell; one that says this already keeps its age, by which ccache knows compilers."""
    text = '#!/bin/sh\n' + text + '\n'
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)
        path.chmod(0o755)
    return path


def tools_of(root, target):
    """The wrappers of the compiler, which is one program with a word for each tool: those of C, of archives, of import libraries."""
    tools = root / 'build/targets/tools'
    tools.mkdir(parents=True, exist_ok=True)
    where = subprocess.run([root / 'out/targets-env/bin/python', '-c', 'import ziglang; print(ziglang.__path__[0])'], check=True,
                           capture_output=True, text=True)
    zig = where.stdout.strip() + '/zig'
    return {'cc': write_script(tools / ('cc-' + target.triple), 'exec %s cc -target %s "$@"' % (zig, target.triple)),
            **{word: write_script(tools / word, 'exec %s %s "$@"' % (zig, word)) for word in ('ar', 'ranlib', 'dlltool', 'objcopy')}}


def unpack(root, library):
    """The folder of a library's sources, unpacked once, or None where its archive is missing."""
    archives = [a for a in sorted((root / 'out/library-sources').glob(library.archive)) if a.suffix != '.asc']
    if not archives:
        return None
    folder = root / 'build/targets/sources' / library.name
    if not folder.is_dir():
        fresh = folder.with_suffix('.new')
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.unpack_archive(archives[-1], fresh)
        fresh.rename(folder)
    return next(p for p in folder.iterdir() if p.is_dir())


# The notices of what the compiler links in from its C library, by system: those of glibc and of macOS are not linked in.
SYSTEM_NOTICES = {
    'WASI': ['wasi/LICENSE', 'wasi/LICENSE-MIT', 'wasi/libc-bottom-half/cloudlibc/LICENSE', 'wasi/libc-top-half/musl/COPYRIGHT'],
    'Windows': ['mingw/COPYING', 'musl/COPYRIGHT'],
    'musl': ['musl/COPYRIGHT'],
}
NOTICES = {'zlib': 'README', 'expat': 'expat/COPYING', 'cjson': 'LICENSE', 'zstd': 'LICENSE'}


def notices_of(root, system, libraries=LIBRARIES):
    """The notices that go with what was built for a system: bytes, by names of files."""
    where = subprocess.run([root / 'out/targets-env/bin/python', '-c', 'import ziglang; print(ziglang.__path__[0])'], check=True,
                           capture_output=True, text=True)
    compiler = pathlib.Path(where.stdout.strip())
    found = {'zig': (compiler / 'LICENSE').read_bytes()}
    for name in SYSTEM_NOTICES.get(system, []):
        found[name.replace('/', '-')] = (compiler / 'lib/libc' / name).read_bytes()
    for library in libraries:
        sources = unpack(root, library)
        if sources:
            found[library.name] = (sources / NOTICES[library.name]).read_bytes()
    return found


def write_notices(folder, notices):
    """Writes them as one file, NOTICES."""
    rule = '\n' + 72 * '-' + '\n'
    text = 'What is inside besides brio, and its terms.\n'
    text += ''.join('%s%s\n\n%s' % (rule, name, data.decode()) for name, data in sorted(notices.items()))
    (pathlib.Path(folder) / 'NOTICES').write_text(text, encoding='utf-8')


def build_library(root, target, library, tools):
    """What CMake is told of a library, which is compiled if it was not: nothing where its sources are missing."""
    use = 'BRIO_USE_' + library.cmake
    sources = unpack(root, library)
    if sources is None:
        return {use: 'OFF'}
    folder = root / 'build/targets/libraries' / target.name
    archive = folder / 'lib' / ('lib%s.a' % library.name)
    include = folder / 'include' / library.name
    if not archive.is_file():
        objects = folder / 'objects' / library.name
        for made in (objects, archive.parent, include):
            made.mkdir(parents=True, exist_ok=True)
        for header, place in library.headers.items():
            (include / place).mkdir(exist_ok=True)
            shutil.copy(sources / header, include / place)
        (objects / 'expat_config.h').write_text('')
        files = [file for pattern in library.sources for file in sorted(sources.glob(pattern))]
        launcher = ['ccache'] if shutil.which('ccache') else []
        flags = ['-O2', '-g0', '-DNDEBUG', '-fPIC', '-fvisibility=hidden', '-ffunction-sections', '-w', '-I', objects, *library.flags]
        flags += [ENTROPY[target.system]] * (library.name == 'expat')
        for file in files:
            subprocess.run([*launcher, tools['cc'], '-c', *flags, file, '-o', objects / (file.stem + '.o')], check=True)
        subprocess.run([tools['ar'], 'rcs', archive, *sorted(objects.glob('*.o'))], check=True)
    return {use: 'ON', library.cmake + '_LIBRARY': archive, library.cmake + '_INCLUDE_DIR': include}


# What a program is made of.
SOURCES = ['src', 'cli', 'include', 'cmake', 'CMakeLists.txt', 'web/page.html', 'scripts/cross.py']


def made_of(root):
    """A hash of SOURCES: names and contents."""
    digest = hashlib.sha256()
    files = [p for name in SOURCES for p in ((root / name).rglob('*') if (root / name).is_dir() else [root / name])]
    for file in sorted(p for p in files if p.is_file()):
        digest.update(b'%s  %s\n' % (hashlib.sha256(file.read_bytes()).hexdigest().encode(), file.relative_to(root).as_posix().encode()))
    return digest.hexdigest()


def c_library(target):
    """The key of SYSTEM_NOTICES."""
    return 'musl' if target.triple.endswith('-musl') else target.system


# The compiler makes a target's C library from its sources, up to 1500 files, when it first links: once more for what is linked with other
# words, as the programs are that CMake tries. Facts for debuggers, which it adds unasked, were four fifths of a program.
ONE_LIBRARY = {'CMAKE_C_FLAGS': '-O2 -g0', 'CMAKE_TRY_COMPILE_CONFIGURATION': 'Release'}


def options_of(root, target):
    """What CMake is told to build for a target."""
    tools = tools_of(root, target)
    options = {'CMAKE_SYSTEM_NAME': target.system, 'CMAKE_SYSTEM_PROCESSOR': target.processor, 'CMAKE_C_COMPILER': tools['cc'],
               'CMAKE_AR': tools['ar'], 'CMAKE_RANLIB': tools['ranlib'], 'CMAKE_BUILD_TYPE': 'Release', **ONE_LIBRARY,
               'CMAKE_C_FLAGS_RELEASE': '-DNDEBUG'}
    for library in LIBRARIES:
        options.update(build_library(root, target, library, tools))
    if shutil.which('ccache'):
        options['CMAKE_C_COMPILER_LAUNCHER'] = 'ccache'
    return options


def configure_and_build(source, folder, options, goals):
    """Builds goals in a folder. A RuntimeError names the log."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / 'log', 'w') as log:
        for command in (['cmake', '-S', source, '-B', folder] + ['-D%s=%s' % pair for pair in options.items()],
                        ['cmake', '--build', folder, '-j', str(os.cpu_count()), '--target', *goals, '--', '-k']):
            if subprocess.run([str(w) for w in command], stdout=log, stderr=log).returncode:
                raise RuntimeError('does not build, see %s' % log.name)


if __name__ == '__main__':
    # cross.py --names: the targets. cross.py --made-of: the hash of the sources around this file. cross.py FOLDER TARGET|module: writes NOTICES of a program, or of brio-module.wasm, which has no libraries
    here = pathlib.Path(__file__).resolve().parents[1]
    if sys.argv[1] == '--names':
        print('\n'.join(t.name for t in TARGETS))
    elif sys.argv[1] == '--made-of':
        print(made_of(here))
    elif sys.argv[2] == 'module':
        write_notices(sys.argv[1], notices_of(here, 'WASI', []))
    else:
        write_notices(sys.argv[1], notices_of(here, c_library(next(t for t in TARGETS if t.name == sys.argv[2]))))
