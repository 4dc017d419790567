"""Programs under a memory limit that holds for their pages and for the files that they map: memory cgroups, v1 and v2.

Only root (or whom root has given a cgroup) may make one. `reason()` says why there is none here."""
import os
import signal
import subprocess
import threading
import time

ROOT = '/sys/fs/cgroup'


def _paths():
    """(folder of our own memory cgroup, its version), as the system has it; (None, 0) without one."""
    with open('/proc/self/cgroup') as f:
        lines = [line.strip().split(':', 2) for line in f]
    for _, controllers, path in lines:
        if 'memory' in controllers.split(','): return os.path.join(ROOT, 'memory', path.lstrip('/')), 1
    for _, controllers, path in lines:
        if controllers == '' and os.path.exists(f'{ROOT}/cgroup.controllers'):
            return os.path.join(ROOT, path.lstrip('/')), 2
    return None, 0


def _write(path, text):
    with open(path, 'w') as f: f.write(text)


def _make(parent, version):
    """A fresh cgroup in the folder, or an OSError. In v2 the parent has to hand the controller down, which it may not
    while it has processes of its own, unless it is the root."""
    group = os.path.join(parent, f'brio-thesis-{os.getpid()}-{time.monotonic_ns()}')
    if version == 2:
        with open(os.path.join(parent, 'cgroup.subtree_control')) as f: handed = f.read().split()
        if 'memory' not in handed: _write(os.path.join(parent, 'cgroup.subtree_control'), '+memory')
    os.mkdir(group)
    return group


class Group:
    """A memory cgroup: `with Group(bytes) as g`, and processes join by g.join()."""

    def __init__(self, limit):
        own, self.version = _paths()
        if not own: raise OSError('there is no memory cgroup')
        top = ROOT if self.version == 2 else os.path.join(ROOT, 'memory')
        parents = [own] if self.version == 1 else [own, os.path.dirname(own), top]
        for i, parent in enumerate(parents):
            try:
                self.path = _make(parent, self.version)
                break
            except OSError:
                if i + 1 == len(parents): raise
        limits = ['memory.limit_in_bytes'] if self.version == 1 else ['memory.max', 'memory.swap.max']
        try:
            for name in limits:
                if os.path.exists(os.path.join(self.path, name)):
                    _write(os.path.join(self.path, name), '0' if 'swap' in name else str(limit))
        except OSError:
            os.rmdir(self.path)
            raise

    def join(self):
        _write(os.path.join(self.path, 'cgroup.procs'), str(os.getpid()))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for _ in range(100):  # its last pages may still be on their way to the disk
            try:
                return os.rmdir(self.path)
            except OSError:
                time.sleep(0.1)


def reason():
    """'' where memory can be limited, else the words for why not."""
    try:
        with Group(1 << 30): return ''
    except OSError as e:
        return f'no memory cgroup can be made here ({e.strerror or e})'


class Done:
    """What a limited run gave: its output, exit code, seconds, whether it was stopped, the per cent of each stage."""

    def __init__(self):
        self.out, self.code, self.seconds, self.stopped, self.marks = b'', None, 0.0, False, []


def _follow(pipe, done, start):
    """Progress lines '<stage> [###---]  35 %  ...' with the second they came at."""
    for line in pipe:
        words = line.decode(errors='replace').split()
        if '%' in words[1:]: done.marks.append((time.monotonic() - start, words[0], int(words[words.index('%') - 1])))


def run(command, limit=None, most_seconds=None):
    """Runs a program, in `limit` bytes of memory if given, at most so many seconds."""
    done = Done()
    group = Group(limit) if limit else None
    process = None
    try:
        start = time.monotonic()
        process = subprocess.Popen(command + ['--progress'], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   preexec_fn=group.join if group else None)
        follower = threading.Thread(target=_follow, args=(process.stderr, done, start))
        follower.start()
        timer = threading.Timer(most_seconds or 1e6, lambda: (setattr(done, 'stopped', True),
                                                              process.send_signal(signal.SIGKILL)))
        timer.start()
        done.out = process.stdout.read()
        done.code = process.wait()
        timer.cancel()
        follower.join()
        done.seconds = time.monotonic() - start
    finally:
        if process and process.poll() is None:  # interrupted
            process.kill()
            process.wait()
        if group: group.__exit__()
    return done
