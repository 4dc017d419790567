"""Medial axis and offset of a sampled ellipsoid"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

points = np.random.default_rng(9).normal(size=(3000, 3))
points *= np.array([2, 1, 1]) / np.linalg.norm(points, axis=1)[:, None]
axis, shell = brio.medial_axis(points), brio.offset(points, 0.3)
plt.figure(figsize=(5, 3))
for cloud, style in ((points, "k."), (shell.vertices, "c."), (axis.vertices, "r.")):
    near = np.abs(cloud[:, 2]) < 0.06
    plt.plot(*cloud[near, :2].T, style, ms=3)
plt.axis("equal")
plt.axis("off")
plt.savefig(sys.argv[1], dpi=80)
