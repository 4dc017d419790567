"""The verdicts of bench/thesis, and its page.

Each figure's verdict gets results for which the claim beside it holds, results for which it does not, and results that do not
tell. A figure without such results fails here. The page in docs is what its results give, to the letter."""

import copy
import os
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "bench", "thesis"))
import figures
import report
from surface_cases import CASES

FIGURES = {f.name: f for f in figures.figures(2000000, 256 << 20, [1, 2, 4, 10], [10, 20])}


def line(points, seconds, bends=(), steps=50):
    """A curve whose slope is multiplied at shares of the points: ((share, times), ...); it ends after `seconds` if straight."""
    curve, at = [], 0.0
    for i in range(steps + 1):
        curve.append((points * i / steps, at))
        slope = seconds / steps
        for share, times in bends:
            if i >= share * steps: slope *= times
        at += slope
    return curve


def run(points=1000000, seconds=10.0, bends=(), **more):
    curve = line(points, seconds, bends)
    r = {"points": points, "vertices": points, "status": "done", "reached": 100, "wall": curve[-1][1], "order": 0.1,
         "insert": curve[-1][1], "memory": 1 << 27, "needed": 1 << 29, "peak_bytes": 1 << 29, "curve": curve, "caches": [],
         "tetrahedra": 6.5 * points, "created": 26.5 * points, "destroyed": 20 * points, "walk_steps": 5 * points,
         "history": 0, "history_tests": 0,
         "rounds": [{"points": p, "seconds": s, "tetrahedra": 6.5 * p, "locate_seconds": 0.4 * s, "history": 0, "pages": p / 20}
                    for p, s in curve[1:]]}
    r.update(more)
    return r


def stopped(share, points=1000000, seconds=10.0, bends=(), **more):
    """A run that ends early."""
    r = run(points, seconds, bends)
    curve = [c for c in r["curve"] if c[0] <= share * points]
    r.update(status="stopped", reached=round(100 * share), curve=curve, wall=curve[-1][1], rounds=[])
    r.update(more)
    return r


def tetrahedra(a_point=6.5, created=26.5, destroyed=20, grows=0.0):
    """Results of figure 4.5; `grows`: how much the tetrahedra a point do, from nothing to the end."""
    results = {}
    for k in ("happy", "dragon", "MTD", "B-1", "B-2"):
        r = run(tetrahedra=a_point * 1e6, created=created * 1e6, destroyed=destroyed * 1e6)
        for x in r["rounds"]: x["tetrahedra"] = x["points"] * (a_point - grows * (1 - x["points"] / 1e6))
        results[k] = r
    return results


def located(share):
    results = {}
    for k in ("hull", "pyramid"):
        results[k] = run()
        for x in results[k]["rounds"]: x["locate_seconds"] = share * x["seconds"]
    return results


THRASHES = ((0.4, 20),)
PROGRAMS = ("hull", "CGAL hierarchy", "pyramid")


def three(*runs): return dict(zip(PROGRAMS, runs))


def in_turn(*shares): return three(*(run(bends=((s, 20),)) for s in shares))


def copies(*seconds_a_million, status="done"):
    results = {f"{c} happy": run(c * 1000000, c * s) for c, s in zip((1, 2, 4, 10), seconds_a_million)}
    results[f"{(1, 2, 4, 10)[len(seconds_a_million) - 1]} happy"]["status"] = status
    return results


def search(walk=10.0, jump=20.0, bends=((0.5, 3),), steps=4.9):
    return {"walk": run(seconds=walk), "jump": run(seconds=jump, bends=bends, walk_steps=steps * 1e6)}


def histories(brio, octree): return {"BRIO": run(history=brio * 1e6), "octree": run(history=octree * 1e6)}


def pair(brio, octree, free_brio=None, free_octree=None):
    results = {"BRIO": run(seconds=brio), "octree": run(seconds=octree)}
    if free_brio: results.update({"BRIO, free": run(seconds=free_brio), "octree, free": run(seconds=free_octree)})
    return results


def orders(a, b, insert=10.0):
    return {"octree blocks": run(10 ** 7, order=a), "k-d tree blocks": run(10 ** 7, order=b, insert=insert)}


def blocks(**seconds):
    return {f"{size[1:]} points": run(insert=s, order=0) for size, s in seconds.items()}


def ladder(brio, random):
    """The headline: multiples of the time without a limit, by thousands of points."""
    results = {"BRIO, free": run(10 ** 7, 100), "random, free": run(10 ** 6, 10)}
    for order, sizes in (("BRIO", brio), ("random", random)):
        for n, times in sizes.items(): results[f"{order}, {n}"] = run(n * 1000, n / 100 * times)
    return results


def eighth(free, brio, random):
    return {"free": run(seconds=free, order=0), "BRIO": run(seconds=brio, order=0), "random": random}


