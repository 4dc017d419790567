"""Alpha shapes: of how many components is the solid?"""
import sys
import matplotlib.pyplot as plt
import numpy as np
import brio

rng = np.random.default_rng(10)
points = rng.normal(size=(4000, 3))
points *= rng.random((4000, 1)) ** (1 / 3) / np.linalg.norm(points, axis=1)[:, None]
points[2000:, 0] += 2.5
complex = brio.alpha_complex(points)
alphas = np.geomspace(0.002, 1, 30)
components = [complex.shape(alpha).certificate.components for alpha in alphas]
plt.figure(figsize=(4, 3))
plt.loglog(alphas, components, ".-")
plt.axhline(2, lw=0.5)
plt.xlabel("alpha (squared radius)")
plt.ylabel("components of the boundary")
plt.tight_layout()
plt.savefig(sys.argv[1], dpi=80)
