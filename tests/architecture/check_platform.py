"""check_platform.py ROOT: one room knows the operating system.

src/platform holds all that depends on it, behind headers that are the same everywhere. No other file in C of the library, the program and
their modules asks which system it is: a condition of the preprocessor asks for nothing but processors, compilers and the build's own words (MAY_ASK);
none sets what a C library asks for (SYSTEMS), includes a header that only some systems have (HEADERS), or names a function of one
(CALLS). Within the room each subject has a header and a file for every system: name_posix.c, and name_windows.c; name_wasi.c where WASI
is not POSIX enough."""

import pathlib
import re
import sys

ROOM = "src/platform"
ROOMS_BESIDE = re.compile(r"python/native/system_(posix|windows)[.]c|mpi/transport[.]c")  # of libraries of their own
SYSTEMS = re.compile(r"^\s*#\s*define\s+(_GNU_SOURCE|_DEFAULT_SOURCE|_\w*_SOURCE|_FILE_OFFSET_BITS|WIN32_LEAN_AND_MEAN|_WIN32_WINNT)\b", re.M)
CONDITION = re.compile(r"^\s*#\s*(?:if|ifdef|ifndef|elif)\b((?:\\\n|.)*)", re.M)
MAY_ASK = re.compile(r"(BRIO_\w+|defined|__cplusplus|NDEBUG|__clang__|__has_feature|__SANITIZE_(?:THREAD|ADDRESS)__|__OPTIMIZE__|__FAST_MATH__"
                     r"|__FINITE_MATH_ONLY__|__ASSOCIATIVE_MATH__|__RECIPROCAL_MATH__|FLT_EVAL_METHOD|__SIZEOF_INT128__|__BYTE_ORDER__"
                     r"|__ORDER_LITTLE_ENDIAN__|__x86_64__|__i386__|__aarch64__|__FMA__|__SSE2__|__AVX\w*__|thread_sanitizer|address_sanitizer"
                     r"|memory_sanitizer|Py_\w+|PY_\w+)\Z")
HEADERS = re.compile(r"^\s*#\s*include\s*<((?:sys/|linux/|mach/)[^>]*|(?:aio|alloca|dirent|dlfcn|fcntl|glob|grp|io|langinfo|libgen|locale"
                     r"|malloc|poll|process|pthread|pwd|sched|semaphore|signal|spawn|termios|threads|time|ucontext|unistd|windows|xlocale)\.h)>", re.M)
CALLS = re.compile(r"(?<![\w.>])(open|openat|close|read|write|pread|pwrite|lseek|fstat|stat|lstat|access|unlink|rename|fsync|ftruncate|poll|ioctl"
                   r"|isatty|fileno|fdopen|fopen|mmap|munmap|mremap|madvise|sysconf|getpid|fork|nanosleep|usleep|clock_gettime|signal|sigaction"
                   r"|open_memstream|fmemopen|feenableexcept|memmem|stpcpy|strcasestr|strsep|asprintf|getline|secure_getenv|newlocale|setlocale|uselocale)\s*\(")
OWN = {"cli/pages/pages.c"}  # runs where brio is built, and writes what the builder names
COMMENT_OR_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.S)
DEFINED = re.compile(r"^static [^;{}()]*?\b(\w+)\(", re.M)
POINTER = re.compile(r"\(\*(\w+)\)\(")
SHARED = {"target"}  # subjects with a file for all systems besides
INNER = {"quiet_signals": "posix", "wide_names": "windows"}  # headers of one system's files


def complaints(root, path):
    name = path.relative_to(root).as_posix()
    text = path.read_text(encoding="utf-8")
    code = COMMENT_OR_TEXT.sub(lambda match: "\n" * match.group().count("\n"), text)
    if name.startswith(ROOM + "/") or ROOMS_BESIDE.fullmatch(name):
        return
    for match in CONDITION.finditer(code):
        for word in re.findall(r"\b[A-Za-z_]\w*", match.group(1)):
            if not MAY_ASK.match(word):
                yield "%s:%d: asks for %s; only src/platform knows the system" % (name, code.count("\n", 0, match.start(1)) + 1, word)
    for what, found in (("defines", SYSTEMS), ("includes", HEADERS)):
        for match in found.finditer(code):
            yield "%s:%d: %s: %s; only src/platform knows the system" % (name, code.count("\n", 0, match.start(1)) + 1, what, match.group(1))
    own = set(DEFINED.findall(code)) | set(POINTER.findall(code))
    for match in CALLS.finditer(code):
        if match.group(1) not in own and name not in OWN:
            yield "%s:%d: calls %s; src/platform has a function for it" % (name, code.count("\n", 0, match.start(1)) + 1, match.group(1))


def room(root):
    files = {path.name for path in (root / ROOM).iterdir()}
    for header in sorted(f for f in files if f.endswith(".h")):
        subject = header[:-2]
        for system in [INNER[subject]] if subject in INNER else ["posix", "windows"]:
            if "%s_%s.c" % (subject, system) not in files:
                yield "%s/%s: no %s_%s.c beside it" % (ROOM, header, subject, system)
    for name in sorted(f for f in files if f.endswith(".c")):
        subject, _, system = name[:-2].rpartition("_")
        if name[:-2] not in SHARED and (system not in ("posix", "windows", "wasi") or subject + ".h" not in files):
            yield "%s/%s: is no file of a system beside a header" % (ROOM, name)


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = [p for top in ("src", "cli", "include", "mpi", "python/native", "wasm") for p in sorted((root / top).rglob("*")) if p.suffix in (".c", ".h")]
    wrong = [line for path in files for line in complaints(root, path)] + list(room(root))
    print("\n".join([*wrong, "%d files, %d complaints" % (len(files), len(wrong))]))
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
