#!/usr/bin/python3
"""Open3D's surfaces of points with normals, by a separate program: nothing of it is in brio's process.

    open3d_surface.py poisson-5|poisson-20|pivoting IN OUT

Needs Open3D from PyPI: scripts/setup.sh rivals installs it in out/open3d-env. Poisson reconstruction has depth 8, and of its vertices
5 or 20 in a hundred, those with the least density, are cut off. Ball pivoting has balls of 1, 2 and 4 times the mean distance of nearest points."""
import sys

DEPTH = 8
RADII = [1, 2, 4]


def poisson(o3d, np, cloud, cut):
    mesh, density = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=DEPTH)
    density = np.asarray(density)
    mesh.remove_vertices_by_mask(density < np.quantile(density, cut))
    return mesh


def pivoting(o3d, np, cloud):
    spacing = float(np.mean(cloud.compute_nearest_neighbor_distance()))
    radii = o3d.utility.DoubleVector([factor * spacing for factor in RADII])
    return o3d.geometry.TriangleMesh.create_from_point_cloud_ball_pivoting(cloud, radii)


def main():
    way, source, out = sys.argv[1:]
    import numpy as np
    import open3d as o3d
    cloud = o3d.io.read_point_cloud(source)
    if way == 'pivoting':
        mesh = pivoting(o3d, np, cloud)
    else:
        mesh = poisson(o3d, np, cloud, {'poisson-5': 0.05, 'poisson-20': 0.2}[way])
    return 0 if o3d.io.write_triangle_mesh(out, mesh, write_vertex_normals=False) else 1


if __name__ == '__main__':
    sys.exit(main())
