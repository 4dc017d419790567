"""An option that changes nothing is wrong usage, or the program says so: every option of every command, in every mode of
the command.

A mode is a command line. Each option that it does not have is added, with each of its values in VALUES, until the report,
the output or the exit code differs, or a message names the option. Options that do none of that are ignored in silence;
IDLE has those that may be, with the reason.
"""

import json
import math
import os
import re
import shutil

from brio_cli import CliTest, CUBE, FLAT, FLAT_RIGHT, main, OCTAHEDRON, OCTAHEDRON_FACES

# Options of which results do not depend, by the contract of the command line, or about the report alone.
ANYWHERE = {"json", "quiet", "verbose", "progress", "threads", "seed", "max-memory", "scratch", "output", "help"}

VALUES = {
    "view": ["v.html"], "picture": ["v.png"], "look": ["1,2,3"], "colour-by": ["x"], "picture-size": ["20x10"], "title": ["other"],
    "format": ["zzz"], "input-format": ["obj", "zzz"], "columns": ["-,x,y,z"], "weights": ["w.txt"], "weights-mod": ["-9"],
    "order": ["random", "hilbert"], "block-size": ["7"], "round-ratio": ["0.9"], "locate": ["jump"], "record-every": ["5"],
    "subgraph": ["tree"], "tiles": ["3"], "page-size": ["4K"], "surface": ["mesh.ply"], "cache-size": ["64K"], "plane": ["xy"], "method": ["cocone", "linear", "voronoi"], "labeling": ["naive"], "noise": ["smooth", "0.5"],
    "open": ["4"], "from": ["0,0,9"], "crs": ["crs.prj"], "error": ["0.05", "1e-9"], "spacing": ["0.2"], "left-out": ["left.ply"], "normals": ["n.ply"], "sampling-density": ["0.3"], "theta": ["0.1"], "pieces": ["3"],
    "extraction": ["candidates"], "min-component": ["100000", "2"], "sides": ["outer"], "scale": ["1.5"], "scale-axis": ["1.5"], "rho": ["0.5"], "redundancy": ["0.5"],
    "crust": ["c.ply"], "alpha": ["0.5"], "filtration": ["f.txt"], "distance": ["0.2"], "box": ["0,0,0,1,1,1"],
    "faces": ["f.csv", "20"], "samples": ["50", "cloud.ply"], "level": ["-3"], "resolution": ["9", "20"], "points": ["40"], "blobbiness": ["4"],
    "crop": ["0,0,0,0.5,1,1"], "drop-outliers": ["8"], "thin": ["0.4"], "merge": ["0.3"], "views": ["3"], "truth": ["t.ply"],
    "truth-resolution": ["9"], "within": ["0.001"], "class": ["2"], "max-edge": ["0.3"], "raster": ["t.asc"], "cell": ["0.5", "3,3,3"], "periodic": ["xy"], "kind": ["machined"], "levels": ["2"], "at": ["p.csv"], "property": ["q"],
}

# Lines without `brio`.
MODES = [
    "delaunay cloud.ply", "delaunay cloud.ply -o out.node", "delaunay cloud.ply --plane xy -o out.ply",
    "delaunay mesh.ply --locate trace",
    "surface cloud.ply", "surface cloud.ply -o out.ply", "surface cloud.ply -o out.stl",
    "surface cloud.ply --tiles 2 --scratch . -o out.ply",
    "surface cloud.ply --method power-crust -o out.ply", "surface cloud.ply --method cocone -o out.ply",
    "surface cloud.ply --method cocone --pieces 3 -o out.ply",
    "medial cloud.ply -o out.ply", "medial cloud.ply", "medial cloud.ply --method voronoi -o out.ply", "balls axis.ply -o out.ply", "hull text.csv",
    "alpha cloud.ply --alpha auto -o out.ply", "offset cloud.ply -D 0.1 -o out.ply", "offset cloud.ply -D 0.1",
    "voronoi cloud.ply -o out.csv", "voronoi cloud.ply",
    "check mesh.ply", "check open.off", "check flat.node", "compare mesh.ply mesh2.ply",
    "iso ball.map --level -4 -o out.ply", "iso atoms.pdb --level 1 -o out.ply", "iso ball.map --level -4",
    "convert text.csv out.las", "convert text.csv out.vpc --tiles 2 --scratch .", "info text.csv", "view mesh.ply -o page.html", "view cloud.ply mesh.ply -o page.html",
    "generate scan -n 90 -o out.ply", "generate solid --resolution 16 -o out.ply",
    "subdivide mesh.ply -o out.ply", "restricted cloud.ply --surface mesh2.ply -o out.ply", "tree cloud.ply -o out.ply", "surface ring.xyz -o out.ply", "locate cloud.ply --at p.csv -o out.csv",
    "interpolate text.csv --at p.csv --property q -o out.csv", "interpolate text.csv --at p.csv --property q -o out.ply",
]

