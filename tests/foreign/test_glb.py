"""test_glb.py: glTF files of trimesh are read, and trimesh reads what brio writes; files that no program writes are made
here, byte by byte.

BRIO_FILES names the example program 03_files, which reads one file and writes another. A test is skipped with its reason
where trimesh is missing.
"""

import base64
import json
import struct
import subprocess
import unittest

import numpy

import ply_mesh
from test_foreign import FILES, ForeignTest, main, missing

TYPES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}


class Maker:
    """A glTF file, array by array."""

    def __init__(self):
        self.binary, self.views, self.accessors, self.primitives, self.nodes = b"", [], [], [], []

    def add(self, values, normalized=False, pad=0):
        values = numpy.asarray(values)
        rows = values.reshape(len(values), -1)
        stride = rows.shape[1] * rows.itemsize + pad
        data = b"".join(row.tobytes() + b"\xcc" * pad for row in rows)
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), "byteStride": stride})
        if not pad:
            del self.views[-1]["byteStride"]
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": TYPES[values.dtype.str[1:]],
                               "count": len(values), "normalized": normalized,
                               "type": ["SCALAR", "VEC2", "VEC3", "VEC4"][rows.shape[1] - 1]})
        self.binary += data + bytes(-len(data) % 4)
        return len(self.accessors) - 1

    def document(self, **more):
        return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                "nodes": self.nodes or [{"mesh": 0}], "meshes": [{"primitives": self.primitives}],
                "accessors": self.accessors, "bufferViews": self.views,
                "buffers": [{"byteLength": len(self.binary)}], **more}

    def glb(self, path, **more):
        text = json.dumps(self.document(**more)).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(self.binary), len(text), 0x4e4f534a))
            file.write(text + struct.pack("<II", len(self.binary), 0x004e4942) + self.binary)

    def gltf(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.document(buffers=[{"byteLength": len(self.binary), "uri": uri}]), file)


def load_json(path):
    with open(path, "rb") as file:
        data = file.read()
    length, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + length]), data[28 + length:]


