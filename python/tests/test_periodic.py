"""Space that repeats: lattices, cells that fill the box, and what does not change the result."""

import itertools
import os
import pickle
from fractions import Fraction

import numpy as np
import pytest

import brio

RNG = np.random.default_rng(45)
SKEW = np.array([[1, 0, 0], [7, 1, 0], [-13, 50, 1]])
CUBIC, HEXAGONAL = np.eye(3), np.array([[1, 0, 0], [-0.5, np.sqrt(0.75), 0], [0, 0, 1]])
FCC, BCC = np.array([[0, 1, 1], [1, 0, 1], [1, 1, 0]]) / 2, np.array([[-1, 1, 1], [1, -1, 1], [1, 1, -1]]) / 2
ORTHOHEXAGONAL = [[1, 0, 0], [1, 2, 0], [0, 0, 1]]  # of hexagonal vectors
U, (X, Y, Z) = 0.4697, (0.4135, 0.2669, 0.7858)  # of alpha quartz: SiO2, in the group P3(2)21
QUARTZ = [[U, 0, 2 / 3], [0, U, 1 / 3], [-U, -U, 0], [X, Y, Z], [-Y, X - Y, Z + 2 / 3], [-X + Y, -X, Z + 1 / 3], [Y, X, -Z],
          [X - Y, -Y, -Z + 1 / 3], [-X, -X + Y, -Z + 2 / 3]]
# Primitive cells: vectors, atoms in shares of them, faces of each atom's cell, and the conventional cell in these vectors.
CRYSTALS = {
    "sc": (CUBIC, [[0, 0, 0]], [6], np.eye(3)),
    "bcc": (BCC, [[0, 0, 0]], [14], [[0, 1, 1], [1, 0, 1], [1, 1, 0]]),
    "fcc": (FCC, [[0, 0, 0]], [12], [[-1, 1, 1], [1, -1, 1], [1, 1, -1]]),
    "diamond": (FCC, [[0, 0, 0], [0.25, 0.25, 0.25]], [16, 16], [[-1, 1, 1], [1, -1, 1], [1, 1, -1]]),
    "hcp": (HEXAGONAL * [[1], [1], [np.sqrt(8 / 3)]], [[0, 0, 0], [2 / 3, 1 / 3, 0.5]], [12, 12], ORTHOHEXAGONAL),
    "quartz": (HEXAGONAL * [[1], [1], [5.4052 / 4.9134]], QUARTZ, [10] * 3 + [21] * 6, ORTHOHEXAGONAL),
}


def supercell(cell, shares, change):
    """The atoms in a cell whose vectors are sums of those of a primitive one, and which primitive atom each is."""
    change = np.rint(change).astype(int)
    reach = np.abs(change).sum()
    moves = np.array(list(itertools.product(range(-reach, reach + 1), repeat=3)))
    inside = np.linalg.solve(change.T, (np.asarray(shares) % 1 + moves[:, None] + 1e-6).reshape(-1, 3).T).T
    kept = ((inside >= 0) & (inside < 1)).all(axis=1)
    atoms = (np.asarray(shares) + moves[:, None]).reshape(-1, 3)[kept]
    return change @ cell, atoms @ cell, np.tile(np.arange(len(shares)), len(moves))[kept]


