"""Screened Poisson reconstruction, a program of its own: nothing of it is in brio's process.

    poisson.py POINTS OUT --normals given|estimated      prints {"seconds": processor time}

POINTS is a binary little-endian PLY with normals, which `estimated` ignores: it takes those of planes through the nearest
points, oriented along a minimum spanning tree. Needs PyMeshLab from PyPI, which has the program of the authors.

Based on: Kazhdan, Hoppe. Screened Poisson surface reconstruction. ACM TOG 2013.
          Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH 1992 (normals).
"""
import argparse
import json
import sys
import time

DEPTH = 8      # of the octree, the default of the program: cells of about half the spacing of 20,000 samples
NEAREST = 16   # points for a plane


def reconstruct(pymeshlab, points, out, estimated):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(points)
    if estimated:
        meshes.compute_normal_for_point_clouds(k=NEAREST)
    meshes.generate_surface_reconstruction_screened_poisson(depth=DEPTH, threads=1)
    meshes.save_current_mesh(out, save_vertex_normal=False, save_vertex_color=False, save_vertex_quality=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('points')
    parser.add_argument('out')
    parser.add_argument('--normals', choices=['given', 'estimated'], default='given')
    options = parser.parse_args()
    import pymeshlab  # late: its seconds do not count
    begin = time.process_time()
    reconstruct(pymeshlab, options.points, options.out, options.normals == 'estimated')
    print(json.dumps({'seconds': time.process_time() - begin}))
    return 0


if __name__ == '__main__':
    sys.exit(main())
