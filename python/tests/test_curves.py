"""Curves through points of a plane, power crusts of them, minimum spanning trees."""

import numpy as np
import pytest

import brio

ANGLE = np.linspace(0, 2 * np.pi, 80, endpoint=False)
RING = np.column_stack([np.cos(ANGLE), np.sin(ANGLE)])
ROUND = {tuple(sorted((i, (i + 1) % 80))) for i in range(80)}


def links(mesh):
    return {tuple(sorted(pair)) for pair in mesh.samples[mesh.edges].tolist()}


@pytest.mark.parametrize("method", ["curves", "power-crust"])
def test_a_ring_in_any_plane(method):
    slanting = RING[:, :1] * [0.48, 0.6, 0.64] + RING[:, 1:] * [0.8, -0.6, 0.0]
    for points in (RING, slanting, brio.Mesh(slanting)):
        assert links(brio.curve(points, method)) == ROUND


def test_options_and_properties():
    arc = RING[:60]
    assert len(brio.curve(arc).edges) == 59
    assert len(brio.curve(arc, closed=True).edges) == len(brio.curve(arc, open=100).edges) == 60
    mesh = brio.Mesh(np.column_stack([arc, np.zeros(60)]), properties={"h": np.arange(60.0)})
    made = brio.curve(mesh)
    assert (made.properties["h"] == np.arange(60)).all() and set(made.properties["curve"].tolist()) == {0}
    with pytest.raises(brio.errors.ArgumentError, match="one of curves"):
        brio.curve(arc, "cocone")
    with pytest.raises(brio.errors.ArgumentError, match="closed"):
        brio.curve(arc, "power-crust", closed=True)


def test_what_is_no_curve():
    grid = np.stack(np.meshgrid(np.arange(15.0), np.arange(15.0)), -1).reshape(-1, 2)
    with pytest.raises(brio.errors.NoAnswerError, match="area"):
        brio.curve(grid)
    with pytest.raises(brio.errors.NoAnswerError, match="not in a plane"):
        brio.curve(np.random.default_rng(1).normal(size=(50, 3)))


def test_trees_have_the_least_length():
    csgraph = pytest.importorskip("scipy.sparse.csgraph")
    distance = pytest.importorskip("scipy.spatial.distance")
    for columns in (2, 3):
        points = np.random.default_rng(columns).random((200, columns))
        tree = brio.spanning_tree(points)
        length = np.linalg.norm(tree.vertices[tree.edges[:, 0]] - tree.vertices[tree.edges[:, 1]], axis=1)
        least = csgraph.minimum_spanning_tree(distance.squareform(distance.pdist(points))).sum()
        assert len(tree.edges) == 199 and (np.diff(length) >= 0).all()
        assert abs(length.sum() - least) < 1e-9
