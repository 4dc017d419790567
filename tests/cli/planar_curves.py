"""Curves in the plane whose truth is known: which samples follow each other, how many curves, corners and ends there are.

The samples keep the density that include/brio/curve.h states for brio_curve. In half of the scenes corners have a sample; in the
others the curve passes between two.
"""

import math
import random

TAU = 2 * math.pi


class Scene:
    """Samples, and the pairs of them that a link joins."""

    def __init__(self):
        self.points, self.links = [], set()
        self.curves = self.closed = self.corners = 0

    def add(self, points, closed, corners):
        first, n = len(self.points), len(points)
        self.points += points
        pairs = [(i, i + 1) for i in range(n - 1)] + ([(0, n - 1)] if closed else [])
        self.links |= {(first + a, first + b) for a, b in pairs}
        self.curves += 1
        self.closed += closed
        self.corners += corners

    @property
    def ends(self):
        return 2 * (self.curves - self.closed)


def gaps(rng, count):
    """`count` lengths whose sum is 1; the ratio of two that follow each other is at most 1.5."""
    lengths, now = [], 1.0
    for _ in range(count):
        lengths.append(now)
        now = min(2.0, max(0.5, now * rng.uniform(1 / 1.22, 1.22)))
    if abs(math.log(lengths[0] / lengths[-1])) > math.log(1.4):  # closed curves: the last one is beside the first
        return gaps(rng, count)
    total = sum(lengths)
    return [length / total for length in lengths]


def along(line, length, total):
    """The point of a fine polyline at a length."""
    rest = min(max(length, 0), total)
    for (ax, ay), (bx, by) in zip(line, line[1:]):
        step = math.hypot(bx - ax, by - ay)
        if rest <= step:
            return (ax + (bx - ax) * rest / step, ay + (by - ay) * rest / step)
        rest -= step
    return line[-1]


def length_of(line):
    return sum(math.hypot(bx - ax, by - ay) for (ax, ay), (bx, by) in zip(line, line[1:]))


def sampled(rng, line, link, at_start=True, at_end=True):
    """Samples along a line, about `link` apart. An end without a sample is about half a link from the next one."""
    total = length_of(line)
    count = max(3, round(total / link))
    steps = gaps(rng, count)
    places, here = [0.0], 0.0
    for step in steps:
        here += step * total
        places.append(here)
    if not at_start:
        places[0] = steps[0] * total * rng.uniform(0.4, 0.6)
        places = places[:1] + places[2:] if count > 4 else places
    if not at_end:
        places[-1] = total - steps[-1] * total * rng.uniform(0.4, 0.6)
        places = places[:-2] + places[-1:] if count > 4 else places
    return [along(line, place, total) for place in places]


def polygon(rng, corners, link, at_corners=True, closed=True):
    """Samples of a polygon or an open polyline with these corners; `at_corners`: with samples on them."""
    points, n = [], len(corners)
    sides = n if closed else n - 1
    for i in range(sides):
        start = at_corners or (not closed and i == 0)
        end = at_corners or (not closed and i == sides - 1)
        side = sampled(rng, [corners[i], corners[(i + 1) % n]], link, start, end)
        last = not closed and i == sides - 1
        points += side if not end or last else side[:-1]
    return points


def smooth(rng, curve, link, closed):
    """Samples of curve(t), t from 0 to 1."""
    line = [curve(i / 2000) for i in range(2001)]
    points = sampled(rng, line, link)
    return points[:-1] if closed else points


def circle(x, y, radius):
    return lambda t: (x + radius * math.cos(TAU * t), y + radius * math.sin(TAU * t))


def regular(n, radius=1.0, turn=0.1, x=0.0, y=0.0):
    return [(x + radius * math.cos(turn + TAU * i / n), y + radius * math.sin(turn + TAU * i / n)) for i in range(n)]


def star(tips, inner, turn=0.2):
    return [((1 if i % 2 == 0 else inner) * math.cos(turn + math.pi * i / tips),
             (1 if i % 2 == 0 else inner) * math.sin(turn + math.pi * i / tips)) for i in range(2 * tips)]


def circles(rng, scene):
    scene.add(smooth(rng, circle(0, 0, 1), TAU / rng.randint(14, 200), True), True, 0)


