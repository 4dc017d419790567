"""What a binary little-endian PLY file of brio holds, so that tests can look at what brio has read."""

import numpy

TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
         "double": "f8"}


def read(path):
    """A dictionary: of each element the array of its rows, or a list of its lists. What stands behind a list is passed over."""
    with open(path, "rb") as file:
        data = file.read()
    at = data.index(b"end_header\n") + len("end_header\n")
    elements = []
    for line in data[:at].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    result = {}
    for name, count, properties in elements:
        if properties[0][0] != "list":
            kind = numpy.dtype([(p[-1], "<" + TYPES[p[0]]) for p in properties])
            result[name] = numpy.frombuffer(data, kind, count, at)
            at += count * kind.itemsize
            continue
        size, item = (numpy.dtype("<" + TYPES[word]) for word in properties[0][1:3])
        rows, behind = [], sum(numpy.dtype(TYPES[p[0]]).itemsize for p in properties[1:])
        for _ in range(count):
            corners = int(numpy.frombuffer(data, size, 1, at)[0])
            rows.append(numpy.frombuffer(data, item, corners, at + size.itemsize).tolist())
            at += size.itemsize + corners * item.itemsize + behind
        result[name] = rows
    return result


def points(mesh):
    return numpy.column_stack([mesh["vertex"][axis] for axis in "xyz"]).astype(float)


def edges(mesh):
    return [[int(row["vertex1"]), int(row["vertex2"])] for row in mesh.get("edge", [])]
