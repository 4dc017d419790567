/* Voronoi and power cells of points in space. */
#include "native.h"

void cells_release(void *cells) {
    brio_cells_free(cells);
}

/* An array that may be absent, as None; a copy if it has no owner. */
static PyObject *maybe(module_state *state, PyObject *owner, const void *data, layout shown) {
    if (data) return owner ? array_new(state, owner, shown) : array_copy(state, shown);
    Py_RETURN_NONE;
}

PyObject *cells_views(module_state *state, PyObject *owner, const brio_cells *c) {
    size_t n = c->num_cells, faces = c->face_offsets ? c->face_offsets[n] : 0;
    size_t corners = c->corner_offsets ? c->corner_offsets[faces] : 0;
#define VIEW(name, format, rows, columns) #name, maybe(state, owner, c->name, layout_of(c->name, format, rows, columns))
    return Py_BuildValue(
        "{s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:N,s:d,s:d}", VIEW(site, 'I', n, 0), VIEW(volume, 'd', n, 0),
        VIEW(bounded, '?', n, 0), VIEW(area, 'd', n, 0), VIEW(centroid, 'd', n, 3), VIEW(face_offsets, 'L', n + 1, 0),
        VIEW(face_neighbours, 'l', faces, 0), VIEW(face_areas, 'd', faces, 0), VIEW(face_normals, 'd', faces, 3),
        VIEW(corner_offsets, 'L', faces + 1, 0), VIEW(face_vertices, 'I', corners, 0),
        VIEW(vertices, 'd', c->num_vertices, 3), VIEW(face_shifts, 'i', faces, 3), "volume_sum", c->volume_sum,
        "region_volume", c->region_volume);
#undef VIEW
}

typedef struct {
    input points, weights, box, planes;
} cell_arrays;

static int open_arrays(cell_arrays *a, PyObject *points, PyObject *weights, PyObject *box, PyObject *planes) {
    *a = (cell_arrays){{.held = 0}, {.held = 0}, {.held = 0}, {.held = 0}};
    if (input_open(&a->points, points, "points", 'd', 3) || input_open_weights(&a->weights, weights, a->points.rows))
        return -1;
    if (box != Py_None && (input_open(&a->box, box, "box", 'd', 0) || input_has_rows(&a->box, "box", 6))) return -1;
    return planes != Py_None ? input_open(&a->planes, planes, "planes", 'd', 4) : 0;
}

static void close_arrays(cell_arrays *a) {
    input_close(&a->points);
    input_close(&a->weights);
    input_close(&a->box);
    input_close(&a->planes);
}

/* cells(t or None, points, weights, box, planes, threads, progress): a dict of arrays. */
static PyObject *cells(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *box, *planes, *progress, *owner = NULL, *result = NULL;
    int threads;
    cell_arrays a;
    call c;
    brio_cells *made = NULL;
    module_state *state = state_of(module);
    if (!PyArg_ParseTuple(args, "OOOOOiO", &object, &points, &weights, &box, &planes, &threads, &progress)) return NULL;
    const brio_triangulation *t = object == Py_None ? NULL : handle_object(state, object, KIND_TRIANGULATION);
    if (object != Py_None && !t) return NULL;
    if (!open_arrays(&a, points, weights, box, planes) &&
        (!t || !handle_has_points(state, object, &a.points, &a.weights)) && !call_begin(&c, state, threads, progress)) {
        brio_cells_options o = {0};
        brio_status status;
        o.vertices = 1;
        o.box = a.box.data;
        o.planes = a.planes.data;
        o.num_planes = a.planes.rows;
        CALL(c, status, brio_voronoi_cells(c.ctx, t, a.points.data, a.weights.data, a.points.rows, &o, &made));
        owner = call_end_with(&c, status, KIND_CELLS, made, cells_release, NULL);
    }
    close_arrays(&a);
    if (owner) result = cells_views(state, owner, made);
    Py_XDECREF(owner);
    return result;
}

PyMethodDef cells_methods[] = {
    {"cells", cells, METH_VARARGS, "cells(t, points, weights, box, planes, threads, progress): a dict of arrays."},
    {NULL, NULL, 0, NULL},
};
