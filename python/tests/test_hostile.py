"""Nothing that a program can do from Python crashes the interpreter. Each test runs in a new process."""

import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest
from conftest import PYTHON

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no fork, no timers by signals, no module resource")

HOSTILE = r"""
import random, sys, tempfile, warnings
import numpy as np
import brio
from brio import _native

folder = tempfile.TemporaryDirectory()

warnings.simplefilter("ignore")
draw = random.Random(int(sys.argv[1]))
calls = int(sys.argv[2])


def numbers():
    n, d = draw.choice([0, 1, 2, 3, 4, 5, 8, 20, 50]), draw.choice([1, 2, 3, 2, 3, 2, 3, 4])
    kind = draw.randrange(7)
    rng = np.random.default_rng(draw.randrange(10**6))
    if kind == 0:
        return rng.random((n, d))
    if kind == 1:
        return rng.integers(0, 3, (n, d)).astype(float)
    if kind == 2:
        return rng.choice([0, 1, -1, 1e-300, 1e300, 1.7e308, -1.7e308, 5e-324], (n, d))
    if kind == 3:
        return rng.choice([0, 1, np.nan, np.inf, -np.inf], (n, d))
    if kind == 4:
        return rng.random((n, d))[::-1]
    if kind == 5:
        return np.asfortranarray(rng.random((n, d)).astype(draw.choice([">f8", "f4", "f2", "i8", "u1", "c16"])))
    return np.lib.stride_tricks.as_strided(rng.random((n + 1) * d), (n, d), (8, 8))


class Odd:
    def __array__(self, *args, **options):
        raise draw.choice([ValueError("no"), KeyError("no"), RuntimeError("no")])

    def __len__(self):
        return 10**9

    def __call__(self, *args):
        raise ZeroDivisionError


def thing():
    odd = [None, 0, -1, 1.5, "text", b"bytes", [], [[]], [[1, 2], [3]], {}, object(), Odd(), [None] * 3, float("nan"), 2**70,
           -2**70, np.zeros((0, 3)), np.zeros((3, 0)), np.zeros((2, 3, 4)), np.array(5), np.array([object()] * 4),
           np.ma.masked_all((4, 3)), memoryview(b"123"), range(5), np.zeros((5, 3), "f8,f8"), np.zeros(4, "U3"), True, Ellipsis]
    return numbers() if draw.random() < 0.6 else draw.choice(odd)


def objects():
    p = np.random.default_rng(draw.randrange(1000)).random((draw.choice([4, 20, 60]), draw.choice([2, 3])))
    out = [brio.Delaunay(p), brio.Voronoi(p), brio.ConvexHull(p), brio.LinearNDInterpolator(p, p[:, 0]),
           brio.NaturalNeighbourInterpolator(p, p), brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])]
    if p.shape[1] == 3:
        out.append(brio.alpha_complex(p))
        out.append(brio.TiledDelaunay(p, scratch=folder.name, tiles=3, stars=True))
        out.append(out[-1].part(0))
    return out


NAMES = [name for name in brio.__all__ if name[0] != "_" and name not in ("errors", "write", "read", "convert")]
NATIVE = [name for name in dir(_native) if callable(getattr(_native, name)) and name not in ("set_make_error", "read", "write", "convert")]
alive, handles, outcomes = objects(), [], {}


def attempt():
    global alive
    kind = draw.randrange(10)
    if kind < 3:
        arguments = [thing() for _ in range(draw.randrange(1, 4))]
        options = draw.choice([{}, {"threads": draw.choice([0, 1, 2, -5, 10**6])}, {"progress": thing()}, {"weights": thing()}])
        return getattr(brio, draw.choice(NAMES))(*arguments, **options)
    if kind < 7:
        target = draw.choice(alive)
        name = draw.choice([n for n in dir(type(target)) if not n.startswith("__")] or ["close"])
        value = getattr(target, name)
        return value(*[thing() for _ in range(draw.randrange(0, 3))]) if callable(value) else value
    if kind < 9:
        pool = handles + [thing() for _ in range(4)]
        return getattr(_native, draw.choice(NATIVE))(*[draw.choice(pool) for _ in range(draw.randrange(0, 8))])
    alive = objects()
    handles[:] = [t._handle for t in alive if hasattr(t, "_handle")] + [np.empty((9, 3), np.int32), np.empty(9), 0, 1, None]
    return setattr(draw.choice(alive), draw.choice(["points", "weights", "_handle", "values", "simplices"]), thing())


for n in range(calls):
    try:
        attempt()
        outcome = "fine"
    except (KeyboardInterrupt, SystemExit):
        raise
    except Exception as error:
        outcome = type(error).__name__
    outcomes[outcome] = outcomes.get(outcome, 0) + 1
print(sum(outcomes.values()), outcomes)
"""


