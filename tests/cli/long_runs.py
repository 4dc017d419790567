"""Runs of every command that take seconds, for the promise that a signal ends them soon: inputs, and command lines.

An input is made by the program itself, of a size that is multiplied by `scale`: a small scale tries the command lines. A
command without a row here fails cli.moments.
"""

import os
import struct
import subprocess

from brio_cli import BRIO

# name: the command line that makes it, after `brio`. {n:SIZE} is SIZE times the scale, {NAME} another input.
INPUTS = {
    "scan.ply": "generate scan -n {n:600000} -o {out}",
    "small.ply": "generate scan -n {n:60000} -o {out}",
    "ball.ply": "generate ball -n {n:1000000} -o {out}",
    "few.ply": "generate ball -n {n:100000} -o {out}",
    "sphere.ply": "generate sphere -n {n:1500000} -o {out}",
    "grid.ply": "generate grid -n {n:500000} -o {out}",
    "big.ply": "generate ball -n {n:8000000} -o {out}",
    "big.xyz": "convert {ball.ply} -o {out}",
    "big.laz": "convert {ball.ply} -o {out}",
    "big.las": "convert {ball.ply} -o {out}",
    "big.csv": "convert {ball.ply} -o {out}",
    "big.pcd": "convert {big.ply} --compress -o {out}",
    "big.vtp": "convert {ball.ply} --compress -o {out}",
    "solid.ply": "generate solid --resolution {r:200} -o {out}",
    "coarse.ply": "generate solid --resolution {r:48} -o {out}",
    "other.ply": "generate solid --resolution {r:190} -o {out}",
    "dense.ply": "subdivide {solid.ply} -o {out}",
    "dense.obj": "convert {dense.ply} -o {out}",
    "dense.stl": "convert {dense.ply} -o {out}",
    "dense.glb": "convert {dense.ply} -o {out}",
    "dense.vtk": "convert {dense.ply} --ascii -o {out}",
    "tets.vtu": "delaunay {few.ply} -o {out}",
    "many.vtu": "delaunay {ball.ply} -o {out}",
    "axis.ply": "medial {small.ply} -o {out}",
    "ball.map": None,
}

