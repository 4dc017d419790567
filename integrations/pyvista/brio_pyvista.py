"""brio in PyVista: `import brio_pyvista` gives every dataset `.brio`.

    cloud = pyvista.PolyData(points)
    cloud.brio.surface()        the closed surface of the scan, as PolyData
    cloud.brio.delaunay_3d()    exact tetrahedra, as an UnstructuredGrid
    cloud.brio.voronoi()        the cells within the cloud's box, as polyhedra

Properties of points come along: a surface has those of its samples, tetrahedra have those of their corners, a cell has those of its
point. What a call finds out is in `field_data` of its result. Options are those of the functions of brio."""
import brio
import numpy as np
import pyvista

__all__ = ["BrioAccessor"]


def _columns(dataset):
    """The properties of a dataset's points, as brio takes them: rows of numbers."""
    found = {}
    for name in dataset.point_data.keys():
        values = np.asarray(dataset.point_data[name])
        if values.dtype.kind in "biuf" and values.ndim <= 2:
            found[str(name)] = values
    return found


@pyvista.register_dataset_accessor("brio", pyvista.DataSet)
class BrioAccessor:
    """What brio computes of the points of a dataset."""

    def __init__(self, dataset):
        self._dataset = dataset

    def _points(self):
        return np.ascontiguousarray(self._dataset.points, dtype=np.float64)

    def surface(self, method="labeled-delaunay", *, outliers=False, **options):
        """Returns the surface of the points, as PolyData.

        Normals are those of the dataset, where it has some of its points ("Normals"). `outliers`: points far from all others are left
        out first. The certificate is in `field_data`: closed, manifold, oriented, components, genus. Other options as for
        brio.reconstruct."""
        columns = _columns(self._dataset)
        normals = columns.pop("Normals", None)
        rows = self._points()
        if normals is not None and "normals" not in options and method != "power-crust":
            options["normals"] = np.asarray(normals, dtype=np.float64)
        if outliers:
            keep = ~brio.outliers(rows)
            rows, columns = rows[keep], {name: values[keep] for name, values in columns.items()}
            if options.get("normals") is not None:
                options["normals"] = np.asarray(options["normals"])[keep]
        found = brio.reconstruct(rows, method, attributes=columns, **options)
        out = found.to_pyvista()
        for name in ("closed", "manifold", "oriented", "components", "genus"):
            out.field_data[name] = [int(getattr(found.certificate, name))]
        return out

    def delaunay_3d(self, *, weights=None, threads=0):
        """Returns the Delaunay triangulation, or the regular one of points with weights, as an UnstructuredGrid of tetrahedra.

        weights  one a point, or the name of one of the dataset's properties. `field_data` has the checksum, which is the same for every
        order of the points and number of threads."""
        if isinstance(weights, str):
            weights = np.asarray(self._dataset.point_data[weights], dtype=np.float64)
        tri = brio.Delaunay(self._points(), weights, threads=threads)
        out = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: tri.simplices.astype(np.int64)}, self._points())
        for name in self._dataset.point_data.keys():
            out.point_data[name] = self._dataset.point_data[name]
        out.field_data["checksum"] = ["%016x" % tri.checksum]
        return out

    def voronoi(self, *, box=None, weights=None, threads=0):
        """Returns the Voronoi cells of the points, as an UnstructuredGrid of polyhedra.

        box  low and high corner of the box that the cells are cut by; by default the dataset's own, which is grown by a hundredth.
        Cells are in the points' order; `cell_data` has the number of the point, the volume, and the properties of the points."""
        if isinstance(weights, str):
            weights = np.asarray(self._dataset.point_data[weights], dtype=np.float64)
        rows = self._points()
        if box is None:
            low, high = rows.min(axis=0), rows.max(axis=0)
            box = [low - 0.01 * (high - low), high + 0.01 * (high - low)]
        cells = brio.Voronoi(rows, weights, box=box, threads=threads).cells
        out, points = _polyhedra(cells)
        out.cell_data["point"] = points
        out.cell_data["volume"] = np.asarray(cells["volume"])[points]
        for name in self._dataset.point_data.keys():
            out.cell_data[name] = np.asarray(self._dataset.point_data[name])[points]
        return out


def _polyhedra(cells):
    """The cells of brio as polyhedra of VTK: of each the number of its faces, of each face the number of its corners and these. Returns the
    grid, and the number of the point of each cell: a hidden point has none."""
    offsets, corners = (np.asarray(cells[n], dtype=np.int64) for n in ("face_offsets", "corner_offsets"))
    numbers, stream, points = np.asarray(cells["face_vertices"], dtype=np.int64), [], []
    for point, (first, end) in enumerate(zip(offsets[:-1], offsets[1:])):
        if end == first:
            continue
        faces = [end - first]
        for face in range(first, end):
            round_ = numbers[corners[face]:corners[face + 1]]
            faces += [len(round_), *round_]
        stream += [len(faces), *faces]
        points.append(point)
    kinds = np.full(len(points), pyvista.CellType.POLYHEDRON)
    return pyvista.UnstructuredGrid(np.array(stream, dtype=np.int64), kinds, np.array(cells["vertices"])), np.array(points, dtype=np.int64)
