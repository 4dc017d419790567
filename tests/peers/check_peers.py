"""check_peers.py hull|alpha: brio against Qhull (scipy), and against GUDHI (gudhi), on 20 sets of points.

hull    the vertices are Qhull's, the volume within 1e-11 of it
alpha   simplices and values are GUDHI's, with and without weights, to 1e-13 of each value; persistence read back from the
        exported file is GUDHI's

BRIO names the program. Skips itself (77) without the packages, which scripts/setup.sh check installs.
"""

import json
import os
import subprocess
import sys
import tempfile

PEER = {"hull": "scipy", "alpha": "gudhi"}
WANTED = 1e-13


def point_sets(np):
    rng = np.random.default_rng(5)
    sizes = (30, 200, 800, 1500) if os.environ.get("BRIO_LONG") else (30, 60, 200, 400)
    for i in range(20):
        n = sizes[i % 4]
        if i // 4 == 0:
            yield rng.random((n, 3))
        elif i // 4 == 1:
            yield rng.normal(size=(n, 3))
        elif i // 4 == 2:
            p = rng.normal(size=(n, 3))
            yield p / np.linalg.norm(p, axis=1)[:, None]
        elif i // 4 == 3:
            yield np.unique(rng.integers(0, 12, (n, 3)), axis=0).astype(float)
        else:
            yield rng.random((n, 3)) * np.array([1, 1, 1e-3]) + 100


def brio(*arguments):
    done = subprocess.run([os.environ["BRIO"], *arguments, "--json"], stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def check_hull(np, folder, points):
    from scipy.spatial import ConvexHull
    out = os.path.join(folder, "hull.off")
    facts = brio("hull", os.path.join(folder, "p.xyz"), "-o", out)
    with open(out) as lines:
        rows = [line.split() for line in lines if not line.startswith(("OFF", "#"))][1:facts["vertices"] + 1]
    mine, peer = {tuple(map(float, row)) for row in rows}, ConvexHull(points)
    theirs = {tuple(row) for row in points[peer.vertices]}
    complaints = ["%d vertices of Qhull are none" % len(theirs - mine)] if theirs - mine else []
    if mine - theirs:
        complaints.append("%d vertices are none of Qhull's" % len(mine - theirs))
    if abs(facts["certificate"]["volume"] / peer.volume - 1) > 1e-11:
        complaints.append("volume %.17g, Qhull %.17g" % (facts["certificate"]["volume"], peer.volume))
    return complaints


def check_filtration(gudhi, folder, points, weights):
    out, more = os.path.join(folder, "f.txt"), ["--weights", os.path.join(folder, "w.txt")] if weights is not None else []
    brio("alpha", os.path.join(folder, "p.xyz"), "--alpha", "auto", "--filtration", out, *more)
    tree = gudhi.AlphaComplex(points=points, weights=weights, precision="exact").create_simplex_tree()
    theirs = {tuple(sorted(simplex)): value for simplex, value in tree.get_filtration()}
    mine, again = {}, gudhi.SimplexTree()
    with open(out) as lines:
        for row in map(str.split, lines):
            simplex = tuple(map(int, row[1:-1]))
            mine[simplex] = float(row[-1])
            again.insert(list(simplex), mine[simplex])
    if set(mine) != set(theirs):
        return ["%d simplices of %d, GUDHI %d" % (len(set(mine) - set(theirs)), len(mine), len(theirs))]
    least = 1e-12 * max(map(abs, theirs.values()))
    worst = max(abs(mine[s] - theirs[s]) / max(abs(theirs[s]), least) for s in mine)
    complaints = ["values differ by %g" % worst] if worst > WANTED else []
    if [s for s in mine if again.filtration(list(s)) != mine[s]]:
        complaints.append("inserted in the order of the file, simplices take other values")
    if again.make_filtration_non_decreasing():
        complaints.append("a value decreases")
    bars, other = again.persistence(), tree.persistence()
    if len(bars) != len(other) or again.betti_numbers() != tree.betti_numbers():
        complaints.append("%d bars, GUDHI %d" % (len(bars), len(other)))
    return complaints


def check_alpha(np, folder, points):
    import gudhi
    weights = np.random.default_rng(len(points)).random(len(points)) * 0.02
    np.savetxt(os.path.join(folder, "w.txt"), weights, fmt="%.17g")
    return check_filtration(gudhi, folder, points, None) + check_filtration(gudhi, folder, points, weights)


def main():
    try:
        import numpy as np
        __import__(PEER[sys.argv[1]])
    except ImportError as missing:
        print("skipped: peers.%s: %s" % (sys.argv[1], missing))
        return 77
    wrong = 0
    for number, points in enumerate(point_sets(np)):
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(os.path.join(folder, "p.xyz"), points, fmt="%.17g")
            for complaint in (check_hull if sys.argv[1] == "hull" else check_alpha)(np, folder, points):
                print("set %d, %d points: %s" % (number, len(points), complaint))
                wrong += 1
    print("20 sets, %d complaints" % wrong)
    return 1 if wrong else 0


sys.exit(main())
