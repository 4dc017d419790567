"""Chapter 3 of the thesis: what it claims of surfaces, and the runs that show it, each judged by what is true of its samples.

A run is a method on a scene (scenes.py). Its result has what the certificate says, whether that is what is true (`right`:
closed, manifold, oriented, with the components and the handles of the scene), and how far the surface is from the truth, in
spacings of the samples: the mean of both ways, and the farthest. Where only a part was sampled, the way from the surface."""
import collections
import surface_verdicts as say

# method: words of a command line, or one of crust, robust and shape, which surfaces.py makes, or plane (planar.py)
Shape = collections.namedtuple('Shape', 'label set method')
CRUST = ('surface', '--method', 'power-crust', '--noise', 'keep')
GREEDY = (*CRUST, '--labeling', 'greedy')
COCONE = ('surface', '--method', 'cocone', '--extraction')
STANDS_IN = ('knot', 'hand', 'part')
SETS = (*STANDS_IN, *(f'shared-{name}' for name in STANDS_IN))
PLANE = ('star', 'bean', 'ring')  # curves of planar.py
OPEN, OPEN_INSIDE = '10', '8'  # spacings: the holes of the foot and of the shell are wider
# name: (kind, seed, number of samples)
SOLIDS = {'hand': ('implicit', 5, 8000), 'part': ('machined', 10, 6000)}
SOLIDS.update({f'solid-{kind}-{seed}': (kind, seed, 10000) for kind in ('implicit', 'machined') for seed in range(2, 14, 2)})
# of the corpus beside the project
OTHERS = ('homer', 'cow', 'horse', 'camel', 'bear', 'fish', 'spot', 'bull', 'mushroom', 'cheese', 'rocker_arm', 'knot2', 'pinion',
          'wingnut', 'three_holes', 'trim_star')


def over(sets, **methods):
    """Runs of each method on each set, labelled 'set, method'."""
    return [Shape(f'{s}, {name}', s, method) for s in sets for name, method in methods.items()]


def figures(Figure):
    labelings = {name: (*CRUST, '--labeling', name) for name in ('greedy', 'naive', 'theoretical', 'global')}
    solids = [n for n in SOLIDS if n.startswith('solid-')] + [f'shared-{n}' for n in OTHERS]
    inwards = ('offset', '--noise', 'keep', '--self-intersections', '--distance')
    return [
        Figure('3.2.2-crust', 'surfaces', 'the co-cone beside the crust of [2, 4]',
               over(('torus', 'hand', 'part', *SETS[3:]), cocone=(*COCONE, 'candidates'), crust='crust'),
               'The result is comparable to that of the crust algorithm, although the algorithm runs faster.', say.like_the_crust),
        Figure('3.2.2-walk', 'surfaces', 'a manifold from candidate triangles', over(
            ('torus', *SETS), walk=(*COCONE, 'walk'), labels=(*COCONE, 'labels')),
               'The theoretical extraction of a manifold does not work robustly in case of real data; a heuristic works quite well.',
               say.walk_fails),
        Figure('3.3', 'surfaces', 'candidate triangles', over(('torus', 'cube', 'shell', *SETS), candidates=(*COCONE, 'candidates')),
               'For sharp corners and boundaries, the output may have gaps and holes.', say.gaps),
        Figure('3.4', 'plane', 'power crusts of curves', [Shape(name, name, 'plane') for name in PLANE],
               'In the plane all Voronoi vertices can be poles; the power crust, and the power shape of its interior solid.', say.planar),
        Figure('3.5', 'surfaces', 'a scan, its power crust, and its power shape', over(
            ('scan', 'shared-hand'), crust=GREEDY, shape='shape'),
               'Holes in the data are filled in an appropriate way; the power shape is homotopy equivalent to the solid.', say.scan_and_shape),
        Figure('3.6', 'surfaces', 'a hole where large balls come out', [
            Shape('closed', 'foot', GREEDY), Shape('open', 'foot', (*GREEDY, '--open', OPEN, '--triangulate'))],
               'The opening was detected because large inner polar balls protrude, and left as a hole.', say.hole_stays),
        Figure('3.3.2', 'surfaces', 'faces and vertices of power crusts', over(
            SETS, crust=(*GREEDY, '--polygons'), cocone=(*COCONE, 'labels')),
               'Power crusts have more faces than comparable triangulated surfaces; not all samples are their vertices, and not all '
               'their vertices are samples.', say.more_faces),
        Figure('3.3.3', 'surfaces', 'labels by the four rules', over(('torus', *SETS), **{k: v for k, v in labelings.items() if k != 'global'}),
               'Where the sampling condition is not met, a naive traversal fails dramatically; the greedy one does not.', say.naive_fails),
        Figure('3.3.3-toggled', 'surfaces', 'labels that are toggled', over(SETS, **{k: labelings[k] for k in ('greedy', 'global')}),
               'An algorithm which toggles labels to find a locally optimal labeling might be better, but was not found necessary.',
               say.toggling_not_needed),
        Figure('3.3.4', 'surfaces', 'power crusts of models', over(solids, greedy=GREEDY),
               'Almost all of the inputs immediately produced perfect surface reconstructions.', say.almost_all),
        Figure('3.9', 'surfaces', 'a hole inside the hull', [
            Shape('closed', 'shell', GREEDY), Shape('open', 'shell', (*GREEDY, '--open', OPEN_INSIDE, '--triangulate', '--keep-largest'))],
               'The area in the interior, where there are no samples, is detected and left as a hole.', say.hole_stays),
        Figure('3.10', 'surfaces', 'edges without samples', [
            Shape('sharp', 'cube', (*GREEDY, '--sharp')), Shape('all poles', 'cube', GREEDY), Shape('cocone', 'cube', (*COCONE, 'labels'))],
               'Sharp corners without samples on the edge are reconstructed, which is not possible with triangles of the samples.', say.sharp),
        Figure('3.11', 'surfaces', 'a mechanical part from few samples', over(
            ('part', 'shared-part'), crust=(*GREEDY, '--sharp'), plain=GREEDY, old='crust'),
               'All the holes of the part are correct; it is beyond the capabilities of the crust.', say.part),
        Figure('3.12', 'surfaces', 'a stamp, of imperfect scans', [
            Shape('greedy', 'stamp', GREEDY), Shape('cocone', 'stamp', (*COCONE, 'labels')), Shape('robust co-cone', 'stamp', 'robust'),
            Shape('default', 'stamp', ('surface',))],
               'Six imperfect scans give a closed model, with the gaps filled where scans fail to overlap.', say.stamp),
        Figure('3.13', 'surfaces', 'an inner offset', [
            Shape('torus', 'torus', (*inwards, '-0.15')), Shape('hand', 'hand', (*inwards, '-0.01')),
            Shape('shared-hand', 'shared-hand', (*inwards, '-0.005'))],
               'The offset surface is always the watertight boundary of a solid, without cracks and self-intersections.', say.offset),
    ]
