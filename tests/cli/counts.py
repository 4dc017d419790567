"""Files of which one count grows: for each count that a file can claim, a file of n of them.

A row of FAMILIES is a name, its count to begin with, and a function that makes the file's name and its bytes. Files that a
reader refuses past a limit are here, too: the refusal must not cost more than the file is long."""

import gzip
import io
import json
import struct
import zipfile
import zlib

from whole_files import (DOUBLE, LEGACY_POINTS, crc32c, described, doubles, e57, e57_axes, las, legacy, npy, physical, vlr)

PLY = "ply\nformat ascii 1.0\n%selement vertex %d\nproperty double x\nproperty double y\nproperty double z\n%send_header\n"
TETRAHEDRON = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
ARRAY = '<DataArray type="Float32" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>'


def lines(n, form="%d 0 0\n"):
    return "".join(form % i if "%" in form else form for i in range(n))


def circle(n):
    """Points that no test takes for equal, for a polygon of n corners."""
    return "".join("%d %d 0\n" % (i, i * i) for i in range(n))


def chunks(scene, binary=b""):
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4e4f534a) + text
    if binary:
        binary += bytes(-len(binary) % 4)
        body += struct.pack("<II", len(binary), 0x004e4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def scene(nodes=1, meshes=1, primitives=1, accessors=1, views=1, extra_attributes=0, deep=False, **more):
    """Triangles in one buffer; each count alone is large."""
    attributes = dict({"POSITION": 0}, **{"_A%d" % i: 0 for i in range(extra_attributes)})
    listed = [dict({"mesh": i % meshes}, **({"children": [i + 1]} if deep and i + 1 < nodes else {})) for i in range(nodes)]
    whole = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0] if deep else list(range(nodes))}],
             "nodes": listed,
             "meshes": [{"primitives": [{"attributes": attributes}] * primitives}] * meshes,
             "accessors": [{"bufferView": i % views, "componentType": 5126, "count": 3, "type": "VEC3"} for i in range(accessors)],
             "bufferViews": [{"buffer": 0, "byteLength": 36}] * views, "buffers": [{"byteLength": 36}]}
    return chunks(dict(whole, **more), struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))


def archive(names, content, kind=zipfile.ZIP_STORED):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", kind) as f:
        f.writestr("points.npy", npy("<f8", (2, 3), doubles(*range(6))))
        for name in names:
            f.writestr(name, content)
    return out.getvalue()


def vtk_xml(kind, pieces, in_file=""):
    return '<VTKFile type="%s" byte_order="LittleEndian"%s><%s>%s</%s></VTKFile>' % (kind, in_file, kind, "".join(pieces), kind)


def piece(points=2, data="", attributes="", polys=""):
    coordinates = ARRAY % ("Points", 3, "1 2 3 " * points)
    return ('<Piece NumberOfPoints="%d" NumberOfPolys="0"%s><PointData>%s</PointData><Points>%s</Points>%s</Piece>'
            % (points, attributes, data, coordinates, polys))


def polygon_of_vtp(n):
    polys = "<Polys>%s%s</Polys>" % (
        '<DataArray type="Int64" Name="connectivity" format="ascii">%s</DataArray>' % " ".join(map(str, range(n))),
        '<DataArray type="Int64" Name="offsets" format="ascii">%d</DataArray>' % n)
    coordinates = ARRAY % ("Points", 3, circle(n))
    return vtk_xml("PolyData", ['<Piece NumberOfPoints="%d" NumberOfPolys="1"><Points>%s</Points>%s</Piece>' % (n, coordinates, polys)])


def vtp_in_blocks(n):
    """Appended raw data of 24 bytes a block, each compressed alone."""
    blocks = [zlib.compress(struct.pack("<3d", i, i * i, 0)) for i in range(n)]
    data = struct.pack("<%dQ" % (3 + n), n, 24, 0, *map(len, blocks)) + b"".join(blocks)
    head = ('<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">'
            '<PolyData><Piece NumberOfPoints="%d"><Points><DataArray type="Float64" Name="Points" NumberOfComponents="3" '
            'format="appended" offset="0"/></Points></Piece></PolyData><AppendedData encoding="raw">_' % n)
    return head.encode() + data + b"</AppendedData></VTKFile>"


