"""What the tests share: the package of the build (BRIO_PYTHON names its folder), points, and processes of their own."""

import os
import subprocess
import sys

import pytest

if os.environ.get("BRIO_PYTHON"):
    sys.path.insert(0, os.environ["BRIO_PYTHON"])


# What starts a new Python: in an emulator (tests/targets/wheels.py) the system does not know its program.
PYTHON = [*os.environ.get("BRIO_EMULATOR", "").split(), sys.executable]


@pytest.fixture
def alone():
    """Runs a program in a new process; returns what it printed."""

    def run(program, *arguments, timeout=120):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
        done = subprocess.run([*PYTHON, "-X", "faulthandler", "-c", program, *arguments], env=environment,
                              capture_output=True, text=True, timeout=timeout)
        assert done.returncode == 0, "status %d\n%s\n%s" % (done.returncode, done.stdout[-2000:], done.stderr[-4000:])
        return done.stdout

    return run
