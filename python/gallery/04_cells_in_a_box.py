"""Cells in a box: the volumes of power cells"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

rng = np.random.default_rng(4)
points = rng.random((20_000, 3))
plain = brio.Voronoi(points, box=[[0, 0, 0], [1, 1, 1]])
power = brio.Voronoi(points, 0.002 * rng.random(len(points)), box=[[0, 0, 0], [1, 1, 1]])
assert np.isclose(plain.volumes.sum(), 1) and np.isclose(power.volumes.sum(), 1)
plt.figure(figsize=(4, 3))
for vor, label in ((plain, "Voronoi"), (power, "power")):
    plt.hist(vor.volumes[vor.volumes > 0] * len(points), bins=np.linspace(0, 4, 60), histtype="step", label=label)
plt.xlabel("volume of a cell / mean")
plt.legend()
plt.tight_layout()
plt.savefig(sys.argv[1], dpi=80)