def ellipses(rng, scene):
    scene.add(smooth(rng, lambda t: (3 * math.cos(TAU * t), math.sin(TAU * t)), rng.uniform(0.04, 0.07), True), True, 0)


def blobs(rng, scene):
    a, b = rng.uniform(0, 0.2), rng.uniform(0, TAU)

    def curve(t):
        r = 1 + a * math.sin(3 * TAU * t + b) + 0.08 * math.cos(5 * TAU * t)
        return (r * math.cos(TAU * t), r * math.sin(TAU * t))
    scene.add(smooth(rng, curve, rng.uniform(0.03, 0.07), True), True, 0)


def polygons(rng, scene):
    n, sharp = rng.randint(3, 8), rng.random() < 0.5
    scene.add(polygon(rng, regular(n), rng.uniform(0.03, 0.12), sharp), True, n)


def stars(rng, scene):
    tips, sharp = rng.randint(4, 7), rng.random() < 0.5
    scene.add(polygon(rng, star(tips, rng.uniform(0.35, 0.45)), rng.uniform(0.03, 0.08), sharp), True, 2 * tips)


def wedges(rng, scene):
    """An open line of two arms; the corner between them is 25 degrees or wider."""
    angle, length = rng.uniform(math.radians(25), math.radians(120)), 2
    tip, a, b = (0, 0), (length, 0), (length * math.cos(angle), length * math.sin(angle))
    scene.add(polygon(rng, [a, tip, b], rng.uniform(0.03, 0.12), rng.random() < 0.5, closed=False), False, 1)


def spirals(rng, scene):
    turns, link = rng.uniform(1.5, 4), rng.uniform(0.1, 0.35)

    def curve(t):
        angle = 3 + TAU * turns * t
        return (angle / TAU * math.cos(angle), angle / TAU * math.sin(angle))
    scene.add(smooth(rng, curve, link / 1.2, False), False, 0)


def arcs(rng, scene):
    for i in range(rng.randint(1, 4)):
        start, sweep = rng.uniform(0, 1), rng.uniform(0.3, 0.75)
        scene.add(smooth(rng, lambda t: circle(3 * i, 0, 1)(start + sweep * t), rng.uniform(0.06, 0.14), False), False, 0)


def nested(rng, scene):
    link = rng.uniform(0.08, 0.2)
    for i in range(rng.randint(2, 5)):
        scene.add(smooth(rng, circle(0.05 * i, 0, 1 + 3.5 * link * i), link, True), True, 0)
    scene.add(polygon(rng, regular(4, 0.6), link / 2), True, 4)


def parallels(rng, scene):
    link = rng.uniform(0.05, 0.15)
    for i in range(rng.randint(2, 5)):
        scene.add(sampled(rng, [(0, 9 * link * i), (3, 9 * link * i)], link), False, 0)


def waves(rng, scene):
    height = rng.uniform(0.2, 0.5)
    scene.add(smooth(rng, lambda t: (8 * t, height * math.sin(2 * TAU * t)), rng.uniform(0.04, 0.12), False), False, 0)


def letters(rng, scene):
    """L, U and Z, beside each other."""
    link = rng.uniform(0.05, 0.12)
    for i, line in enumerate(([(0, 2), (0, 0), (1, 0)], [(0, 2), (0, 0), (1, 0), (1, 2)], [(0, 2), (1.5, 2), (0, 0), (1.5, 0)])):
        corners = [(x + 3 * i, y) for x, y in line]
        scene.add(polygon(rng, corners, link, rng.random() < 0.5, closed=False), False, len(line) - 2)


KINDS = (circles, ellipses, blobs, polygons, stars, wedges, spirals, arcs, nested, parallels, waves, letters)


def scenes(count, seed=1):
    """(name, Scene) of `count` scenes, in turn of all kinds; the samples are in random order."""
    for i in range(count):
        rng = random.Random(1000 * seed + i)
        scene = Scene()
        kind = KINDS[i % len(KINDS)]
        kind(rng, scene)
        order = list(range(len(scene.points)))
        rng.shuffle(order)
        place = {old: new for new, old in enumerate(order)}
        scene.points = [scene.points[old] for old in order]
        scene.links = {tuple(sorted((place[a], place[b]))) for a, b in scene.links}
        yield "%s %d" % (kind.__name__, i), scene
