"""A surface from points"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

rng = np.random.default_rng(7)
u, v = 2 * np.pi * rng.random((2, 6000))
points = np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)], axis=1)
surface = brio.reconstruct(points)
c = surface.certificate
assert c.closed and c.manifold and c.genus == 1
axes = plt.figure(figsize=(4, 4)).add_subplot(projection="3d")
axes.plot_trisurf(*surface.vertices.T, triangles=surface.faces, lw=0)
axes.set(zlim=(-1, 1), title=f"closed, genus {c.genus}, volume {c.volume:.2f}")
axes.set_axis_off()
plt.savefig(sys.argv[1], dpi=80)
