"""The runs of chapter3.py, and the judge of their surfaces."""
import os
import resource

import baselines
import numpy as np
import planar
import scenes
from chapter3 import OPEN, Shape
from scenes import ply

COMPARED = '20000'  # points on each surface
KEPT = ('closed', 'manifold', 'oriented', 'components', 'genus', 'boundary_edges', 'boundary_loops', 'nonmanifold_edges',
        'self_intersections')


def wide_holes(path, width):
    """The number of holes that are wider."""
    points, triangles = ply.read_mesh(path)
    edges = {(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1])}
    after = {b: a for a, b in edges if (b, a) not in edges}
    count = 0
    while after:
        first, at = after.popitem()
        loop = [first]
        while at in after:
            loop.append(at)
            at = after.pop(at)
        count += (np.ptp(points[loop], axis=0) > width).any()
    return int(count)


class Surfaces:
    """Runs chapter 3 in a folder. Surfaces that pictures need are kept there until the end."""

    def __init__(self, brio, folder):
        self.brio, self.folder = brio, folder
        self.scenes = scenes.Scenes(brio, folder)

    def path_of(self, label, name): return os.path.join(self.folder, f'{label} of {name}.ply'.replace(', ', '-').replace(' ', '_'))

    def path(self, r): return self.path_of(r.label, r.set)

    def _surface(self, r, scene):
        """(the facts of the surface, its path); no path where there is no answer."""
        path = self.path(r)
        if r.method == 'crust':
            made, seconds = baselines.crust(self.brio, scene.samples, self.folder)
            os.replace(made, path)
            facts = self.scenes.facts('check', path)
            return {**facts, 'triangulations': seconds}, path
        if r.method == 'robust':
            chosen = baselines.robust_samples(self.brio, scene.samples, self.folder)
            return self.scenes.facts('surface', chosen, '--method', 'tight-cocone', '-o', path), path
        if r.method == 'shape':
            return self.scenes.facts('medial', scene.samples, '--noise', 'keep', '--labeling', 'greedy', '-o', path), path
        command, *words = r.method
        facts = self.scenes.facts(command, scene.samples, *words, '--threads', '1', '-o', path)
        return facts, None if 'error' in facts else path

    def _distances(self, r, scene, path):
        """How far a surface is from the truth, in spacings."""
        if not scene.truth or r.method == 'shape': return {}
        whole, surface = r.set not in ('foot', 'shell'), path
        if not whole:
            surface = os.path.join(self.folder, 'vertices.ply')
            ply.write_points(surface, ply.read_mesh(path)[0])
        facts = self.scenes.facts('compare', surface, scene.truth, *(['--samples', COMPARED] if whole else []))
        return {'mean': facts['mean'] / scene.spacing, 'farthest': facts['hausdorff'] / scene.spacing}

    def _edges(self, scene, path):
        """The mean distance of the cube's edges from the surface, in spacings."""
        t, places = np.linspace(-1, 1, 401), []
        for axis in range(3):
            for one in (-1, 1):
                for two in (-1, 1):
                    p = np.empty((len(t), 3))
                    p[:, axis], p[:, axis - 1], p[:, axis - 2] = t, one, two
                    places.append(p)
        edges = os.path.join(self.folder, 'edges.ply')
        ply.write_points(edges, np.concatenate(places))
        return self.scenes.facts('compare', edges, path)['mean'] / scene.spacing

    def measure(self, r):
        """A dict of what a run gave, or None where its data are not there."""
        if r.method == 'plane': return planar.measure(self.brio, self.folder, r.set)
        scene = self.scenes.scene(r.set)
        if not scene: return None
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        facts, path = self._surface(r, scene)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        result = {'points': scene.points, 'status': 'done' if path else 'no answer', 'wall': seconds, 'memory': '', 'needed': '',
                  'true_components': scene.components, 'true_genus': scene.genus, 'right': False}
        if not path: return result
        c = facts.get('certificate', {})
        result.update({k: facts[k] for k in ('vertices', 'faces', 'edges', 'triangles', 'tetrahedra', 'triangulations') if k in facts})
        result.update({k: c[k] for k in KEPT if c.get(k) is not None})
        sound = bool(c) and c['closed'] and c['manifold'] and c['oriented']
        result['right'] = bool(sound and (c['components'], c['genus']) == (scene.components, scene.genus))
        result.update(self._distances(r, scene, path))
        if r.set == 'cube': result['edges_off'] = self._edges(scene, path)
        if '--open' in r.method: result['wide_holes'] = wide_holes(path, float(OPEN) * scene.spacing)
        if '--polygons' in r.method: result['samples_kept'] = self._samples_kept(scene, path)
        if r.method == 'crust': self._compare_with_cocone(r, result, path)
        return result

    def _samples_kept(self, scene, path):
        """The number of vertices of a surface that are samples."""
        with open(path, 'rb') as f:
            _, count, properties = ply.read_header(f)[0]
            rows = ply.read_rows(f, count, properties, 0)
        vertices = np.stack([rows[c].astype(float) for c in 'xyz'], 1)
        samples = ply.read_cells(scene.samples, 'face', 3)[0]
        return len(set(map(tuple, vertices)) & set(map(tuple, samples)))

    def _compare_with_cocone(self, r, result, path):
        """The shares of triangles in common with the co-cone's candidates, if these were made."""
        other = self.path(Shape(r.label.replace('crust', 'cocone'), r.set, None))
        if os.path.exists(other): result['in_cocone'], result['in_crust'] = baselines.common(path, other)
