"""test_matrix.py: every format into every other one, property by property: what is different in the output is named.

Files of other programs are converted by brio, and other programs read the outputs: laspy, pye57, pypcd4, meshio, PyVista,
trimesh, plyfile, NumPy, and parsers of this file for what has none. A property of the input is in the output with the
same values, or `lost` or `renamed` names it; and what `lost` names is not there. In `make check` every source is
written once, as points at the place of a survey; with BRIO_LONG also with coordinates of all bits and with deeper
colours, and read by the other programs, too. BRIO names the program brio; a format is skipped with its reason where its
program is missing.
"""

import json
import os
import struct
import subprocess
import sys
import unittest

import numpy

from test_foreign import PLY_TYPES, ForeignTest, main, missing

BRIO = os.environ.get("BRIO", "brio")
LONG = bool(os.environ.get("BRIO_LONG"))
COUNT = 40
WKT = 'PROJCS["own",GEOGCS["base"],UNIT["m",1],AUTHORITY["EPSG","32633"]]'
COLOURS, NORMALS = ["red", "green", "blue"], ["nx", "ny", "nz"]


# --- what is written ---

def table(words, grid):
    """The columns of all sources. words: colours of 16 bits; grid: coordinates are whole millimetres."""
    random = numpy.random.default_rng(7)
    rows = {axis: random.integers(0, 100000, COUNT) / 1000 + origin
            for axis, origin in zip("xyz", (500000.123, 5400000.456, 77.001))}
    for axis in "xyz":
        rows[axis] = numpy.round(rows[axis], 3) if grid else rows[axis] + random.random(COUNT) * 1e-4
    for colour in COLOURS:
        values = random.integers(0, 256, COUNT)
        values[0] = 255
        rows[colour] = (values * 257 - 3 * (values % 2)).astype("u2") if words else values.astype("u1")
    normals = random.standard_normal((COUNT, 3))
    normals /= numpy.linalg.norm(normals, axis=1)[:, None]
    rows.update(zip(NORMALS, normals.T.astype("f4")))
    rows["intensity"] = random.integers(0, 65536, COUNT).astype("u2")
    rows["classification"] = random.integers(0, 32, COUNT).astype("u1")
    rows["gps_time"] = 3e8 + random.random(COUNT) * 1e4
    rows["heat"] = random.standard_normal(COUNT)
    rows["level"] = random.integers(-2**31, 2**31, COUNT).astype("i4")
    return rows


def xyz_of(rows):
    return numpy.stack([rows[axis] for axis in "xyz"], axis=1)


def records(rows, kinds=None):
    out = numpy.zeros(COUNT, [(name, (kinds or {}).get(name, values.dtype)) for name, values in rows.items()])
    for name, values in rows.items():
        out[name] = values
    return out


def write_ply(path, rows):
    names = {"f8": "double", "u1": "uchar", "u2": "ushort", "f4": "float", "i4": "int"}
    out = records(rows)
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % COUNT
    header += "".join("property %s %s\n" % (names[out.dtype[n].str[1:]], n) for n in out.dtype.names) + "end_header\n"
    with open(path, "wb") as file:
        file.write(header.encode() + out.tobytes())


def write_las(path, rows):
    import laspy
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [500000, 5400000, 0]
    header.global_encoding.wkt = True
    header.vlrs.append(laspy.vlrs.known.WktCoordinateSystemVlr(WKT))
    for name in NORMALS + ["heat", "level"]:
        header.add_extra_dim(laspy.ExtraBytesParams(name, rows[name].dtype.str[1:]))
    las = laspy.LasData(header)
    for name, values in rows.items():
        las[name] = values
    las.write(path)