class GlbTest(ForeignTest):
    def setUp(self):
        super().setUp()
        with open(self.path("try.gltf"), "w", encoding="utf-8") as file:
            file.write('{"asset": {"version": "2.0"}}')
        run = subprocess.run([FILES, self.path("try.gltf"), self.path("try.ply")], capture_output=True, check=False)
        if b"built without" in run.stderr:
            self.skipTest("brio was built without cJSON")

    def read_mesh(self, name):
        self.convert(self.path(name), self.path("read.ply"))
        return ply_mesh.read(self.path("read.ply"))

    def refused(self, name, part):
        run = subprocess.run([FILES, self.path(name), self.path("read.ply")], capture_output=True, check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(part, run.stderr.decode())


class MadeTest(GlbTest):
    def test_modes(self):
        corners = [0, 1, 2, 3, 4, 5]
        faces = {4: [[0, 1, 2], [3, 4, 5]], 5: [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]],
                 6: [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]}
        edges = {1: [[0, 1], [2, 3], [4, 5]], 2: [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]],
                 3: [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]]}
        for mode in range(7):
            for kind in None, "u1", "u2", "u4":
                maker = Maker()
                primitive = {"mode": mode, "attributes": {"POSITION": maker.add(
                    self.random.standard_normal((6, 3)).astype("f4"), pad=8)}}
                if kind:
                    primitive["indices"] = maker.add(numpy.array(corners, kind))
                maker.primitives.append(primitive)
                maker.glb(self.path("a.glb"))
                mesh = self.read_mesh("a.glb")
                self.assertEqual(mesh.get("face", []), faces.get(mode, []))
                self.assertEqual(ply_mesh.edges(mesh), edges.get(mode, []))

    def test_attributes(self):
        for path in "a.glb", "a.gltf":
            maker, n = Maker(), 20
            rgb, rgba = self.random.integers(0, 256, (n, 3)).astype("u1"), self.random.random((n, 4)).astype("f4")
            at, own = self.random.standard_normal((n, 3)).astype("f4"), self.random.integers(0, 99, n).astype("u2")
            normals = self.random.standard_normal((n, 3)).astype("f4")
            attributes = {"POSITION": maker.add(at), "NORMAL": maker.add(normals), "COLOR_0": maker.add(rgb, True, 1),
                          "_RING": maker.add(own, False, 2), "TEXCOORD_0": maker.add(at[:, :2].copy())}
            maker.primitives.append({"attributes": attributes, "mode": 0})
            getattr(maker, path[2:])(self.path(path))
            mesh = self.read_mesh(path)
            self.expect_equal(ply_mesh.points(mesh), at.astype(float), path)
            for names, values in (("nx ny nz", normals), ("red green blue", rgb), ("RING", own[:, None])):
                for i, name in enumerate(names.split()):
                    self.expect_equal(mesh["vertex"][name], values[:, i], name)
                    self.assertEqual(mesh["vertex"][name].dtype, values.dtype)
            self.assertEqual(len(mesh["vertex"].dtype.names), 10)
            # of two primitives with colours of two types, as the bytes that PLY has
            maker.primitives.append({"attributes": {"POSITION": maker.add(at), "COLOR_0": maker.add(rgba)}, "mode": 0})
            getattr(maker, path[2:])(self.path(path))
            mesh = self.read_mesh(path)
            byte = lambda share: numpy.rint(255 * share.astype(float)).astype("u1")
            self.expect_equal(mesh["vertex"]["green"][n:], byte(rgba[:, 1]), "green")
            self.expect_equal(mesh["vertex"]["green"][:n], rgb[:, 1], "green")
            self.expect_equal(mesh["vertex"]["alpha"], byte(numpy.concatenate([numpy.ones(n), rgba[:, 3]])), "alpha")
            self.expect_equal(mesh["vertex"]["RING"][n:], numpy.zeros(n), "RING")

    def test_quantized(self):
        maker = Maker()
        at = self.random.integers(-32767, 32768, (9, 3)).astype("i2")
        maker.primitives.append({"attributes": {"POSITION": maker.add(at, True, 2)}, "mode": 0})
        maker.nodes = [{"mesh": 0, "scale": [2, 2, 2], "translation": [10, 0, 0]}]
        maker.glb(self.path("a.glb"), extensionsRequired=["KHR_mesh_quantization"])
        self.assertTrue(numpy.allclose(ply_mesh.points(self.read_mesh("a.glb")), at / 32767 * 2 + [10, 0, 0]))

    def test_places(self):
        """A tree of nodes with a mirror image, which turns faces round; the other scene is not read."""
        maker = Maker()
        at = self.random.standard_normal((3, 3)).astype("f4")
        normals = numpy.array([[0, 0, 1]] * 3, "f4")
        maker.primitives.append({"attributes": {"POSITION": maker.add(at), "NORMAL": maker.add(normals)}})
        mirror = [-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]
        turn = numpy.sqrt(0.5)
        maker.nodes = [{"mesh": 0}, {"children": [2, 3], "translation": [100, 0, 0]}, {"mesh": 0, "matrix": mirror},
                       {"mesh": 0, "rotation": [turn, 0, 0, turn], "scale": [1, 2, 3]}]
        maker.glb(self.path("a.glb"), scenes=[{"nodes": [0]}, {"nodes": [1]}], scene=1)
        mesh = self.read_mesh("a.glb")
        x, y, z = at.astype(float).T
        expected = [numpy.column_stack([-2 * x + 105, y + 6, z + 7]), numpy.column_stack([x + 100, -3 * z, 2 * y])]
        self.assertTrue(numpy.allclose(ply_mesh.points(mesh), numpy.concatenate(expected)))
        self.assertEqual(mesh["face"], [[0, 2, 1], [3, 4, 5]])
        self.assertTrue(numpy.allclose(mesh["vertex"]["nz"], [1, 1, 1, 0, 0, 0], atol=1e-6))
        self.assertTrue(numpy.allclose(mesh["vertex"]["ny"], [0, 0, 0, -1, -1, -1], atol=1e-6))

    def test_vertices_are_shared(self):
        maker = Maker()
        attributes = {"POSITION": maker.add(self.random.standard_normal((4, 3)).astype("f4"))}
        for mode, corners in ((4, [0, 1, 2]), (4, [1, 3, 2]), (1, [0, 3])):
            maker.primitives.append({"attributes": attributes, "mode": mode,
                                     "indices": maker.add(numpy.array(corners, "u2"))})
        maker.glb(self.path("a.glb"))
        mesh = self.read_mesh("a.glb")
        self.assertEqual((len(mesh["vertex"]), mesh["face"], ply_mesh.edges(mesh)),
                         (4, [[0, 1, 2], [1, 3, 2]], [[0, 3]]))

    def test_refused(self):
        def make(change, **more):
            maker = Maker()
            maker.primitives.append({"attributes": {"POSITION": maker.add(numpy.zeros((3, 3), "f4"))}})
            change(maker)
            maker.glb(self.path("a.glb"), **more)

        draco = {"KHR_draco_mesh_compression": {}}
        cases = [
            ("is sparse", lambda m: m.accessors[0].update(sparse={})),
            ("Draco", lambda m: m.primitives[0].update(extensions=draco)),
            ("meshopt", lambda m: m.views[0].update(extensions={"EXT_meshopt_compression": {}})),
            ("has no bufferView", lambda m: m.accessors[0].pop("bufferView")),
            ("which are not in its view", lambda m: m.accessors[0].update(count=4)),
            ("which are not in its view", lambda m: m.accessors[0].update(count=0)),
            ("which are not in its view", lambda m: m.accessors[0].update(count=2**53)),
            ("which are not in its view", lambda m: m.accessors[0].update(byteOffset=4)),
            ("of buffers[0]", lambda m: m.views[0].update(byteOffset=2**53)),
            ("expected a whole number", lambda m: m.accessors[0].update(count=-1)),
            ("a view of a buffer", lambda m: m.accessors[0].update(bufferView=7)),
            ("is there twice", lambda m: m.nodes.extend([{"children": [0]}])),
            ("expected nodes of the file", lambda m: m.nodes.extend([{"children": [1]}])),
            ("has 1 meshes", lambda m: m.nodes.extend([{"mesh": 1}])),
            ("vertex 3, it has 3", lambda m: m.primitives[0].update(indices=m.add(numpy.array([0, 1, 3], "u1")))),
            ("has 2 corners", lambda m: m.primitives[0].update(indices=m.add(numpy.array([0, 1], "u1")))),
        ]
        for part, change in cases:
            make(change)
            self.refused("a.glb", part)
        make(lambda m: None, extensionsRequired=["KHR_draco_mesh_compression"])
        self.refused("a.glb", "needs the extension KHR_draco_mesh_compression")
        make(lambda m: None, buffers=[{"byteLength": 36, "uri": "other.bin"}])
        self.refused("a.glb", "other.bin: No such file")