@pytest.mark.parametrize("seed", [1, 2, 3, 4] if os.environ.get("BRIO_LONG") else [1, 2])
def test_hostile_calls(alone, seed):
    calls = 2500 if os.environ.get("BRIO_LONG") else 400
    out = alone(HOSTILE, str(seed), str(calls), timeout=300)
    assert out.startswith("%d " % calls) and "SystemError" not in out


# Seconds of changes, for each of the programs below.
CHANGED_SECONDS = "3" if os.environ.get("BRIO_LONG") else "0.25"

CHANGED = r"""
import sys, threading, time
import numpy as np
import brio

stop = False


def change(points):
    rng = np.random.default_rng(1)
    while not stop:
        k = rng.integers(0, len(points), 50)
        points[k] = rng.random((50, points.shape[1])) if rng.random() < 0.9 else rng.choice([0, 1, 0.5], (50, points.shape[1]))


fine = refused = 0
for d in 2, 3:
    for n in 300, 5000:
        points, stop = np.random.default_rng(2).random((n, d)), False
        thread = threading.Thread(target=change, args=(points,))
        thread.start()
        end = time.monotonic() + float(sys.argv[1])
        while time.monotonic() < end:
            tri = brio.Delaunay(points)
            for call in (lambda: tri.find_simplex(points), tri.verify, lambda: brio.ConvexHull(points),
                         lambda: brio.LinearNDInterpolator(tri, points)(points)):
                try:
                    call()
                    fine += 1
                except brio.ArgumentError:
                    refused += 1
        stop = True
        thread.join()
print(fine > 0, refused > 0)
"""


def test_arrays_that_another_thread_changes(alone):
    assert alone(CHANGED, CHANGED_SECONDS).split() == ["True", "True"]


CHANGED_HULL = r"""
import sys, threading, time
import numpy as np
import brio

good = np.random.default_rng(1).normal(size=(100_000, 3))
points, stop = good.copy(), threading.Event()


def change():
    rng = np.random.default_rng(2)
    while not stop.is_set():
        rows = rng.integers(0, len(points), 2000)
        points[rows] = rng.normal(size=(2000, 3)) * rng.choice([1, 1, 1e150, np.nan]) if rng.random() < 0.7 else points[0]
        points[rows] = good[rows]


thread = threading.Thread(target=change)
thread.start()
made, end = 0, time.monotonic() + float(sys.argv[1])
while time.monotonic() < end:
    try:
        hull = brio.ConvexHull(points, threads=2)
    except brio.Error:
        continue
    assert hull.vertices.max() < len(points) and hull.simplices.min() >= 0 and hull.neighbors.max() < hull.nsimplex
    made += 1
stop.set()
thread.join()
print(made > 0, np.array_equal(brio.ConvexHull(points).vertices, brio.ConvexHull(good).vertices))
"""


def test_hulls_of_points_that_another_thread_changes(alone):
    assert alone(CHANGED_HULL, CHANGED_SECONDS).split() == ["True", "True"]


@posix
def test_hulls_without_a_copy_of_the_points(alone):
    grown = alone(r"""
import resource, numpy as np, brio

def most():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

points = np.random.default_rng(1).random((1_500_000, 3))
brio.ConvexHull(points[:1000])
before = most()
brio.ConvexHull(points)
print(most() - before)
""")
    assert float(grown) < 1_500_000 * 24 / 2**20 / 2  # MiB: half a copy


FORK = r"""
import os, threading, numpy as np, brio

points = np.random.default_rng(1).random((30000, 3))
first = brio.Delaunay(points, threads=2)
busy = threading.Thread(target=lambda: [brio.Delaunay(points, threads=2) for _ in range(6)])
busy.start()
children = []
for _ in range(4):
    child = os.fork()
    if not child:
        assert brio.Delaunay(points, threads=2).checksum == first.checksum
        assert first.find_simplex(points[:100]).min() >= 0
        del first
        os._exit(0)
    children.append(child)
busy.join()
print(all(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0 for child in children))
"""


@posix
def test_fork_while_a_call_runs(alone):
    assert alone(FORK, timeout=100).strip() == "True"


POOL = r"""
import multiprocessing, numpy as np, brio

def total(seed):
    return brio.Delaunay(np.random.default_rng(seed).random((5000, 3)), threads=2).checksum

if __name__ == "__main__":
    wanted = [total(k) for k in range(4)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        print(pool.map(total, range(4)) == wanted)
"""


@posix
def test_processes_of_multiprocessing(alone):
    assert alone(POOL).strip() == "True"