def write_e57(path, rows):
    from pye57 import libe57
    image = libe57.ImageFile(path, "w")  # pye57's own class leaves no place for a coordinate system
    root, scans = image.root(), libe57.VectorNode(image, True)
    image.extensionsAdd("", libe57.E57_V1_0_URI)
    for name, text in (("formatName", "ASTM E57 3D Imaging Data File"), ("guid", "{0}"), ("coordinateMetadata", WKT)):
        root.set(name, libe57.StringNode(image, text))
    root.set("versionMajor", libe57.IntegerNode(image, 1))
    root.set("versionMinor", libe57.IntegerNode(image, 0))
    root.set("data3D", scans)
    image.extensionsAdd("nor", "http://www.libe57.org/E57_NOR_surface_normals.txt")
    image.extensionsAdd("own", "http://example.org/own")
    prototype, scan = libe57.StructureNode(image), libe57.StructureNode(image)
    arrays = {}
    for name, values in rows.items():
        field = {"x": "cartesianX", "y": "cartesianY", "z": "cartesianZ", "intensity": "intensity"}.get(name)
        field = field or ("color" + name.capitalize() if name in COLOURS else
                          "nor:normal" + name[1].upper() if name in NORMALS else "own:" + name)
        precision = libe57.FloatPrecision.E57_SINGLE if values.dtype == "f4" else libe57.FloatPrecision.E57_DOUBLE
        info = None if values.dtype.kind == "f" else numpy.iinfo(values.dtype)
        node = libe57.IntegerNode(image, max(0, info.min), info.min, info.max) if info else \
            libe57.FloatNode(image, 0.0, precision, -1e30, 1e30)
        prototype.set(field, node)
        arrays[field] = numpy.ascontiguousarray(values, "f8" if values.dtype == "i4" else values.dtype)
    points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
    scan.set("guid", libe57.StringNode(image, "{1}"))
    scan.set("points", points)
    scans.append(scan)
    writer = points.writer(e57_buffers(image, arrays))
    writer.write(COUNT)
    writer.close()
    image.close()


def e57_buffers(image, arrays):
    from pye57 import libe57
    buffers = libe57.VectorSourceDestBuffer()
    for name, array in arrays.items():
        buffers.append(libe57.SourceDestBuffer(image, name, array, COUNT, True, True))
    return buffers


def write_pcd(path, rows):
    import pypcd4
    rows = dict(rows)
    packed = (rows["red"].astype("u4") << 16 | rows["green"].astype("u4") << 8 | rows["blue"]).view("f4")
    columns = [rows[axis] for axis in "xyz"] + [packed] + [rows[n] for n in NORMALS]
    names = ["x", "y", "z", "rgb", "normal_x", "normal_y", "normal_z"]
    for name in ("intensity", "classification", "gps_time", "heat", "level"):
        names.append(name)
        columns.append(rows[name])
    cloud = pypcd4.PointCloud.from_points([numpy.asarray(c) for c in columns], names, [c.dtype for c in columns])
    cloud.save(path)


def write_npy(path, rows):
    numpy.save(path, records(rows))


def write_csv(path, rows):
    with open(path, "w") as file:
        file.write(",".join(rows) + "\n")
        for values in zip(*rows.values()):
            file.write(",".join(repr(v.item()) for v in values) + "\n")


def write_ptx(path, rows):
    with open(path, "w") as file:
        file.write("%d\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" % COUNT)
        for values in zip(*(rows[n] for n in ["x", "y", "z", "intensity"] + COLOURS)):
            file.write(" ".join(repr(v.item()) for v in values) + "\n")


def write_vtu(path, rows):
    import meshio
    data = {"RGB": numpy.stack([rows[c] for c in COLOURS], axis=1), "Normals": numpy.stack([rows[n] for n in NORMALS], axis=1)}
    data.update({n: v for n, v in rows.items() if n not in "xyz" and n not in COLOURS + NORMALS})
    meshio.write(path, meshio.Mesh(xyz_of(rows), [("vertex", numpy.arange(COUNT)[:, None])], point_data=data))


def write_by_vtk(path, rows):
    import pyvista
    cloud = pyvista.PolyData(xyz_of(rows))
    cloud.point_data["RGB"] = numpy.stack([rows[c] for c in COLOURS], axis=1)
    cloud.point_data["Normals"] = numpy.stack([rows[n] for n in NORMALS], axis=1)
    for name, values in rows.items():
        if name not in "xyz" and name not in COLOURS + NORMALS:
            cloud.point_data[name] = values
    cloud.save(path)


