"""Voronoi cells, coloured by their areas"""
import sys
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
import brio

points = np.random.default_rng(3).random((400, 2))
vor = brio.Voronoi(points)
bounded = np.flatnonzero(np.isfinite(vor.volumes))
cells = [vor.vertices[vor.regions[vor.point_region[p]]] for p in bounded]
fig, axes = plt.subplots(figsize=(4, 4))
axes.add_collection(PolyCollection(cells, array=np.log(vor.volumes[bounded]), edgecolor="w", lw=0.5))
axes.plot(*points.T, "k.", ms=2)
axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
axes.axis("off")
fig.savefig(sys.argv[1], dpi=80)
