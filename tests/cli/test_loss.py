"""What a run would lose or get wrong: it says so, or does not begin."""

import os

from brio_cli import CliTest, main


class FilesNamedTwice(CliTest):
    """An output that is the input, or another output."""

    def refuse(self, *arguments):
        before = {name: self.content(name) for name in os.listdir(self.folder)}
        self.usage("name the same file", *arguments)
        self.assertEqual({name: self.content(name) for name in os.listdir(self.folder)}, before)

    def content(self, name):
        path = self.path(name)
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as f:
            return f.read()

    def test_output_over_the_input(self):
        points = self.cloud("a.ply", 60, "ball")
        other = self.file("b.xyz", "0 0 0\n")
        for how in [("surface",), ("delaunay",), ("hull",), ("alpha", "--alpha", "auto"), ("medial",),
                    ("offset", "-D", "1"), ("subdivide",), ("iso", "--level", "1"),
                    ("interpolate", "--at", other, "--property", "p")]:
            self.refuse(how[0], points, *how[1:], "-o", points)
        table = self.file("a.csv", "x,y,z\n0,0,0\n")
        self.refuse("voronoi", table, "-o", table)
        self.refuse("locate", table, "--at", other, "-o", table)

    def test_output_over_the_input_by_another_name(self):
        points = self.cloud("a.ply", 60, "ball")
        os.symlink("a.ply", self.path("link.ply"))
        os.link(points, self.path("hard.ply"))
        os.symlink(".", self.path("folder"))
        for name in ["./a.ply", "link.ply", "hard.ply", "folder/a.ply", points]:
            self.refuse("surface", "a.ply", "-o", name)
        self.refuse("surface", "link.ply", "-o", "hard.ply")

    def test_second_output_over_the_input(self):
        points = self.cloud("a.ply", 60, "ball")
        for how in [("surface", "--normals"), ("surface", "--method", "power-crust", "--normals"),
                    ("medial", "--crust"), ("alpha", "--alpha", "auto", "--filtration"), ("voronoi", "--faces")]:
            self.refuse(how[0], points, *how[1:], "./a.ply", "-o", self.path("out.vtu"))

    def test_output_over_another_input(self):
        points, rows = self.cloud("a.ply", 60, "ball"), self.file("rows.ply", "1\n" * 60)
        self.refuse("delaunay", points, "--weights", rows, "-o", rows)
        self.refuse("locate", points, "--at", self.file("at.csv", "0 0 0\n"), "-o", "at.csv")

    def test_two_outputs_that_are_not_there_yet(self):
        points = self.cloud("a.ply", 60, "ball")
        os.symlink(".", self.path("folder"))
        os.symlink("new.ply", self.path("ahead.ply"))
        for name in ["./new.ply", "folder/new.ply", "ahead.ply"]:
            self.refuse("surface", points, "-o", "new.ply", "--normals", name)

    def test_the_files_of_a_pair_of_tetgen(self):
        self.tetrahedra("a", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)])
        self.refuse("delaunay", "a.node", "-o", "a.ele")
        self.refuse("delaunay", "a.ele", "-o", "a.node")

    def test_devices_may_be_named_twice(self):
        points = self.cloud("a.ply", 60, "ball")
        self.expect(0, "alpha", points, "--alpha", "auto", "--format", "ply", "-o", "/dev/null", "--filtration",
                    "/dev/null")

    def test_an_input_may_be_named_twice(self):
        points, mesh = self.cloud("a.ply", 60, "ball"), self.path("hull.ply")
        self.expect(0, "locate", points, "--at", points, "-o", self.path("out.csv"))
        self.expect(0, "hull", points, "-o", mesh)
        self.expect(0, "compare", mesh, mesh)


if __name__ == "__main__":
    main()
