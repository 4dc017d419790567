#!/usr/bin/env python3
"""Mistakes in the invariants, and the asserts that catch them.

    mutants.py ROOT COMPILER FLAGS OBJECTS [LIBRARY ...]

Each mistake of MUTANTS is put into a copy of one source file. The unit tests of a checked build (asserts on) are linked with
that copy, and one suite runs. An assert must fail, in the file that the mutant names: a wrong result that a test notices
later, or a crash, is not enough. CMake passes the flags with which the library's objects were compiled, and the list of all
objects of the unit tests, a line each.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# What is wrong, the invariant: the file; what stands there, what comes in its place; the suite; where the assert stands.
MUTANTS = [
    ("a new tetrahedron is entered under the wrong facet", "I3 of tetrahedra.h", "triangulation/cavity.c",
     "table[xyzx & pair] = brio_facet_of(tet, 3);", "table[xyzx & pair] = brio_facet_of(tet, 2);",
     "test_triangulation", "triangulation/cavity.c"),
    ("the first tetrahedron is turned the wrong way", "I1 of tetrahedra.h", "triangulation/start.c",
     "r[own[2]], r[own[3]]) < 0) own[2]", "r[own[2]], r[own[3]]) > 0) own[2]",
     "test_triangulation", "triangulation/start.c"),
    ("an unused slot keeps the state of a cavity", "N4 of inserter.h", "triangulation/cavity.c",
     "state[slot] = TET_UNUSED;", "state[slot] = TET_CAVITY;", "test_triangulation", "triangulation/"),
    ("a duplicate takes the place of its vertex", "I7 of store.h", "triangulation/insert.c",
     "s->representative[p] = v;", "s->representative[v] = p;", "test_triangulation", "triangulation/"),
    ("two records have one name", "I8 of store.h", "triangulation/start.c",
     "s->caller[i] = s->caller[j], s->caller[j] = c;", "s->caller[i] = s->caller[j];",
     "test_triangulation", "triangulation/"),
    ("a thread inserts a point of a segment that it does not hold", "P4 of store.h", "triangulation/parallel.c",
     " || !brio_zone_has(ins->zone, p)", "", "test_parallel", "triangulation/parallel.c"),
    ("slots of a worker are forgotten after its pass", "I6 of store.h", "triangulation/parallel.c",
     "main->num_unused += ins->num_unused;", "", "test_parallel", "triangulation/parallel.c"),
    ("a hand changes a row of a segment that it does not hold", "L7 of live.h", "dynamic/together.c",
     "if (!brio_zone_has(d->zone, d->row_of[own->batch->name[item]])) return BRIO_OK;", "", "test_dynamic_threads",
     "dynamic/"),
    ("a hand digs a hole that has hidden points", "L8 of live.h", "dynamic/place.c",
     "if (d->zone && brio_hole_has_hidden(d)) return brio_give_up(d, BRIO_TRY_ALONE);", "", "test_dynamic_threads",
     "dynamic/store.c"),
    ("a hand hides a vertex", "L8 of live.h", "dynamic/place.c",
     "if (d->zone) return brio_give_up(d, BRIO_TRY_ALONE);", "", "test_dynamic_threads", "dynamic/store.c"),
    ("new triangles are joined to the wrong edge", "I3 of plane_store.h", "plane/plane_insert.c",
     "brio_edge_of(before, 1)", "brio_edge_of(before, 2)", "test_plane", "plane/plane_insert.c"),
    ("the cut of a face has no end", "I1 of polyhedron.h", "cells/polyhedron.c",
     "if (back != NONE) p->after[back] = left;", "", "test_cells", "cells/polyhedron.c"),
    ("zeros stay at the low end of a number", "I2 of dyadic.h", "predicates/dyadic.c",
     "while (r->limb[zeros] == 0) zeros++;", "", "test_dyadic", "predicates/dyadic.c"),
    ("triangles of a hull are joined to the wrong edge", "I2 of polytope.h", "hull/polytope.c",
     "4 * before, outer}", "4 * before + 1, outer}", "test_convex_hull", "hull/polytope.c"),
    ("a block that shrinks is taken off the account as a whole", "I3 of memory.c", "base/memory.c",
     "if (size < old) account_sub(ctx, old - size);", "if (size < old) account_sub(ctx, old);",
     "test_memory", "base/memory.c"),
    ("sorted pairs are looked for in the wrong array", "the order of brio_radix_sort", "base/sort.c",
     "in_spare ^= s->moved;", "in_spare ^= true;", "test_sort", "base/sort.c"),
]

FAILED = re.compile(r"(?:^|\s|/)(src/)?([\w/.]+\.[ch]):(\d+): [^\n]*Assertion `(.*)' failed")


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", **more)


class Builder:
    def __init__(self, arguments):
        self.root, self.compiler = pathlib.Path(arguments[0]).resolve(), arguments[1]
        self.flags = pathlib.Path(arguments[2]).read_text().split()
        self.objects = pathlib.Path(arguments[3]).read_text().split()
        self.libraries = arguments[4:]

    def program(self, folder, name, text):
        """The unit tests with another text of one source file. Returns the program, or what the compiler says."""
        source, made = folder / "src" / name, folder / "mutant.o"
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(text)
        said = run([self.compiler, *self.flags, "-w", "-c", source, "-o", made])
        if said.returncode:
            return None, said.stdout
        kept = [o for o in self.objects if not o.endswith("src/" + name + ".o")]
        if len(kept) + 1 != len(self.objects):
            return None, "there is no object of src/%s" % name
        listed, program = folder / "objects", folder / "unit_tests"
        listed.write_text("\n".join(map(str, [made, *kept])))
        said = run([self.compiler, *[f for f in self.flags if f.startswith("-f")], "@%s" % listed, "-o", program,
                    *self.libraries])
        return (None, said.stdout) if said.returncode else (program, "")


def judge(builder, mutant, folder):
    """Returns whether an assert catches the mistake, and where, or what went wrong."""
    _, _, name, old, new, suite, expected = mutant
    text = (builder.root / "src" / name).read_text()
    if text.count(old) != 1:
        return False, "src/%s has the line %d times: give the mutant another one" % (name, text.count(old))
    program, said = builder.program(folder, name, text.replace(old, new))
    if not program:
        return False, said
    # reports of the sanitizers take longer than the suite
    environment = dict(os.environ, ASAN_OPTIONS="handle_abort=0:detect_leaks=0:symbolize=0")
    try:
        done = run([program, suite], env=environment, timeout=300)
    except subprocess.TimeoutExpired:
        return False, "the suite runs for ever"
    found = FAILED.search(done.stdout)
    if not found:
        return False, "no assert fails; the suite ends with %d: %s" % (done.returncode, done.stdout[-300:])
    place = "src/%s:%s: %s" % (found.group(2).split("src/")[-1], found.group(3), found.group(4))
    return place.startswith("src/" + expected), place


def main():
    builder, wrong = Builder(sys.argv[1:]), 0
    for mutant in MUTANTS:
        with tempfile.TemporaryDirectory() as folder:
            caught, where = judge(builder, mutant, pathlib.Path(folder))
        print("%s (%s, src/%s): %s%s" % (mutant[0], mutant[1], mutant[2], "" if caught else "NOT CAUGHT: ", where), flush=True)
        wrong += not caught
    print("%d of %d mistakes are caught by an assert" % (len(MUTANTS) - wrong, len(MUTANTS)))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