@pytest.mark.parametrize("name", CRYSTALS)
@pytest.mark.parametrize("edge", [1.0, 4.0495, 3.165e-10, 5.43e9])
def test_crystals_have_equal_volumes_and_the_right_faces(name, edge):
    """In the primitive, the conventional and skewed cells. Symmetry that doubles hold gives no face of rounding's size."""
    vectors, shares, faces, conventional = CRYSTALS[name]
    vectors, volumes = vectors * edge, {}
    for change, skew in itertools.product((np.eye(3), conventional), (np.eye(3), SKEW)):
        cell, atoms, kind = supercell(vectors, shares, change)
        assert len(atoms) == round(abs(np.linalg.det(change))) * len(shares)
        vor = brio.Voronoi(atoms, cell=skew @ cell)
        exact = skew is not SKEW and name not in ("hcp", "quartz") and np.all(change == np.eye(3)) == (name == "sc")
        assert vor.coordination(0 if exact else 1e-9).tolist() == np.array(faces)[kind].tolist()
        for i in range(len(shares)):
            first = volumes.setdefault(faces[i], vor.volumes[kind == i][0])
            most = 1e-12 if skew is SKEW else 1e-13  # skewed vectors are rounded fifty times as coarsely by who gives them
            assert np.abs(vor.volumes[kind == i] / first - 1).max() < most
        assert abs(vor.volumes.sum() / abs(np.linalg.det(cell)) - 1) < 1e-12


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6, 1e12])
def test_neighbours_do_not_depend_on_the_unit(size):
    count, most = (100000, 0.03) if os.environ.get("BRIO_LONG") else (10000, 0.09)
    points = np.random.default_rng(1).random((count, 3)) * size
    vor = brio.Voronoi(points, cell=[size] * 3)
    assert abs(len(vor.neighbor_points) / len(points) - 15.535) < most
    assert abs(vor.volumes.sum() / size**3 - 1) < 1e-12


def test_faces_come_in_pairs():
    points, cell = RNG.random((40, 3)), np.array([[1, 0, 0], [0.3, 1.2, 0], [0.1, -0.4, 0.9]])
    vor = brio.Voronoi(points @ cell, cell=cell, radii=0.05 * RNG.random(40))
    owner = np.repeat(np.arange(40), np.diff(vor.neighbor_offsets))
    there = {(i, j, *s): a for i, j, s, a in zip(owner.tolist(), vor.neighbor_points.tolist(), vor.neighbor_shifts.tolist(), vor.face_areas)}
    assert len(there) == len(owner)
    for (i, j, a, b, c), area in there.items():
        assert there[j, i, -a, -b, -c] == pytest.approx(area, rel=1e-9, abs=1e-14)
    way = vor.points[vor.neighbor_points] + vor.neighbor_shifts @ vor.cell - vor.points[owner]
    assert np.allclose(way / np.linalg.norm(way, axis=1)[:, None], vor.face_normals)


def solve(rows, right):
    """Solves three equations in fractions."""
    rows = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for i in range(3):
        pivot = next(k for k in range(i, 3) if rows[k][i] != 0)
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(3):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i], strict=True)]
    return [row[3] for row in rows]


def volume_in_fractions(tri, weights, point):
    """The volume of a point's cell: the cones over its faces, of which each is a fan of the centres round an edge."""
    where = [[Fraction(x) for x in row] for row in tri.image_positions.tolist()]
    cell = [[Fraction(x) for x in row] for row in tri.cell.tolist()]
    minus = lambda a, b: [x - y for x, y in zip(a, b, strict=True)]  # noqa: E731
    dot = lambda a, b: sum(x * y for x, y in zip(a, b, strict=True))  # noqa: E731
    faces = {}
    for simplex in tri.simplices.tolist():
        for apex in range(4):
            if tri.image_points[simplex[apex]] != point:
                continue
            at = where[simplex[apex]]
            ways = [minus(where[v], at) for k, v in enumerate(simplex) if k != apex]
            lifts = [(dot(w, w) + weights[point] - weights[tri.image_points[v]]) / 2
                     for w, v in zip(ways, [v for k, v in enumerate(simplex) if k != apex], strict=True)]
            centre = solve(ways, lifts)
            for k in range(3):  # the edge of the face with neighbour k that leaves this centre: names of centres are positions
                faces.setdefault(tuple(ways[k]), set()).add((tuple(centre), lifts[k]))
    total = Fraction(0)
    for normal, corners in faces.items():
        height = next(iter(corners))[1]
        corners = [c for c, _ in corners]
        total += height * area_over_normal(normal, corners) / 3
    assert len(cell) == 3
    return total


