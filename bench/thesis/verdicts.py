"""Whether a claim of the thesis holds in what was measured here: (True, False, or None where it was not shown; the words).

Each takes the results of a figure, a dict a run, by label."""
import math
import statistics

SLOWER = 5     # times its early time a point: a run thrashes
FINISHES = 5   # times the time without a limit: a run that takes longer does not count as finished
NOISE = 1.05   # ratios nearer to 1 say nothing
LINEAR = 1.25  # times a point that differ by no more are the same: growth is linear
NEARLY = 2     # and near-linear up to here
FEW_THOUSAND = (2000, 6000)  # points of a block, as the thesis recommends


def is_done(results, *labels): return all(label in results and results[label]['status'] == 'done' for label in labels)


def million(r): return f'{r["points"] / 1e6:.3g} M points'


def mib(n): return f'{n / 2**20:.0f} MiB'


def outcome(label, r):
    if r['status'] == 'done': return f'{label} took {r["wall"]:.1f} s'
    return f'{label} was {r["status"]} after {r["wall"]:.0f} s with {r["reached"]} % of the points inserted'


def missing(results, *labels):
    return None, '; '.join(outcome(k, results[k]) if k in results else f'{k} was left out' for k in labels
                           if not is_done(results, k))


def both(*verdicts):
    known = [v for v, _ in verdicts if v is not None]
    return (all(known) if len(known) == len(verdicts) else None if all(known) else False), '. '.join(w for _, w in verdicts)


def an_insertion(r): return f'{r["created"] / r["vertices"]:.1f} tetrahedra created an insertion'


def slower(results, slow, fast, times):
    """Whether one run took so many times another's time, or was stopped after that."""
    if not is_done(results, fast) or slow not in results: return missing(results, fast, slow)
    a, b = results[slow], results[fast]
    ratio = a['wall'] / b['wall']
    words = f'{outcome(slow, a)}, {outcome(fast, b)}: {ratio:.1f} times' + ('' if a['status'] == 'done' else ' by then')
    if a['status'] == 'done': return ratio >= times, words
    return (True if ratio >= times else None), words


def linear_tetrahedra(results):
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    if not done: return missing(results, *results)
    a_point = [r['tetrahedra'] / r['vertices'] for r in done.values()]
    words = '; '.join(f'{k}: {r["tetrahedra"] / r["vertices"]:.2f} a point, {r["created"] / r["vertices"]:.1f} created and '
                      f'{r["destroyed"] / r["vertices"]:.1f} destroyed an insertion' for k, r in done.items())
    return all(5.5 <= v <= 7.5 for v in a_point), words + '. Infinite ones are created and destroyed too, but not counted in the end'


def location_share(results):
    """Of each stretch of the insertion, and of these the median: a stretch in which the program had to wait says little."""
    words, shares = [], []
    for label, r in results.items():
        if r['status'] != 'done' or len(r['rounds']) < 8: return None, f'{label}: too short to tell'
        steps = list(zip(r['rounds'], r['rounds'][1:]))
        shares.append(statistics.median((b['locate_seconds'] - a['locate_seconds']) / (b['seconds'] - a['seconds'])
                                        for a, b in steps if b['seconds'] > a['seconds']))
        took = 1e6 * (r['rounds'][-1]['seconds'] - r['rounds'][0]['seconds']) / r['points']
        words.append(f'{label} spends {shares[-1]:.0%} of {took:.1f} microseconds an insertion in location')
    words = '; '.join(words)
    if all(0.1 < v < 0.75 for v in shares): return True, words
    return False, words + '. Conflicts are tested several at a time here, which makes the rest of an insertion shorter than ' \
        'it was; a search through nodes that are in no cache has nothing of that'


def near_linear(results, label, most=NEARLY, first=0.25):
    """Whether the last part of the insertion goes on as fast as the part before it, within the factor `most`."""
    r = results.get(label)
    if not r or r['status'] != 'done' or len(r['curve']) < 8: return None, f'{label}: too short to tell'
    begin, end = r['curve'][0], r['curve'][-1]
    cut = min(r['curve'], key=lambda c: abs(c[0] - first * end[0]))
    early, late = (cut[1] - begin[1]) / max(1, cut[0] - begin[0]), (end[1] - cut[1]) / max(1, end[0] - cut[0])
    if early <= 0: return None, f'{label}: too short to tell'
    words = f'{label} takes {1e6 * early:.1f} s a million points up to a quarter of them and {1e6 * late:.1f} s after'
    words += f', {late / early:.2f} times'
    if late < most * early: return True, words
    if not r['memory'] or not r['needed']: return False, words
    return False, words + f'. The memory holds {r["memory"] / r["needed"]:.0%} of what is needed in the end: the early rounds fit'


