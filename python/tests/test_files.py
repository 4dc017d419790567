"""Files of points: what convert makes of many points."""

import numpy as np
import pytest

import brio


def test_convert_to_tiles(tmp_path):
    points = np.random.default_rng(1).random((1000, 3))
    cloud = tmp_path / "a.ply"
    brio.Mesh(points, properties={"number": np.arange(1000, dtype=np.int32)}).write(cloud)
    (tmp_path / "out").mkdir()
    done = brio.convert(cloud, tmp_path / "out" / "#.ply", tiles=4, scratch=tmp_path)
    assert (done.tiles, done.points) == (4, 1000) and 250 <= done.largest_tile < 400
    tiles = [brio.read(tmp_path / "out" / f"{i}.ply") for i in range(4)]
    numbers = np.concatenate([tile.properties["number"] for tile in tiles])
    assert max(len(tile.vertices) for tile in tiles) == done.largest_tile
    assert sorted(numbers) == list(range(1000))
    assert np.array_equal(np.concatenate([tile.vertices for tile in tiles]), points[numbers])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.ply", "out"]
    assert brio.convert(cloud, tmp_path / "b.ply").tiles == 0


@pytest.mark.parametrize("target, options", [
    ("#.ply", {"tiles": 2}), ("a.ply", {"tiles": 2, "scratch": "."}), ("#.ply", {"tiles": 65537, "scratch": "."}),
    ("#.ply", {"tiles": -1, "scratch": "."}), ("#.ply", {"tiles": 2, "scratch": 7}), ("#.ply", {"tiles": 2, "scratch": ".", "merge": True})])
def test_tiles_that_are_refused(tmp_path, target, options):
    brio.Mesh([[0, 0, 0], [1, 0, 0]]).write(tmp_path / "in.ply")
    with pytest.raises(brio.ArgumentError):
        brio.convert(tmp_path / "in.ply", tmp_path / target, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["in.ply"]


def test_points_that_are_not_whole(tmp_path):
    """drop_invalid and salvage, wherever a file is read."""
    points = np.random.default_rng(2).random((50, 3))
    bad, short = tmp_path / "bad.xyz", tmp_path / "short.npy"
    np.savetxt(bad, np.where(np.arange(150).reshape(-1, 3) == 30, np.nan, points))
    np.save(short, points)
    short.write_bytes(short.read_bytes()[:-24 * 7 - 5])
    for path, option, kind, left in ((bad, "drop_invalid", brio.NotFiniteError, np.delete(points, 10, axis=0)),
                                     (short, "salvage", brio.FormatError, points[:42])):
        with pytest.raises(kind):
            brio.read(path)
        with pytest.raises(kind):
            brio.convert(path, tmp_path / "out.ply")
        with brio.TiledDelaunay(scratch=tmp_path) as tri, pytest.raises(kind):
            tri.read(path)
        assert np.array_equal(brio.read(path, **{option: True}).vertices, left)
        assert brio.convert(path, tmp_path / "out.ply", **{option: True}).points == len(left)
        with brio.TiledDelaunay(scratch=tmp_path) as tri:
            tri.read(path, **{option: True})
            tri.run()
            assert tri.checksum == brio.Delaunay(left).checksum