# command: its long runs. {out} is a file that the run writes, {out2} another.
RUNS = {
    "delaunay": ["delaunay {ball.ply} -o {out}.vtu", "delaunay {grid.ply} --verify", "delaunay {ball.ply} --plane xy --verify",
                 "delaunay {few.ply} --locate history --order random", "delaunay {ball.ply} -o {out}.node --neighbors --faces --edges",
                 "delaunay {ball.ply} --ascii -o {out}.vtu", "delaunay {ball.ply} --weights-mod 0 --verify",
                 "delaunay {ball.ply} -o {out}.vtk", "delaunay {ball.ply} --scratch {folder} --threads 1",
                 "delaunay {ball.ply} --tiles 3 --scratch {folder} --view {out}.html"],
    "surface": ["surface {scan.ply} -o {out}.ply", "surface {small.ply} --method power-crust -o {out}.ply",
                "surface {scan.ply} --method cocone --boundaries -o {out}.ply", "surface {small.ply} --method tight-cocone -o {out}.ply",
                "surface {small.ply} --simplify --self-intersections --vertex-normals --normals {out2}.ply -o {out}.ply",
                "surface {scan.ply} --closed --noise smooth -o {out}.obj", "surface {scan.ply} --method cocone --pieces 8 -o {out}.ply",
                "surface {scan.ply} --tiles 3 --scratch {folder} -o {out}.ply"],
    "medial": ["medial {small.ply} -o {out}.ply", "medial {coarse.ply} --simplify -o {out}.ply"],
    "balls": ["balls {axis.ply} -o {out}.ply"],
    "hull": ["hull {big.ply} -o {out}.ply", "hull {sphere.ply} -o {out}.ply", "hull {sphere.ply} --polygons -o {out}.off"],
    "alpha": ["alpha {ball.ply} --alpha auto -o {out}.ply", "alpha {few.ply} --filtration {out2}.txt --alpha auto -o {out}.ply",
              "alpha {ball.ply} --filtration {out2}.sparse --alpha 0.001 -o {out}.ply",
              "alpha {ball.ply} --alpha 0.001 --tiles 3 --scratch {folder} -o {out}.ply"],
    "offset": ["offset {coarse.ply} --distance 0.02 -o {out}.ply", "offset {coarse.ply} --distance -0.01 --error 0.002 -o {out}.ply",
               "offset {small.ply} --distance 0.02 -o {out}.ply"],
    "voronoi": ["voronoi {few.ply} -o {out}.vtu", "voronoi {ball.ply} --box 0,0,0,1,1,1 -o {out}.csv --faces {out2}.csv",
                "voronoi {ball.ply} -o {out}.npy", "voronoi {ball.ply} --box 0,0,0,1,1,1 --tiles 3 --scratch {folder} --view {out}.html"],
    "check": ["check {dense.ply} --self-intersections", "check {many.vtu}", "check {dense.obj}"],
    "compare": ["compare {solid.ply} {other.ply} --samples {n:2000000}", "compare {dense.ply} {solid.ply}"],
    "iso": ["iso {ball.map} --level -40 --delaunay-conforming -o {out}.ply", "iso {ball.map} --level -40 --vertex-normals -o {out}.ply"],
    "convert": ["convert {big.xyz} -o {out}.ply", "convert {big.ply} -o {out}.xyz", "convert {big.ply} -o {out}.laz", "convert {big.laz} -o {out}.las",
                "convert {big.csv} -o {out}.npy", "convert {big.pcd} -o {out}.pcd --compress", "convert {big.vtp} -o {out}.vtp --compress",
                "convert {ball.ply} --drop-outliers 12 -o {out}.ply", "convert {big.ply} --thin 0.004 -o {out}.ply",
                "convert {dense.ply} --merge 0.0001 -o {out}.ply", "convert {dense.stl} --merge -o {out}.ply", "convert {dense.obj} -o {out}.vtk",
                "convert {dense.glb} -o {out}.obj", "convert {dense.vtk} -o {out}.vtu --compress", "convert {dense.ply} -o {out}.off",
                "convert {dense.ply} -o {out}.stl --ascii", "convert {dense.ply} -o {out}.glb", "convert {dense.ply} -o {out}.vtp",
                "convert {big.ply} --tiles 5 --scratch {folder} -o {out}.vpc", "convert {big.laz} --tiles 3 --scratch {folder} -o {out}.pvtp"],
    "info": ["info {big.ply}", "info {dense.ply}", "info {big.xyz}", "info {big.laz}", "info {sphere.ply}", "info {many.vtu}"],
    "generate": ["generate scan -n {n:3000000} -o {out}.ply", "generate solid --kind machined --resolution {r:260} -o {out}.ply",
                 "generate ball -n {n:20000000} -o {out}.ply", "generate clusters -n {n:9000000} -o {out}.ply"],
    "subdivide": ["subdivide {coarse.ply} --levels 5 -o {out}.ply"],
    "simplify": ["simplify {dense.ply} --faces {n:20000} -o {out}.ply", "simplify {dense.ply} --error 0.001 -o {out}.ply"],
    "terrain": ["terrain {ball.ply} -o {out}.ply", "terrain {ball.ply} --raster {out}.asc --cell 0.001 -o {out2}.ply"],
    "locate": ["locate {few.ply} --at {big.ply} -o {out}.csv", "locate {ball.ply} --plane xy --at {ball.ply} -o {out}.npy"],
    "restricted": ["restricted {solid.ply} --surface {dense.ply} -o {out}.ply"],
    "tree": ["tree {ball.ply} -o {out}.ply", "tree {ball.ply} --plane xy -o {out}.vtp"],
    "view": ["view {dense.ply} -o {out}.html", "view {big.ply} -o {out}.html", "view {big.ply} --picture {out}.png"],
    "interpolate": ["interpolate {small.ply} --at {scan.ply} --property view -o {out}.ply"],
}


def write_map(path, size):
    """A CCP4 map whose values fall with the distance from the middle, in waves."""
    header = struct.pack("<10i", size, size, size, 2, 0, 0, 0, size, size, size)
    header += struct.pack("<6f", size, size, size, 90, 90, 90) + struct.pack("<3i", 1, 2, 3)
    header = header.ljust(208, b"\0") + b"MAP \x44\x44\0\0"
    middle, row = (size - 1) / 2, range(size)
    with open(path, "wb") as file:
        file.write(header.ljust(1024, b"\0"))
        for z in row:
            for y in row:
                part = (y - middle) ** 2 + (z - middle) ** 2
                file.write(struct.pack("<%df" % size, *[-80 / size * ((x - middle) ** 2 + part) ** 0.5 -
                                                        4 * ((x * 7 + y * 5 + z * 3) % 11 > 8) for x in row]))


class Inputs:
    """The inputs in a folder, made when they are first named."""

    def __init__(self, folder, scale=1.0):
        self.folder, self.scale = folder, scale

    def size(self, kind, number):
        if kind == "r":  # cells along a side: the work grows with their square or cube
            return max(24, int(int(number) * self.scale ** 0.4))
        return max(40, int(int(number) * self.scale))

    def line(self, template, out="out"):
        words = []
        for word in template.split():
            while "{" in word:
                before, rest = word.split("{", 1)
                name, after = rest.split("}", 1)
                word = before + self.value(name, out) + after
            words.append(word)
        return words

    def value(self, name, out):
        if name in ("out", "out2"):
            return os.path.join(self.folder, out if name == "out" else out + "-second")
        if name == "folder":
            return self.folder
        if ":" in name:
            return str(self.size(*name.split(":")))
        return self.made(name)

    def made(self, name):
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            if INPUTS[name] is None:
                write_map(path, self.size("r", 160))
                return path
            line = self.line(INPUTS[name], name)
            done = subprocess.run([BRIO] + line + ["--quiet"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            if done.returncode:
                raise RuntimeError("%s: %s" % (" ".join(line), done.stderr.decode()))
        return path