def history_sizes(results):
    if not is_done(results, 'BRIO', 'octree'): return missing(results, 'BRIO', 'octree')
    nodes = {k: r['history'] / r['vertices'] for k, r in results.items() if r['status'] == 'done'}
    return nodes['BRIO'] < nodes['octree'], '; '.join(f'{k}: {v:.1f} nodes a point' for k, v in nodes.items())


def copies_scale(results):
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    if not done: return missing(results, *results)
    rates = {k: r['wall'] / r['points'] * 1e6 for k, r in done.items()}
    words = '; '.join(f'{million(r)} in {r["wall"]:.1f} s ({rates[k]:.1f} s a million)' for k, r in done.items())
    words += ''.join('; ' + outcome(k, r) for k, r in results.items() if k not in done)
    ratio = max(rates.values()) / min(rates.values())
    words += f': a point takes up to {ratio:.2f} times the least'
    if len(done) < len(results): return False, words
    if ratio <= LINEAR: return True, words
    return False, words + f'. All finish, but the time is not linear: {LINEAR} times is the most that counts as that. The more ' \
        'points there are, the smaller is the part of them that the memory holds'


def onset(r):
    """The number of points at which a run began to take SLOWER times its early time a point, or else was stopped; None if
    neither."""
    c, stopped = r['curve'], r['points'] * r['reached'] / 100 if r['status'] != 'done' else None
    if len(c) < 5: return stopped
    tenth = c[len(c) // 10 + 1]
    base = (tenth[1] - c[0][1]) / max(1, tenth[0] - c[0][0])
    return next((a[0] for a, b in zip(c, c[1:]) if base and b[0] > a[0] and (b[1] - a[1]) / (b[0] - a[0]) > SLOWER * base), stopped)


def thrash_in_turn(results):
    """Whether all runs thrash, each at more points than the one before it."""
    starts, words = [], []
    for label, r in results.items():
        starts.append(onset(r))
        begins = 'no thrashing' if starts[-1] is None else f'thrashing from {starts[-1]:,.0f} points on'
        needs = f'; without a limit it takes {mib(r["needed"])}' if r['needed'] else ''
        words.append(f'{outcome(label, r)}, {begins}{needs}')
    words = '. '.join(words)
    late = [math.inf if s is None else s for s in starts]
    if late == sorted(late) and None not in starts: return True, words
    calm = [k for k, s in zip(results, starts) if s is None]
    if calm: return False, words + f'. Here {" and ".join(calm)} did not slow down by a factor of {SLOWER} before the end'
    return False, words + '. All thrash, but in another turn than that of their sizes: it is not the size of the structure ' \
        'alone that counts, but how many of its pages an insertion meets'


def alike_in_counts(results):
    """What the numbers of tetrahedra say where times differ."""
    created = [r['created'] / r['vertices'] for r in results.values() if r['status'] == 'done']
    words = f'. {min(created):.1f} to {max(created):.1f} tetrahedra are created an insertion: '
    if max(created) < NOISE * min(created):
        return words + 'the work is the same, the times differ by what the caches hold and by what else the machine does'
    return words + 'the work differs'


def order_time(results):
    if not is_done(results, 'octree blocks', 'k-d tree blocks'): return missing(results, 'octree blocks', 'k-d tree blocks')
    a, b = results['octree blocks'], results['k-d tree blocks']
    alike = max(a['insert'], b['insert']) < 1.25 * min(a['insert'], b['insert'])
    words = (f'{million(a)}: order in {a["order"]:.2f} s with an octree, {b["order"]:.2f} s with a k-d tree; insertion '
             f'{a["insert"]:.1f} and {b["insert"]:.1f} s')
    if alike and a['order'] <= 120 * a['points'] / 1e7: return True, words
    return False, words + alike_in_counts(results)


def block_sizes(results):
    times = {k: r['order'] + r['insert'] for k, r in results.items() if r['status'] == 'done'}
    if not times: return missing(results, *results)
    words = '; '.join(f'{k}: {v:.2f} s' for k, v in times.items())
    low, high = FEW_THOUSAND
    few = [v for k, v in times.items() if low <= int(k.split()[0]) <= high]
    if len(few) < 2: return None, words
    words += f'. From {low} to {high} points the times differ by {max(few) / min(few):.2f} times, over all sizes by ' \
        f'{max(times.values()) / min(times.values()):.2f}'
    if max(few) <= LINEAR * min(few): return True, words
    return False, words + alike_in_counts(results)


def without_a_limit(results, fast, slow):
    """The words for the same two orders without a limit, where these were run, and how they compare there."""
    free = [results.get(f'{k}, free') for k in (fast, slow)]
    if not all(r and r['status'] == 'done' for r in free): return '', None
    ratio = free[1]['wall'] / free[0]['wall']
    return f'. Without a limit: {fast} {free[0]["wall"]:.1f} s, {slow} {free[1]["wall"]:.1f} s, {ratio:.2f} times', ratio


def faster(results, fast, slow):
    """Whether one order is the faster one; where it is not, what else was measured of both."""
    if is_done(results, slow) and fast in results and results[fast]['status'] == 'stopped':
        holds, words = slower(results, fast, slow, 1)
        return False if holds else None, words
    if not is_done(results, fast, slow): return missing(results, fast, slow)
    a, b = results[fast], results[slow]
    ratio = b['wall'] / a['wall']
    more, free = without_a_limit(results, fast, slow)
    words = f'{outcome(fast, a)}, {outcome(slow, b)}: {ratio:.2f} times' + more
    if ratio >= NOISE: return True, words
    words += f'. {fast}: {an_insertion(a)}; {slow}: {an_insertion(b)}'
    if ratio > 1 / NOISE: return None, words + '. The times differ by less than two runs of one of them do'
    if not free or free > NOISE: return False, words
    if ratio > NOISE * free:
        return False, words + f'. {fast} is slower whatever the memory; too little of it brings the two nearer to each other'
    return False, words + f'. {fast} is slower whatever the memory'


def wasted_search(results):
    if not is_done(results, 'walk', 'jump'): return slower(results, 'jump', 'walk', NOISE)
    a, b = results['walk'], results['jump']
    samples = round(a['points'] ** 0.25)
    words = (f'{outcome("walk", a)}, {outcome("jump", b)}: {b["wall"] / a["wall"]:.2f} times; {a["walk_steps"] / a["points"]:.1f} '
             f'steps an insertion from the last point, {b["walk_steps"] / b["points"]:.1f} from the closest of up to {samples} samples')
    if b['wall'] >= NOISE * a['wall']: return True, words + ': the search is wasted with a BRIO'
    saved = 1 - b['walk_steps'] / a['walk_steps']
    gain = f'saves {saved:.0%} of the steps' if saved > 0 else 'saves no steps'
    return False, words + f'. The search {gain}, and reads no more than the coordinates of {samples} points, which costs little ' \
        'beside an insertion'


def within(results, limited, free, times):
    if not is_done(results, free) or limited not in results: return missing(results, free, limited)
    a, b = results[limited], results[free]
    if a['status'] != 'done': return False, outcome(limited, a)
    took = [r['order'] + r['insert'] for r in (a, b)]
    return took[0] <= times * took[1], (f'{limited}: order and insertion in {took[0]:.1f} s in {mib(a["memory"])}; without a '
                                        f'limit {took[1]:.1f} s in {mib(b["peak_bytes"])}: {took[0] / took[1]:.2f} times')


def largest(results, order):
    """The largest set of an order that finished, in the sense of FINISHES, or None; and how long each took."""
    free, best, words = results.get(f'{order}, free'), None, []
    for label, r in results.items():
        if not label.startswith(order + ', ') or r is free: continue
        times = (r['wall'] / r['points']) / (free['wall'] / free['points'])
        done = r['status'] == 'done'
        words.append(f'{million(r)} {times:.1f}' + ('' if done else f' ({r["status"]} with {r["reached"]} % of them inserted)'))
        if done and times <= FINISHES and (not best or r['points'] > best['points']): best = r
    return best, ', '.join(words)


def headline(results):
    if not is_done(results, 'BRIO, free', 'random, free'): return missing(results, 'BRIO, free', 'random, free')
    (brio, words), (random, more) = largest(results, 'BRIO'), largest(results, 'random')
    words = f'Times as multiples of the time a point without a limit, BRIO: {words}; random order: {more}'
    if not brio: return False, words
    first = f'In {mib(brio["memory"])} a BRIO finishes {million(brio)} in {brio["wall"]:.0f} s, random order '
    if not random: return True, f'{first}not even the smallest set. {words}'
    factor = brio['points'] / random['points']
    return round(factor) >= 20, f'{first}{million(random)} in {random["wall"]:.0f} s: a factor of {factor:.0f}. {words}'
