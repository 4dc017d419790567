"""What the thesis shows in chapters 3 to 5, and the runs that show it here; those of chapter 3 are in chapter3.py.

The thesis' programs are strategies of point location here: hull the history DAG, searched depth first up to the first
conflict that is alive, CGAL the Delaunay hierarchy, pyramid jump-and-walk, and pyramid "with the simplified point location" the walk from the last point. `CGAL` is that library itself, with its hierarchy and its
own storage. Insertion orders are
`random`, `brio-octree` (its BRIO) and `octree` (pure locality); `brio` is the tuned order of this program.

Memory is given as a share of what the same work takes without a limit: the thesis' machines held about as much of
theirs. See `--patience` for when a run is stopped."""
import collections
import chapter3
from verdicts import (LINEAR, TENTH, block_sizes, both, copies_scale, does_not_finish, faster, finishes, headline, history_sizes,
                      linear_tetrahedra, locality, location_share, model, near_linear, order_time, slower, thrash_in_turn,
                      thrashes, thrashes_after, wasted_search, within)

# share: of the memory without a limit, (share, strategy) of what another strategy takes, bytes, or None for no limit;
# clock: the run whose time a point says when this one is stopped; needs: a run that has to be done before
Run = collections.namedtuple('Run', 'label set order locate share options clock needs')
# whose: who claims it
Figure = collections.namedtuple('Figure', 'name kind title runs claim verdict whose', defaults=['Thesis'])
PROJECT = 'Goal of this project, not of the thesis'
MODEL = 'Model of this project, for a question that the thesis leaves open'
HALF_AN_HOUR = 1800
PAGE = 512  # bytes: COUNTED points then have as many pages as eight times as many have of 4 KiB
COUNTED = 20000  # points whose page touches are counted
KINDS = ('uniform', 'clusters', 'sphere', 'torus', 'scan', 'grid', 'lidar')


def run(label, data, order, locate='walk', share=None, options=(), clock=None, needs=None):
    return Run(label, data, order, locate, share, list(options), clock, needs)


def hull(label, data, order, share=None, clock=None):
    """The program hull, which goes depth first through conflicts of the history, up to the first one that is alive."""
    return run(label, data, order, 'history', share, ['--first-conflict'], clock)


def eighth(name, title, data):
    return Figure(name, 'time', f'{title} in an eighth of the memory', [
        run('free', data, 'brio'), run('BRIO', data, 'brio', 'walk', 0.125), run('random', data, 'random', 'hierarchy', 0.125)],
        'A BRIO takes at most 3 times its time without a limit, random order 5 times a BRIO or is stopped.',
        lambda r: both(within(r, 'BRIO', 'free', 3), slower(r, 'random', 'BRIO', 5)), PROJECT)


def most_points(memory, copies, parts):
    """The headline. Random order has the strategy of location that is best for it."""
    random = [(f'1/{p}', f'part-{p}') for p in parts] + [('1', 'happy-1'), ('2', 'happy-2')]
    ladder = [run(f'random, {name}', data, 'random', 'hierarchy', memory, clock='random, free',
                  needs=f'random, {random[i - 1][0]}' if i else None) for i, (name, data) in enumerate(random)]
    return Figure('headline', 'time', f'most points in {memory >> 20} MiB', [
        run('BRIO, free', f'happy-{copies[0]}', 'brio'), run('random, free', 'happy-1', 'random', 'hierarchy'),
        *[run(f'BRIO, {c} copies', f'happy-{c}', 'brio', 'walk', memory, clock='BRIO, free') for c in copies], *ladder],
        '10.6 M points with a BRIO, about 0.5 M in random order: a factor of 20.', headline)


