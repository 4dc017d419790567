"""Whether a claim of chapter 3 holds in what was measured: as verdicts.py, whose rules these follow.

A result tells with `right` whether a surface is what it should be. Distances are in spacings of the samples."""

NEARLY = 2           # times as far from the truth, at most: comparable; so are distances under LEAST
LEAST = 0.1
QUITE_WELL = 2 / 3   # share of the sets on which a heuristic is right that works quite well
ALMOST_ALL = 0.9     # share of the inputs
DRAMATIC = 10        # handles too many, or too few
NEAR = 1.0           # mean distance from the truth, in spacings, of a surface that is where it should be
NEAR_EDGE = 0.25     # and of edges
BLUNT = 3            # times as far: the edge is not reconstructed


def told(r, what=''):
    """The words for a result."""
    if r['status'] != 'done': return 'no answer'
    if 'closed' not in r: return what
    sound = r['closed'] and r['manifold'] and r['oriented']
    handles = f'genus {r["genus"]}' if sound else 'not closed' if not r['closed'] else 'not a manifold'
    parts = f', {r["components"]} parts' if sound and r['components'] != r['true_components'] else ''
    return f'{handles}{parts}'


def by_set(results):
    """{set: {method: result}} of labels 'set, method'."""
    sets = {}
    for label, r in results.items():
        name, _, method = label.rpartition(', ')
        sets.setdefault(name, {})[method] = r
    return sets


def truth(runs):
    """What is true of a set."""
    r = next(iter(runs.values()))
    return f'genus {r["true_genus"]}'


def words_of(results):
    return '; '.join(f'{name} ({truth(runs)}): ' + ', '.join(f'{m} {told(r)}' for m, r in runs.items())
                     for name, runs in by_set(results).items())


def complete(results, *methods):
    """The sets of which all methods were run."""
    return {s: runs for s, runs in by_set(results).items() if all(m in runs for m in methods)}


def missing(results, *labels):
    return None, '; '.join(f'{k} was left out' for k in labels if k not in results) or 'Nothing was run'


def like_the_crust(results):
    """Comparable: as near to the truth. Faster: than the two triangulations that the crust needs."""
    sets = complete(results, 'cocone', 'crust')
    sets = {s: r for s, r in sets.items() if all('mean' in x for x in r.values())}
    if not sets: return None, 'Nothing was run'
    words, holds = [], []
    for name, r in sets.items():
        crust, cocone = r['crust'], r['cocone']
        words.append(f'{name}: co-cone {cocone["mean"]:.3f}, crust {crust["mean"]:.3f} spacings from the truth; {crust["in_crust"]:.0%} of '
                     f'the co-cone\'s triangles are in the crust, {crust["in_cocone"]:.0%} the other way round; {cocone["wall"]:.2f} s of the '
                     f'processor for the co-cone with its files, {crust["triangulations"]:.2f} s for the crust\'s two triangulations with theirs')
        holds.append(cocone['mean'] <= max(NEARLY * crust['mean'], LEAST))
    faster = sum(r['cocone']['wall'] for r in sets.values()) < sum(r['crust']['triangulations'] for r in sets.values())
    return all(holds) and faster, '; '.join(words)


def walk_fails(results):
    sets = complete(results, 'walk', 'labels')
    real = {s: r for s, r in sets.items() if s != 'torus'}
    if not real: return None, 'Nothing was run'
    words = words_of(results)
    walked = [s for s, r in real.items() if r['walk']['right']]
    works = sum(r['labels']['right'] for r in real.values())
    words += f'. The walk is right on {len(walked)} of {len(real)} sets, the labels on {works}'
    return not walked and works >= QUITE_WELL * len(real), words


def gaps(results):
    """Gaps are boundary edges. Sets with sharp corners, boundaries, or few samples have them."""
    sets = complete(results, 'candidates')
    rough = {s: r['candidates'] for s, r in sets.items() if s != 'torus'}
    if not rough: return None, 'Nothing was run'
    words = '; '.join(f'{s}: {r["candidates"]["boundary_edges"]} edges of one triangle, in {r["candidates"]["boundary_loops"]} loops'
                      for s, r in sets.items())
    if 'torus' in sets:
        share = sets['torus']['candidates']['boundary_edges'] / sets['torus']['candidates']['faces']
        if share > 0.01: return False, words + '. The torus, which has neither corners nor boundaries, has as many'
    return all(r['boundary_edges'] > 0 for r in rough.values()), words


def euler(r): return r['vertices'] - r['edges'] + r['triangles'] - r['tetrahedra']


def planar(results):
    if not results: return None, 'Nothing was run'
    if any(r['status'] != 'done' for r in results.values()): return False, 'No answer'
    words = '; '.join(f'{k}: {r["common"]} of {r["links"]} links, {r["found"] - r["common"]} others; Euler characteristic of the shape '
                      f'{r["euler"]}, of the inside {r["true_euler"]}' for k, r in results.items())
    return all(r['right'] for r in results.values()), words


def scan_and_shape(results):
    sets = complete(results, 'crust', 'shape')
    if not sets: return None, 'Nothing was run'
    words, holds = [], []
    for name, r in sets.items():
        crust, shape = r['crust'], r['shape']
        if shape['status'] != 'done': return False, f'{name}: no power shape'
        solid = crust['true_components'] - crust['true_genus']
        words.append(f'{name}: the crust is of {told(crust)}, {truth(r)} is true, {crust["mean"]:.2f} spacings from the truth; the shape\'s Euler '
                     f'characteristic is {euler(shape)}, that of the solid {solid}')
        holds.append(crust['right'] and crust['mean'] <= NEAR and euler(shape) == solid)
    return all(holds), '; '.join(words)


