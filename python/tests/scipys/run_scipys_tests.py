"""run_scipys_tests.py [--write TABLE]: runs the tests of the installed scipy for Delaunay, Voronoi, ConvexHull, halfspaces,
spheres, linear interpolation and griddata with brio's names in place of scipy's. QhullError is NoAnswerError there.

Each test passes, or fails because of something that brio does not offer (NotOfferedError says what), or for a reason of
reasons.tsv. Any other failure is one of brio, and so is a test of reasons.tsv that passes. --write writes the table of all
tests that docs/python keeps.
"""

import argparse
import collections
import pathlib
import sys
import types
import warnings

HERE = pathlib.Path(__file__).parent
MODULES = {"scipy.spatial.tests.test_qhull": "spatial", "scipy.spatial.tests.test_spherical_voronoi": "sphere",
           "scipy.interpolate.tests.test_interpnd": "interpolate", "scipy.interpolate.tests.test_ndgriddata": "griddata"}
# What each module of tests is given in place of scipy's names, besides what `qhull` and `interpnd` have.
NAMES = ["Delaunay", "Voronoi", "ConvexHull", "HalfspaceIntersection", "SphericalVoronoi", "LinearNDInterpolator", "griddata"]
# Classes of scipy that have no counterpart here.
ABSENT = {"Test_Qhull": "Qhull's own interface", "TestNearestNDInterpolator": "no NearestNDInterpolator",
          "TestEstimateGradients2DGlobal": "no CloughTocher2DInterpolator",
          "TestCloughTocher2DInterpolator": "no CloughTocher2DInterpolator"}


class Replaced(types.ModuleType):
    """A module of scipy with other classes."""

    def __init__(self, module, classes):
        super().__init__(module.__name__)
        self._module = module
        self.__dict__.update(classes)

    def __getattr__(self, name):
        return getattr(self._module, name)


def class_of(item):
    return item.cls.__name__ if item.cls else "-"


class Plugin:
    """Replaces the classes in the modules of tests, and keeps the outcomes."""

    def __init__(self):
        self.outcomes = collections.OrderedDict()
        self.patched = set()

    def pytest_collection_modifyitems(self, items):
        import brio

        classes = {name: getattr(brio, name) for name in NAMES}
        classes["QhullError"] = brio.NoAnswerError
        for item in items:
            module = item.module
            if module.__name__ in self.patched:
                continue
            self.patched.add(module.__name__)
            for name in ("qhull", "interpnd"):
                if hasattr(module, name):
                    setattr(module, name, Replaced(getattr(module, name), classes))
            for name in NAMES:
                if hasattr(module, name):
                    setattr(module, name, classes[name])
        items[:] = [item for item in items if class_of(item) not in ABSENT]

    def pytest_runtest_makereport(self, item, call):
        if call.when == "call":
            name = "%s::%s::%s" % (MODULES[item.module.__name__], class_of(item), item.name)
            error = call.excinfo.value if call.excinfo else None
            self.outcomes[name] = error


def run():
    import pytest
    import scipy

    root = pathlib.Path(scipy.__file__).parent
    plugin = Plugin()
    paths = [str(root.joinpath(*name.split(".")[1:])) + ".py" for name in MODULES]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pytest.main(["-q", "-p", "no:cacheprovider", "--tb=no", "--no-header", "-c", str(HERE / "pytest.ini"),
                     "--disable-warnings", *paths], plugins=[plugin])
    return plugin.outcomes, scipy.__version__


def judge(outcomes, reasons):
    """Each test with its outcome in words; and complaints."""
    from brio import NotOfferedError

    rows, wrong = [], []
    for name, error in outcomes.items():
        reason = reasons.get(name)
        if error is None:
            rows.append((name, "pass"))
            if name in reasons:
                wrong.append("%s passes; reasons.tsv says it cannot" % name)
        elif isinstance(error, NotOfferedError):
            rows.append((name, "not offered: " + str(error).partition(";")[0]))
        elif reason:
            rows.append((name, "differs: " + reason))
        else:
            rows.append((name, "FAILS: %s: %s" % (type(error).__name__, str(error).strip().partition("\n")[0])))
            wrong.append("%s fails: %r" % (name, error))
    return rows, wrong


def table(rows, version):
    counts = collections.Counter(outcome.partition(":")[0] for _, outcome in rows)
    lines = ["# scipy's own tests, run with brio's classes", "",
             "Of scipy %s: %s, with" % (version, ", ".join("`%s.py`" % name.replace(".", "/") for name in MODULES)),
             "%s replaced. Written by" % ", ".join("`%s`" % name for name in NAMES),
             "`python/tests/scipys/run_scipys_tests.py --write docs/measured/scipy-tests.md`; `make check` runs the same tests",
             "and holds every outcome against this page.", "",
             "%d tests: %s." % (len(rows), ", ".join("%d %s" % (n, what) for what, n in sorted(counts.items()))), "",
             "Left out, because they test what brio does not have: " +
             "; ".join("`%s` (%s)" % pair for pair in sorted(ABSENT.items())) + ".", "", "| test | outcome |", "|---|---|"]
    lines += ["| `%s` | %s |" % (name.replace("|", "\\|"), outcome.replace("|", "\\|")) for name, outcome in rows]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write")
    options = parser.parse_args()
    lines = (HERE / "reasons.tsv").read_text(encoding="utf-8").splitlines()
    reasons = dict(line.split("\t") for line in lines if line and not line.startswith("#"))
    outcomes, version = run()
    rows, wrong = judge(outcomes, reasons)
    text = table(rows, version)
    if options.write:
        pathlib.Path(options.write).write_text(text, encoding="utf-8")
    kept = HERE.parents[2] / "docs/measured/scipy-tests.md"
    if kept.exists() and not options.write and kept.read_text(encoding="utf-8") != text:
        before = set(kept.read_text(encoding="utf-8").splitlines())
        wrong += ["not in %s: %s" % (kept.name, line) for line in text.splitlines() if line not in before]
    print("\n".join([*wrong, "%d tests, %d complaints" % (len(rows), len(wrong))]))
    return 1 if wrong or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
