"""A program that is started again and again with a fault in it: fault_server.c, from the other side."""

import mmap
import os
import select
import signal
import struct
import subprocess
import tempfile

NONE, MEMORY, THREAD, ERROR, SHORT, INTERRUPT, SIGNAL, CUT = range(8)
OPEN, READ, WRITE, MAP, OTHER = 1, 2, 4, 8, 16
FOREVER = 1 << 60
FIELDS = struct.Struct("<10q1024s")
NAMES = ("kind", "detail", "k", "last", "count", "struck", "live", "call", "caught", "is_on", "path")
LIMIT = 60  # seconds for a run that takes milliseconds, not counted while it is stopped
UNSEEN = 98  # what a child says that cannot see calls of the system


class Came:
    """What came of a run: exit code (a signal's number below 0, None where it did not end), the plan, what was printed."""

    def __init__(self, code, plan, out, err):
        self.code, self.out, self.err = code, out, err
        self.__dict__.update(zip(NAMES, plan))
        self.path = self.path.split(b"\0")[0].decode(errors="replace")


def is_stopped(process):
    try:
        with open("/proc/%d/stat" % process, encoding="ascii") as f:
            return f.read().rpartition(")")[2].split()[0] in "Tt"
    except OSError:
        return False


class Server:
    """One command line, ready to run."""

    def __init__(self, command, library, folder, stdin=os.devnull):
        self.plan_file = tempfile.TemporaryFile()
        self.plan_file.truncate(FIELDS.size)
        self.plan = mmap.mmap(self.plan_file.fileno(), FIELDS.size)
        self.printed = [tempfile.TemporaryFile(buffering=0) for _ in range(2)]
        for file in self.printed:
            os.set_inheritable(file.fileno(), True)
        orders, self.orders = os.pipe()
        self.answers, answers = os.pipe()
        passed = (self.plan_file.fileno(), orders, answers)
        environment = dict(os.environ, LD_PRELOAD=library, BRIO_FAULT_SERVER="%d,%d,%d" % passed)
        with open(stdin, "rb") as self_in:
            self.process = subprocess.Popen(command, stdin=self_in, stdout=self.printed[0], stderr=self.printed[1],
                                            pass_fds=passed, cwd=folder, env=environment)
        os.close(orders)
        os.close(answers)

    def close(self):
        os.close(self.orders)
        self.process.wait()
        os.close(self.answers)
        self.plan.close()
        for file in [self.plan_file, *self.printed]:
            file.close()

    def answer(self, child=None):
        """The next number from the server; None where the child takes too long."""
        left = LIMIT
        while not select.select([self.answers], [], [], 1)[0]:
            left -= not is_stopped(child or self.process.pid)
            if left == 0:
                return None
        return struct.unpack("<i", os.read(self.answers, 4))[0]

    def run(self, kind=NONE, k=0, last=None, detail=0):
        self.plan[:] = FIELDS.pack(kind, detail, k, k if last is None else last, 0, 0, 0, 0, 0, 0, b"")
        for file in self.printed:
            file.truncate(0)
            file.seek(0)
        os.write(self.orders, b"r")
        child = self.answer()
        status = self.answer(child)
        late = status is None
        if late:
            os.kill(child, signal.SIGKILL)
            status = self.answer()
        code = None if late else os.waitstatus_to_exitcode(status)
        texts = [os.pread(file.fileno(), 1 << 24, 0) for file in self.printed]
        return Came(code, FIELDS.unpack(self.plan[:]), texts[0], texts[1].decode(errors="replace"))