def write_by_trimesh(path, rows):
    import trimesh
    colours = numpy.stack([rows[c] for c in COLOURS] + [numpy.full(COUNT, 255, "u1")], axis=1)
    trimesh.PointCloud(xyz_of(rows) - [500000, 5400000, 0], colors=colours).export(path)


def write_obj(path, rows):
    with open(path, "w") as file:
        for values in zip(*(rows[n] for n in "xyz"), *(rows[c] / 255 for c in COLOURS)):
            file.write("v " + " ".join(repr(float(v)) for v in values) + "\n")
        for values in zip(*(rows[n] for n in NORMALS)):
            file.write("vn " + " ".join("%.9g" % v for v in values) + "\n")


POINTS_ONLY = ["x", "y", "z"]
# format: the writer, the columns that it writes (None: all), the packages that it needs, whether it takes words as colours
SOURCES = {"ply": (write_ply, None, [], True), "las": (write_las, None, ["laspy"], True),
           "laz": (write_las, None, ["laspy", "lazrs"], True), "pcd": (write_pcd, None, ["pypcd4"], False),
           "npy": (write_npy, None, [], True), "e57": (write_e57, None, ["pye57"], True), "csv": (write_csv, None, [], True),
           "ptx": (write_ptx, POINTS_ONLY + ["intensity"] + COLOURS, [], False), "vtu": (write_vtu, None, ["meshio"], False),
           "vtp": (write_by_vtk, None, ["pyvista"], False), "vtk": (write_by_vtk, None, ["pyvista"], False),
           "obj": (write_obj, POINTS_ONLY + COLOURS + NORMALS, [], False),
           "glb": (write_by_trimesh, COLOURS, ["trimesh"], False)}


# --- what is read ---

def read_ply(path):
    with open(path, "rb") as file:
        data = file.read()
    start = data.index(b"end_header\n") + 11
    lines = [line.split() for line in data[:start].decode().splitlines()]
    kinds = [(words[2], "<" + PLY_TYPES[words[1]]) for words in lines if words[0] == "property" and words[1] != "list"]
    rows = numpy.frombuffer(data, kinds, COUNT, start)
    return {name: rows[name] for name in rows.dtype.names}


def read_las(path):
    import laspy
    las = laspy.read(path)
    rows = {name: numpy.asarray(las[name]) for name in las.point_format.dimension_names if name not in "XYZ"}
    rows.update({axis: numpy.asarray(las[axis]) for axis in "xyz"})
    systems = las.vlrs.get("WktCoordinateSystemVlr")
    return rows, systems[0].string if systems else None


def read_pcd(path):
    import pypcd4
    cloud = pypcd4.PointCloud.from_path(path)
    rows = {name: cloud.pc_data[name] for name in cloud.fields}
    if "rgb" in rows or "rgba" in rows:
        packed = numpy.ascontiguousarray(rows.pop("rgb" if "rgb" in rows else "rgba")).view("u4")
        rows.update({c: (packed >> shift & 255).astype("u1") for c, shift in zip(COLOURS, (16, 8, 0))})
    return {{"normal_" + n[1]: n for n in NORMALS}.get(name, name): values for name, values in rows.items()}


def read_npy(path):
    rows = numpy.load(path)
    if rows.dtype.names is None:
        return dict(zip("xyz", rows.T))
    return {name: rows[name] for name in rows.dtype.names}


def read_e57(path):
    import pye57
    file = pye57.E57(path)
    image, header = file.image_file, file.get_header(0)
    assert file.scan_count == 1 and header.point_count == COUNT
    arrays = {field: numpy.zeros(COUNT) for field in header.point_fields}
    file.data3d[0]["points"].reader(e57_buffers(image, arrays)).read()
    own = {"cartesian" + axis.upper(): axis for axis in "xyz"}
    own.update({"color" + c.capitalize(): c for c in COLOURS})
    own.update({"nor:normal" + n[1].upper(): n for n in NORMALS})
    rows = {own.get(field, field.replace("brio:", "")): values for field, values in arrays.items()}
    if "red" in rows:
        most = header["colorLimits"]["colorRedMaximum"].value()
        for colour in COLOURS:
            rows[colour] = rows[colour].astype("u1" if most == 255 else "u2")
    system = file.root["coordinateMetadata"].value() if file.root.isDefined("coordinateMetadata") else None
    return rows, system


