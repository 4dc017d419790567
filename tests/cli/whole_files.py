"""Files with everything that their format allows, for formats that are no text."""

import io
import json
import struct
import zipfile


def table():
    rest = list(range(256))
    for _ in range(8):
        rest = [r >> 1 ^ (0x82f63b78 if r & 1 else 0) for r in rest]
    return rest


TABLE = table()


def crc32c(data):
    rest = 0xffffffff
    for byte in data:
        rest = rest >> 8 ^ TABLE[(rest ^ byte) & 255]
    return rest ^ 0xffffffff


def physical(logical):
    return logical // 1020 * 1024 + logical % 1020


def e57(fields, records, scan="", root="", length=None, behind=b""):
    """One scan. Fields: (name, attributes, the bytes of its stream); length: of the section, as its header says; behind: bytes
    that the XML section has behind its end."""
    streams = [stream for _, _, stream in fields]
    packet = struct.pack("<H", len(streams)) + b"".join(struct.pack("<H", len(s)) for s in streams) + b"".join(streams)
    packet += b"\0" * (-(len(packet) + 4) % 4)
    packet = struct.pack("<BBH", 1, 0, len(packet) + 3) + packet
    whole = 32 + len(packet)
    section = struct.pack("<B7xQQQ", 1, whole if length is None else length, physical(48 + 32), 0) + packet
    names = "".join('<%s %s/>' % (name, attributes) for name, attributes, _ in fields)
    xml = ('<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure" '
           'xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0" xmlns:own="http://example.org/own">%s'
           '<data3D type="Vector"><vectorChild type="Structure">%s<points type="CompressedVector" fileOffset="%d" '
           'recordCount="%d"><prototype type="Structure">%s</prototype></points></vectorChild></data3D></e57Root>'
           % (root, scan, physical(48), records, names)).encode() + behind
    content = section + xml
    pages = (48 + len(content) + 1019) // 1020
    header = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, pages * 1024, physical(48 + len(section)), len(xml), 1024)
    content = (header + content).ljust(pages * 1020, b"\0")
    return b"".join(content[i:i + 1020] + struct.pack(">I", crc32c(content[i:i + 1020]))
                    for i in range(0, len(content), 1020))


DOUBLE, SINGLE = 'type="Float"', 'type="Float" precision="single"'


def doubles(*values):
    return struct.pack("<%dd" % len(values), *values)


def e57_axes(kind="cartesian", names="XYZ"):
    return [(kind + name, DOUBLE, doubles(*values)) for name, values in zip(names, [(1, 2), (3, 4), (5, 6)])]


def e57_of_everything():
    words = b"".join(bytes([2 * len(word)]) + word for word in [b"one", b"two"])
    spherical = [("spherical" + name, DOUBLE, doubles(1, 1)) for name in ["Range", "Azimuth", "Elevation"]]
    byte = 'type="Integer" minimum="0" maximum="255"'
    fields = e57_axes() + spherical + [
        ("cartesianInvalidState", 'type="Integer" minimum="0" maximum="2"', b"\0"),
        ("intensity", SINGLE, struct.pack("<2f", 0.5, 1)), ("colorRed", byte, b"\1\2"), ("colorGreen", byte, b"\3\4"),
        ("colorBlue", byte, b"\5\6"), ("rowIndex", byte, b"\0\1"), ("own:label", 'type="String"', words)]
    text = '<%s type="String">x</%s>'
    scan = "".join(text % (name, name) for name in ["guid", "name", "description", "sensorVendor", "own:extra"])
    scan += '<temperature type="Float">20</temperature><acquisitionStart type="Structure"><dateTimeValue type="Float"/>'
    scan += ('</acquisitionStart><pointGroupingSchemes type="Structure"><groupingByLine type="Structure"/>'
             '</pointGroupingSchemes><pose type="Structure"><translation type="Structure"><x>1</x></translation></pose>')
    root = text % ("guid", "guid") + '<images2D type="Vector"><vectorChild type="Structure"/></images2D>'
    root += '<creationDateTime type="Structure"><dateTimeValue type="Float">1</dateTimeValue></creationDateTime>'
    return e57(fields, 2, scan, root)


def npy(descr, shape, data):
    header = repr({"descr": descr, "fortran_order": False, "shape": shape})
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header.encode() + data


def npy_of_everything():
    descr = [("X", "<f8"), ("Y", "<f8"), ("Z", "<f8"), ("label", "<U2"), ("rgb", "|u1", (3,)), ("id", "<u8"), ("time", "<M8[ns]")]
    return npy(descr, (1,), struct.pack("<3d8s3BQq", 1, 2, 3, b"a\0\0\0b\0\0\0", 4, 5, 6, 2**53 + 1, 7))


def npz_of_everything():
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as f:
        f.writestr("points.npy", npy("<f8", (2, 3), doubles(*range(6))))
        f.writestr("heat.npy", npy("<f4", (2,), struct.pack("<2f", 1, 2)))
        f.writestr("id.npy", npy("<i8", (2,), struct.pack("<2q", 1, 2**60 + 1)))
        f.writestr("words.npy", npy("<U1", (2,), b"a\0\0\0b\0\0\0"))
        f.writestr("other.npy", npy("<f8", (5,), doubles(*range(5))))
        f.writestr("notes.txt", "not an array")
    return out.getvalue()


