"""Random calls with arrays in every form, in a process of their own: make python-fuzz goes on for longer."""

import pathlib


def test_random_calls(alone):
    program = pathlib.Path(__file__).with_name("random_calls.py").read_text()
    out = alone(program, "--seed", "1", "--calls", "700", timeout=300)
    assert out.splitlines()[-1] == "700 calls, 0 wrong"
    for name in ("Delaunay", "Voronoi", "ConvexHull", "alpha_complex", "thin", "outliers", "reconstruct", "medial_axis", "Mesh"):
        assert " %s fine" % name in out, "no call of %s has a result" % name