def read_ptx(path):
    with open(path) as file:
        lines = file.read().splitlines()
    assert int(lines[0]) * int(lines[1]) == COUNT
    matrix = numpy.array([list(map(float, line.split())) for line in lines[6:10]])
    values = numpy.array([list(map(float, line.split())) for line in lines[10:]])
    assert (matrix[:3, :3] == numpy.eye(3)).all()
    names = ["x", "y", "z", "intensity"] + (COLOURS if values.shape[1] == 7 else [])
    rows = dict(zip(names, values.T))
    for k, axis in enumerate("xyz"):
        rows[axis] = rows[axis] + matrix[3, k]
    rows.update({c: rows[c].astype("u1") for c in COLOURS if c in rows})
    return rows


def read_arrays(points, arrays):
    rows = dict(zip("xyz", points.T))
    for name, values in arrays.items():
        values = numpy.asarray(values)
        if name in ("RGB", "RGBA", "Normals"):
            rows.update(zip(NORMALS if name == "Normals" else COLOURS + ["alpha"], values.T))
        else:
            rows[name] = values.reshape(COUNT)
    return rows


def read_by_meshio(path):
    import meshio
    mesh = meshio.read(path)
    return read_arrays(mesh.points, mesh.point_data)


def read_by_vtk(path):
    import pyvista
    mesh = pyvista.read(path)
    return read_arrays(numpy.asarray(mesh.points), {n: mesh.point_data[n] for n in mesh.point_data})


def read_glb(path):
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    scene, body = json.loads(data[20:20 + size]), data[28 + size:]
    place = scene["nodes"][0].get("translation", [0, 0, 0])
    rows = {}
    for name, number in scene["meshes"][0]["primitives"][0]["attributes"].items():
        accessor = scene["accessors"][number]
        view = scene["bufferViews"][accessor["bufferView"]]
        kind = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        stride = view.get("byteStride", width * numpy.dtype(kind).itemsize)
        at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values = numpy.ndarray((COUNT, width), "<" + kind, body, at, (stride, numpy.dtype(kind).itemsize))
        names = {"POSITION": list("xyz"), "NORMAL": NORMALS, "COLOR_0": COLOURS + ["alpha"]}.get(name, [name[1:]])
        rows.update(zip(names, values.T))
    for k, axis in enumerate("xyz"):
        rows[axis] = rows[axis].astype(float) + place[k]
    return rows


def read_text(path):
    with open(path) as file:
        lines = file.read().splitlines()
    names = next(line for line in lines if "x" in line and "brio" not in line).lstrip("# ").replace(",", " ").split()
    values = [list(map(float, line.replace(",", " ").split())) for line in lines if line[0] not in "#x"]
    return dict(zip(names, numpy.array(values).T))


def read_obj(path):
    with open(path) as file:
        lines = [line.split() for line in file]
    values = numpy.array([list(map(float, words[1:])) for words in lines if words[0] == "v"])
    normals = numpy.array([list(map(float, words[1:])) for words in lines if words[0] == "vn"])
    rows = dict(zip(["x", "y", "z"] + COLOURS, values.T))
    rows.update({c: (rows[c]).astype("f4") for c in COLOURS if c in rows})
    return dict(rows, **dict(zip(NORMALS, normals.T)))


def read_off(path):
    with open(path) as file:
        lines = [line for line in file.read().splitlines() if line[0] != "#"]
    return dict(zip("xyz", numpy.array([list(map(float, line.split())) for line in lines[2:]]).T))


def read_node(path):
    """Its columns have no names: they are those of the points, in their order."""
    with open(path) as file:
        lines = [line for line in file.read().splitlines() if line[0] != "#"]
    values = numpy.array([list(map(float, line.split())) for line in lines[1:]]).T[1:]
    return dict(zip(list("xyz") + ["column%d" % i for i in range(len(values))], values))