SUBINTERPRETER = r"""
try:
    import _interpreters as interpreters
except ImportError:
    import _xxsubinterpreters as interpreters
import brio, numpy as np
from brio import _native

brio.Delaunay(np.random.default_rng(1).random((100, 3)))
for _ in range(3):
    other = interpreters.create()
    try:
        # numpy may refuse to be loaded by an interpreter that is not the first; the module itself must not mind.
        interpreters.run_string(other, '''
import importlib.util, array
spec = importlib.util.spec_from_file_location("brio._native", %r)
native = importlib.util.module_from_spec(spec)
spec.loader.exec_module(native)
native.set_make_error(lambda status, sentence, points, reason: RuntimeError(sentence))
points = memoryview(array.array("d", [0, 0, 1, 0, 0, 1])).cast("B").cast("d", (3, 2))
t = native.delaunay2(points, None, 0, None)
assert native.triangulation_facts(t)["simplices"] == 1
assert sorted(memoryview(native.triangulation_view(t, 0)).tolist()[0]) == [0, 1, 2]
''' % _native.__file__)
    finally:
        interpreters.destroy(other)
brio.Delaunay(np.random.default_rng(1).random((100, 3))).verify()
print("done")
"""


def test_other_interpreters(alone):
    assert alone(SUBINTERPRETER).strip().endswith("done")


INTERRUPT = pathlib.Path(__file__).parent.parent / "bench" / "interrupt.py"


@posix
@pytest.mark.parametrize("work", ["delaunay", "plane", "labeled-delaunay", "power-crust", "voronoi", "alpha", "locate",
                                  "natural", "natural2", "tiles", "cells-in-tiles"])
def test_interrupt(alone, work):
    """A signal ends a call, wherever in the call it comes. How soon: docs/measured/python.md."""
    assert alone(INTERRUPT.read_text(), work).startswith(work)


def test_interrupt_by_a_thread(alone):
    """What a session's button for it does on every system."""
    assert alone(r"""
import _thread, signal, threading, numpy as np, brio
signal.signal(signal.SIGINT, signal.default_int_handler)
points = np.random.default_rng(1).random((1_000_000, 3))
try:
    threading.Timer(0.3, _thread.interrupt_main).start()
    brio.Delaunay(points, threads=1)
    print("ended")
except KeyboardInterrupt:
    print("interrupted")
""").strip() == "interrupted"


@posix
def test_ctrl_c():
    program = """
import signal, numpy as np, brio
signal.signal(signal.SIGINT, signal.default_int_handler)  # which Python does not do where the tests run in the background of a shell
points = np.random.default_rng(1).random((4_000_000, 3))
print("ready", flush=True)
try:
    brio.Delaunay(points)
except KeyboardInterrupt:
    print("interrupted")
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    process = subprocess.Popen([*PYTHON, "-c", program], env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=60)[0].split() == ["interrupted"]


MEMORY = r"""
import gc, resource, sys, numpy as np, brio

def held():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()

points = np.random.default_rng(1).random((2000, 3))
plane = np.ascontiguousarray(points[:, :2])

def build():
    for p in points, plane:
        tri = brio.Delaunay(p)
        tri.find_simplex(p[:10]), tri.neighbors, tri.simplices
        try:
            brio.Delaunay(np.full((3, 2), np.nan))
        except brio.NotFiniteError:
            pass

for _ in range(100):
    build()
gc.collect()
before = held()
for _ in range(400):
    build()
gc.collect()
print((held() - before) / 2**20)
"""


@posix
def test_hundreds_of_builds_without_growth(alone):
    assert float(alone(MEMORY, timeout=300)) < 1.6


TOGETHER = r"""
import threading, numpy as np, brio

# Each call waits, in its progress function, until the other call is in its own: two calls that excluded each other would
# wait for ever, and the barrier would break.
both = threading.Barrier(2, timeout=60)
errors = []


def build(seed):
    met = []

    def progress(stage, share):
        if not met:
            met.append(both.wait())

    try:
        # The library calls back 50 times a second: a call that is too short for that is repeated.
        while not met:
            brio.Delaunay(np.random.default_rng(seed).random((100_000, 3)), threads=1, progress=progress)
    except BaseException as error:
        errors.append(repr(error))


threads = [threading.Thread(target=build, args=(seed,)) for seed in range(2)]
for t in threads:
    t.start()
for t in threads:
    t.join()
print(errors)
"""


def test_two_threads_build_side_by_side(alone):
    assert alone(TOGETHER).strip() == "[]"


def test_one_object_used_by_several_threads(alone):
    """Also while one of them adds points: then the others see the object before or after that, never between."""
    alone(r"""
import threading, numpy as np, brio
points = np.random.default_rng(1).random((3000, 3))
for d in 2, 3:
    p = np.ascontiguousarray(points[:, :d])
    tri, hull = brio.Delaunay(p), brio.ConvexHull(p)
    wanted, wrong = brio.Delaunay(p).find_simplex(p), []
    def use():
        try:
            for _ in range(8):
                if (tri.find_simplex(p) != wanted).any(): wrong.append("simplex")
                tri.neighbors, tri.transform, tri.vertex_neighbor_vertices, tri.checksum
                if len(hull.equations) != len(hull.simplices): wrong.append("hull")
                tri.add_points(p[:0])
                hull.add_points(p[:0])
        except BaseException as error:
            wrong.append(repr(error))
    threads = [threading.Thread(target=use) for _ in range(4)]
    for t in threads: t.start()
    for t in threads: t.join()
    assert not wrong, wrong
""")