def area_over_normal(normal, corners):
    """The area of a convex polygon that is upright to a vector, divided by its length: of its image along one axis."""
    axis = max(range(3), key=lambda k: abs(normal[k]))
    flat = sorted({tuple(c[k] for k in range(3) if k != axis) for c in corners})
    turn = lambda o, a, b: (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])  # noqa: E731
    rings = []
    for points in (flat, flat[::-1]):
        chain = []
        for q in points:
            while len(chain) > 1 and turn(chain[-2], chain[-1], q) <= 0:
                chain.pop()
            chain.append(q)
        rings += chain[:-1]
    twice = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(rings, rings[1:] + rings[:1], strict=True))
    return abs(twice / 2 / normal[axis])


class AsGiven:
    """A triangulation with the positions of its images in fractions, of the points and the vectors that were given."""

    def __init__(self, tri, cell):
        self.image_points, self.simplices, self.cell = tri.image_points, tri.simplices, cell
        points, vectors = ([[Fraction(x) for x in row] for row in rows.tolist()] for rows in (tri.points, cell))
        self.image_positions = self
        self.rows = [[points[p][k] + sum(s * vectors[j][k] for j, s in enumerate(shift)) for k in range(3)]
                     for p, shift in zip(tri.image_points.tolist(), tri.image_shifts.tolist(), strict=True)]

    def tolist(self):
        return self.rows


def test_a_skewed_quartz_has_the_volumes_of_the_numbers_given():
    """Vectors that are skewed by 1 : 50 are rounded by who gives them: equal atoms have cells that differ by 2.5e-13 then."""
    vectors, shares, faces, _ = CRYSTALS["quartz"]
    cell, atoms, kind = supercell(vectors * 4.0495, shares, np.eye(3))
    vor = brio.Voronoi(atoms, cell=SKEW @ cell)
    given = AsGiven(vor.delaunay, SKEW @ cell)
    exact = np.array([float(volume_in_fractions(given, [0] * len(atoms), i)) for i in range(len(atoms))])
    assert np.abs(vor.volumes / exact - 1).max() < 1e-13
    groups = [exact[np.array(faces)[kind] == count] for count in (10, 21)]
    assert 1e-13 < max(group.max() / group.min() for group in groups) - 1 < 4e-13


@pytest.mark.parametrize("kind", ["uniform", "slivers", "sphere", "needles", "thin", "weighted", "lattice"])
def test_volumes_are_those_of_fractions(kind):
    rng = np.random.default_rng(33)
    cell = np.diag([16, 0.25, 1]) if kind == "thin" else np.array([[1, 0, 0], [0.25, 1, 0], [0, -0.375, 1]])
    shares, weights = rng.random((24, 3)), np.zeros(24)
    if kind == "slivers":
        shares = np.round(shares * 3) / 4 + 2.0**-20 * rng.random((24, 3))
    if kind == "lattice":
        shares = np.array(list(itertools.product((0, 0.25, 0.5), (0, 0.5), (0, 0.25, 0.5, 0.75))))
    if kind == "sphere":
        shares = 0.5 + 0.375 * (shares - 0.5) / np.linalg.norm(shares - 0.5, axis=1)[:, None]
    if kind == "needles":
        shares[1::2] = shares[::2] + 2.0**-24 * rng.random((12, 3))
    if kind == "weighted":
        weights = np.round(rng.random(24) * 2**12) / 2**14
    points = np.round(np.mod(shares, 1) * 2**36) / 2**36 @ cell
    points = np.round(points * 2**34) / 2**34
    vor = brio.Voronoi(points, weights, cell=cell)
    exact = [Fraction(w) for w in weights.tolist()]
    total = 0
    for point in range(0, 24, 1 if kind == "weighted" else 3):
        volume = float(volume_in_fractions(vor.delaunay, exact, point))
        total += volume > 0
        assert vor.volumes[point] == pytest.approx(volume, rel=1e-12, abs=1e-15), point
    assert total >= 8
    assert vor.volumes.sum() == pytest.approx(abs(np.linalg.det(cell)), rel=1e-12)