def pages(kind, points):
    """The orders and programs on one kind of points, with page touches counted instead of memory limited."""
    def counted(label, order, locate, *options):
        return run(label, f'{kind}-{points}', order, locate, options=('--page-size', str(PAGE), '--rounds', *options))
    orders = {'random': 'random', 'BRIO': 'brio-octree', 'octree': 'octree'}
    programs = {'hull': ('history', '--first-conflict'), 'CGAL hierarchy': ('hierarchy',), 'pyramid': ('walk',)}
    runs = [counted(f'{order}, {p}', orders[order], *(('jump',) if (order, p) == ('random', 'pyramid') else how))
            for p, how in programs.items() for order in orders]
    others = [counted(f'{order}, walk', order, 'walk') for order in ('brio', 'brio-kdtree', 'hilbert', 'input')]
    return [Figure(f'pages-{kind}', 'pages', f'page faults, counted, on {kind} points', runs + others,
                   'With each program random order thrashes, a BRIO does not.', locality),
            Figure(f'model-{kind}', 'none', f'a model of thrashing, on {kind} points',
                   [x for x in runs if x.label in ('random, CGAL hierarchy', 'BRIO, pyramid')],
                   'With a quarter of the pages in the cache, or more: in random order an insertion loads its pages anew, but those '
                   'in the cache; in a BRIO a round loads each page once.', model, MODEL)]


