"""What surfaces have that their points do not show: signed distances, coverage, and the report of a reconstruction."""

import numpy as np
import pytest

import brio

GENERATOR = np.random.default_rng(8)
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


@pytest.fixture(scope="module")
def dome():
    """Samples of half a sphere, evenly spread."""
    k = np.arange(3000) + 0.5
    z, turn = k / 3000, np.pi * (1 + np.sqrt(5)) * k
    return np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], 1)


@pytest.fixture(scope="module")
def closed(dome):
    return brio.reconstruct(dome, open=0)


def areas(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_signed_distances_from_a_cube():
    """Those of a box are known: outside to the nearest point, inside to the nearest side."""
    points = GENERATOR.uniform(-1, 2, (4000, 3))
    beyond = np.abs(points - 0.5) - 0.5
    known = np.where((beyond < 0).all(1), beyond.max(1), np.linalg.norm(np.maximum(beyond, 0), axis=1))
    for faces in (SIDES, SIDES[:, ::-1]):  # a closed surface, whichever way it looks
        assert np.allclose(brio.Mesh(CUBE, faces).signed_distances(points), known, atol=1e-12)


def test_points_behind_an_open_surface_have_negative_distances():
    points = GENERATOR.uniform(-3, 3, (500, 3)) + [0.5, 0.5, 0]
    square = brio.Mesh(CUBE[[0, 4, 6, 2]], [[0, 1, 2, 3]])
    near = np.clip(points, 0, [1, 1, 0])
    assert np.allclose(square.signed_distances(points), np.sign(points[:, 2]) * np.linalg.norm(points - near, axis=1))
    assert square.signed_distances(np.empty((0, 3))).shape == (0,)


def test_coverage_finds_the_lid_of_a_dome(dome, closed):
    whole, c = areas(closed), closed.coverage(dome)
    assert c.bridges == 1 and c.bridge.shape == (len(closed.faces),)
    assert c.bridge_share == pytest.approx(whole[c.bridge].sum() / whole.sum(), abs=1e-12)
    assert c.bridge_share == pytest.approx(np.pi / (3 * np.pi), abs=0.05)  # a lid of pi, a dome of 2 pi
    assert closed.vertices[closed.faces[c.bridge]][:, :, 2].max() < 0.1
    assert np.hypot(*c.bridge_centre[:2]) < 0.2 and c.left_out == 0 and c.far_share > 0.1


def test_coverage_of_what_is_seen(dome):
    c = brio.reconstruct(dome).coverage(dome)
    assert (c.bridges, c.bridge_share, c.bridge_radius, c.left_out) == (0, 0, 0, 0) and not c.bridge.any()


def test_points_that_a_surface_leaves(dome, closed):
    points = np.concatenate([dome, dome[:700] + [0, 0, 2]])
    left = closed.left_out(points)
    assert left.dtype == bool and left[3000:].all() and not left[:3000].any()
    assert closed.coverage(points).left_out == 700


def test_a_report_says_what_faces_and_vertices_say(dome, closed):
    of_bridges = closed.face_properties["bridge"].astype(bool)
    whole, report = areas(closed), closed.report
    assert report["bridges"]["number"] == 1
    assert report["bridges"]["area_share"] == pytest.approx(whole[of_bridges].sum() / whole.sum(), abs=1e-6)
    assert report["uncertain_share"] == pytest.approx((closed.properties["confidence"] < 0.7).mean(), abs=1e-9)
    assert len(closed.face_properties["confidence"]) == len(closed.faces)
    assert (report["orientation"], report["holes"], report["agreement"]) == ("guess", 0, None)
    opened = brio.reconstruct(dome, confidence=0)
    assert opened.report["holes"] == 1 and opened.report["bridges"]["number"] == 0
    assert "confidence" not in opened.properties
    assert brio.reconstruct(dome, "power-crust").report == {}


def test_evidence_that_contradicts_is_left_aside_and_told(dome):
    outwards = dome - [0, 0, 0.2]
    lots = GENERATOR.choice([-1, 1], 3000)[:, None]
    report = brio.reconstruct(dome, normals=lots * dome).report
    assert report["orientation"] == "guess" and report["agreement"] is None and abs(report["normals_agreement"] - 0.5) < 0.05
    above = brio.reconstruct(dome, normals=outwards, origins=[0, 0, 99])
    wrong = brio.reconstruct(dome, normals=-outwards, origins=[0, 0, 99])
    assert above.report["orientation"] == "evidence" and above.report["agreement"] > 0.98
    assert wrong.report["orientation"] == "scanner" and wrong.report["origins_agreement"] > 0.96
    assert wrong.report["normals_agreement"] < 0.02 and (wrong.normals * wrong.vertices).sum(1).mean() > 0.9


@pytest.mark.parametrize("name", ["signed_distances", "coverage", "left_out"])
def test_points_that_are_no_points(name):
    measure = getattr(brio.Mesh(CUBE, SIDES), name)
    with pytest.raises(brio.ArgumentError):
        measure([[1, 2]])
    with pytest.raises(brio.NotFiniteError) as caught:
        measure([[0, 0, 0], [0, np.nan, 0]])
    assert caught.value.indices.tolist() == [1]
