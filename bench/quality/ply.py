"""Binary little-endian PLY files: those of brio, and those of the corpora."""
import os

import numpy as np

SCALARS = {'char': 'i1', 'int8': 'i1', 'uchar': 'u1', 'uint8': 'u1', 'short': '<i2', 'int16': '<i2', 'ushort': '<u2',
           'uint16': '<u2', 'int': '<i4', 'int32': '<i4', 'uint': '<u4', 'uint32': '<u4', 'float': '<f4',
           'float32': '<f4', 'double': '<f8', 'float64': '<f8'}
NAMES = {'i1': 'char', 'u1': 'uchar', 'i4': 'int', 'f4': 'float', 'f8': 'double'}


def read_header(f):
    """The elements of a file: a name, a count, and the words of each property."""
    elements = []
    for line in iter(f.readline, b'end_header\n'):
        if not line:
            raise ValueError('no end of the header')
        words = line.decode('latin1').split()
        if words[0] == 'format' and words[1] != 'binary_little_endian':
            raise ValueError('the format is ' + words[1])
        if words[0] == 'element':
            elements.append((words[1], int(words[2]), []))
        elif words[0] == 'property':
            elements[-1][2].append(words[1:])
    return elements


def read_rows(f, count, properties, length):
    """The rows of an element as a structured array. A list must have `length` entries in all rows."""
    fields = []
    for words in properties:
        if words[0] == 'list':
            fields += [('length', SCALARS[words[1]]), (words[3], SCALARS[words[2]], length)]
        else:
            fields.append((words[1], SCALARS[words[0]]))
    rows = np.fromfile(f, np.dtype(fields), count)
    if len(rows) < count or ('length' in rows.dtype.names and (rows['length'] != length).any()):
        raise ValueError('lists of other lengths than %d, or no end' % length)
    return rows


def read_cells(path, element, length):
    """The points of a file and its cells of `length` corners: of the element `face` or `tetrahedron`."""
    points, cells = None, np.zeros((0, length), np.int64)
    with open(path, 'rb') as f:
        for name, count, properties in read_header(f):
            rows = read_rows(f, count, properties, length)
            if name == 'vertex':
                points = np.stack([rows[axis].astype(float) for axis in 'xyz'], 1)
            elif name == element:
                cells = rows[rows.dtype.names[1]].astype(np.int64)
    return points, cells


def read_mesh(path):
    """The points and the triangles of a file."""
    return read_cells(path, 'face', 3)


def write_elements(path, elements):
    """elements: a name and a structured array each, whose two-dimensional fields follow their lengths."""
    header = ['ply', 'format binary_little_endian 1.0']
    for name, rows in elements:
        header.append('element %s %d' % (name, len(rows)))
        for field in rows.dtype.names:
            kind = NAMES[rows.dtype[field].base.str[1:]]
            if rows.dtype[field].shape:
                header.append('property list uchar %s %s' % (kind, field))
            elif field != 'length':
                header.append('property %s %s' % (kind, field))
    with open(path + '.part', 'wb') as f:
        f.write('\n'.join([*header, 'end_header\n']).encode())
        for _, rows in elements:
            f.write(rows.tobytes())
    os.replace(path + '.part', path)


def columns(names, values, scalar):
    rows = np.zeros(len(values), [(name, scalar) for name in names])
    for i, name in enumerate(names):
        rows[name] = values[:, i]
    return rows


def write_mesh(path, points, triangles):
    """In single precision."""
    faces = np.zeros(len(triangles), [('length', 'u1'), ('vertex_indices', '<i4', 3)])
    faces['length'], faces['vertex_indices'] = 3, triangles
    write_elements(path, [('vertex', columns('xyz', points, '<f4')), ('face', faces)])


def write_points(path, points, normals=None):
    """In double precision, with normals where they are given."""
    values = points if normals is None else np.hstack([points, normals])
    names = ['x', 'y', 'z', 'nx', 'ny', 'nz'][:values.shape[1]]
    write_elements(path, [('vertex', columns(names, values, '<f8'))])
