"""What the thesis shows in chapters 4 and 5, and the runs that show it here.

The thesis' programs are strategies of point location here: hull the history DAG, CGAL the Delaunay hierarchy, pyramid
jump-and-walk, and pyramid "with the simplified point location" the walk from the last point. Its insertion orders are
`random`, `brio-octree` (its BRIO) and `octree` (pure locality); `brio` is the tuned order of this program.

Memory is given as a share of what the same work takes without a limit: the thesis' machines held about as much of
theirs. The first run of a figure sets the clock for the others, see `--patience`."""
import collections

Run = collections.namedtuple('Run', 'label set order locate share options')
Figure = collections.namedtuple('Figure', 'name kind title runs claim verdict')


def run(label, data, order, locate='walk', share=None, *options):
    return Run(label, data, order, locate, share, list(options))


def seconds(r): return r['order'] + r['insert']


def slower(results, slow, fast, times, what):
    """Whether one run took so many times another's time, or was stopped."""
    a, b = results.get(slow), results.get(fast)
    if not a or not b or b['status'] != 'done': return None, f'{fast} did not finish'
    if a['status'] == 'stopped': return True, f'{slow} was stopped at {a["reached"]} % after {a["wall"]:.0f} s; {fast} took {b["wall"]:.0f} s'
    ratio = a['wall'] / b['wall']
    return ratio >= times, f'{slow} took {a["wall"]:.1f} s, {fast} {b["wall"]:.1f} s: {ratio:.2f} times; {what}'


def linear_tetrahedra(results):
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    per_point = {k: r['tetrahedra'] / r['vertices'] for k, r in done.items()}
    words = '; '.join(f'{k}: {v:.2f} a point, {done[k]["created"] / done[k]["vertices"]:.1f} created and '
                      f'{done[k]["destroyed"] / done[k]["vertices"]:.1f} destroyed an insertion' for k, v in per_point.items())
    return bool(done) and all(5.5 <= v <= 7.5 for v in per_point.values()), words


def location_share(results):
    shares = {k: r['rounds'][-1]['locate_seconds'] / r['rounds'][-1]['seconds'] for k, r in results.items()
              if r['status'] == 'done' and r['rounds']}
    words = '; '.join(f'{k}: {v:.0%}' for k, v in shares.items())
    return bool(shares) and all(0.1 < v < 0.75 for v in shares.values()), 'location of all time: ' + words


def near_linear(results, label, first=0.25):
    """Whether the last part of the insertion goes on as fast as the part before it, within a factor of 2."""
    r = results.get(label)
    if not r or r['status'] != 'done' or len(r['curve']) < 8: return None, f'{label}: too short to tell'
    begin, end = r['curve'][0], r['curve'][-1]
    cut = min(r['curve'], key=lambda c: abs(c[0] - first * end[0]))
    early, late = (cut[1] - begin[1]) / max(1, cut[0] - begin[0]), (end[1] - cut[1]) / max(1, end[0] - cut[0])
    if early <= 0: return None, f'{label}: too short to tell'
    return late < 2 * early, f'{label}: {1e6 * early:.1f} s a million points up to a quarter, {1e6 * late:.1f} after'


def both(*verdicts):
    known = [v for v, _ in verdicts if v is not None]
    return (all(known) if known else None), '; '.join(w for _, w in verdicts)


def history_sizes(results):
    a, b = results.get('BRIO'), results.get('octree')
    if not a or not b or 'done' != a['status'] or a['status'] != b['status']: return None, 'not both finished'
    return a['history'] < b['history'], (f'{a["history"] / a["vertices"]:.1f} nodes a point with BRIO, '
                                         f'{b["history"] / b["vertices"]:.1f} with octree')


def copies_scale(results):
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    rates = {k: r['wall'] / r['vertices'] * 1e6 for k, r in done.items()}
    words = '; '.join(f'{k}: {r["points"] / 1e6:.2f} M points in {r["wall"]:.0f} s ({rates[k]:.1f} a million)' for k, r in done.items())
    missing = [k for k in results if k not in done]
    return len(done) == len(results) and max(rates.values()) < 3 * min(rates.values()), words + ''.join(f'; {k} stopped' for k in missing)