def e57_scans(n, pose=""):
    """n scans of one point each."""
    streams = [struct.pack("<d", v) for v in (1, 2, 3)]
    packet = struct.pack("<H3H", 3, 8, 8, 8) + b"".join(streams)
    packet += b"\0" * (-(len(packet) + 4) % 4)
    packet = struct.pack("<BBH", 1, 0, len(packet) + 3) + packet
    size = 32 + len(packet)
    sections = [struct.pack("<B7xQQQ", 1, size, physical(48 + size * i + 32), 0) + packet for i in range(n)]
    prototype = "".join('<cartesian%s type="Float"/>' % axis for axis in "XYZ")
    scans = "".join('<vectorChild type="Structure">%s<points type="CompressedVector" fileOffset="%d" recordCount="1"><prototype '
                    'type="Structure">%s</prototype></points></vectorChild>' % (pose, physical(48 + size * i), prototype)
                    for i in range(n))
    return e57_file(b"".join(sections), '<data3D type="Vector">%s</data3D>' % scans)


def e57_packets(n):
    """One scan of n packets of one point."""
    packet = struct.pack("<H3H", 3, 8, 8, 8) + doubles(1, 2, 3)
    packet += b"\0" * (-(len(packet) + 4) % 4)
    packet = struct.pack("<BBH", 1, 0, len(packet) + 3) + packet
    section = struct.pack("<B7xQQQ", 1, 32 + n * len(packet), physical(48 + 32), 0) + packet * n
    prototype = "".join('<cartesian%s type="Float"/>' % axis for axis in "XYZ")
    return e57_file(section, '<data3D type="Vector"><vectorChild type="Structure"><points type="CompressedVector" fileOffset="%d" '
                    'recordCount="%d"><prototype type="Structure">%s</prototype></points></vectorChild></data3D>'
                    % (physical(48), n, prototype))


def e57_file(sections, body):
    xml = ('<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure" '
           'xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0">%s</e57Root>' % body).encode()
    content = sections + xml
    pages = (48 + len(content) + 1019) // 1020
    header = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, pages * 1024, physical(48 + len(sections)), len(xml), 1024)
    content = (header + content).ljust(pages * 1020, b"\0")
    return b"".join(content[i:i + 1020] + struct.pack(">I", crc32c(content[i:i + 1020])) for i in range(0, len(content), 1020))


def e57_fields(n):
    byte = 'type="Integer" minimum="0" maximum="255"'
    return e57(e57_axes() + [("own:a%d" % i, byte, b"\1\2") for i in range(n)], 2)


def ptx(n):
    block = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"
    return block * n


def pcd(fields, points=1, comments=0):
    names = "".join(" a%d" % i for i in range(fields))
    return ("# .PCD v0.7\n" + "# word\n" * comments + "VERSION 0.7\nFIELDS x y z%s\nSIZE 4 4 4%s\nTYPE F F F%s\nCOUNT 1 1 1%s\nWIDTH %d\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n" % (names, " 4" * fields, " F" * fields, " 1" * fields, points, points)
            + ("1 2 3" + " 4" * fields + "\n") * points)


def legacy_arrays(n):
    return legacy(b"3.0", LEGACY_POINTS + b"POINT_DATA 4\n" +
                  b"".join(b"SCALARS a%d unsigned_char\nLOOKUP_TABLE default\n" % i + b"\1\2\3\4\n" for i in range(n)))


def legacy_fields(n):
    return legacy(b"3.0", b"FIELD FieldData %d\n" % n + b"".join(b"a%d 1 1 unsigned_char\n\1\n" % i for i in range(n)) + LEGACY_POINTS)


