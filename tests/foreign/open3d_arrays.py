"""open3d_arrays.py [read|write KIND FILE ARRAYS] ...: what Open3D finds in files, or what it writes of arrays.

KIND is cloud or mesh; ARRAYS is a NumPy archive of points, colors, normals (rows of three) and triangles. A program by itself,
because Open3D is in an environment that the tests are not in.
"""

import sys

import numpy
import open3d


def read(kind, path):
    if kind == "cloud":
        found = open3d.io.read_point_cloud(path)
        arrays = {"points": found.points, "colors": found.colors, "normals": found.normals}
    else:
        found = open3d.io.read_triangle_mesh(path)
        arrays = {"points": found.vertices, "colors": found.vertex_colors, "normals": found.vertex_normals,
                  "triangles": found.triangles}
    return {name: numpy.asarray(values) for name, values in arrays.items()}


def write(kind, path, arrays):
    vector = open3d.utility.Vector3dVector
    if kind == "cloud":
        made = open3d.geometry.PointCloud(vector(arrays["points"]))
        made.colors, made.normals = vector(arrays["colors"]), vector(arrays["normals"])
        return open3d.io.write_point_cloud(path, made)
    made = open3d.geometry.TriangleMesh(vector(arrays["points"]), open3d.utility.Vector3iVector(arrays["triangles"]))
    made.vertex_colors, made.vertex_normals = vector(arrays["colors"]), vector(arrays["normals"])
    made.compute_triangle_normals()  # without which it writes no STL
    return open3d.io.write_triangle_mesh(path, made)


def main(jobs):
    for verb, kind, path, arrays in zip(*[iter(jobs)] * 4):
        if verb == "read":
            numpy.savez(arrays, **read(kind, path))
        elif not write(kind, path, dict(numpy.load(arrays))):
            sys.exit("Open3D writes no " + path)


if __name__ == "__main__":
    main(sys.argv[1:])
