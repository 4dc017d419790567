"""Normals that point outwards"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

points = np.random.default_rng(8).normal(size=(1500, 3))
points *= np.array([2, 1, 1]) / np.linalg.norm(points, axis=1)[:, None]
normals = brio.oriented_normals(points)
slice_ = np.abs(points[:, 2]) < 0.12
plt.figure(figsize=(5, 3))
plt.quiver(*points[slice_, :2].T, *normals[slice_, :2].T, width=0.003)
plt.axis("equal")
plt.axis("off")
plt.savefig(sys.argv[1], dpi=80)
