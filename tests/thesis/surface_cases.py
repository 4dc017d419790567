"""Results of chapter 3's figures, by name: those for which the claim holds, those for which it does not, and those that do not
tell. Used by test_thesis.py."""


def surface(genus=1, true=1, components=1, **more):
    """A closed surface with so many handles."""
    r = {"points": 5000, "status": "done", "wall": 0.1, "true_components": 1, "true_genus": true, "closed": True, "manifold": True,
         "oriented": True, "components": components, "genus": genus, "boundary_edges": 0, "boundary_loops": 0, "nonmanifold_edges": 0,
         "faces": 10000, "vertices": 5000, "mean": 0.05, "farthest": 0.6, "self_intersections": 0}
    r["right"] = components == 1 and genus == true
    r.update(more)
    if not (r["closed"] and r["manifold"]): r["right"] = False
    return r


def open_surface(edges=50, loops=3, **more):
    return surface(**{"closed": False, "boundary_edges": edges, "boundary_loops": loops, **more})


def nothing(true=1):
    return {"points": 5000, "status": "no answer", "wall": 0.1, "true_components": 1, "true_genus": true, "right": False}


def sets(**runs):
    """Results of the runs of each set: sets(torus={"walk": ...})."""
    return {"%s, %s" % (name, method): r for name, methods in runs.items() for method, r in methods.items()}


def beside_the_crust(near=0.05, crust=0.04, seconds=0.1, triangulations=0.3):
    one = {"cocone": surface(mean=near, wall=seconds),
           "crust": surface(mean=crust, triangulations=triangulations, in_crust=0.95, in_cocone=0.8)}
    return sets(torus=one, part=one)


def walked(walk, labels):
    rough = {"walk": walk, "labels": labels}
    return sets(torus={"walk": surface(), "labels": surface()}, knot=rough, hand=rough, part=rough)


def candidates(torus, rough):
    return sets(torus={"candidates": torus}, cube={"candidates": rough}, knot={"candidates": rough})


def shape(euler):
    return {**nothing(), "status": "done", "vertices": 100, "edges": 300, "triangles": 250, "tetrahedra": 50 - euler}


def planar(common=160, found=160, euler=1):
    right = (common, found, euler) == (160, 160, 1)
    return {"star": {"points": 160, "status": "done", "links": 160, "found": found, "common": common, "euler": euler, "true_euler": 1,
                     "right": right}}


def scan(crust, euler): return sets(scan={"crust": crust, "shape": shape(euler)})


def hole(wide=1, small=2, closed=None, **more):
    return {"closed": closed or surface(0, 0), "open": open_surface(true=0, wide_holes=wide, boundary_loops=wide + small, **more)}


def counted(faces=50000, kept=4000, vertices=60000):
    return sets(knot={"crust": surface(faces=faces, samples_kept=kept, vertices=vertices), "cocone": surface()})


def labels(greedy, naive, torus=1):
    rough = {"greedy": surface(greedy), "naive": surface(naive), "theoretical": surface(naive + 30)}
    return sets(torus={k: surface(torus) for k in rough}, knot=rough, hand=rough, part=rough)


def toggled(greedy, other): return sets(knot={"greedy": surface(greedy), "global": surface(other)})


def models(right, wrong):
    runs = {"model %d" % i: {"greedy": surface(1 if i < right else 5)} for i in range(right + wrong)}
    return sets(**runs)


def edges(sharp=0.15, cocone=0.6, genus=0):
    return {"sharp": surface(genus, 0, edges_off=sharp), "all poles": surface(0, 0, edges_off=0.27), "cocone": surface(0, 0, edges_off=cocone)}


def machined(crust, plain, old): return sets(part={"crust": crust, "plain": plain, "old": old})


def stamped(greedy): return {"greedy": greedy, "cocone": surface(0, 0), "robust co-cone": nothing(0)}


def moved(**more): return {"torus": surface(**more), "hand": surface(2, 2)}


CASES = {
    "3.2.2-crust": ([beside_the_crust(), beside_the_crust(0.08, 0.01)],
                    [beside_the_crust(0.5), beside_the_crust(seconds=0.4)], [{}, sets(torus={"cocone": surface()})]),
    "3.2.2-walk": ([walked(nothing(), surface()), walked(surface(7), surface())],
                   [walked(surface(), surface()), walked(nothing(), surface(4))], [{}, sets(torus={"walk": surface(), "labels": surface()})]),
    "3.3": ([candidates(surface(), open_surface()), candidates(open_surface(1, 1), open_surface(8))],
            [candidates(surface(), surface()), candidates(open_surface(500), open_surface())], [{}, sets(torus={"candidates": surface()})]),
    "3.4": ([planar()], [planar(159), planar(found=161), planar(euler=0), {"star": nothing()}], [{}]),
    "3.5": ([scan(surface(3, 3), -2)], [scan(surface(3, 3), 0), scan(surface(4, 3), -2), scan(surface(3, 3, mean=2), -2), sets(
        scan={"crust": surface(), "shape": nothing()})], [{}, sets(scan={"crust": surface()})]),
    "3.6": ([hole(), hole(small=0)], [hole(wide=0), hole(wide=2), hole(mean=3), hole(components=2), hole(closed=surface(2, 0))],
            [{}, {"closed": surface(0, 0), "open": nothing()}]),
    "3.3.2": ([counted()], [counted(faces=9000), counted(kept=5000), counted(kept=4000, vertices=4000)],
              [{}, sets(knot={"crust": surface(), "cocone": nothing()})]),
    "3.3.3": ([labels(1, 25)], [labels(1, 1), labels(2, 25), labels(1, 25, torus=2)], [{}, sets(torus={"greedy": surface()})]),
    "3.3.3-toggled": ([toggled(1, 1), toggled(3, 4)], [toggled(3, 1)], [{}, sets(knot={"greedy": surface()})]),
    "3.3.4": ([models(10, 0), models(9, 1)], [models(8, 2), models(0, 3)], [{}]),
    "3.10": ([edges()], [edges(sharp=0.5), edges(cocone=0.3), edges(genus=1)], [{}, {"sharp": surface()}]),
    "3.11": ([machined(surface(3, 3), surface(4, 3), open_surface()), machined(surface(5, 3), surface(3, 3), open_surface())],
             [machined(surface(5, 3), surface(5, 3), open_surface()), machined(surface(3, 3), surface(3, 3), surface(3, 3))],
             [{}, sets(part={"crust": surface()})]),
    "3.12": ([stamped(surface(0, 0))], [stamped(surface(1, 0)), stamped(surface(0, 0, mean=2)), stamped(open_surface(true=0))], [{}]),
    "3.13": ([moved()], [moved(self_intersections=3), moved(closed=False), moved(manifold=False)], [{}, {"torus": nothing()}]),
}
CASES["3.9"] = CASES["3.6"]
