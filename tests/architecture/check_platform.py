"""check_platform.py ROOT: one room knows the operating system.

src/platform holds all that depends on it, behind headers that are the same everywhere. No other file of src, cli and include
asks which system it is (SYSTEMS), includes a header that only some systems have (HEADERS), or names a function of one (CALLS).
What a processor has, such as AVX, is another matter. Within the room each subject has a header and a file for every system:
name_posix.c, and name_windows.c; name_wasi.c where WASI is not POSIX enough."""

import pathlib
import re
import sys

ROOM = "src/platform"
SYSTEMS = re.compile(r"^\s*#.*\b(__linux__|__linux|linux|__unix__|unix|_WIN32|_WIN64|__MINGW32__|_MSC_VER|__APPLE__|__MACH__|__wasi__|__wasm__"
                     r"|__EMSCRIPTEN__|__GLIBC__|__BSD__|__FreeBSD__|__ANDROID__|_GNU_SOURCE|_POSIX_C_SOURCE|_DEFAULT_SOURCE)\b", re.M)
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
    if name.startswith(ROOM + "/"):
        return
    for what, found in (("asks for the system", SYSTEMS), ("includes", HEADERS)):
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
    files = [p for top in ("src", "cli", "include") for p in sorted((root / top).rglob("*")) if p.suffix in (".c", ".h")]
    wrong = [line for path in files for line in complaints(root, path)] + list(room(root))
    print("\n".join([*wrong, "%d files, %d complaints" % (len(files), len(wrong))]))
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
