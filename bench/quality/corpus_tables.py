"""The tables of docs/measured/quality.md about closed models of known topology (corpus.py)."""
import collections
import math
import statistics

from corpus import METHODS
from sampling import SAMPLINGS

LIMITS = [1, 1.5, 2, 3, 5, 8, 12, math.inf] # of the thinnest places, in spacings
HOPELESS = 1.5                              # walls under so many spacings: a disk of a wall has no room between its sides


def known(rows, column):
    return [float(row[column]) for row in rows if row[column] != '-']


def mean(values, form):
    return form % statistics.fmean(values) if values else '-'


def right_of(rows):
    return sum(row['right'] == '1' for row in rows)


def share(rows):
    return '%d of %d, %.0f %%' % (right_of(rows), len(rows), 100 * right_of(rows) / len(rows)) if rows else '-'


def summary(rows):
    sound = [row for row in rows if row['sound'] == '1']
    off = [abs(int(row['genus']) - int(row['true_genus'])) for row in sound]
    return [share(rows), mean(off, '%.2f'), mean(known(rows, 'normals'), '%.4f'), mean(known(rows, 'chamfer'), '%.4f'),
            str(len(rows) - len(sound)), mean(known(rows, 'seconds'), '%.1f')]


def table(head, rows):
    return ['| ' + ' | '.join(head) + ' |', '|' + '---|' * len(head), *('| ' + ' | '.join(row) + ' |' for row in rows)]


def by(rows, column, order):
    """The rows for each value of a column, in the given order, those that there are."""
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row[column]].append(row)
    return [(value, groups[value]) for value in order if value in groups]


def sampling_table(rows):
    lines = []
    for way, of_sampling in [*by(rows, 'sampling', SAMPLINGS), ('all', rows)]:
        lines += [[way, method, *summary(of_method)] for method, of_method in by(of_sampling, 'method', METHODS)]
    return table(['samples', 'method', 'right', 'handles off', 'normals', 'chamfer', 'unsound', 'seconds'], lines)


def limit_of(row):
    return next(limit for limit in LIMITS if float(row['thinnest']) < limit or limit == math.inf)


def thickness_table(rows):
    methods = [method for method, _ in by(rows, 'method', METHODS)]
    lines = []
    for below, limit in zip([0, *LIMITS], LIMITS):
        of_bin = [row for row in rows if limit_of(row) == limit]
        if of_bin:
            name = '%g and more' % below if limit == math.inf else '%g to %g' % (below, limit)
            shares = dict(by(of_bin, 'method', METHODS))
            lines.append([name, *(share(shares.get(method, [])) for method in methods)])
    return table(['thinnest places, spacings', *methods], lines)


def hopeless_table(rows):
    """The models of which no sampling, or not all, can be right."""
    thin = [row for row in rows if float(row['thinnest']) < HOPELESS]
    return table(['method', 'under %g spacings' % HOPELESS, 'all others'],
                 [[method, share(of_method), share([r for r in rows if r['method'] == method and r not in of_method])]
                  for method, of_method in by(thin, 'method', METHODS)])


def names(rows):
    samplings = collections.defaultdict(list)
    for row in rows:
        if row['sampling'] not in samplings[row['model']]:
            samplings[row['model']].append(row['sampling'])
    return '; '.join('%s (%s)' % (model, ', '.join(found)) for model, found in samplings.items())


def crossing_table(rows):
    crossing = [row for row in rows if row['crossings'] not in ('-', '0')]
    models = list(dict.fromkeys(row['model'] for row in crossing))
    methods = [method for method, _ in by(rows, 'method', METHODS)]
    return table(['model', 'pairs of faces that cross', *methods],
                 [[model, of_model[0]['crossings'], *(share(dict(by(of_model, 'method', METHODS)).get(m, [])) for m in methods)]
                  for model, of_model in by(crossing, 'model', models)])


def section(title, rows, intro):
    """A section of the page, as text; empty if nothing was measured."""
    if not rows:
        return ''
    thin = [row for row in rows if float(row['thinnest']) < HOPELESS]
    parts = ['## ' + title, intro % len({row['model'] for row in rows}), '\n'.join(sampling_table(rows)), THICKNESS,
             '\n'.join(thickness_table(rows))]
    if thin:
        parts += [IMPOSSIBLE % (HOPELESS, names(thin)), '\n'.join(hopeless_table(rows))]
    if any(row['crossings'] not in ('-', '0') for row in rows):
        parts += [CROSSING, '\n'.join(crossing_table(rows))]
    return '\n\n'.join(parts) + '\n\n'


THICKNESS = '''Right runs against the thickness of the thinnest walls, gaps and bars, in spacings of the samples
(bench/quality/thickness.py: what one sample in a hundred is thinner than).'''

CROSSING = 'Models that cross themselves: no surface without crossings has their shape everywhere.'

IMPOSSIBLE = '''Under %g spacings the samples of both sides of a wall or a gap are about as near as those of one side. Points alone
do not tell how they are joined: these runs count as hopeless, and those that are right as luck. They are: %s.'''
