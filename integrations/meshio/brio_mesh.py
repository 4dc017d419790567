#!/usr/bin/env python3
"""brio_mesh.py surface|hull|delaunay IN OUT [NAME=VALUE ...]: brio on files of meshio and trimesh.

Reads points by brio where it knows the format, else by meshio, else by trimesh; writes the result by brio, meshio or trimesh in the same
way. So a scan in a .3mf or .inp becomes a surface in a .glb or .xdmf.

    surface     the surface of the points; options are those of brio.reconstruct, such as method=power-crust open=auto
    hull        the convex hull
    delaunay    tetrahedra

Prints what it made as a line of JSON. Exit status: 0, or 1 with a sentence on the standard error."""
import json
import pathlib
import sys

import brio
import numpy as np


def read_points(path):
    """The points of a file as a brio.Mesh, by the first library that reads it."""
    reasons = []
    try:
        return brio.read(path)
    except (brio.Error, OSError) as error:
        reasons.append("brio: %s" % error)
    try:
        import meshio

        mesh = meshio.read(path)
        rows = np.zeros((len(mesh.points), 3))
        rows[:, : mesh.points.shape[1]] = mesh.points
        columns = {name: values for name, values in mesh.point_data.items() if np.ndim(values) <= 2 and np.asarray(values).dtype.kind in "iuf"}
        return brio.Mesh(rows, properties=columns)
    except (ImportError, SystemExit, Exception) as error:  # noqa: B902: meshio ends the process, or raises what it likes
        reasons.append("meshio: %s" % (error or "does not read it"))
    try:
        import trimesh

        loaded = trimesh.load(path)
        return brio.Mesh(np.asarray(loaded.to_geometry().vertices if hasattr(loaded, "to_geometry") else loaded.vertices))
    except (ImportError, Exception) as error:  # noqa: B902
        reasons.append("trimesh: %s" % error)
    raise SystemExit("%s: no library reads it (%s)" % (path, "; ".join(str(r).strip() for r in reasons)))


def write_mesh(path, mesh):
    """Writes a mesh by the first library that has the format. Returns its name."""
    reasons = []
    ways = [("brio", lambda: mesh.write(path)), ("meshio", lambda: mesh.to_meshio().write(path)), ("trimesh", lambda: mesh.to_trimesh().export(path))]
    for name, write in ways:
        try:
            write()
            return name
        except (ImportError, SystemExit, Exception) as error:  # noqa: B902
            reasons.append("%s: %s" % (name, str(error).strip() or "does not write it"))
    pathlib.Path(path).unlink(missing_ok=True)
    raise SystemExit("%s: no library writes it (%s)" % (path, "; ".join(reasons)))


def value_of(text):
    """A number where it is one, else a word."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def surface(points, options):
    found = brio.reconstruct(points, **options)
    return found, {name: int(getattr(found.certificate, name)) for name in ("closed", "manifold", "oriented", "components", "genus")}


def hull(points, options):
    found = brio.ConvexHull(points.vertices, **options)
    return brio.Mesh(points.vertices, found.simplices).select(np.asarray(found.vertices)), {"volume": found.volume, "area": found.area}


def delaunay(points, options):
    found = brio.Delaunay(points.vertices, **options)
    return brio.Mesh(points.vertices, tetrahedra=found.simplices, properties=points.properties), {"checksum": "%016x" % found.checksum}


COMMANDS = {"surface": surface, "hull": hull, "delaunay": delaunay}


def main(words):
    if len(words) < 3 or words[0] not in COMMANDS or not all("=" in word for word in words[3:]):
        raise SystemExit(__doc__)
    options = {name: value_of(text) for name, text in (word.split("=", 1) for word in words[3:])}
    try:
        mesh, facts = COMMANDS[words[0]](read_points(words[1]), options)
    except (brio.Error, TypeError, ValueError) as error:
        raise SystemExit("%s: %s" % (words[1], error)) from None
    facts.update(vertices=len(mesh.vertices), faces=len(mesh.face_offsets) - 1, tetrahedra=len(mesh.tetrahedra), by=write_mesh(words[2], mesh))
    print(json.dumps(facts))


if __name__ == "__main__":
    main(sys.argv[1:])
