"""Pages of brio.view: what they hold is tested in tests/cli/test_view.py, what they show in tests/browser."""

import html
import json
import os
import re

import numpy as np
import pytest

import brio

TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_a_page_holds_every_mesh_by_its_name():
    page = brio.view(brio.Mesh(TRIANGLE, [[0, 1, 2]]), np.random.default_rng(1).random((50, 3)), names=["one", "<b>two"],
                     title="both", side_by_side=True)
    assert page.html.count('class="layer"') == 2
    assert '"name":"one"' in page.html and '"name":"\\u003cb\\u003etwo"' in page.html
    assert '"title":"both","beside":1' in page.html


def test_properties_of_numpys_types_are_taken():
    mesh = brio.Mesh(TRIANGLE, [[0, 1, 2]], properties={"count": np.arange(3, dtype=np.int64)})
    assert re.search(r'"name":"count","type":"int32"', brio.view(mesh).html)


def test_a_cell_shows_the_page_and_nothing_of_it_is_taken_for_the_notebooks():
    page = brio.view(TRIANGLE, height=300)
    frame = re.fullmatch(r'<iframe srcdoc="([^"]*)" style="width: 100%; height: 300px; border: 0" title="brio"></iframe>', page._repr_html_())
    assert frame and html.unescape(frame.group(1)) == page.html


def test_a_page_is_saved(tmp_path):
    page = brio.view(TRIANGLE)
    page.save(tmp_path / "p.html")
    assert (tmp_path / "p.html").read_text(encoding="utf-8") == page.html
    assert "save" in repr(page)


def test_a_page_is_opened_from_a_folder_whose_name_no_address_may_have(tmp_path, monkeypatch):
    folder, opened = tmp_path / "a b#c", []
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.setattr("webbrowser.open", opened.append)
    path = brio.view(TRIANGLE).open()
    assert path.startswith(str(folder)) and opened[0].endswith("/" + os.path.basename(path))
    assert "/a%20b%23c/" in opened[0]


def test_wrong_calls():
    with pytest.raises(brio.ArgumentError):
        brio.view()
    with pytest.raises(brio.ArgumentError):
        brio.view(TRIANGLE, names=["a", "b"])
    with pytest.raises(brio.ArgumentError):
        brio.view(*[TRIANGLE] * 13)
    with pytest.raises(brio.ArgumentError):
        brio.view(TRIANGLE, title=3)


def test_a_picture_is_seen_from_where_it_is_asked_for():
    triangle = brio.Mesh(TRIANGLE, [[0, 1, 2]], properties={"heat": [1.0, 2.0, 4.0]})
    seen = brio.picture(triangle, look=(0, 0, 2), size=(100, 100), colour_by="heat")
    assert seen.png.startswith(b"\x89PNG\r\n\x1a\n") and seen.png[16:24] == (100).to_bytes(4, "big") * 2
    assert seen.look == (0, 0, 1) and seen.range == (1, 4) and abs(seen.pixel - 1 / 92) < 1e-12
    assert seen._repr_png_() == seen.png and "save" in repr(seen)
    assert brio.picture(triangle, size=(90, 60)).look[2] > 0.5  # its front


def test_a_picture_is_saved(tmp_path):
    seen = brio.picture(TRIANGLE, dark=True, size=(50, 40), threads=1)
    seen.save(tmp_path / "p.png")
    assert (tmp_path / "p.png").read_bytes() == seen.png != brio.picture(TRIANGLE, size=(50, 40)).png


def test_a_cell_shows_a_mesh_by_a_small_picture_and_its_certificate():
    text = brio.Mesh(TRIANGLE, [[0, 1, 2]])._repr_html_()
    assert "1 boundary loops, manifold, oriented" in text and 'src="data:image/png;base64,iVBOR' in text
    assert "boundary" not in brio.Mesh(TRIANGLE)._repr_html_()
    unseen = brio.Mesh(TRIANGLE + [[0, 0, float("nan")]])._repr_html_()
    assert "4 vertices" in unseen and "img" not in unseen, "no picture shows what is no number; the cell of a notebook still has words"


