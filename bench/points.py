"""Points of PLY files, for the benchmarks."""
import numpy as np

SCALARS = {'char': 'i1', 'uchar': 'u1', 'short': '<i2', 'ushort': '<u2', 'int': '<i4', 'uint': '<u4', 'float': '<f4',
           'double': '<f8', 'int8': 'i1', 'uint8': 'u1', 'int16': '<i2', 'uint16': '<u2', 'int32': '<i4',
           'uint32': '<u4', 'float32': '<f4', 'float64': '<f8'}


def read_points(path):
    """x, y, z of a binary little-endian PLY, in their own type."""
    with open(path, 'rb') as f:
        row, count, vertex = [], 0, False
        for line in iter(f.readline, b'end_header\n'):
            w = line.decode().split()
            if w[0] == 'element':
                vertex = w[1] == 'vertex'
                count = int(w[2]) if vertex else count
            elif w[0] == 'property' and vertex:
                row.append((w[2], SCALARS[w[1]]))
        a = np.fromfile(f, np.dtype(row), count)
    return np.stack([a[c] for c in 'xyz'], 1)