def pdb(atoms, other=0):
    atom = "ATOM  %5d  C   ALA A%4d    %8.3f%8.3f%8.3f  1.00  0.00           C  \n"
    return ("REMARK   1 word\n" * other + "".join(atom % (i % 99999, i % 9999, i % 900, i // 900 % 900, 0) for i in range(atoms)) + "END\n")


# name: (the first n, the name of the file, its content)
FAMILIES = {
    "rows of a text": (300000, "a.xyz", lines),
    "columns of a text": (100000, "a.xyz", lambda n: "1 2 3" + " 4" * n + "\n"),
    "names of a text": (100000, "a.csv", lambda n: "x,y,z" + lines(n, ",a%d") + "\n1,2,3" + ",4" * n + "\n"),
    "equal names of a text": (1000, "a.csv", lambda n: "x,y,z" + ",a" * n + "\n1,2,3" + ",4" * n + "\n"),
    "names in quotes": (1000, "a.csv", lambda n: "x,y,z" + lines(n, ',"a ""%d"""') + "\n1,2,3" + ",4" * n + "\n"),
    "a name that is long": (2000000, "a.csv", lambda n: "x,y,z," + "a" * n + "\n1,2,3,4\n"),
    "comments of a text": (300000, "a.xyz", lambda n: "# word\n" * n + "1 2 3\n"),
    "empty lines of a text": (1000000, "a.xyz", lambda n: "\n" * n + "1 2 3\n"),
    "digits of a number": (1000000, "a.xyz", lambda n: "0." + "3" * n + " 2 3\n"),
    "blocks of a text": (100000, "a.pts", lambda n: "1\n1 2 3\n" * n),
    "rows of ply": (300000, "a.ply", lambda n: PLY % ("", n, "") + lines(n)),
    "comments of ply": (300000, "a.ply", lambda n: PLY % ("comment word\n" * n, 1, "") + "1 2 3\n"),
    "properties of ply": (1000, "a.ply", lambda n: PLY % ("", 1, lines(n, "property uchar a%d\n")) + "1 2 3" + " 4" * n + "\n"),
    "equal properties of ply": (1000, "a.ply", lambda n: PLY % ("", 1, "property uchar a\n" * n) + "1 2 3" + " 4" * n + "\n"),
    "elements of ply": (50000, "a.ply", lambda n: PLY % ("", 1, lines(n, "element e%d 0\n")) + "1 2 3\n"),
    "rows of another element": (300000, "a.ply", lambda n: PLY % ("", 1, "element own %d\nproperty int a\n" % n) + "1 2 3\n" + "4\n" * n),
    "a list of ply": (300000, "a.ply", lambda n: PLY % ("", 1, "element own 1\nproperty list int int a\n") + "1 2 3\n%d" % n + " 4" * n + "\n"),
    "corners of a polygon of ply": (100000, "a.ply", lambda n: PLY % ("", n, "element face 1\nproperty list int int vertex_indices\n") +
                                    circle(n) + "%d " % n + " ".join(map(str, range(n))) + "\n"),
    "polygons of ply": (200000, "a.ply", lambda n: PLY % ("", 4, "element face %d\nproperty list int int vertex_indices\n" % n) +
                        TETRAHEDRON + "3 0 1 2\n" * n),
    "corners of a strip of ply": (200000, "a.ply", lambda n: PLY % ("", 4, "element tristrips 1\nproperty list int int vertex_indices\n") +
                                  TETRAHEDRON + "%d" % n + " 0 1 2 3" * (n // 4) + "\n"),
    "polygons of off": (200000, "a.off", lambda n: "OFF\n4 %d 0\n" % n + TETRAHEDRON + "3 0 1 2\n" * n),
    "corners of a polygon of off": (100000, "a.off", lambda n: "OFF\n%d 1 0\n" % n + circle(n) + "%d " % n + " ".join(map(str, range(n))) + "\n"),
    "vertices of obj": (200000, "a.obj", lambda n: lines(n, "v %d 0 0\n")),
    "polygons of obj": (200000, "a.obj", lambda n: lines(4, "v %d 0 0\n") + "f 1 2 3\n" * n),
    "corners of a polygon of obj": (100000, "a.obj", lambda n: lines(n, "v %d 0 0\n") + "f " + " ".join(map(str, range(1, n + 1))) + "\n"),
    "normals of obj": (100000, "a.obj", lambda n: lines(4, "v %d 0 0\n") + "vn 0 0 1\n" * n + "f 1//1 2//1 3//1\n"),
    "corners with normals": (60000, "a.obj", lambda n: lines(3, "v %d 0 0\n") + lines(n, "vn %d 0 1\n") +
                             "".join("f 1//%d 2//%d 3//%d\n" % (i, i, i) for i in range(1, n + 1))),
    "groups of obj": (200000, "a.obj", lambda n: "v 1 2 3\n" + lines(n, "g name%d\n")),
    "materials of obj": (200000, "a.obj", lambda n: "v 1 2 3\n" + lines(n, "usemtl name%d\n")),
    "other words of obj": (200000, "a.obj", lambda n: "v 1 2 3\n" + lines(n, "own%d 4\n")),
    "continued lines of obj": (200000, "a.obj", lambda n: "v 1 \\\n" + " \\\n" * n + "2 3\n"),
    "facets of stl": (50000, "a.stl", lambda n: "solid a\n" + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n" * n + "endsolid a\n"),
    "solids of stl": (30000, "a.stl", lambda n: lines(n, "solid a%d\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")),
    "fields of pcd": (1000, "a.pcd", pcd),
    "equal fields of pcd": (1000, "a.pcd", lambda n: pcd(n).replace("a1", "a")),
    "fields of pcd past the limit": (50000, "a.pcd", pcd),
    "comments of pcd": (300000, "a.pcd", lambda n: pcd(0, 1, n)),
    "points of pcd": (200000, "a.pcd", lambda n: pcd(0, n)),
    "attributes of node": (1000, "a.node", lambda n: "1 3 %d 0\n0 1 2 3%s\n" % (n, " 4" * n)),
    "records of las": (60000, "a.las", lambda n: las(vlrs=[vlr("own", i % 60000, b"note") for i in range(n)])),
    "records behind the points": (60000, "a.las", lambda n: las(minor=4, form=6, evlrs=[vlr("own", i % 60000, b"note", True) for i in range(n)])),
    "records of extra bytes": (2000, "a.las", lambda n: las(vlrs=[vlr("LASF_Spec", 4, described("a%d" % i, 1)) for i in range(n)], extra=lambda i: bytes(2000))),
    "lists of extra bytes": (1000, "a.las", lambda n: las(vlrs=[vlr("LASF_Spec", 4, b"".join(described("a%d" % (300 * k + i), 1) for i in range(300)))
                                                                  for k in range(n // 300)], extra=lambda i: bytes(n))),
    "geokeys": (20, "a.las", lambda n: las(vlrs=[vlr("LASF_Projection", 34735, struct.pack("<4H", 1, 1, 0, 8000) + b"".join(
        struct.pack("<4H", 1024 + i, 0, 1, 1) for i in range(8000)))] * n)),
    "points of las": (30000, "a.las", las),
    "scans of e57": (2000, "a.e57", e57_scans),
    "poses of e57": (1000, "a.e57", lambda n: e57_scans(n, '<pose type="Structure"><translation type="Structure"><x>1</x></translation></pose>')),
    "packets of e57": (20000, "a.e57", e57_packets),
    "fields of e57": (60, "a.e57", e57_fields),
    "fields of e57 past the limit": (3000, "a.e57", e57_fields),
    "elements of e57's XML": (20000, "a.e57", lambda n: e57(e57_axes(), 2, root='<own:a type="String">x</own:a>' * n)),
    "names of e57's XML": (20000, "a.e57", lambda n: e57(e57_axes(), 2, root="".join('<a%d type="String">x</a%d>' % (i, i) for i in range(n)))),
    "names of a scan": (20000, "a.e57", lambda n: e57(e57_axes(), 2, scan="".join('<a%d type="String">x</a%d>' % (i, i) for i in range(n)))),
    "levels of e57's XML": (20000, "a.e57", lambda n: e57(e57_axes(), 2, root='<a type="Structure">' * n + "</a>" * n)),
    "attributes of e57's XML": (20000, "a.e57", lambda n: e57(e57_axes(), 2, root="<a %s/>" % "".join('b%d="c" ' % i for i in range(n)))),
    "namespaces of e57's XML": (5000, "a.e57", lambda n: e57(e57_axes(), 2, root="<a %s/>" % "".join('xmlns:b%d="http://c/%d" ' % (i, i) for i in range(n)))),
    "images of e57": (20000, "a.e57", lambda n: e57(e57_axes(), 2, root='<images2D type="Vector">%s</images2D>' % ('<vectorChild type="Structure"/>' * n))),
    "text in e57's XML": (300000, "a.e57", lambda n: e57(e57_axes(), 2, root='<a type="String">%s</a>' % ("&lt;x" * n))),
    "grids of ptx": (20000, "a.ptx", ptx),
    "fields of npy": (500, "a.npy", lambda n: npy([("x", "<f8"), ("y", "<f8"), ("z", "<f8")] + [("a%d" % i, "|u1") for i in range(n)], (2,), (doubles(1, 2, 3) + bytes(n)) * 2)),
    "entries of npz": (10000, "a.npz", lambda n: archive(["a%d.npy" % i for i in range(n)], npy("<f8", (2,), doubles(1, 2)))),
    "equal entries of npz": (1000, "a.npz", lambda n: archive(["a/%s/b.npy" % ("/" * i) for i in range(n)], b"")),
    "packed entries of npz": (10000, "a.npz", lambda n: archive(["a%d.npy" % i for i in range(n)], npy("<f8", (2,), doubles(1, 2)), zipfile.ZIP_DEFLATED)),
    "other files of npz": (10000, "a.npz", lambda n: archive(["a%d.txt" % i for i in range(n)], b"x")),
    "pieces of vtp": (5000, "a.vtp", lambda n: vtk_xml("PolyData", [piece()] * n)),
    "arrays of vtp": (1000, "a.vtp", lambda n: vtk_xml("PolyData", [piece(data="".join(ARRAY % ("a%d" % i, 1, "1 2") for i in range(n)))])),
    "arrays past the limit": (20000, "a.vtp", lambda n: vtk_xml("PolyData", [piece(data="".join(ARRAY % ("a%d" % i, 1, "1 2") for i in range(n)))])),
    "arrays of the field": (20000, "a.vtp", lambda n: vtk_xml("PolyData", ["<FieldData>" + "".join(ARRAY % ("a%d" % i, 1, "1 2") for i in range(n)) + "</FieldData>", piece()])),
    "attributes of vtk's XML": (100000, "a.vtp", lambda n: vtk_xml("PolyData", [piece(attributes="".join(' b%d="c"' % i for i in range(n)))])),
    "levels of vtk's XML": (100000, "a.vtp", lambda n: vtk_xml("PolyData", ["<a>" * n + "</a>" * n, piece()])),
    "elements of vtk's XML": (100000, "a.vtp", lambda n: vtk_xml("PolyData", ["<a/>" * n, piece()])),
    "comments of vtk's XML": (100000, "a.vtp", lambda n: vtk_xml("PolyData", ["<!-- word -->" * n, piece()])),
    "blocks of vtk": (20000, "a.vtp", vtp_in_blocks),
    "corners of a polygon of vtp": (100000, "a.vtp", polygon_of_vtp),
    "arrays of legacy vtk": (1000, "a.vtk", legacy_arrays),
    "field of legacy vtk": (30000, "a.vtk", legacy_fields),
    "nodes of glb": (4000, "a.glb", lambda n: scene(nodes=n)),
    "nodes without a mesh": (20000, "a.glb", lambda n: chunks({"asset": {"version": "2.0"}, "scenes": [{"nodes": list(range(n))}], "nodes": [{}] * n})),
    "nested nodes of glb": (20000, "a.glb", lambda n: scene(nodes=n, deep=True)),
    "meshes of glb": (4000, "a.glb", lambda n: scene(nodes=n, meshes=n)),
    "primitives of glb": (4000, "a.glb", lambda n: scene(primitives=n)),
    "accessors of glb": (20000, "a.glb", lambda n: scene(accessors=n)),
    "views of glb": (20000, "a.glb", lambda n: scene(accessors=n, views=n)),
    "attributes of glb": (1000, "a.glb", lambda n: scene(extra_attributes=n)),
    "attributes of many primitives": (200, "a.glb", lambda n: scene(extra_attributes=200, primitives=n)),
    "different attributes of glb": (300, "a.glb", lambda n: chunks({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "_A%d" % i: 0}} for i in range(n)]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}]}, bytes(36))),
    "members of JSON": (50000, "a.glb", lambda n: scene(extras={"a%d" % i: 1 for i in range(n)})),
    "extensions of glb": (20000, "a.glb", lambda n: scene(extensionsUsed=["A%d" % i for i in range(n)], extensions={"A%d" % i: {} for i in range(n)})),
    "scenes of glb": (20000, "a.glb", lambda n: scene(scenes=[{"nodes": [0]}] * n)),
    "images of glb": (20000, "a.glb", lambda n: scene(images=[{"uri": "a%d.png" % i} for i in range(n)])),
    "members of a gzip file": (20000, "a.xyz.gz", lambda n: gzip.compress(b"1 2 3\n") * n),
    "atoms": (50000, "a.pdb", pdb),
    "remarks of pdb": (100000, "a.pdb", lambda n: pdb(3, n)),
    "words of a chemical comment": (300000, "a.xyz", lambda n: "1\n" + "word " * n + "\nC 0 0 0\n"),
    "properties of a chemical comment": (1000, "a.xyz", lambda n: "1\nProperties=species:S:1:pos:R:3" + lines(n, ":a%d:R:1") + "\nC 0 0 0" + " 1" * n + "\n"),
    "frames of chemical xyz": (50000, "a.xyz", lambda n: "1\nname\nC 0 0 0\n" * n),
}