def test_wrong_calls_of_pictures():
    for wrong in ({"look": (1, 2)}, {"look": (0, 0, 0)}, {"size": (0, 9)}, {"size": (20000, 9)}, {"colour_by": "heat"}, {"colour_by": 5}, {"look": (1, float("nan"), 2)}):
        with pytest.raises(ValueError):
            brio.picture(TRIANGLE, **wrong)


SITES = np.random.default_rng(3).random((60, 3))


def cells_near(voronoi):
    """The cells that are shown of an open set: they end, and are not far beyond the points."""
    low, high = voronoi.points.min(axis=0), voronoi.points.max(axis=0)
    far = (high - low).max() / 4
    out = []
    for site, region in enumerate(voronoi.regions[r] for r in voronoi.point_region):
        corners = voronoi.vertices[region]
        if -1 not in region and (corners >= low - far).all() and (corners <= high + far).all():
            out.append(site)
    return out


def layer(page):
    return json.loads(re.search(r'class="layer">(.*?)</script>', page.html).group(1))


def test_triangulations_hulls_and_cells_are_shown():
    tri, flat, hull = brio.Delaunay(SITES), brio.Delaunay(SITES[:, :2]), brio.ConvexHull(SITES)
    assert layer(brio.view(tri))["tetrahedra"] == len(tri.simplices)
    assert layer(brio.view(flat))["faces"] == len(flat.simplices)
    assert layer(brio.view(brio.DynamicDelaunay(SITES)))["tetrahedra"] == len(tri.simplices)
    periodic = brio.Delaunay(SITES, cell=[1, 1, 1])
    assert layer(brio.view(periodic))["tetrahedra"] == len(periodic.simplices)
    shown = layer(brio.view(hull))
    assert (shown["vertices"], shown["faces"]) == (len(hull.vertices), len(hull.simplices))
    assert shown["certificate"]["closed"] and shown["certificate"]["oriented"]
    assert shown["certificate"]["volume"] == pytest.approx(hull.volume, 1e-12)
    assert layer(brio.view(brio.ConvexHull(SITES[:, :2])))["edges"] == len(brio.ConvexHull(SITES[:, :2]).vertices)


@pytest.mark.parametrize("made, solids, volume", [
    (lambda: brio.Voronoi(SITES, box=[0, 0, 0, 1, 1, 1]), 60, 1), (lambda: brio.Voronoi(SITES, cell=[1, 1, 1]), 60, 1),
    (lambda: brio.Voronoi(SITES), 0, 0)])
def test_cells_are_closed_solids(made, solids, volume):
    voronoi = made()
    shown = layer(brio.view(voronoi))
    c, near = shown["certificate"], solids == 0 and cells_near(voronoi)
    assert (c["closed"], c["manifold"], c["oriented"], c["components"]) == (True, True, True, solids or len(near))
    assert c["volume"] == pytest.approx(volume or voronoi.volumes[near].sum(), 1e-9)
    assert [p["name"] for p in shown["face_properties"]] == ["site", "volume"]
    assert brio.picture(voronoi, size=(60, 40)).png


def test_cells_of_the_plane_are_polygons():
    shown = layer(brio.view(brio.Voronoi(SITES[:, :2], box=[0, 0, 1, 1])))
    assert (shown["faces"], shown["certificate"]["area"]) == (60, pytest.approx(1))
    open_ones = brio.Voronoi(SITES[:, :2])
    assert layer(brio.view(open_ones))["faces"] == len(cells_near(open_ones)) < np.isfinite(open_ones.volumes).sum()


def test_of_many_cells_an_even_choice():
    shown = layer(brio.view(brio.Voronoi(np.random.default_rng(1).random((8100, 3)), box=[0, 0, 0, 1, 1, 1])))
    assert shown["certificate"]["components"] == 8000
