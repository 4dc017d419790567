"""draw.py PICTURE.png: what README.md says of the accessor, side by side: points, their surface, tetrahedra, cells."""
import sys

import brio_pyvista  # noqa: F401: registers the accessor
import numpy as np
import pyvista


def torus(count):
    """Points on a torus, even in its area."""
    rng = np.random.default_rng(4)
    u, v, keep = rng.random((3, 4 * count))
    u, v = 2 * np.pi * u, 2 * np.pi * v
    taken = keep < (1 + 0.4 * np.cos(v)) / 1.4
    u, v = u[taken][:count], v[taken][:count]
    return np.column_stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)])


def draw(path):
    cloud = pyvista.PolyData(torus(4000))
    cloud["height"] = cloud.points[:, 2]
    few = pyvista.PolyData(np.random.default_rng(5).random((60, 3)))
    tetrahedra = few.brio.delaunay_3d()
    cells = few.brio.voronoi()
    plotter = pyvista.Plotter(shape=(1, 4), window_size=(1400, 380), off_screen=True, border=False)
    shown = [(cloud, {"scalars": "height", "point_size": 3}, "cloud"),
             (cloud.brio.surface(), {"scalars": "height", "show_edges": True, "line_width": 0.3}, "cloud.brio.surface()"),
             (tetrahedra.explode(0.4), {"color": "#7aa6c2", "show_edges": True}, "cloud.brio.delaunay_3d()"),
             (cells.explode(0.4), {"scalars": "volume", "show_edges": True}, "cloud.brio.voronoi()")]
    for column, (mesh, options, title) in enumerate(shown):
        plotter.subplot(0, column)
        plotter.add_mesh(mesh, show_scalar_bar=False, **options)
        plotter.add_text(title, font_size=9)
    plotter.screenshot(path)
    plotter.close()


if __name__ == "__main__":
    draw(sys.argv[1])