def test_volumes_and_neighbours_are_those_of_whole_cells():
    for count, weight in ((1, 0), (5, 0.1), (300, 0.01), (4000, 0.001)):
        points, weights = RNG.random((count, 3)) @ SKEW, RNG.random(count) * weight
        vor = brio.Voronoi(points, weights, cell=SKEW)
        offsets, neighbours = vor.neighbor_offsets, vor.neighbor_points
        areas = np.bincount(np.repeat(np.arange(count), np.diff(offsets)), vor.face_areas, count)
        assert vor.face_areas.shape == neighbours.shape and vor.face_normals.shape == (*neighbours.shape, 3)
        assert np.allclose(areas, vor.areas, rtol=1e-12)
        assert np.isnan(vor.centroids[:, 0]).sum() == (vor.volumes == 0).sum()
        pairs = np.stack([np.repeat(np.arange(count), np.diff(offsets)), neighbours], 1)
        assert sorted(map(tuple, pairs.tolist())) == sorted(map(tuple, pairs[:, ::-1].tolist()))
        assert not vor.areas.flags.writeable and not vor.face_areas.flags.writeable


def test_cells_hold_their_vertices_where_points_are_given():
    cell = np.array([[1, 0, 0], [0.2, 1, 0], [0, 0.3, 1]])
    points = RNG.random((8, 3)) @ cell + RNG.integers(-1, 2, (8, 3)) @ cell
    vor = brio.Voronoi(points, cell=cell, vertices=True)
    images = (points[:, None] + np.array(list(itertools.product(range(-4, 5), repeat=3))) @ cell).reshape(-1, 3)
    for i in range(8):
        faces = slice(vor.neighbor_offsets[i], vor.neighbor_offsets[i + 1])
        corners = np.unique(vor.face_vertices[vor.corner_offsets[faces.start] : vor.corner_offsets[faces.stop]])
        for v in vor.vertices[corners]:
            mine = np.linalg.norm(v - points[i])
            assert mine < 2 and np.linalg.norm(images - v, axis=1).min() > mine - 1e-12
        assert np.linalg.norm(vor.centroids[i] - points[i]) < 1


def test_origin_representatives_and_order_do_not_matter():
    cell = np.array([[1, 0, 0], [0.25, 1.5, 0], [0, -0.5, 0.75]])
    points = RNG.random((50, 3)) @ cell
    first = brio.Delaunay(points, cell=cell)
    assert first.check()
    for _ in range(40):
        moved = points + RNG.random(3) * 20 - 10 + RNG.integers(-4, 5, (50, 3)) @ cell
        change = np.eye(3, dtype=int)
        for i, j in [(0, 1), (1, 2), (2, 0)]:
            change[i] += RNG.integers(-3, 4) * change[j]
        assert brio.Delaunay(RNG.permutation(moved), cell=change @ cell).checksum == first.checksum


def test_thin_and_skewed_cells_of_few_points():
    for n in (1, 2, 4):
        for cell in ([[1, 0, 0], [50, 1, 0], [0, 50, 1]], [[50, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 1, 0], [0.5, 0.5, 1e-3]]):
            tri = brio.Delaunay(RNG.random((n, 3)) @ np.array(cell), cell=cell)
            assert tri.check()
            assert tri.nsimplex > 0 and np.allclose(tri.cell, cell)


def test_hidden_points_and_duplicates():
    points = np.array([[0.1, 0.1, 0.1], [0.6, 0.6, 0.6], [0.95, 0.1, 0.1], [1.1, 0.1, 2.1]])
    tri = brio.Delaunay(points, [0.0, 0.0, -1.0, 0.0], cell=[1, 1, 1])
    assert (tri.facts["vertices"], tri.facts["hidden"], tri.facts["duplicates"]) == (2, 1, 1)
    assert tri.representatives.tolist() == [0, 1, 0, 0]
    assert tri.representative_shifts.tolist() == [[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 2]]
    assert brio.Voronoi(points, [0.0, 0.0, -1.0, 0.0], cell=[1, 1, 1]).volumes[2:].tolist() == [0, 0]


