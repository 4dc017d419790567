"""Whether a claim of the thesis holds in what was measured here: (True, False, or None where it was not shown; the words).

Each takes the results of a figure, a dict a run, by label, and tests the sentence that stands beside it in figures.py, all of
it: tests/thesis has results for each for which it holds, and results for which it does not."""
import math
import statistics

SLOWER = 5     # times its early time a point: a run thrashes
FINISHES = 5   # times the time without a limit, or another run's time: a run that takes longer does not count as finished
NOISE = 1.05   # ratios nearer to 1 say nothing
LINEAR = 1.25  # times a point that differ by no more are the same: growth is linear
NEARLY = 2     # and near-linear up to here
SLIGHTLY = 1.5  # a run that is faster by no more is slightly faster
ABOUT = 0.15   # a number is "about" another one within this share of it
WASTED = 0.1   # of the steps of a walk: a search that saves less is wasted
LOCATION = (0.1, 0.75)  # share of the time that is significant, but not overwhelming
TENTH = (0.05, 0.2)     # of the points: "a tenth" of them
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


def an_insertion(r):
    if 'created' not in r: return f'{r["tetrahedra"] / r["vertices"]:.1f} tetrahedra a point'
    return f'{r["created"] / r["vertices"]:.1f} tetrahedra created an insertion'


def slower(results, slow, fast, times):
    """Whether one run took so many times another's time, or was stopped after that."""
    if not is_done(results, fast) or slow not in results: return missing(results, fast, slow)
    a, b = results[slow], results[fast]
    ratio = a['wall'] / b['wall']
    words = f'{outcome(slow, a)}, {outcome(fast, b)}: {ratio:.1f} times' + ('' if a['status'] == 'done' else ' by then')
    if a['status'] == 'done': return ratio >= times, words
    return (True if ratio >= times else None), words


def is_about(value, expected): return abs(value - expected) <= ABOUT * expected


def spread(r, first=0.1):
    """How much the tetrahedra a point differ while the insertion goes on, from a tenth of the points on."""
    ratios = [x['tetrahedra'] / x['points'] for x in r['rounds'] if x['points'] >= first * r['points']]
    return max(ratios) / min(ratios) if len(ratios) > 2 else None


def linear_tetrahedra(results):
    if not results or not is_done(results, *results): return missing(results, *results)
    words, holds = [], []
    for k, r in results.items():
        a_point, differ = r['tetrahedra'] / r['vertices'], spread(r)
        created, destroyed = r['created'] / r['vertices'], r['destroyed'] / r['vertices']
        if differ is None: return None, f'{k}: too short to tell'
        words.append(f'{k}: {a_point:.2f} a point, on the way different by {differ:.2f} times, {created:.1f} created and '
                     f'{destroyed:.1f} destroyed an insertion')
        holds.append(6 <= round(a_point, 1) <= 7 and differ <= LINEAR and is_about(created, 27) and is_about(destroyed, 20))
    return all(holds), '; '.join(words) + '. Infinite ones are created and destroyed too, but not counted in the end'


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
    if not shares: return None, 'Nothing was run'
    if all(LOCATION[0] < v < LOCATION[1] for v in shares): return True, words
    if min(shares) <= LOCATION[0]: return False, words
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
    ratio = nodes['octree'] / nodes['BRIO']
    words = '; '.join(f'{k}: {v:.1f} nodes a point' for k, v in nodes.items()) + f'. The octree order has {ratio:.2f} times those of a BRIO'
    return 1 < ratio <= SLIGHTLY, words