IDLE = {
    # a mesh is no cloud to thin
    ("view mesh.ply -o page.html", "points"),
    # what is asked for comes anyway
    ("view mesh.ply -o page.html", "exact"), ("view cloud.ply mesh.ply -o page.html", "exact"),
    ("delaunay cloud.ply -o out.node", "ascii"),
    ("interpolate text.csv --at p.csv --property q -o out.csv", "ascii"), ("locate cloud.ply --at p.csv -o out.csv", "ascii"),
    ("voronoi cloud.ply -o out.csv", "ascii"),
    ("surface cloud.ply -o out.stl", "float32"),
    ("surface cloud.ply -o out.ply", "vertex-normals"), ("surface cloud.ply -o out.stl", "vertex-normals"),
    ("surface cloud.ply", "triangulate"),
    ("surface cloud.ply -o out.stl", "triangulate"), ("surface cloud.ply --method power-crust -o out.ply", "triangulate"),
    # a report in JSON has the density in any case
    ("surface cloud.ply --method cocone -o out.ply", "density"),
    ("surface cloud.ply --method cocone --pieces 3 -o out.ply", "density"),
    # points without weights are unweighted
    ("delaunay cloud.ply", "unweighted"), ("delaunay cloud.ply -o out.node", "unweighted"),
    ("delaunay cloud.ply --plane xy -o out.ply", "unweighted"), ("delaunay mesh.ply --locate trace", "unweighted"),
    ("alpha cloud.ply --alpha auto -o out.ply", "unweighted"), ("voronoi cloud.ply", "unweighted"),
    ("voronoi cloud.ply -o out.csv", "unweighted"),
    ("locate cloud.ply --at p.csv -o out.csv", "unweighted"), ("check flat.node", "unweighted"),
    # of points in a plane this is the default, and this curve is open by so much
    ("surface ring.xyz -o out.ply", "curves"), ("surface ring.xyz -o out.ply", "open"),
    # these surfaces are closed already, and these points know no normals and no places of scanners
    ("check mesh.ply", "open"),
    ("surface cloud.ply", "open"), ("surface cloud.ply", "closed"),
    ("surface cloud.ply", "ignore-normals"), ("surface cloud.ply", "ignore-origins"),
    ("surface cloud.ply -o out.ply", "open"), ("surface cloud.ply -o out.ply", "closed"),
    ("surface cloud.ply -o out.ply", "ignore-normals"), ("surface cloud.ply -o out.ply", "ignore-origins"),
    ("surface cloud.ply -o out.stl", "open"), ("surface cloud.ply -o out.stl", "closed"),
    ("surface cloud.ply -o out.stl", "ignore-normals"), ("surface cloud.ply -o out.stl", "ignore-origins"),
    ("surface cloud.ply --method power-crust -o out.ply", "closed"),
    ("surface cloud.ply --method cocone -o out.ply", "ignore-normals"),
    ("surface cloud.ply --method cocone -o out.ply", "ignore-origins"),
    ("surface cloud.ply --method cocone --pieces 3 -o out.ply", "ignore-normals"),
    ("surface cloud.ply --method cocone --pieces 3 -o out.ply", "ignore-origins"),
}


class IdleOptions(CliTest):
    def setUp(self):
        super().setUp()
        self.cloud("cloud.ply", 150, "torus")
        self.expect(0, "hull", self.path("cloud.ply"), "-o", self.path("mesh.ply"), "--quiet")
        self.expect(0, "subdivide", self.path("mesh.ply"), "-o", self.path("mesh2.ply"), "--quiet")
        self.off("open.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        self.xyz("ring.xyz", [(math.cos(i / 9), math.sin(i / 9), 0) for i in range(50)])
        self.tetrahedra("flat", FLAT, FLAT_RIGHT)
        self.ball_map("ball.map", 12)
        self.file("w.txt", "".join("%d\n" % (i % 5) for i in range(150)))
        self.file("atoms.pdb", "".join("ATOM  %5d  C   ALA A   1    %8.3f%8.3f%8.3f  1.00  0.00           C  \n" %
                                       (i, 1.5 * i, 0.3 * i * i, 0.1 * i) for i in range(5)))
        self.file("text.csv", "x,y,z,q\n" + "".join("%r,%r,%r,%d\n" % (*p, i) for i, p in enumerate(
            CUBE + [(x / 3 + 0.01, y / 3, 0.2 * x + y * y / 9) for x in range(3) for y in range(3)])))
        self.file("p.csv", "x,y,z,q\n0.4,0.3,0.2,1\n0.6,0.5,0.3,2\n0.2,0.2,0.2,3\n")
        self.expect(0, "medial", self.path("cloud.ply"), "-o", self.path("axis.ply"), "--quiet")
        self.inputs = set(os.listdir(self.folder))

    def options_of(self, command):
        text = self.expect(0, "help", command).text
        return dict(re.findall(r"(?m)^  (?:-\w, )?--([a-z0-9-]+)(?: (\S+))?", text))

    def result(self, line):
        """Exit code, facts without what varies, messages, and the bytes of what was written."""
        run = self.run_brio(*line.split(), "--json")
        written = {}
        for name in sorted(set(os.listdir(self.folder)) - self.inputs):
            with open(self.path(name), "rb") as f:
                written[name] = f.read()
            os.remove(self.path(name))
        facts = json.loads(run.out) if run.out.startswith(b"{") else {}
        for name in "seconds", "peak_bytes", "input", "output":
            facts.pop(name, None)
        return run.code, facts, run.err, written

    def is_idle(self, mode, plain, option, takes):
        for value in VALUES[option] if takes and not takes.startswith("[") else [""]:
            found = self.result("%s --%s %s" % (mode, option, value))
            if found != plain or "--" + option in found[2]:
                return False
        return True

    def test_no_option_is_ignored_in_silence(self):
        idle = set()
        for mode in MODES if os.environ.get("BRIO_LONG") else MODES[::3]:
            plain = self.result(mode)
            self.assertEqual(plain[0] in (0, 5), True, "%s\n%s" % (mode, plain[2]))
            given = re.findall(r"--([a-z0-9-]+)", mode) + (["distance"] if " -D " in mode else []) + (
                ["points"] if " -n " in mode else [])
            for option, takes in self.options_of(mode.split()[0]).items():
                if option not in ANYWHERE and option not in given and self.is_idle(mode, plain, option, takes):
                    idle.add((mode, option))
        self.assertEqual(idle - IDLE, set())
        if os.environ.get("BRIO_LONG"):
            self.assertEqual(IDLE - idle, set(), "no exceptions any more")


if __name__ == "__main__":
    main()
