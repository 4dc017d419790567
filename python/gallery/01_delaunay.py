"""Triangulation of points in the plane"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

points = np.random.default_rng(1).normal(size=(300, 2))
tri = brio.Delaunay(points)
tri.verify()
plt.figure(figsize=(4, 4))
plt.triplot(*points.T, tri.simplices, lw=0.5)
plt.plot(*points.T, ".", ms=3)
plt.axis("equal")
plt.axis("off")
plt.savefig(sys.argv[1], dpi=80)