def copies_scale(results, copies, seconds=None):
    """Whether so many copies finish, and time grows linearly; 10 M points in so many seconds, if given."""
    done = {k: r for k, r in results.items() if r['status'] == 'done'}
    if not done: return missing(results, *results)
    rates = {k: r['wall'] / r['points'] * 1e6 for k, r in done.items()}
    words = '; '.join(f'{million(r)} in {r["wall"]:.1f} s ({rates[k]:.1f} s a million)' for k, r in done.items())
    words += ''.join('; ' + outcome(k, r) for k, r in results.items() if k not in done)
    ratio = max(rates.values()) / min(rates.values())
    words += f': a point takes up to {ratio:.2f} times the least'
    if any(r['status'] == 'stopped' for r in results.values()): return False, words
    if len(done) < len(results) or max(int(k.split()[0]) for k in done) < copies or len(done) < 2: return None, words
    if seconds and max(rates.values()) * 10 > seconds: return False, words + f': more than {seconds} s for 10 M points'
    if ratio <= LINEAR: return True, words
    return False, words + f'. All finish, but the time is not linear: {LINEAR} times is the most that counts as that. The more ' \
        'points there are, the smaller is the part of them that the memory holds'


def onset(r):
    """(the number of points at which a run began to take SLOWER times its early time a point, or None; whether its growth was
    near-linear up to there, or None where the run is too short to tell)."""
    c = r['curve']
    if len(c) < 5: return None, None
    tenth = c[len(c) // 10 + 1]
    base = (tenth[1] - c[0][1]) / max(1, tenth[0] - c[0][0])
    if base <= 0: return None, None
    steps = [(a, b) for a, b in zip(c, c[1:]) if b[0] > a[0]]
    at = next((a for a, b in steps if (b[1] - a[1]) / (b[0] - a[0]) > SLOWER * base), None)
    end = at or c[-1]
    return at and at[0], (end[1] - c[0][1]) <= NEARLY * base * max(1, end[0] - c[0][0])


def thrashing(label, r):
    """The words, where a run thrashes, and whether it was near-linear before."""
    at, calm = onset(r)
    begins = 'no thrashing' if at is None else f'thrashing from {at:,.0f} points on'
    before = '' if calm is None else ', near-linear before' if calm else ', not near-linear before'
    needs = f'; without a limit it takes {mib(r["needed"])}' if r['needed'] else ''
    return f'{outcome(label, r)}, {begins}{before}{needs}', at, calm


def thrash_in_turn(results):
    """Whether all runs are near-linear, then thrash, each at more points than the one before it."""
    if any(p not in results for p in PROGRAMS): return missing(results, *PROGRAMS)
    told = [thrashing(k, r) for k, r in results.items()]
    words, starts = '. '.join(w for w, _, _ in told), [at for _, at, _ in told]
    calm = [k for k, s in zip(results, starts) if s is None]
    early = [k for k in calm if results[k]['status'] != 'done']
    if early: return None, words + f'. What became of {" and ".join(early)} is not known'
    if calm: return False, words + f'. Here {" and ".join(calm)} did not slow down by a factor of {SLOWER} before the end'
    if any(c is False for _, _, c in told): return False, words
    if starts == sorted(set(starts)): return True, words
    return False, words + '. All thrash, but in another turn than that of their sizes: it is not the size of the structure ' \
        'alone that counts, but how many of its pages an insertion meets'


def thrashes(results, label, share=None):
    """Whether a run thrashes before it is done; at a share of its points between these two, if given."""
    if label not in results: return missing(results, label)
    r = results[label]
    words, at, _ = thrashing(label, r)
    if at is None: return (False if r['status'] == 'done' else None), words
    if share is None: return True, words
    return share[0] <= at / r['points'] <= share[1], words + f': at {at / r["points"]:.0%} of the points'


def thrashes_after(results, label):
    """Whether a run is near-linear, then thrashes."""
    if label not in results: return missing(results, label)
    words, at, calm = thrashing(label, results[label])
    if at is None: return (False if results[label]['status'] == 'done' else None), words
    return calm, words


def finishes(results, label):
    if label not in results: return missing(results, label)
    return results[label]['status'] == 'done', outcome(label, results[label])


def does_not_finish(results, slow, fast):
    """Whether a run was stopped after FINISHES times another's time."""
    if not is_done(results, fast) or slow not in results: return missing(results, fast, slow)
    a, b = results[slow], results[fast]
    words = f'{outcome(slow, a)}, {outcome(fast, b)}: {a["wall"] / b["wall"]:.1f} times'
    if a['status'] == 'done': return False, words
    return (True if a['wall'] >= FINISHES * b['wall'] else None), words + ' by then'


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
    alike = max(a['insert'], b['insert']) <= LINEAR * min(a['insert'], b['insert'])
    words = (f'{million(a)}: order in {a["order"]:.2f} s with an octree, {b["order"]:.2f} s with a k-d tree; insertion '
             f'{a["insert"]:.1f} and {b["insert"]:.1f} s')
    if max(a['order'], b['order']) > 120 * a['points'] / 1e7: return False, words
    if alike: return True, words
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


def faster(results, fast, slow, slightly=False, not_before=False):
    """Whether one order is the faster one: slightly, if so said; and not without a limit, if so said."""
    if is_done(results, slow) and fast in results and results[fast]['status'] == 'stopped':
        holds, words = slower(results, fast, slow, 1)
        return False if holds else None, words
    if not is_done(results, fast, slow): return missing(results, fast, slow)
    a, b = results[fast], results[slow]
    ratio = b['wall'] / a['wall']
    more, free = without_a_limit(results, fast, slow)
    words = f'{outcome(fast, a)}, {outcome(slow, b)}: {ratio:.2f} times' + more
    if not_before and ratio >= NOISE and free is None: return None, words
    if not_before and ratio >= NOISE and free > 1: return False, words + f'. {fast} is faster without a limit, too'
    if ratio >= NOISE: return (not slightly or ratio <= SLIGHTLY), words
    words += f'. {fast}: {an_insertion(a)}; {slow}: {an_insertion(b)}'
    if 'history_tests' in a and a['history_tests'] and 'history_tests' in b:
        words += f'. Tests in the history a point: {fast} {tests(a):.0f}, {slow} {tests(b):.0f}'
    if ratio > 1 / NOISE: return None, words + '. The times differ by less than two runs of one of them do'
    if not free or free > NOISE: return False, words
    if ratio > NOISE * free:
        return False, words + f'. {fast} is slower whatever the memory; too little of it brings the two nearer to each other'
    return False, words + f'. {fast} is slower whatever the memory'


def tests(r): return r['history_tests'] / r['vertices']


def quarters(r):
    """Seconds a point of the first and of the last quarter of an insertion, or None."""
    c = r['curve']
    if r['status'] != 'done' or len(c) < 8: return None
    first, last = (min(c, key=lambda x: abs(x[0] - share * c[-1][0])) for share in (0.25, 0.75))
    early, late = (first[1] - c[0][1]) / max(1, first[0] - c[0][0]), (c[-1][1] - last[1]) / max(1, c[-1][0] - last[0])
    return (early, late) if early > 0 else None


def wasted_search(results):
    """Whether the search makes each insertion slower the more points there are, and saves next to none of the steps."""
    if not is_done(results, 'walk', 'jump'): return missing(results, 'walk', 'jump')
    a, b = results['walk'], results['jump']
    slow, fast = quarters(b), quarters(a)
    if not slow or not fast: return None, 'too short to tell'
    growth, saved = (slow[1] / slow[0]) / (fast[1] / fast[0]), 1 - b['walk_steps'] / a['walk_steps']
    samples = round(a['points'] ** 0.25)
    words = (f'{outcome("walk", a)}, {outcome("jump", b)}: {b["wall"] / a["wall"]:.2f} times; a point of the last quarter takes '
             f'{slow[1] / slow[0]:.2f} times one of the first with the search, {fast[1] / fast[0]:.2f} times without; '
             f'{a["walk_steps"] / a["points"]:.1f} steps an insertion from the last point, {b["walk_steps"] / b["points"]:.1f} '
             f'from the closest of up to {samples} samples')
    slows, wasted = growth >= LINEAR and b['wall'] >= LINEAR * a['wall'], saved <= WASTED
    if slows and wasted: return True, words + ': the search is wasted with a BRIO'
    gain = f'saves {saved:.0%} of the steps' if saved > 0 else 'saves no steps'
    words += f'. The search {gain}'
    if not slows:
        words += f', and does not slow down: it reads no more than the coordinates of {samples} points, which costs little ' \
            'beside an insertion'
    return False, words


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
    if not random: return None, f'{first}not even the smallest set. {words}'
    factor = brio['points'] / random['points']
    return round(factor) >= 20, f'{first}{million(random)} in {random["wall"]:.0f} s: a factor of {factor:.0f}. {words}'


# --- page faults, which are counted

def cache_of(results, share):
    """The pages of the largest cache, a power of two, that is at most so large a share of the pages of all runs."""
    return 2 ** int(math.log2(share * min(r['pages'] for r in results.values())))


def faults(r, cache):
    """Faults of a run in a cache of so many pages."""
    return next((c['page_faults'] for c in r['caches'] if c['cache_pages'] == cache), r['caches'][-1]['page_faults'])


PROGRAMS = ('hull', 'CGAL hierarchy', 'pyramid')


def locality(results):
    """In an eighth of the pages, for each program: random order faults SLOWER times as often as a BRIO, which loads each page
    few times; and whether octree order is better."""
    labels = [f'{order}, {p}' for p in PROGRAMS for order in ('random', 'BRIO', 'octree')]
    if not is_done(results, *labels): return missing(results, *labels)
    words, holds = [], []
    for p in PROGRAMS:
        mine = {order: results[f'{order}, {p}'] for order in ('random', 'BRIO', 'octree')}
        cache = cache_of(mine, 1 / 8)
        each = {order: faults(r, cache) / r['points'] for order, r in mine.items()}
        words.append(f'{p}, {cache} pages: ' + ', '.join(f'{order} {v:.2f}' for order, v in each.items()))
        holds.append(each['random'] >= SLOWER * each['BRIO'])
    return all(holds), 'Faults a point. ' + '; '.join(words)


def thrashing_model(r, cache, rate):
    """Faults of random order: none while all pages fit, then each insertion loads `rate` pages, but those in the cache. Pages
    grow in proportion to points."""
    share = cache / r['pages']
    return 0 if share >= 1 else rate * r['points'] * (1 - share + share * math.log(share))


def sweeps_model(r, cache):
    """Faults of a BRIO: each round that has more pages than the cache loads each of its pages once."""
    pages = [x['pages'] for x in r['rounds']]
    return max([p for p in pages if p <= cache], default=0) + sum(p for p in pages if p > cache)


def model(results):
    """Measured faults as multiples of the models', within NEARLY from a quarter of the pages on. That of random order has one
    constant, which the smallest cache gives."""
    if not is_done(results, 'random, CGAL hierarchy', 'BRIO, pyramid'):
        return missing(results, 'random, CGAL hierarchy', 'BRIO, pyramid')
    random, brio = results['random, CGAL hierarchy'], results['BRIO, pyramid']
    rows, holds = [], []
    least = cache_of(results, 1 / 32)
    rate = faults(random, least) / thrashing_model(random, least, 1)
    for share in (1 / 16, 1 / 8, 1 / 4, 1 / 2):
        cache = cache_of({'random': random, 'BRIO': brio}, share)
        ratios = faults(random, cache) / thrashing_model(random, cache, rate), faults(brio, cache) / sweeps_model(brio, cache)
        rows.append(f'1/{round(1 / share)} of the pages: random {ratios[0]:.2f}, BRIO {ratios[1]:.2f}')
        holds.append(all(1 / NEARLY <= x <= NEARLY for x in ratios))
    words = f'{rate:.0f} pages an insertion in random order. Measured as multiples of the models, in ' + '; '.join(rows)
    fits = [i for i in range(4) if all(holds[i:])]
    if fits: words += f'. Both fit from 1/{16 >> fits[0]} of the pages on'
    return all(holds[2:]), words
