"""The convex hull of points on a sphere and inside"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

rng = np.random.default_rng(5)
points = rng.normal(size=(100_000, 3))
points *= (rng.random((100_000, 1)) ** (1 / 3)) / np.linalg.norm(points, axis=1)[:, None]
hull = brio.ConvexHull(points)
axes = plt.figure(figsize=(4, 4)).add_subplot(projection="3d")
axes.plot_trisurf(*points.T, triangles=hull.simplices, edgecolor="k", lw=0.1)
axes.set_title(f"{len(hull.vertices)} vertices, volume {hull.volume:.4f}", fontsize=9)
axes.set_axis_off()
plt.savefig(sys.argv[1], dpi=80)
