"""Which points are inside a closed triangle mesh.

A vertical ray from each point upwards crosses triangles; a crossing counts by the direction in which the triangle faces.
Points and triangles meet in the columns of a grid. The points are random, so that none is on an edge as seen from above."""
import numpy as np

COLUMNS = 2.0 # cells along a side of the grid, times the root of the number of triangles
BLOCK = 1 << 21 # pairs of a point and a triangle at once


class Inside:
    def __init__(self, points, triangles):
        self.corners = points[triangles]
        self.low = points.min(0)[:2]
        side = max(1, int(COLUMNS * np.sqrt(len(triangles) / 2)))
        self.cells = np.array([side, side])
        self.size = np.maximum((points.max(0)[:2] - self.low) / side, 1e-300)
        self.fill()

    def column(self, xy):
        return np.clip(((xy - self.low) / self.size).astype(np.int64), 0, self.cells - 1)

    def fill(self):
        """Lists the triangles of each column: those whose box, seen from above, meets it."""
        first = self.column(self.corners[:, :, :2].min(1))
        counts = self.column(self.corners[:, :, :2].max(1)) - first + 1
        triangle, rank = expand(counts.prod(1))
        x, y = first[triangle, 0] + rank // counts[triangle, 1], first[triangle, 1] + rank % counts[triangle, 1]
        column = x * self.cells[1] + y
        order = np.argsort(column, kind='stable')
        self.triangle = triangle[order]
        self.start = np.searchsorted(column[order], np.arange(self.cells.prod() + 1))

    def crossings(self, points, point, triangle):
        """Of the ray from each point with a triangle: 1 for one that faces up, -1 for one that faces down, or 0."""
        a, b, c = (self.corners[triangle, i] - points[point] for i in range(3))
        turns = [u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] for u, v in ((b, c), (c, a), (a, b))]
        area = turns[0] + turns[1] + turns[2]
        hit = np.all([np.sign(turn) == np.sign(area) for turn in turns], 0) & (area != 0)
        height = turns[0] * a[:, 2] + turns[1] * b[:, 2] + turns[2] * c[:, 2]
        return np.where(hit & (np.sign(height) == np.sign(area)), np.sign(area), 0)

    def __call__(self, points):
        column = self.column(points[:, :2]) @ np.array([self.cells[1], 1])
        counts = self.start[column + 1] - self.start[column]
        winding = np.zeros(len(points))
        for begin, end in blocks(counts, BLOCK):
            point, rank = expand(counts[begin:end])
            point += begin
            crossing = self.crossings(points, point, self.triangle[self.start[column[point]] + rank])
            winding[begin:end] = np.bincount(point - begin, crossing, end - begin)
        return winding > 0.5


def expand(counts):
    """counts[i] times i, and beside it 0 to counts[i] - 1."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def blocks(counts, most):
    """Ranges of indices whose counts are about `most` in all."""
    ends = np.cumsum(counts)
    begin = 0
    while begin < len(counts):
        end = max(begin + 1, int(np.searchsorted(ends, (ends[begin - 1] if begin else 0) + most)))
        yield begin, min(end, len(counts))
        begin = end