def test_slabs_are_clipped_by_a_box():
    points = RNG.random((200, 3))
    vor = brio.Voronoi(points, cell=np.eye(3), periodic="xy", box=[[0, 0, -1], [1, 1, 2]])
    assert vor.volumes.sum() == pytest.approx(3, rel=1e-12)
    assert set(vor.neighbor_points[vor.neighbor_points < 0].tolist()) == {-5, -6}
    assert np.isinf(brio.Voronoi(points, cell=np.eye(3), periodic="xy").volumes).any()


def test_points_of_a_plane_and_a_line_have_cells():
    flat = RNG.random((30, 3)) * [1, 1, 0]
    vor = brio.Voronoi(flat, cell=np.eye(3), periodic="xy", box=[0, 0, -1, 1, 1, 1])
    assert vor.volumes.sum() == pytest.approx(2, rel=1e-12)


def test_places_in_any_cell():
    """Against all translates; positions that are moved by the cell have the same answers, moved."""
    cell = np.array([[1, 0, 0], [0.2, 1, 0], [0, 0.3, 1]])
    points, places = RNG.random((30, 3)) @ cell, RNG.random((40, 3)) * 6 - 3
    tri = brio.Delaunay(points, cell=cell)
    moves = np.array(list(itertools.product(range(-5, 6), repeat=3)))
    images = points[:, None] + moves @ cell
    found, shifts = tri.nearest(places)
    distance = np.linalg.norm(points[found] + shifts @ cell - places, axis=1)
    least = [np.linalg.norm(images - place, axis=2).min() for place in places]
    assert np.allclose(distance, least, rtol=1e-12)
    simplices, shifts = tri.find_simplex(places.reshape(5, 8, 3))
    assert simplices.shape == (5, 8) and shifts.shape == (5, 8, 3)
    corners = tri.image_positions[tri.simplices[simplices]] + (shifts @ cell)[..., None, :]
    corners, x = corners.reshape(-1, 4, 3), places
    inside = np.linalg.solve(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2), (x - corners[:, 0])[..., None])[..., 0]
    assert inside.min() > -1e-9 and inside.sum(axis=1).max() < 1 + 1e-9
    other, there = tri.find_simplex(places + [3, -2, 1] @ cell)
    assert (other == simplices.ravel()).all() and (there - shifts.reshape(-1, 3) == [3, -2, 1]).all()
    slab = brio.Delaunay(points, cell=cell, periodic="xy")
    assert slab.find_simplex([0, 0, 9])[0] == -1


def test_alpha_complex_of_a_torus():
    """Betti numbers of the whole filtration are 1, 3, 3, 1; values are those of many copies."""
    points = RNG.random((200, 3))
    complex = brio.alpha_complex(points, cell=[1, 1, 1])
    counts = [len(part) for part in complex.values]
    assert counts[0] - counts[1] + counts[2] - counts[3] == 0
    simplices = list(complex.filtration())
    assert len(simplices) == sum(counts) and len({s for s, _ in simplices}) == len(simplices)
    seen = set()
    for simplex, value in simplices:
        assert all(face in seen for face in itertools.combinations(simplex, len(simplex) - 1) if face)
        seen.add(simplex)
    gudhi = pytest.importorskip("gudhi")
    tree = gudhi.SimplexTree()
    for simplex, value in simplices:
        tree.insert(list(simplex), value)
    tree.compute_persistence(persistence_dim_max=True)
    assert tree.betti_numbers() == [1, 3, 3, 1]


def test_alpha_needs_simplices_that_differ():
    complex = brio.alpha_complex(RNG.random((4, 3)), cell=[1, 1, 1])
    with pytest.raises(brio.NoAnswerError, match="repeat the cell"):
        list(complex.filtration())


def test_alpha_shapes_that_repeat():
    points = RNG.random((400, 3))
    shape = brio.AlphaShape(points, 0.004, cell=[1, 1, 1])
    inside = shape.complex.values[3] <= 0.004
    corners = shape.complex.image_positions[shape.complex.simplices[3][inside]]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])).sum() / 6
    assert shape.counts["volume"] == pytest.approx(volume, rel=1e-12) and shape.counts["tetrahedra"] == inside.sum()
    properties = shape.properties
    shift = np.stack([properties["shift_" + k] for k in "abc"], axis=1)
    assert np.allclose(points[properties["point"]] + shift, shape.vertices, atol=1e-12)
    full = brio.AlphaShape([[0, 0, 0]], cell=[1, 1, 1])
    assert full.alpha == 0.75 and len(full.faces) == 0 and full.counts["volume"] == pytest.approx(1)
    copy = pickle.loads(pickle.dumps(brio.AlphaShape(points, 0.01)))
    assert len(copy.faces) > 0


