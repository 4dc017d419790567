"""How thick the walls, gaps and bars of a model are, in spacings of its samples: by a measure, not by the model's name.

Thickness at a point of the surface: the distance to the nearest sheet in front of the point or behind it, along the normal,
that faces the other way (the angle between the normals is over 143 degrees). Behind the point it is that of a wall or a
bar, in front that of a gap or a hole. Found by marching along the normal: the distance to the nearest of many random
points of the surface is a step that passes no sheet, but at the rim of one.

Spacing: the side of a square that has as much of the surface as one sample has. A sample
has the surface that is nearest to it, on its own sheet, and the mean is taken over it and the 12 nearest samples. Noise is
left aside. The thinnest places of a model: one sample in a hundred is thinner.
"""
import numpy as np
from scipy.spatial import cKDTree

import sampling

SURFACE, PLACES = 120000, 6000  # random points that stand for the surface; those whose thickness is measured
OPPOSITE = -0.8                 # most cosine between normals of sheets that face each other; chosen: creases do not count
REACH = 20                      # how far to look, in spacings of 20,000 samples
NEIGHBOURS = 13                 # samples in the mean of the spacing
SHEET = 3                       # spacings between sheets for each unit between normals, to tell sheets apart
SHARE = 0.01                    # of the samples, in the thinnest places


class Thickness:
    """The thickness at random points of a mesh."""

    def __init__(self, points, triangles):
        rng = np.random.default_rng(1)
        self.points, self.normals = sampling.random_points(points, triangles, SURFACE, rng)
        self.area = sampling.areas_and_normals(points, triangles)[0].sum()
        self.tree = cKDTree(self.points)
        self.at = np.minimum(self.march(1), self.march(-1))

    def march(self, way):
        """The distance along the normals (way 1) or against them (-1) to a sheet that faces the other way; inf if there is
        none within reach."""
        grain, reach = np.sqrt(self.area / SURFACE), REACH * np.sqrt(self.area / sampling.MANY)
        place, normal = self.points[:PLACES], way * self.normals[:PLACES]
        found, gone = np.full(PLACES, np.inf), np.full(PLACES, grain)
        left = np.arange(PLACES)
        while len(left):
            distance, nearest = self.tree.query(place[left] + gone[left, None] * normal[left])
            facing = way * np.einsum('ij,ij->i', self.normals[nearest], normal[left]) < OPPOSITE
            hit = facing & (distance < 2 * grain)
            there = self.points[nearest[hit]] - place[left[hit]]
            found[left[hit]] = np.abs(np.einsum('ij,ij->i', there, normal[left[hit]]))
            gone[left] += np.maximum(distance - grain, grain)
            left = left[~hit & (gone[left] < reach)]
        return found

    def spacing(self, tree, scale):
        """Of each sample.   tree  the samples and, times scale, their normals."""
        nearest = tree.query(np.hstack([self.points, scale * self.normals]))[1]
        area = np.bincount(nearest, minlength=tree.n) * self.area / SURFACE
        return np.sqrt(area[tree.query(tree.data, NEIGHBOURS)[1]].mean(1))

    def thinnest(self, samples):
        """The thickness of the thinnest places in spacings of the samples; inf if it is beyond reach."""
        scale = SHEET * np.sqrt(self.area / len(samples.exact))
        tree = cKDTree(np.hstack([samples.exact, scale * samples.normals]))
        places = cKDTree(np.hstack([self.points[:PLACES], scale * self.normals[:PLACES]]))
        thickness = self.at[places.query(tree.data)[1]] / np.maximum(self.spacing(tree, scale), 1e-300)
        return float(np.quantile(thickness, SHARE, method='lower'))
