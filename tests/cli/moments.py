"""How soon a signal ends a run: processor time from SIGINT to the end of the process, at moments spread over long runs of every
command, in a table. Exits with 1 where it is more than half a second, or where every moment came too late to tell.

    BRIO=build/brio python3 tests/cli/moments.py [--moments 20] [--scale 1] [WORD ...]

WORD is a command, or a part of a line of long_runs.py. The first run of each command is interrupted at all moments, the others at a
fourth of them.
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time

from brio_cli import BRIO
from long_runs import RUNS, Inputs

MOST = 0.5  # seconds
TICK = os.sysconf("SC_CLK_TCK")


def processor_time(pid):
    """Of all threads of a process that has not been waited for, to a hundredth of a second."""
    with open("/proc/%d/stat" % pid) as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def whole(line):
    """The processor time of a run that is let alone, and its exit code."""
    process = subprocess.Popen([BRIO] + line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime, process.returncode


def interrupted(line, when):
    """Interrupts a run after `when` seconds of processor time. Returns how many more it took, or None if it ended before."""
    process = subprocess.Popen([BRIO] + line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    at = 0
    while at < when:
        time.sleep(0.002)
        at = processor_time(process.pid)
        with open("/proc/%d/stat" % process.pid) as file:
            if file.read().rsplit(")", 1)[1].split()[0] == "Z":
                break
    os.kill(process.pid, signal.SIGINT)  # not send_signal, which takes the status of a run that has ended
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime - at if process.returncode == 130 else None


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("words", nargs="*")
    options.add_argument("--moments", type=int, default=20)
    options.add_argument("--scale", type=float, default=1.0)
    chosen = options.parse_args()
    # A script in the background is started with the signal ignored, and what it starts inherits that: brio would go on, rightly.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    late = missed = 0
    print("| run | seconds | moments | ended before | mean | most |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="brio-moments-") as folder:
        inputs = Inputs(folder, chosen.scale)
        for command, templates in RUNS.items():
            for number, template in enumerate(templates):
                if chosen.words and not any(word in template for word in chosen.words):
                    continue
                line = inputs.line(template) + ["--quiet"]
                seconds, code = whole(line)
                if code not in (0, 5):  # a check may find faults
                    sys.exit("%s: exit code %d" % (" ".join(line), code))
                moments = chosen.moments if number == 0 else max(1, chosen.moments // 4)
                found = [interrupted(line, seconds * (i + 0.5) / moments) for i in range(moments)]
                after = [x for x in found if x is not None]
                most = max(after, default=0)
                late += most > MOST
                missed += not after
                print("| `%s` | %.2f | %d | %d | %.3f | %.3f |" % (template, seconds, moments, moments - len(after),
                      sum(after) / max(len(after), 1), most), flush=True)
    print("%d runs over %g s, %d that no moment met" % (late, MOST, missed))
    sys.exit(late > 0 or missed > 0)


if __name__ == "__main__":
    main()