def thrash_onsets(results):
    """The share of its points at which each run began to take five times its early time a point."""
    words, late = [], False
    for label, r in results.items():
        c = r['curve']
        reached = f'finished in {r["wall"]:.0f} s' if r['status'] == 'done' else f'stopped at {r["reached"]} % after {r["wall"]:.0f} s'
        base = (c[len(c) // 10 + 1][1] - c[0][1]) / max(1, c[len(c) // 10 + 1][0] - c[0][0]) if len(c) > 4 else 0
        onset = next((a[0] for a, b in zip(c, c[1:]) if base and b[0] > a[0] and (b[1] - a[1]) / (b[0] - a[0]) > 5 * base), None)
        late |= onset is not None or r['status'] == 'stopped'
        words.append(f'{label}: {reached}' + (f', slows down at {onset:.0f} points' if onset else ''))
    return late, '; '.join(words)


def order_time(results):
    a, b = results.get('octree blocks'), results.get('k-d tree blocks')
    if not a or not b or a['status'] != 'done' or b['status'] != 'done': return None, 'not both finished'
    return a['order'] <= 120 * a['points'] / 1e7, (f'{a["points"] / 1e6:.1f} M points: order {a["order"]:.2f} s with an octree, '
        f'{b["order"]:.2f} s with a k-d tree; the triangulation {a["insert"]:.1f} and {b["insert"]:.1f} s')


def block_sizes(results):
    times = {k: seconds(r) for k, r in results.items() if r['status'] == 'done'}
    words = '; '.join(f'{k}: {v:.2f} s' for k, v in times.items())
    return bool(times) and max(times.values()) < 1.25 * min(times.values()), words


def within(results, limited, free, times):
    a, b = results.get(limited), results.get(free)
    if not a or not b or b['status'] != 'done': return None, f'{free} did not finish'
    if a['status'] != 'done': return False, f'{limited}: {a["status"]} at {a["reached"]} %'
    return a['wall'] <= times * b['wall'], (f'{limited}: {a["wall"]:.1f} s in {a["memory"] / 2**20:.0f} MiB, without a limit '
                                            f'{b["wall"]:.1f} s in {b["peak_bytes"] / 2**20:.0f} MiB: {a["wall"] / b["wall"]:.2f} times')


def headline(results):
    """Largest sets that finish within five times their time without a limit, with BRIO and in random order."""
    best = {}
    for label, r in results.items():
        order, _, where = label.partition(', ')
        free = results.get(f'{order}, free')
        if where == 'free' or not free or r['status'] != 'done' or free['status'] != 'done': continue
        allowed = 5 * free['wall'] / free['points'] * r['points']
        if r['wall'] <= allowed and r['points'] > best.get(order, {'points': 0})['points']: best[order] = r
    if 'BRIO' not in best: return False, 'no set finished with BRIO'
    a, b = best['BRIO'], best.get('random')
    words = f'BRIO: {a["points"]} points in {a["wall"]:.0f} s in {a["memory"] / 2**20:.0f} MiB'
    if not b: return True, words + '; random order: not even the smallest set that was tried'
    return a['points'] >= 10 * b['points'], words + (f'; random order: {b["points"]} points in {b["wall"]:.0f} s: a factor of '
                                                     f'{a["points"] / b["points"]:.0f}')


def figures(uniform, memory, copies):
    """All figures. uniform: points of the uniform set; memory: bytes of the headline; copies: numbers of copies."""
    top, parts = copies[-1], [16, 8, 4, 2]
    four = [c for c in copies if c <= 4][-1]
    return [
        Figure('4.5', 'tetrahedra', 'Delaunay tetrahedra per point inserted', [
            run('happy', 'happy-1', 'random'), run('MTD', 'mtd', 'random'), run('B-1', 'b1', 'random')],
            'Linear-sized: about 27 created and 20 destroyed an insertion, 6 to 7 tetrahedra a point.', linear_tetrahedra),
        Figure('4.6', 'time', 'three programs in random order and little memory', [
            run('pyramid', 'b1', 'random', 'jump', 0.5), run('CGAL hierarchy', 'b1', 'random', 'hierarchy', 0.5),
            run('hull', 'b1', 'random', 'history', 0.15)],
            'Near-linear until memory is exceeded, then thrashing; hull first, then CGAL, pyramid last.', thrash_onsets),
        Figure('4.7', 'location', 'time of point location and all time', [
            run('hull', 'mtd', 'random', 'history'), run('pyramid', 'mtd', 'random', 'jump')],
            'Location is a significant, but not overwhelming, fraction of the time.', location_share),
        Figure('5.1', 'time', 'hull on B1: BRIO and random order', [
            run('BRIO', 'b1', 'brio-octree', 'history', 0.25), run('random', 'b1', 'random', 'history', 0.25)],
            'Random order thrashes before it is done; BRIO is near-linear.',
            lambda r: both(slower(r, 'random', 'BRIO', 3, ''), near_linear(r, 'BRIO'))),
        Figure('5.2', 'time', 'CGAL hierarchy on happy: BRIO and random order', [
            run('BRIO', 'happy-1', 'brio-octree', 'hierarchy', 0.125), run('random', 'happy-1', 'random', 'hierarchy', 0.125)],
            'Random order thrashes at a tenth of the points, BRIO finishes.', lambda r: slower(r, 'random', 'BRIO', 3, '')),
        Figure('5.3', 'time', 'pyramid with jump-and-walk on happy, BRIO', [
            run('walk', 'happy-1', 'brio-octree', 'walk', 0.125), run('jump', 'happy-1', 'brio-octree', 'jump', 0.125)],
            'The i^(1/4) search slows down as the triangulation grows: it is wasted with a BRIO.',
            lambda r: slower(r, 'jump', 'walk', 1.05, 'the search is wasted with a BRIO')),
        Figure('5.4', 'time', 'pyramid with the walk on happy: BRIO and random order', [
            run('BRIO', 'happy-1', 'brio-octree', 'walk', 0.125), run('random', 'happy-1', 'random', 'walk', 0.125)],
            'BRIO is linear, random order does not finish.',
            lambda r: both(slower(r, 'random', 'BRIO', 3, ''), near_linear(r, 'BRIO'))),
        Figure('5.5', 'time', f'the walk on {", ".join(map(str, copies))} copies of happy, little memory', [
            run(f'{c} happy', f'happy-{c}', 'brio-octree', 'walk', memory) for c in copies],
            'Four copies (10.6 M points) finish in 128 MB; time grows linearly.', copies_scale),
        Figure('5.6', 'time', 'the same with four times the memory', [
            run(f'{c} happy', f'happy-{c}', 'brio-octree', 'walk', 4 * memory) for c in copies],
            '10 M points in half an hour on a workstation of 864 MHz and 512 MB.', copies_scale),
        Figure('5.7', 'history', 'size of the history DAG on B1', [
            run('BRIO', 'b1', 'brio-octree', 'history'), run('octree', 'b1', 'octree', 'history'),
            run('random', 'b1', 'random', 'history')],
            'BRIO creates a slightly smaller history DAG than the octree order.', history_sizes),
        Figure('5.8', 'time', 'hull on B1: octree order and BRIO', [
            run('BRIO', 'b1', 'brio-octree', 'history', 0.25), run('octree', 'b1', 'octree', 'history', 0.25)],
            'The octree order is slightly faster once memory is exceeded.',
            lambda r: slower(r, 'BRIO', 'octree', 1, 'the octree order was expected to be faster')),
        Figure('5.9', 'time', 'CGAL hierarchy on happy: BRIO and octree order', [
            run('BRIO', 'happy-1', 'brio-octree', 'hierarchy', 0.125), run('octree', 'happy-1', 'octree', 'hierarchy', 0.125)],
            'BRIO is slightly faster.', lambda r: slower(r, 'octree', 'BRIO', 1, 'BRIO was expected to be faster')),
        Figure('5.10', 'time', 'the walk on happy: octree order and BRIO', [
            run('BRIO', 'happy-1', 'brio-octree', 'walk', 0.125), run('octree', 'happy-1', 'octree', 'walk', 0.125)],
            'The purely local octree order is faster.',
            lambda r: slower(r, 'BRIO', 'octree', 1, 'the octree order was expected to be faster')),
        Figure('5.8-order', 'table', 'computing a BRIO', [
            run('octree blocks', f'happy-{top}', 'brio-octree'), run('k-d tree blocks', f'happy-{top}', 'brio-kdtree')],
            '10 M points in about 2 minutes (1.7 GHz); octree and k-d tree essentially the same.', order_time),
        Figure('5.8-blocks', 'table', 'block sizes', [
            run(f'{size} points', 'happy-1', 'brio-octree', 'walk', None, '--block-size', str(size))
            for size in (250, 500, 1000, 2000, 4000, 8000)],
            'The exact block size does not seem to make much difference.', block_sizes),
        Figure('eighth-uniform', 'time', f'{uniform} uniform points in an eighth of the memory', [
            run('free', f'uniform-{uniform}', 'brio'), run('BRIO', f'uniform-{uniform}', 'brio', 'walk', 0.125),
            run('random', f'uniform-{uniform}', 'random', 'walk', 0.125)],
            'BRIO within 3 times its time without a limit, random order 5 times slower or stopped.',
            lambda r: both(within(r, 'BRIO', 'free', 3), slower(r, 'random', 'BRIO', 5, ''))),
        Figure('eighth-happy', 'time', f'{four} copies of happy in an eighth of the memory', [
            run('free', f'happy-{four}', 'brio'), run('BRIO', f'happy-{four}', 'brio', 'walk', 0.125),
            run('random', f'happy-{four}', 'random', 'walk', 0.125)],
            'BRIO within 3 times its time without a limit, random order 5 times slower or stopped.',
            lambda r: both(within(r, 'BRIO', 'free', 3), slower(r, 'random', 'BRIO', 5, ''))),
        Figure('headline', 'time', f'most points in {memory >> 20} MiB', [
            run('BRIO, free', f'happy-{top}', 'brio'), run(f'BRIO, {top} copies', f'happy-{top}', 'brio', 'walk', memory),
            run('random, free', 'happy-1', 'random')] +
            [run(f'random, 1/{p}', f'part-{p}', 'random', 'walk', memory) for p in parts] +
            [run(f'random, {c}', f'happy-{c}', 'random', 'walk', memory) for c in (1, 2)],
            'In the same memory 10.6 M points with a BRIO, about 0.5 M in random order: a factor of 20.', headline),
    ]