def counted(pages=6000, **faults):
    """Results of page counts: faults a point of each order in an eighth of the pages."""
    results = {}
    for p in PROGRAMS:
        for order, a_point in faults.items():
            caches = [{"cache_pages": 2 ** k, "page_faults": a_point * 1e6} for k in range(14)]
            results[f"{order}, {p}"] = run(pages=pages, caches=caches)
    return results


def modelled(off_random=1.0, off_brio=1.0):
    """Results that the models give, or so many times that in caches of over a thirtieth of the pages."""
    import verdicts
    pages = 6400
    random, brio = run(pages=pages), run(pages=pages)
    brio["rounds"] = [{"points": 10 ** 6 / 2 ** k, "pages": pages / 2 ** k} for k in range(8, -1, -1)]
    for r, off, guess in ((random, off_random, lambda r, c: verdicts.thrashing_model(r, c, 40)), (brio, off_brio, verdicts.sweeps_model)):
        r["caches"] = [{"cache_pages": 2 ** k, "page_faults": guess(r, 2 ** k) * (off if 2 ** k * 25 > pages else 1)}
                       for k in range(14)]
    return {"random, CGAL hierarchy": random, "BRIO, pyramid": brio}


ALL = {  # the claims that hold, those that do not, and what does not tell
    "headline": ([ladder({11000: 2.6, 22000: 2.7}, {140: 1.3, 550: 1.1, 1100: 5.2})],
                 [ladder({11000: 2.6, 22000: 2.7}, {550: 1.1, 1100: 1.2, 2200: 3}), ladder({11000: 6, 22000: 7}, {550: 1})],
                 [ladder({11000: 2.6}, {140: 9}), {}]),
    "eighth-uniform": ([eighth(4, 11, run(seconds=60)), eighth(4, 11, stopped(0.2, seconds=300))],
                       [eighth(4, 13, run(seconds=90)), eighth(4, 11, run(seconds=50)), eighth(4, 4, run(seconds=4))],
                       [eighth(4, 11, stopped(0.9, seconds=30)), {}]),
    "4.5": ([tetrahedra(), tetrahedra(6.0, 24, 18), tetrahedra(grows=1)],
            [tetrahedra(created=100), tetrahedra(destroyed=9), tetrahedra(a_point=9), tetrahedra(grows=3), tetrahedra(a_point=5.5)],
            [{}, {**tetrahedra(), "B-2": stopped(0.5)}, {"happy": run(rounds=[])}]),
    "4.6": ([in_turn(0.2, 0.5, 0.8)],
            [three(run(), run(), run()), in_turn(0.5, 0.2, 0.8), in_turn(0.5, 0.5, 0.5), three(*list(in_turn(0.2, 0.5, 0.8).values())[:2], run()),
             three(run(bends=((0.11, 3), (0.4, 20))), run(bends=((0.5, 20),)), run(bends=((0.8, 20),)))],
            [three(stopped(0.2), stopped(0.5), stopped(0.8)), {}, {"hull": run(bends=THRASHES)}]),
    "4.6-CGAL": ([{"random": run(bends=THRASHES)}], [{"random": run()}, {"random": run(bends=((0.11, 3), (0.4, 20)))}],
                 [{"random": stopped(0.2)}, {}]),
    "4.7": ([located(0.2), located(0.7)], [located(0.05), located(0.8), located(0.99)], [{}, {"hull": stopped(0.5)}]),
    "5.1": ([{"BRIO": run(), "random": run(bends=THRASHES)}, {"BRIO": run(), "random": stopped(0.7, bends=THRASHES)}],
            [{"BRIO": run(), "random": run()}, {"BRIO": run(bends=((0.5, 9),)), "random": run(bends=THRASHES)}],
            [{"BRIO": run(), "random": stopped(0.7)}, {"BRIO": run()}, {}]),
    "5.2": ([{"BRIO": run(), "random": run(bends=((0.1, 1), (0.16, 30)))}],
            [{"BRIO": run(), "random": run(bends=THRASHES)}, {"BRIO": run(), "random": run()},
             {"BRIO": stopped(0.9), "random": run(bends=((0.16, 30),))}],
            [{"BRIO": run(), "random": stopped(0.1)}, {}]),
    "5.3": ([search()], [search(jump=10.6, bends=()), search(jump=30, bends=()), search(steps=2), search(jump=10, bends=((0.9, 1.3),))],
            [{"walk": run(), "jump": stopped(0.4)}, {}]),
    "5.4": ([{"BRIO": run(), "random": stopped(0.3, seconds=200)}],
            [{"BRIO": run(), "random": run(seconds=900)}, {"BRIO": run(bends=((0.5, 1.6),)), "random": stopped(0.3, seconds=900)}],
            [{"BRIO": run(), "random": stopped(0.3, seconds=30)}, {}]),
    "5.5": ([copies(5, 5, 5.5), copies(5, 5, 5.2, 6)], [copies(5, 5, 9), copies(5, 6, 7, 8), copies(5, 5, 5, status="stopped")],
            [copies(5, 5), copies(5), {}]),
    "5.6": ([copies(5, 5, 5.5), copies(150, 150, 160)], [copies(5, 5, 9), copies(190, 190, 190), copies(5, 5, 5, status="stopped")],
            [copies(5, 5), {}]),
    "5.7": ([histories(27, 31)], [histories(31, 27), histories(27, 27), histories(27, 60)], [{"BRIO": run(history=1)}, {}]),
    "5.8": ([pair(11, 10, 5, 6)], [pair(10, 12, 5, 6), pair(10, 20), pair(30, 10, 5, 6), pair(11, 10, 6, 5)],
            [pair(10, 10.1, 5, 6), pair(11, 10), {}]),
    "5.9": ([pair(10, 11)], [pair(11, 10), pair(10, 30)], [pair(10, 10.1), {"BRIO": run()}, {}]),
    "5.10": ([pair(11, 10), pair(30, 10)], [pair(10, 11)], [pair(10, 10), {"octree": run()}, {}]),
    "5.8-order": ([orders(1, 1.2), orders(110, 119)], [orders(130, 1), orders(1, 130), orders(1, 1, 20)], [{"octree blocks": run()}, {}]),
    "5.8-blocks": ([blocks(_250=4, _2000=2, _4000=2.2)], [blocks(_2000=2, _4000=3), blocks(_2000=2, _3000=2, _6000=4)],
                   [blocks(_250=2, _2000=2), {}]),
    "pages": ([counted(random=40, BRIO=0.5, octree=0.4)],
              [counted(random=40, BRIO=30, octree=0.4), counted(random=1, BRIO=1, octree=1), counted(random=4, BRIO=1, octree=1)],
              [{"random, hull": run()}, {}]),
    "model": ([modelled(), modelled(1.4, 0.7)], [modelled(3), modelled(1, 4), modelled(0.3, 0.2)], [{"BRIO, pyramid": run()}, {}]),
}
ALL["eighth-happy"] = ALL["eighth-uniform"]
ALL.update(CASES)


