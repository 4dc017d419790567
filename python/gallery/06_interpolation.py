"""Linear interpolation and natural neighbours"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

points = np.random.default_rng(6).random((120, 2))
values = np.sin(8 * points[:, 0]) * np.cos(6 * points[:, 1])
x, y = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200))
fig, axes = plt.subplots(1, 2, figsize=(6, 3))
for ax, kind in zip(axes, (brio.LinearNDInterpolator, brio.NaturalNeighbourInterpolator)):
    ax.imshow(kind(points, values)(x, y), origin="lower", extent=(0, 1, 0, 1))
    ax.plot(*points.T, "k.", ms=2)
    ax.set_title(kind.__name__, fontsize=8)
    ax.axis("off")
fig.savefig(sys.argv[1], dpi=80)