def hole_stays(results):
    if not all(k in results and results[k]['status'] == 'done' for k in ('closed', 'open')): return missing(results, 'closed', 'open')
    a, b = results['closed'], results['open']
    small = b['boundary_loops'] - b['wide_holes']
    words = (f'Closed: {told(a)}. With the faces between deeply intersecting large balls left out: wide holes {b["wide_holes"]}, small ones '
             f'beside them {small}; {b["mean"]:.2f} spacings from the truth in the mean')
    return bool(a['right'] and b['wide_holes'] == 1 and b['manifold'] and b['components'] == 1 and b['mean'] <= NEAR), words


def more_faces(results):
    sets = complete(results, 'crust', 'cocone')
    if not sets: return None, 'Nothing was run'
    words, holds = [], []
    for name, r in sets.items():
        crust, cocone = r['crust'], r['cocone']
        if cocone['status'] != 'done' or crust['status'] != 'done': return None, f'{name}: no answer'
        words.append(f'{name}: {crust["faces"]:,} polygons, the co-cone {cocone["faces"]:,} triangles; {crust["samples_kept"]:,} of '
                     f'{crust["points"]:,} samples are vertices, of {crust["vertices"]:,}')
        holds.append(crust['faces'] > cocone['faces'] and crust['samples_kept'] < crust['points'] and crust['samples_kept'] < crust['vertices'])
    return all(holds), '; '.join(words)


def naive_fails(results):
    """On the torus, which is sampled densely, all are right. On the others the naive labels are off by DRAMATIC handles, and the
    greedy ones are right."""
    sets = complete(results, 'greedy', 'naive', 'theoretical')
    rough = {s: r for s, r in sets.items() if s != 'torus'}
    if not rough: return None, 'Nothing was run'
    words = words_of(results)
    dense = all(r['right'] for r in sets.get('torus', {}).values())
    dramatic = [s for s, r in rough.items() if abs(r['naive']['genus'] - r['naive']['true_genus']) >= DRAMATIC]
    greedy = [s for s, r in rough.items() if r['greedy']['right']]
    words += f'. Of {len(rough)} sets naive labels are off by {DRAMATIC} handles or more on {len(dramatic)}, greedy ones right on {len(greedy)}'
    if not dense: return False, words + '. They are not all right on the torus, where the condition is met'
    return len(dramatic) >= QUITE_WELL * len(rough) and len(greedy) == len(rough), words


def toggling_not_needed(results):
    sets = complete(results, 'greedy', 'global')
    if not sets: return None, 'Nothing was run'
    worse = [s for s, r in sets.items() if r['global']['right'] and not r['greedy']['right']]
    words = words_of(results)
    if not worse: return True, words
    return False, words + f'. On {" and ".join(worse)} toggled labels are right where greedy ones are not'


def almost_all(results):
    if not results: return None, 'Nothing was run'
    right = sum(r['right'] for r in results.values())
    wrong = [f'{k.rpartition(", ")[0]} (genus {r["true_genus"]}: {told(r)})' for k, r in results.items() if not r['right']]
    words = f'{right} of {len(results)} models have the right components and handles' + (f'; not {", ".join(wrong)}' if wrong else '')
    return right >= ALMOST_ALL * len(results), words


def sharp(results):
    labels = ('sharp', 'all poles', 'cocone')
    if not all(k in results and results[k]['status'] == 'done' for k in labels): return missing(results, *labels)
    off = {k: results[k]['edges_off'] for k in labels}
    words = 'Mean distance of the edges from the surface, in spacings: ' + ', '.join(f'{k} {v:.2f}' for k, v in off.items())
    words += f'. With poles discarded: {told(results["sharp"])}'
    return bool(results['sharp']['right'] and off['sharp'] <= NEAR_EDGE and off['cocone'] >= BLUNT * off['sharp']), words


def part(results):
    sets = complete(results, 'crust', 'plain', 'old')
    if not sets: return None, 'Nothing was run'
    words = '; '.join(f'{s} ({truth(r)}): with poles discarded {told(r["crust"])}, with all poles {told(r["plain"])}, the crust '
                      f'{told(r["old"])}, {r["old"]["boundary_edges"]} edges of one triangle' for s, r in sets.items())
    power = all(r['crust']['right'] or r['plain']['right'] for r in sets.values())
    return power and not any(r['old']['right'] for r in sets.values()), words


def stamp(results):
    if 'greedy' not in results: return missing(results, 'greedy')
    r = results['greedy']
    words = '; '.join(f'{k}: {told(x)}' + (f', {x["mean"]:.2f} spacings from the truth in the mean, {x["farthest"]:.1f} at most'
                                           if 'mean' in x else '') for k, x in results.items())
    return bool(r['right'] and r['mean'] <= NEAR), words


def offset(results):
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    if not done: return None, 'Nothing was run'
    words = '; '.join(f'{k}: {told(r)}, {r["components"]} parts, {r["boundary_edges"]} edges of one face, {r["self_intersections"]} pairs of '
                      'faces that cross' for k, r in done.items())
    return all(r['closed'] and r['manifold'] and r['oriented'] and not r['self_intersections'] for r in done.values()), words