def gltf(uri, size, **more):
    """A triangle, its colours and one attribute of its own; the buffer has 3 rows of 3 floats."""
    names = ["POSITION", "NORMAL", "_HEAT3", "TEXCOORD_0", "COLOR_0", "COLOR_1", "TANGENT", "JOINTS_0", "WEIGHTS_0"]
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    primitive = {"attributes": {name: 0 for name in (names if more else names[:1])}, "material": 0,
                 "targets": [{"POSITION": 0}]} if more else {"attributes": {"POSITION": 0}}
    buffer = {"byteLength": size}
    if uri is not None:
        buffer["uri"] = uri
    return dict({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                 "meshes": [{"primitives": [primitive]}], "accessors": [accessor],
                 "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [buffer]}, **more)


TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def glb_of_everything():
    scene = gltf(None, 36, materials=[{}], textures=[{}], images=[{}], animations=[{}], skins=[{}], cameras=[{}],
                 scene=0, extensions={"KHR_lights_punctual": {"lights": []}})
    scene["scenes"].append({})
    scene["nodes"][0]["name"] = "node"
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4e4f534a) + text + struct.pack("<II", 36, 0x4e4942) + TRIANGLE
    return struct.pack("<III", 0x46546c67, 2, 12 + len(chunks)) + chunks


def stl_of_everything():
    return b"made by a program".ljust(80) + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, *[0, 0, 0, 1, 0, 0, 0, 1, 0], 7)


def vtk_xml(kind, counts, cells, areas):
    """Points and point data of every kind as text, the cells of the kind, and an area of each."""
    array = '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>'
    data = array % ("UInt8", "RGB", 3, "1 2 3 " * 5) + array % ("Float32", "Normals", 3, "0 0 1 " * 5)
    data += array % ("Int16", "heat", 1, "1 2 3 4 5") + array % ("Float64", "wide", 17, "0 " * 85)
    data += '<Array type="String" Name="label" format="ascii">97 0 98 0 99 0 100 0 101 0</Array>'
    return ('<VTKFile type="%s" byte_order="LittleEndian"><%s><FieldData>%s</FieldData><Piece NumberOfPoints="5" %s>'
            '<PointData>%s</PointData><CellData>%s</CellData><Points>%s</Points>%s</Piece></%s></VTKFile>'
            % (kind, kind, array % ("Int32", "time", 1, "3"), counts, data, array % ("Float32", "area", 1, areas),
               array % ("Float64", "Points", 3, "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"), cells, kind))


def vtk_lists(section, connectivity, offsets, types=None):
    array = '<DataArray type="Int64" Name="%s" format="ascii">%s</DataArray>'
    return "<%s>%s%s%s</%s>" % (section, array % ("connectivity", connectivity), array % ("offsets", offsets),
                                array % ("types", types) if types else "", section)


def vtp_of_everything():
    return vtk_xml("PolyData", 'NumberOfVerts="1" NumberOfLines="1" NumberOfStrips="1" NumberOfPolys="1"',
                   vtk_lists("Verts", "0", "1") + vtk_lists("Lines", "0 1", "2") + vtk_lists("Strips", "0 1 2 3", "4") +
                   vtk_lists("Polys", "0 1 2", "3"), "1 2 3 4")


def vtu_of_everything():
    """A vertex, a triangle, a tetrahedron, a pyramid, and a quadratic triangle."""
    return vtk_xml("UnstructuredGrid", 'NumberOfCells="5"',
                   vtk_lists("Cells", "0  0 1 2  0 1 2 3  0 1 2 3 4  0 1 2 3 4 0", "1 4 8 13 19", "1 5 10 14 22"), "1 2 3 4 5")


def vtk_of_everything():
    """A vertex, a triangle, a tetrahedron, a pyramid, and a quadratic triangle, as text of version 3."""
    return ("# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\ntime 1 1 int\n3\n"
            "METADATA\nINFORMATION 0\n\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 5 24\n1 0\n3 0 1 2\n4 0 1 2 3\n"
            "5 0 1 2 3 4\n6 0 1 2 3 4 0\nCELL_TYPES 5\n1 5 10 14 22\nCELL_DATA 5\nSCALARS area float\nLOOKUP_TABLE default\n"
            "1 2 3 4 5\nPOINT_DATA 5\nSCALARS heat short 1\nLOOKUP_TABLE colours\n1 2 3 4 5\nLOOKUP_TABLE colours 1\n0 0 0 1\n"
            "NORMALS n float\n" + "0 0 1\n" * 5 + "VECTORS my%20flow float\n" + "1 2 3\n" * 5 + "COLOR_SCALARS c 3\n" + "0 0.5 1\n" * 5 +
            "TEXTURE_COORDINATES t 2 float\n" + "0 1 " * 5 + "\nFIELD FieldData 3\nlabel 1 5 string\na\nb c\n\nd\ne\n"
            "on 1 5 bit\n1 0 1 0 1\nwide 17 5 float\n" + "0 " * 85 + "\n")