def read_by_plyfile(path):
    import plyfile
    rows = plyfile.PlyData.read(path)["vertex"].data
    return {name: rows[name] for name in rows.dtype.names}


# format: the options by which it is written; meshio takes one array of raw data for another
OPTIONS = {"vtu": ["--ascii"]}
# format: the reader, and the packages that it needs
READERS = {"ply": (read_ply, []), "las": (read_las, ["laspy"]), "laz": (read_las, ["laspy", "lazrs"]),
           "pcd": (read_pcd, ["pypcd4"]), "npy": (read_npy, []), "e57": (read_e57, ["pye57"]), "ptx": (read_ptx, []),
           "vtu": (read_by_meshio, ["meshio"]), "vtp": (read_by_vtk, ["pyvista"]), "vtk": (read_by_meshio, ["meshio"]),
           "glb": (read_glb, []), "csv": (read_text, []), "txt": (read_text, []), "obj": (read_obj, []),
           "off": (read_off, []), "node": (read_node, [])}


def read_by_brio(path):
    """For formats that no other program here reads."""
    subprocess.run([BRIO, "convert", path, path + ".npy", "--quiet"], check=True)
    return read_npy(path + ".npy")


def targets():
    """The extensions that are written, each with its reader and the packages that this needs."""
    listed = json.loads(subprocess.run([BRIO, "help", "formats", "--json"], stdout=subprocess.PIPE, check=True).stdout)["formats"]
    others = {kind["format"]: (read_by_brio, []) for kind in listed
              if "properties" in kind["holds"] and not any(e[1:] in READERS for e in kind["written"])}
    return {**READERS, **others}


def depth(values):
    """What white is."""
    kind = values.dtype.str[1:]
    if kind in ("u1", "u2"):
        return {"u1": 255, "u2": 65535}[kind]
    return 1 if values.max() <= 1 else 255 if values.max() <= 255 else 65535


