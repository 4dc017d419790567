"""interrupt.py WORK ...: by how much processor time calls outlast a signal, in the worst of two moments. WORK: delaunay, plane,
labeled-delaunay, power-crust, voronoi, alpha, locate, natural, natural2, tiles, cells-in-tiles. It is an error if a call is not interrupted."""

import signal
import sys
import tempfile
import time

import brio
import numpy as np

rng = np.random.default_rng(1)


def prepare(work):
    if work in ("delaunay", "voronoi", "alpha"):
        space = rng.random((1_000_000, 3))
        function = {"delaunay": brio.Delaunay, "voronoi": brio.Voronoi, "alpha": brio.alpha_complex}[work]
        return lambda: function(space, threads=1)
    if work in ("labeled-delaunay", "power-crust"):
        ball = rng.normal(size=(100_000, 3))
        ball /= np.linalg.norm(ball, axis=1)[:, None]
        return lambda: brio.reconstruct(ball, work, threads=1)
    if work == "tiles":
        many = rng.random((300_000, 3))
        return lambda: brio.TiledDelaunay(many, scratch=tempfile.gettempdir(), tiles=4, threads=1)
    if work == "cells-in-tiles":
        tri = brio.TiledDelaunay(rng.random((40_000, 3)), scratch=tempfile.gettempdir(), tiles=4, stars=True)
        return lambda: [tri.cells(len) for _ in range(9)]
    d = 2 if work in ("plane", "natural2") else 3
    queries, tri = rng.random((2_000_000, d)), brio.Delaunay(rng.random((1000, d)))
    if work == "plane":
        return lambda: brio.Delaunay(queries)
    if work == "locate":
        return lambda: [tri.find_simplex(queries) for _ in range(9)]
    return lambda: brio.NaturalNeighbourInterpolator(tri, np.ones(1000))(queries)


def outlasts(work):
    worst = 0.0
    for after in 0.1, 0.37:
        begin = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, after)
        try:
            work()
            raise SystemExit("ended after %g s" % (time.process_time() - begin))
        except KeyboardInterrupt:
            worst = max(worst, time.process_time() - begin - after)
    return worst


signal.signal(signal.SIGPROF, signal.default_int_handler)
for name in sys.argv[1:]:
    print("%-17s %.3f s" % (name, outlasts(prepare(name))))