def figures(uniform, memory, copies, headline_copies):
    """All figures. uniform: points of the uniform set; memory: bytes of the headline; copies: numbers of copies."""
    four = [c for c in copies if c <= 4][-1]
    return chapter3.figures(Figure) + [
        most_points(memory, headline_copies, [8, 4, 2]),
        eighth('eighth-uniform', f'{uniform / 1e6:g} M uniform points', f'uniform-{uniform}'),
        eighth('eighth-happy', f'{four} copies of happy', f'happy-{four}'),
        Figure('4.5', 'tetrahedra', 'Delaunay tetrahedra per point inserted', [
            run('happy', 'happy-1', 'random', 'jump'), run('dragon', 'dragon', 'random', 'jump'),
            run('MTD', 'mtd', 'random', 'jump'), run('B-1', 'b1', 'random', 'jump'), run('B-2', 'b2', 'random', 'jump')],
            'Linear-sized: about 27 created and 20 destroyed an insertion, 6 to 7 tetrahedra a point.', linear_tetrahedra),
        Figure('4.6', 'time', 'three programs in random order and one memory', [
            hull('hull', 'b1', 'random', (0.6, 'jump')), run('CGAL hierarchy', 'b1', 'random', 'hierarchy', (0.6, 'jump')),
            run('pyramid', 'b1', 'random', 'jump', 0.6)],
            'Near-linear until memory is exceeded, then thrashing; hull first, then CGAL, pyramid last.', thrash_in_turn),
        Figure('4.6-CGAL', 'time', 'CGAL itself in random order', [run('random', 'b1', 'random', 'CGAL', 0.6)],
               'Near-linear until memory is exceeded, then thrashing.', lambda r: thrashes_after(r, 'random')),
        Figure('4.7', 'location', 'time of point location and all time', [
            hull('hull', 'mtd', 'random'), run('pyramid', 'mtd', 'random', 'jump')],
            'Location is a significant, but not overwhelming, fraction of the time.', location_share),
        Figure('5.1', 'time', 'hull on B-1: BRIO and random order', [
            hull('BRIO', 'b1', 'brio-octree', 0.25), hull('random', 'b1', 'random', 0.25)],
            'Random order thrashes before it is done; BRIO is near-linear.',
            lambda r: both(thrashes(r, 'random'), near_linear(r, 'BRIO'))),
        Figure('5.2', 'time', 'CGAL hierarchy on happy: BRIO and random order', [
            run('BRIO', 'happy-1', 'brio-octree', 'hierarchy', 0.125), run('random', 'happy-1', 'random', 'hierarchy', 0.125)],
            'Random order thrashes at a tenth of the points, BRIO finishes.',
            lambda r: both(thrashes(r, 'random', TENTH), finishes(r, 'BRIO'))),
        Figure('5.2-CGAL', 'time', 'CGAL itself on happy: BRIO and random order', [
            run('BRIO', 'happy-1', 'brio-octree', 'CGAL', 0.125), run('random', 'happy-1', 'random', 'CGAL', 0.125)],
            'Random order thrashes at a tenth of the points, BRIO finishes.',
            lambda r: both(thrashes(r, 'random', TENTH), finishes(r, 'BRIO'))),
        Figure('5.3', 'time', 'pyramid with jump-and-walk on happy, BRIO', [
            run('walk', 'happy-1', 'brio-octree', 'walk', 0.125), run('jump', 'happy-1', 'brio-octree', 'jump', 0.125)],
            'The i^(1/4) search slows down as the triangulation grows: it is wasted with a BRIO.', wasted_search),
        Figure('5.4', 'time', 'pyramid with the walk on happy: BRIO and random order', [
            run('BRIO', 'happy-1', 'brio-octree', 'walk', 0.125), run('random', 'happy-1', 'random', 'walk', 0.125)],
            'BRIO is linear, random order does not finish.',
            lambda r: both(does_not_finish(r, 'random', 'BRIO'), near_linear(r, 'BRIO', LINEAR))),
        Figure('5.5', 'time', f'the walk on {", ".join(map(str, copies))} copies of happy in {memory >> 20} MiB', [
            run(f'{c} happy', f'happy-{c}', 'brio-octree', 'walk', memory) for c in copies],
            'Four copies (10.6 M points) finish in 128 MB; time grows linearly.', lambda r: copies_scale(r, 4)),
        Figure('5.6', 'time', f'the same in {memory >> 18} MiB', [
            run(f'{c} happy', f'happy-{c}', 'brio-octree', 'walk', 4 * memory) for c in copies],
            '10 M points in half an hour on a workstation of 864 MHz and 512 MB; time grows linearly.',
            lambda r: copies_scale(r, 4, HALF_AN_HOUR)),
        Figure('5.7', 'history', 'size of the history DAG on B-1', [
            hull('BRIO', 'b1', 'brio-octree'), hull('octree', 'b1', 'octree'), hull('random', 'b1', 'random')],
            'BRIO creates a slightly smaller history DAG than the octree order.', history_sizes),
        Figure('5.8', 'time', 'hull on B-1: octree order and BRIO', [
            hull('BRIO, free', 'b1', 'brio-octree'), hull('octree, free', 'b1', 'octree', clock='BRIO, free'),
            hull('BRIO', 'b1', 'brio-octree', 0.25), hull('octree', 'b1', 'octree', 0.25)],
            'Before memory is exceeded, BRIO is faster; after that, the octree order, slightly.',
            lambda r: faster(r, 'octree', 'BRIO', slightly=True, not_before=True)),
        Figure('5.9', 'time', 'CGAL hierarchy on happy: BRIO and octree order', [
            run('BRIO', 'happy-1', 'brio-octree', 'hierarchy', 0.125), run('octree', 'happy-1', 'octree', 'hierarchy', 0.125)],
            'BRIO is slightly faster.', lambda r: faster(r, 'BRIO', 'octree', slightly=True)),
        Figure('5.9-CGAL', 'time', 'CGAL itself on happy: BRIO and octree order', [
            run('BRIO', 'happy-1', 'brio-octree', 'CGAL', 0.125), run('octree', 'happy-1', 'octree', 'CGAL', 0.125)],
            'BRIO is slightly faster.', lambda r: faster(r, 'BRIO', 'octree', slightly=True)),
        Figure('5.10', 'time', 'the walk on happy: octree order and BRIO', [
            run('BRIO', 'happy-1', 'brio-octree', 'walk', 0.125), run('octree', 'happy-1', 'octree', 'walk', 0.125)],
            'The purely local octree order is faster.', lambda r: faster(r, 'octree', 'BRIO')),
        Figure('5.8-order', 'table', 'computing a BRIO', [
            run('octree blocks', f'happy-{copies[-1]}', 'brio-octree'),
            run('k-d tree blocks', f'happy-{copies[-1]}', 'brio-kdtree')],
            '10 M points in about 2 minutes (1.7 GHz); octree and k-d tree essentially the same.', order_time),
        Figure('5.8-blocks', 'table', 'block sizes', [
            run(f'{size} points', 'happy-1', 'brio-octree', options=('--block-size', str(size)))
            for size in (250, 500, 1000, 2000, 3000, 4000, 6000, 8000)],
            'A few thousand points a block; the exact size does not seem to make much difference.', block_sizes),
        *[f for kind in KINDS for f in pages(kind, COUNTED)],
    ]
