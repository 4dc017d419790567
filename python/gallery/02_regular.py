"""Weights: a regular triangulation, and the points that it hides"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

rng = np.random.default_rng(2)
points, radii = rng.random((150, 2)), 0.12 * rng.random(150) ** 3
tri = brio.Delaunay(points, radii**2)
fig, axes = plt.subplots(figsize=(4, 4))
for centre, radius in zip(points, radii):
    axes.add_patch(plt.Circle(centre, radius, color="tab:blue", alpha=0.2))
axes.triplot(*points.T, tri.simplices, lw=0.5, color="k")
axes.plot(*points[tri.hidden].T, "rx")
axes.set_aspect("equal")
axes.axis("off")
fig.savefig(sys.argv[1], dpi=80)