def legacy(version, data, kind="POLYDATA"):
    return b"# vtk DataFile Version %s\ntitle\nBINARY\nDATASET %s\n" % (version, kind.encode()) + data


LEGACY_POINTS = b"POINTS 4 float\n" + struct.pack(">12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1) + b"\n"


def legacy_lists(name, lists, fifth):
    """Cells as a list with counts, or as offsets and corners."""
    corners = [corner for cell in lists for corner in cell]
    if not fifth:
        numbers = [number for cell in lists for number in [len(cell)] + cell]
        return b"%s %d %d\n" % (name, len(lists), len(numbers)) + struct.pack(">%di" % len(numbers), *numbers) + b"\n"
    ends = [sum(map(len, lists[:i])) for i in range(len(lists) + 1)]
    return (b"%s %d %d\nOFFSETS vtktypeint64\n" % (name, len(ends), len(corners)) + struct.pack(">%dq" % len(ends), *ends) +
            b"\nCONNECTIVITY vtktypeint64\n" + struct.pack(">%dq" % len(corners), *corners) + b"\n")


# --- LAS

LAS_RECORDS = {0: 20, 1: 28, 2: 26, 3: 34, 4: 57, 6: 30, 7: 36, 8: 38}
LAS_HEADERS = {2: 227, 3: 235, 4: 375, 5: 393}


def vlr(user, ident, data, late=False):
    return struct.pack("<H16sH" + ("Q" if late else "H") + "32s", 0, user.encode(), ident, len(data), b"text") + data


def described(name, kind, options=0, scale=(), offset=(), text=""):
    triple = lambda values: struct.pack("<3d", *(tuple(values) + (0, 0, 0))[:3])
    return (struct.pack("<2xBB32s4x72x", kind, options, name.encode()) + triple(scale) + triple(offset) +
            struct.pack("<32s", text.encode()))


def las(n=4, form=0, minor=2, vlrs=(), evlrs=(), extra=lambda i: b"", encoding=0, rgb=lambda i: (0, 0, 0), gps=float,
        shift=0, system=b"", software=b"", date=(0, 0), wave=False):
    """A LAS file whose points i are scattered, in centimetres at the size of UTM."""
    size, rows = LAS_RECORDS[form] + len(extra(0)), []
    for i in range(n):
        if form < 6:
            row = struct.pack("<iiiHBBbBH", i, i * 7919 % 10007, i * 31 % 977, 10 * i & 65535, 9, 2, -3, 5, 7)
            row += struct.pack("<d", gps(i)) if form in (1, 3, 4) else b""
        else:
            row = struct.pack("<iiiHBBBBhHd", i, i * 7919 % 10007, i * 31 % 977, 10 * i & 65535, 17, 0, 2, 5, -30, 7, gps(i))
        row += struct.pack("<HHH", *rgb(i)) if form in (2, 3, 7, 8) else b""
        rows.append((row + bytes(29) if form == 4 else row) + extra(i))
    rows = b"".join(rows)
    head, body = LAS_HEADERS[minor], b"".join(vlrs)
    start = head + len(body)
    h = struct.pack("<4sHH16sBB32s32sHHHIIBHI5I", b"LASF", 0, encoding, bytes(16), 1, minor, system, software, *date,
                    head, start, len(vlrs), form, size, n if form < 6 else 0, 0, 0, 0, 0, 0)
    h += struct.pack("<12d", 0.01, 0.01, 0.01, 500000, 5000000, 0, *[0] * 6)
    h += struct.pack("<Q", 0) if minor >= 3 else b""
    h += struct.pack("<QIQ15Q", start + len(rows), len(evlrs), n, *[0] * 15) if minor >= 4 else b""
    h += struct.pack("<ddH", 0, 0, shift) if minor >= 5 else b""
    return h + body + rows + b"".join(evlrs)


def las_of_everything():
    """Waveforms, which only version 1.3 and 1.4 have, and extra bytes of every kind that is not read."""
    keys = struct.pack("<8H", 1, 1, 0, 1, 3072, 0, 1, 25832)
    lists = described("wide", 9) + described("blob", 0, 4) + described("large", 7)
    records = [vlr("LASF_Projection", 34735, keys), vlr("LASF_Spec", 4, lists), vlr("LASF_Spec", 4, described("odd", 77)),
               vlr("own", 7, b"note"), vlr("copc", 1, bytes(160)), vlr("LAStools", 30, bytes(8))]
    return las(form=4, minor=3, vlrs=records, extra=lambda i: struct.pack("<fIQH", i, 9, 2**53 + i, 1), encoding=1 + 8,
               system=b"OWN SCANNER", software=b"own 1", date=(123, 2024))


def with_index(laz):
    """A LAZ file with an index, which a reader passes over, put in before its points."""
    record = vlr("copc", 1, bytes(160))
    start, count = struct.unpack("<II", laz[96:104])
    table, = struct.unpack("<q", laz[start:start + 8])
    head = laz[:96] + struct.pack("<II", start + len(record), count + 1) + laz[104:start]
    return head + record + struct.pack("<q", table + len(record)) + laz[start + 8:]