def test_arguments():
    with pytest.raises(brio.ArgumentError, match="3 by 3"):
        brio.Delaunay([[0, 0, 0]], cell=[1, 2])
    with pytest.raises(brio.ArgumentError, match="span no volume"):
        brio.Delaunay([[0, 0, 0]], cell=[[1, 0, 0], [2, 0, 0], [0, 0, 1]])
    with pytest.raises(brio.ArgumentError, match="no direction"):
        brio.Delaunay([[0, 0, 0]], cell=np.eye(3), periodic=[False] * 3)
    with pytest.raises(brio.ArgumentError, match="letters"):
        brio.Voronoi([[0, 0, 0]], cell=np.eye(3), periodic="ab")
    with pytest.raises(brio.ArgumentError, match="not both"):
        brio.Voronoi([[0, 0, 0]], [1], radii=[1], cell=np.eye(3))


def test_the_cell_of_a_file(tmp_path):
    """A mesh has the cell of a file of atoms, also as a copy and pickled; other meshes have none."""
    path = tmp_path / "a.extxyz"
    path.write_text('2\nLattice="2 0 0 1 2 0 0 0 3" pbc="T T F"\nC 0 0 0\nO 0.5 1 1.5\n')
    for mesh in (brio.read(path), pickle.loads(pickle.dumps(brio.read(path)))):
        np.testing.assert_array_equal(mesh.cell, [[2, 0, 0], [1, 2, 0], [0, 0, 3]])
        assert mesh.periodic == (True, True, False)
    mesh = brio.read(path)
    cells = brio.Voronoi(mesh.vertices, cell=mesh.cell)
    assert abs(cells.volumes.sum() - 12) < 1e-12
    assert brio.Mesh([[0, 0, 0]]).cell is None and brio.Mesh([[0, 0, 0]]).periodic is None


def test_periodic_objects_are_copied_and_pickled():
    points, cell = np.random.default_rng(8).random((30, 3)), np.array([[1, 0, 0], [0.5, 1, 0], [0, 0, 1]])
    tri = brio.Delaunay(points, 0.001 * np.arange(30), cell=cell, periodic="xy")
    assert cell.flags.writeable, "the caller's"
    again = pickle.loads(pickle.dumps(tri))
    assert again.checksum == tri.checksum and again.periodic == tri.periodic and np.array_equal(again.simplices, tri.simplices)
    complex = brio.alpha_complex(points, cell=[1, 1, 1])
    assert np.array_equal(pickle.loads(pickle.dumps(complex)).values[3], complex.values[3])
    shape = pickle.loads(pickle.dumps(complex.shape(complex.auto_alpha())))
    assert isinstance(shape, brio.PeriodicAlphaShape) and shape.counts["tetrahedra"] > 0
    assert np.array_equal(shape.complex.values[2], complex.values[2])


def test_without_a_cell_nothing_repeats():
    points = np.random.default_rng(9).random((30, 3))
    assert len(brio.AlphaShape(points, cell=None).faces) == len(brio.AlphaShape(points).faces)
    for make in (brio.alpha_complex, brio.AlphaShape):
        with pytest.raises(brio.ArgumentError, match="no cell"):
            make(points, periodic="xy")


def test_a_complex_by_points_has_no_triangulation():
    complex = brio.alpha_complex(np.random.default_rng(10).random((200, 3)), cell=[1, 1, 1])
    named = brio._native.periodic_alpha_by_points(complex._complex)["complex"]
    with pytest.raises(brio.ArgumentError, match="no triangulation"):
        brio._native.alpha_shape(named, complex.points, None, 1.0)
