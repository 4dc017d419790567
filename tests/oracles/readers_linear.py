#!/usr/bin/env python3
"""Families of files, one for each count that a file can claim, up to its limit and past it: the time of `brio info` and of
`brio convert` per byte must not grow with the size of the file.

    BRIO=build/brio python3 tests/oracles/readers_linear.py [--repeat N]

Prints a table: family, size, processor seconds, exit code. Ends with 1 when a file that is twice as large takes more than
three times as long, in runs of more than 50 ms, or when a refusal takes longer than a second.
"""

import argparse
import io
import json
import os
import resource
import struct
import subprocess
import sys
import tempfile
import zipfile

BRIO = os.environ.get("BRIO", "build/brio")
LEAST, MOST_GROWTH, LONGEST_REFUSAL = 0.05, 3.0, 1.0


def columns(n):
    """Rows of many numbers: n rows of 4,000."""
    return "columns.xyz", (("1 2 3 " + "4 " * 3997 + "\n") * (n // 8)).encode()


def too_many_columns(n):
    return "wide.xyz", (("1 2 3 " + "4 " * (100 * n) + "\n") * 2).encode()


def names(n):
    """Names that are alike: each gets a number."""
    count = min(4 * n, 4093)
    return "names.csv", ("x,y,z" + ",a" * count + "\n" + ("1,2,3" + ",4" * count + "\n") * 20).encode()


def words(n):
    """A line of words that belong together, before a comma."""
    return "words.csv", ("x,y,z," + "w " * (500 * n) + ",\n1,2,3,4\n").encode()


def comment(n):
    return "comment.xyz", ("# " + "x y z " * (1000 * n) + "\n1 2 3\n").encode()


def short_rows(n):
    return "short.xyz", ("1 2 3 " + "4 " * 30 + "\n" + "1 2 3\n" * (100 * n)).encode()


def few_wide_rows(n):
    return "lacking.xyz", ("1 2 3 " + "4 " * 3000 + "\n" + "1 2 3\n" * (500 * n)).encode()


PLY = "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"


def properties(n):
    count = min(4 * n, 4093)
    head = PLY % 20 + "".join("property uchar a%d\n" % i for i in range(count))
    return "properties.ply", (head + "end_header\n" + ("0 0 0 " + "1 " * count + "\n") * 20).encode()


def too_many_properties(n):
    return "props.ply", (PLY % 1 + "".join("property uchar a%d\n" % i for i in range(100 * n)) + "end_header\n").encode()


def elements(n):
    return "elements.ply", (PLY % 1 + "".join("element e%d 0\n" % i for i in range(100 * n)) + "end_header\n0 0 0\n").encode()


def array(shape, kind, body):
    head = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    head += " " * (-(len(head) + 11) % 64) + "\n"
    return b"\x93NUMPY\x02\0" + struct.pack("<I", len(head)) + head.encode() + body


def entries(n):
    """An archive of many arrays."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as z:
        z.writestr("points.npy", array("(2, 3)", "<f8", bytes(48)))
        for i in range(min(4 * n, 4000)):
            z.writestr("a%d.npy" % i, array("(2,)", "|u1", bytes(2)))
    return "entries.npz", out.getvalue()


def left_out(n):
    """An archive of arrays that are not read."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as z:
        z.writestr("points.npy", array("(2, 3)", "<f8", bytes(48)))
        for i in range(10 * n):
            z.writestr("a%d.npy" % i, array("(3,)", "|u1", bytes(3)))
    return "left_out.npz", out.getvalue()


def glb(name, scene, binary):
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4e4f534a) + text + struct.pack("<II", len(binary), 0x004e4942) + binary
    return name, struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def scene(nodes, primitives, points):
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(nodes))}],
            "nodes": [{"mesh": 0, "translation": [i, 0, 0]} for i in range(nodes)],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}] * primitives}],
            "accessors": [{"bufferView": 0, "componentType": 5120, "count": points, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 3 * points}], "buffers": [{"byteLength": 3 * points}]}


def nodes(n):
    return glb("nodes.glb", scene(20 * n, 1, 10), bytes(30))


def instances(n):
    return glb("instances.glb", scene(20 * n, 20 * n, 1000), bytes(3000))


def levels(n):
    return "levels.gltf", b'{"asset":{"version":"2.0"},"a":' + b"[" * (1000 * n) + b"]" * (1000 * n) + b"}"


FAMILIES = [columns, too_many_columns, names, words, comment, short_rows, few_wide_rows, properties,
            too_many_properties, elements, entries, left_out, nodes, instances, levels]


def seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(folder, family, n, repeat):
    name, content = family(n)
    path = os.path.join(folder, name)
    with open(path, "wb") as f:
        f.write(content)
    found = []
    for line in (["info", path], ["convert", path, os.path.join(folder, "out.obj")]):
        runs = [seconds([BRIO, *line, "--quiet"]) for _ in range(repeat)]
        found.append((runs[0][0], min(run[1] for run in runs)))
    return len(content), found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for family in FAMILIES:
            before = None
            for n in (256, 512, 1024):
                size, found = measure(folder, family, n, arguments.repeat)
                print("%-20s %9d bytes  info %d %7.3f s  convert %d %7.3f s" %
                      ((family.__name__, size) + found[0] + found[1]), flush=True)
                for i, (code, spent) in enumerate(found):
                    slow = code != 0 and spent > LONGEST_REFUSAL
                    if before and spent > LEAST and code == before[1][i][0]:
                        slow |= spent / before[1][i][1] > MOST_GROWTH * size / before[0] / 2
                    wrong += slow
                    if slow:
                        print("  grows too fast")
                before = (size, found)
    print("%d families, %d faults" % (len(FAMILIES), wrong))
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main())