def cases_of(name): return ALL.get(name) or ALL[name.split("-")[0]]


class Verdicts(unittest.TestCase):
    def check(self, expected, which):
        for name, f in FIGURES.items():
            for i, results in enumerate(cases_of(name)[which]):
                with self.subTest(figure=name, case=i):
                    holds, words = report.verdict_of(f, copy.deepcopy(results))
                    self.assertIs(holds, expected, "%s: %s" % (f.claim, words))
                    self.assertTrue(words)

    def test_claims_that_hold(self):
        self.check(True, 0)

    def test_claims_that_do_not_hold(self):
        self.check(False, 1)

    def test_what_does_not_tell(self):
        self.check(None, 2)

    def test_every_figure_has_cases_of_each_kind(self):
        for name in FIGURES:
            self.assertTrue(all(cases_of(name)), name)

    def test_hull_searches_to_the_first_conflict(self):
        for f in FIGURES.values():
            for r in f.runs if f.kind not in ("surfaces", "plane") else ():
                self.assertNotIn("--all-conflicts", r.options, f.name)
                if "hull" in f.title and r.locate == "history":
                    self.assertTrue("--first-conflict" in r.options or f.kind == "history", f.name)


class Page(unittest.TestCase):
    def test_the_page_is_what_its_results_give(self):
        page = os.path.join(ROOT, "docs", "measured", "thesis-experiments.md")
        facts = report.kept(page[:-len("md")] + "json")
        with tempfile.TemporaryDirectory() as folder:
            again = os.path.join(folder, "page.md")
            report.write(again, facts, "images/thesis/")
            with open(page) as a, open(again) as b:
                self.assertEqual(a.read().splitlines(), b.read().splitlines(),
                                 "docs/measured/thesis-experiments.md was edited, or the generator was: thesis.py --again")

    def test_every_plot_of_the_page_is_there(self):
        docs = os.path.join(ROOT, "docs", "measured")
        with open(os.path.join(docs, "thesis-experiments.md")) as f:
            named = {part.split(")")[0] for part in f.read().split("](")[1:]}
        plots = {name for name in named if name.endswith((".svg", ".png"))}
        folder = os.path.join(docs, "images", "thesis")
        self.assertEqual(plots, {"images/thesis/" + name for name in (os.listdir(folder) if os.path.isdir(folder) else [])})

    def test_figures_of_the_results_are_those_of_the_generator(self):
        facts = report.kept(os.path.join(ROOT, "docs", "measured", "thesis-experiments.json"))
        self.assertEqual(list(facts["figures"]), [f.name for f in report.figures_of(facts)])


if __name__ == "__main__":
    unittest.main()
