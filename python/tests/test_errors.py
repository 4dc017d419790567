"""Errors: their classes, sentences, statuses and indices; progress and cancelling."""

import numpy as np
import pytest

import brio
from brio import _calls

GENERATOR = np.random.default_rng(5)


def test_every_status_has_a_class():
    for status, kind in brio.errors._BY_STATUS.items():
        error = brio.errors._make_error(status, "point 7: wrong, points 8 and 9 too")
        assert type(error) is kind and error.status == status and str(error) == error.sentence
        assert error.indices.tolist() == [7, 8] and isinstance(error, brio.Error)
    assert type(brio.errors._make_error(12345, "")) is brio.InternalError


@pytest.mark.parametrize("make", [brio.Delaunay, brio.Voronoi, brio.ConvexHull, brio.reconstruct, brio.AlphaShape])
def test_points_that_are_not_finite_are_named(make):
    points = GENERATOR.random((50, 3))
    points[[3, 17], [0, 2]] = np.nan, np.inf
    with pytest.raises(brio.NotFiniteError, match="point 3") as caught:
        make(points)
    assert caught.value.indices.tolist() == [3, 17] and caught.value.status == 11
    assert isinstance(caught.value, ValueError)


def test_weights_that_are_not_finite_are_named():
    weights = np.zeros(50)
    weights[9] = -np.inf
    with pytest.raises(brio.NotFiniteError) as caught:
        brio.Delaunay(GENERATOR.random((50, 2)), weights)
    assert caught.value.indices.tolist() == [9]


@pytest.mark.parametrize("points", [np.zeros(3), np.zeros((2, 2, 2)), 3.0, "abc", None, [[1, 2], [3]], [["a", "b"]],
                                    np.zeros((3, 2), complex), np.ma.masked_all((3, 2)), object(), {}, [[None, 1]],
                                    np.zeros((3, 2), "datetime64[s]"), np.zeros(3, "f8,f8")])
def test_what_is_no_array_of_points(points):
    for make in (brio.Delaunay, brio.Voronoi, brio.ConvexHull, brio.reconstruct, brio.alpha_complex, brio.Mesh):
        with pytest.raises((brio.ArgumentError, brio.NotFiniteError)):
            make(points)


@pytest.mark.parametrize("weights", [np.zeros(4), np.zeros((5, 1)), 1.0, "abcde", [1, 2, 3, 4, None]])
def test_weights_of_another_shape(weights):
    with pytest.raises((brio.ArgumentError, brio.NotFiniteError), match="weight"):
        brio.Delaunay(GENERATOR.random((5, 3)), weights)


@pytest.mark.parametrize("d", [2, 3])
def test_points_that_were_changed_are_noticed(d):
    points = GENERATOR.random((100, d))
    tri = brio.Delaunay(points)
    points[7] = 5
    for call in (lambda: tri.find_simplex(points), tri.verify):
        with pytest.raises(brio.ArgumentError, match="changed"):
            call()
    points[7] = np.nan
    with pytest.raises(brio.ArgumentError, match="changed"):
        tri.verify()


def test_errors_can_be_pickled():
    import pickle

    error = pickle.loads(pickle.dumps(brio.NotFiniteError("point 3", [3])))
    assert error.sentence == "point 3" and error.indices.tolist() == [3]


def test_progress_is_reported():
    seen = []
    brio.Delaunay(GENERATOR.random((300_000, 3)), threads=1, progress=lambda stage, part: seen.append((stage, part)))
    assert seen and all(isinstance(stage, str) and 0 <= part <= 1 for stage, part in seen)
    assert [part for _, part in seen] == sorted(part for _, part in seen)


def test_progress_can_cancel():
    with pytest.raises(brio.CancelledError) as caught:
        brio.Delaunay(GENERATOR.random((300_000, 3)), progress=lambda stage, part: True)
    assert caught.value.status == 32

    def fails(stage, part):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        brio.Delaunay(GENERATOR.random((300_000, 3)), progress=fails)
    with pytest.raises(TypeError, match="progress"):
        brio.Delaunay(GENERATOR.random((30, 3)), progress=7)


def test_a_bar_without_tqdm(capsys, monkeypatch):
    monkeypatch.setattr(_calls, "_bar", _calls._Line)
    brio.Delaunay(GENERATOR.random((300_000, 3)), threads=1, progress=True)
    assert "%" in capsys.readouterr().err


def test_a_progress_function_may_build_and_drop_others():
    kept = []

    def nested(stage, part):
        kept[:] = [brio.Delaunay(GENERATOR.random((100, 3)))]

    brio.Delaunay(GENERATOR.random((300_000, 3)), progress=nested).verify()
    kept[0].verify()