@unittest.skipIf(missing("trimesh", "scipy"), missing("trimesh", "scipy"))
class TrimeshTest(GlbTest):
    def test_read(self):
        import trimesh
        from trimesh.exchange.gltf import export_gltf
        sphere = trimesh.creation.icosphere(subdivisions=2)
        sphere.visual.vertex_colors = self.random.integers(0, 256, (len(sphere.vertices), 4)).astype(numpy.uint8)
        scene = trimesh.Scene()
        turn = trimesh.transformations.rotation_matrix(0.3, [1, 2, 3], [4, 5, 6])
        scene.add_geometry(sphere, transform=turn)
        scene.add_geometry(trimesh.creation.box(extents=[1, 2, 3]), transform=turn @ turn)
        scene.export(self.path("a.glb"), include_normals=True)
        with open(self.path("a.gltf"), "wb") as file:
            file.write(export_gltf(scene, embed_buffers=True)["model.gltf"])
        for name in "a.glb", "a.gltf":
            mesh = self.read_mesh(name)
            again = trimesh.Trimesh(ply_mesh.points(mesh), mesh["face"], process=False)
            self.assertEqual(len(again.vertices), len(sphere.vertices) + 8)
            self.assertTrue(again.is_watertight)
            self.assertTrue(numpy.allclose(again.bounds, scene.bounds, atol=1e-6))
            self.assertAlmostEqual(again.volume, sphere.volume + 6, 4)
            self.expect_equal(mesh["vertex"]["red"][:len(sphere.vertices)], sphere.visual.vertex_colors[:, 0], "red")

    def write_ply(self, name, points, columns, faces):
        kinds = {"f": "float", "u": "uchar"}
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
            file.writelines("property double %s\n" % axis for axis in "xyz")
            file.writelines("property %s %s\n" % (kinds[v.dtype.kind], key) for key, v in columns.items())
            file.write("element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces))
            for i, point in enumerate(points):
                numbers = [*point, *(column[i] for column in columns.values())]
                file.write(" ".join("%.17g" % x for x in numbers) + "\n")
            file.writelines("3 %d %d %d\n" % tuple(face) for face in faces)

    def test_write(self):
        import trimesh
        sphere = trimesh.creation.icosphere(subdivisions=2)
        for shift in 0, 1e6:
            sphere = trimesh.Trimesh(sphere.vertices + [shift, 2 * shift, -shift], sphere.faces, process=False)
            n = len(sphere.vertices)
            colours = self.random.integers(0, 256, (n, 4)).astype("u1")
            columns = {"confidence": self.random.random(n).astype("f4"), "ring": colours[:, 0] // 2,
                       **dict(zip(("nx", "ny", "nz"), sphere.vertex_normals.astype("f4").T)),
                       **dict(zip(("red", "green", "blue", "alpha"), colours.T))}
            self.write_ply("a.ply", sphere.vertices, columns, sphere.faces)
            self.convert(self.path("a.ply"), self.path("b.glb"))
            first, second = self.read_mesh("a.ply"), self.read_mesh("b.glb")
            self.assertEqual(first["face"], second["face"])
            for name in first["vertex"].dtype.names[3:]:
                self.expect_equal(first["vertex"][name], second["vertex"][name], name)
            far = numpy.abs(ply_mesh.points(first) - ply_mesh.points(second)).max()
            self.assertLess(far, 1e-7)
            again = trimesh.load(self.path("b.glb"), force="mesh", process=False)
            self.assertTrue(numpy.allclose(again.vertices, ply_mesh.points(first), rtol=0, atol=1e-7))
            self.assertTrue(numpy.array_equal(again.faces, sphere.faces))
            self.assertTrue(numpy.array_equal(again.visual.vertex_colors, colours))
            document, _ = load_json(self.path("b.glb"))
            self.assertEqual(set(document["meshes"][0]["primitives"][0]["attributes"]),
                             {"POSITION", "NORMAL", "COLOR_0", "_confidence", "_ring"})
            self.assertEqual("translation" in document["nodes"][0], shift > 0)

    def test_write_points(self):
        import trimesh
        numpy.savetxt(self.path("a.xyz"), self.random.integers(-100, 100, (40, 3)) / 8)
        self.convert(self.path("a.xyz"), self.path("b.glb"))
        cloud = next(iter(trimesh.load(self.path("b.glb")).geometry.values()))
        self.assertIsInstance(cloud, trimesh.PointCloud)
        self.expect_equal(cloud.vertices, numpy.loadtxt(self.path("a.xyz")), "points")
        document, _ = load_json(self.path("b.glb"))
        self.assertEqual(document["meshes"][0]["primitives"][0]["mode"], 0)
        self.assertNotIn("translation", document["nodes"][0])
        accessor = document["accessors"][0]
        self.expect_equal(accessor["min"], cloud.vertices.min(axis=0), "min")
        self.expect_equal(accessor["max"], cloud.vertices.max(axis=0), "max")


if __name__ == "__main__":
    main()