class MatrixTest(ForeignTest):
    def brio(self, *arguments):
        run = subprocess.run([BRIO, "convert", *map(str, arguments), "--json", "--quiet"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, (arguments, run.stderr.decode()))
        return json.loads(run.stdout)

    def expect_property(self, what, name, values, found, facts):
        """A property is there with its values, or it is named. Single numbers as text are those of the text."""
        lost, renamed = facts["lost"], facts.get("renamed", [])
        if facts["output"].rsplit(".", 1)[1] in ("csv", "txt", "node", "obj"):
            found = {n: v.astype(values.dtype) if values.dtype == "f4" else v for n, v in found.items()}
        if name in lost:
            self.assertNotIn(name, found, what)
            return
        if name in renamed or (name not in found and "names of properties" in lost):
            same = [n for n in found if (found[n] == values).all()]
            self.assertTrue(same, (what, "is under no name"))
            return
        self.assertIn(name, found, what)
        if name in COLOURS:
            was, now = values / depth(values), found[name] / depth(found[name])
            if "colour depth" not in lost:
                self.assertLess(numpy.abs(was - now).max(), 1e-6, what)
            else:
                self.assertLess(numpy.abs(was - now).max(), 1 / 255, what)
        elif "precision" in lost and found[name].dtype == "f4":
            self.assertTrue((found[name] == values.astype("f4")).all(), what)
        else:
            self.assertTrue((found[name] == values).all(), (what, values[:3], found[name][:3]))

    def expect_places(self, what, rows, found, facts):
        was, now = xyz_of(rows), xyz_of(found).astype(float)
        moved = numpy.linalg.norm(was - now, axis=1).max()
        if "precision" in facts["lost"]:
            self.assertLessEqual(moved, facts.get("moved", 0) * (1 + 1e-9), what)
        else:
            self.assertEqual(moved, 0, what)
        self.assertLess(moved, 0.0005 if facts["output"][-3:] != "glb" else 0.01, what)

    def expect_output(self, what, rows, facts, reader, system):
        found = reader(facts["output"])
        found, found_system = found if isinstance(found, tuple) else (found, None)
        self.expect_places(what, rows, found, facts)
        for name, values in rows.items():
            if name not in "xyz":
                self.expect_property((*what, name), name, values, found, facts)
        if system:
            self.assertEqual("crs" in facts["lost"], found_system is None, what)
            self.assertIn(found_system, (None, system), what)

    def source(self, name, words, grid):
        """A source, or None, and what brio is to find in it."""
        write, columns, packages, deep = SOURCES[name]
        if missing(*packages) or (words and not deep) or (name in ("las", "laz") and not grid):
            return None, None, None
        rows = table(words, grid)
        path = self.path("source." + name)
        written = dict(rows)
        if name in ("las", "laz"):
            if not words:
                written.update({c: rows[c].astype("u2") * 257 for c in COLOURS})
            rows.update({c: written[c] for c in COLOURS})
        write(path, written)
        if name in ("las", "laz"):
            rows.update({axis: read_las(path)[0][axis] for axis in "xyz"})
        if name == "glb":  # near 0, where trimesh's single numbers stay the same
            found = read_npy(self.as_npy(path))
            return path, {n: found[n] for n in ["x", "y", "z"] + COLOURS}, None
        if name == "obj":
            rows.update({c: (rows[c] / 255).astype("f4") for c in COLOURS})
            rows.update({n: numpy.array([float("%.9g" % v) for v in rows[n]]) for n in NORMALS})
        rows = {n: rows[n] for n in rows if columns is None or n in columns}
        if name == "e57":
            rows = {n if n in list("xyz") + COLOURS + NORMALS + ["intensity"] else "own_" + n: v for n, v in rows.items()}
        return path, rows, WKT if name in ("las", "laz", "e57") else None

    def as_npy(self, path):
        self.brio(path, path + ".npy")
        return path + ".npy"

    def walk(self, words, grid):
        skipped = set()
        for source in SOURCES:
            path, rows, system = self.source(source, words, grid)
            if path is None:
                continue
            for target, (reader, packages) in targets().items():
                if missing(*packages):
                    skipped.add(target)
                    continue
                with self.subTest(source=source, target=target):
                    facts = self.brio(path, self.path("out." + target), *OPTIONS.get(target, []))
                    self.expect_output((source, target), rows, facts, reader, system)
        if skipped:
            print("skipped: no readers of", *sorted(skipped))

    def test_all_pairs(self):
        self.walk(words=False, grid=True)

    @unittest.skipUnless(LONG, "a long test: BRIO_LONG")
    def test_all_pairs_with_deep_colours(self):
        self.walk(words=True, grid=True)

    @unittest.skipUnless(LONG, "a long test: BRIO_LONG")
    def test_all_pairs_with_all_bits_of_coordinates(self):
        self.walk(words=False, grid=False)
        self.walk(words=True, grid=False)

    @unittest.skipUnless(LONG, "a long test: BRIO_LONG")
    def test_what_other_readers_find(self):
        """The readers of the matrix are one a format; these are the others."""
        rows = table(words=False, grid=True)
        write_ply(self.path("a.ply"), rows)
        for target, read, packages in (("ply", read_by_plyfile, ["plyfile"]), ("vtu", read_by_vtk, ["pyvista"]),
                                       ("vtk", read_by_vtk, ["pyvista"])):
            if missing(*packages):
                print("skipped: no", *packages)
                continue
            with self.subTest(target=target, packages=packages):
                facts = self.brio(self.path("a.ply"), self.path("out." + target))
                self.expect_output(("ply", target), rows, facts, read, None)
        if missing("trimesh"):
            return
        import trimesh
        for target in ("ply", "glb"):
            facts = self.brio(self.path("a.ply"), self.path("out." + target))
            cloud = trimesh.load(self.path("out." + target))
            place = numpy.zeros(3)
            if isinstance(cloud, trimesh.Scene):
                node = cloud.graph.nodes_geometry[0]
                place, cloud = cloud.graph[node][0][:3, 3], next(iter(cloud.geometry.values()))
            self.expect_equal(numpy.asarray(cloud.colors)[:, :3], numpy.stack([rows[c] for c in COLOURS], axis=1), target)
            self.assertLess(numpy.abs(numpy.asarray(cloud.vertices) + place - xyz_of(rows)).max(), 1e-5, target)


if __name__ == "__main__":
    main()
