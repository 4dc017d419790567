/* Triangulations and cells of points in space that repeats. */
#include "mesh.h"

static void free_periodic(void *t) {
    brio_periodic_free(t);
}

static const brio_periodic *periodic_of(PyObject *module, PyObject *object) {
    return handle_object(state_of(module), object, KIND_PERIODIC);
}

/* periodic(points, weights, cell, open, threads, progress): a handle. */
static PyObject *periodic(PyObject *module, PyObject *args) {
    PyObject *points, *weights, *cell, *progress, *result = NULL;
    int threads;
    brio_periodic_options o = {.size = sizeof o};
    input p = {.held = 0}, w = {.held = 0}, l = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOO(iii)iO", &points, &weights, &cell, &o.open[0], &o.open[1], &o.open[2], &threads,
                          &progress))
        return NULL;
    if (!input_open(&p, points, "points", 'd', 3) && !input_open_weights(&w, weights, p.rows) &&
        !input_open(&l, cell, "cell", 'd', 3) && !input_has_rows(&l, "cell", 3) &&
        !call_begin(&c, state_of(module), threads, progress)) {
        brio_periodic *t = NULL;
        brio_status status;
        o.cell = l.data;
        CALL(c, status, brio_delaunay_periodic(c.ctx, p.data, w.data, p.rows, &o, &t));
        result = call_end_with(&c, status, KIND_PERIODIC, t, free_periodic, NULL);
    }
    input_close(&l);
    input_close(&w);
    input_close(&p);
    return result;
}

/* What is known of a triangulation, in a dict. */
static PyObject *periodic_facts(PyObject *module, PyObject *object) {
    const brio_periodic *t = periodic_of(module, object);
    if (!t) return NULL;
    const brio_periodic_stats *s = brio_periodic_facts(t);
    const double *c = s->cell;
#define COUNT(name) #name, (Py_ssize_t)s->name
    return Py_BuildValue("{s:n,s:n,s:n,s:n,s:i,s:i,s:n,s:n,s:n,s:n,s:n,s:i,s:d,s:d,s:d,s:(ddddddddd)}", COUNT(points),
                         COUNT(vertices), COUNT(duplicates), COUNT(hidden), "directions", s->directions, "dimension",
                         s->dimension, COUNT(tetrahedra), COUNT(hull_facets), COUNT(images), COUNT(triangulated),
                         COUNT(completed), "rounds", s->rounds, "cell_volume", s->cell_volume, "cell_moved",
                         s->cell_moved, "moved", s->moved, "cell", c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7],
                         c[8]);
#undef COUNT
}

/* Views: images as rows of point and shift (0), their positions (1), the vertices (2) and mates (3) of finite tetrahedra,
 * the vertices of infinite ones (4), and the representatives as rows of point and shift (5). */
static PyObject *periodic_view(PyObject *module, PyObject *args) {
    PyObject *object;
    int part;
    if (!PyArg_ParseTuple(args, "Oi", &object, &part)) return NULL;
    const brio_periodic *t = periodic_of(module, object);
    if (!t) return NULL;
    const brio_periodic_stats *s = brio_periodic_facts(t);
    module_state *state = state_of(module);
    if (part == 0) return array_new(state, object, layout_of(brio_periodic_images(t), 'i', s->images, 4));
    if (part == 1) return array_new(state, object, layout_of(brio_periodic_positions(t), 'd', s->images, 3));
    if (part == 5) return array_new(state, object, layout_of(brio_periodic_representatives(t), 'i', s->points, 4));
    const uint32_t *first = (const uint32_t *)brio_periodic_tetrahedra(t);
    if (first) first += (part == 3 ? 4 : 0) + (part == 4 ? 8 * s->tetrahedra : 0);
    layout shown = layout_of(first, part == 3 ? 'I' : 'i', part == 4 ? s->hull_facets : s->tetrahedra, 4);
    shown.strides[0] *= 2; /* a tetrahedron: vertices, then mates */
    return array_new(state, object, shown);
}

static PyObject *periodic_checksum(PyObject *module, PyObject *object) {
    const brio_periodic *t = periodic_of(module, object);
    uint64_t sum = 0;
    brio_status status;
    call c;
    if (!t || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_periodic_checksum(c.ctx, t, &sum));
    return call_end(&c, status) ? NULL : PyLong_FromUnsignedLongLong(sum);
}

static PyObject *periodic_check(PyObject *module, PyObject *object) {
    const brio_periodic *t = periodic_of(module, object);
    brio_status status;
    call c;
    if (!t || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_periodic_check(c.ctx, t));
    if (call_end(&c, status)) return NULL;
    Py_RETURN_NONE;
}

/* periodic_cells(t, box, vertices, quick, threads, progress): a dict of arrays. */
static PyObject *periodic_cells(PyObject *module, PyObject *args) {
    PyObject *object, *box, *progress, *owner = NULL, *result = NULL;
    int threads, vertices, quick;
    input b = {.held = 0};
    brio_cells *made = NULL;
    call c;
    if (!PyArg_ParseTuple(args, "OOiiiO", &object, &box, &vertices, &quick, &threads, &progress)) return NULL;
    const brio_periodic *t = periodic_of(module, object);
    if (!t) return NULL;
    if (box != Py_None && (input_open(&b, box, "box", 'd', 0) || input_has_rows(&b, "box", 6))) {
        input_close(&b);
        return NULL;
    }
    if (!call_begin(&c, state_of(module), threads, progress)) {
        brio_cells_options o = {.size = sizeof o, .vertices = vertices, .box = b.data};
        o.no_areas = o.no_centroids = o.no_face_sizes = quick;
        brio_status status;
        CALL(c, status, brio_periodic_cells(c.ctx, t, &o, &made));
        owner = call_end_with(&c, status, KIND_CELLS, made, cells_release, NULL);
    }
    input_close(&b);
    if (owner) result = cells_views(state_of(module), owner, made);
    Py_XDECREF(owner);
    return result;
}

/* --- alpha --- */

static void free_periodic_alpha(void *a) {
    brio_periodic_alpha_free(a);
}

static const brio_periodic_alpha *alpha_of(PyObject *module, PyObject *object) {
    return handle_object(state_of(module), object, KIND_PERIODIC_ALPHA);
}

/* periodic_alpha(t, threads, progress): a dict of lists of arrays, the images and their positions, and the complex. */
static PyObject *periodic_alpha(PyObject *module, PyObject *args) {
    PyObject *object, *progress, *result = NULL;
    int threads;
    brio_periodic_alpha *a = NULL;
    brio_status status;
    call c;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    const brio_periodic *t = periodic_of(module, object);
    if (!t || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_periodic_alpha_values(c.ctx, t, &a));
    PyObject *owner = call_end_with(&c, status, KIND_PERIODIC_ALPHA, a, free_periodic_alpha, object);
    if (!owner) return NULL;
    module_state *state = state_of(module);
    PyObject *images = array_new(state, owner, layout_of(a->images, 'i', a->num_images, 4));
    PyObject *positions = array_new(state, owner, layout_of(a->positions, 'd', a->num_images, 3));
    if (images && positions) result = alpha_views(state, owner, a->complex);
    if (result &&
        (PyDict_SetItemString(result, "images", images) || PyDict_SetItemString(result, "positions", positions)))
        Py_CLEAR(result);
    Py_XDECREF(images);
    Py_XDECREF(positions);
    Py_DECREF(owner);
    return result;
}

/* periodic_alpha_by_points(complex): a dict as of alpha_values. */
static PyObject *periodic_alpha_by_points(PyObject *module, PyObject *object) {
    PyObject *result = NULL, *owner;
    brio_status status;
    call c;
    const brio_periodic_alpha *a = alpha_of(module, object);
    if (!a) return NULL;
    brio_alpha_complex *named = calloc(1, sizeof *named);
    if (!named) return PyErr_NoMemory();
    named->size = sizeof *named;
    if (call_begin(&c, state_of(module), 0, Py_None)) {
        free(named);
        return NULL;
    }
    CALL(c, status, brio_periodic_alpha_by_points(c.ctx, a, named));
    owner = call_end_with(&c, status, KIND_ALPHA, named, alpha_release, NULL);
    if (owner) result = alpha_views(state_of(module), owner, named);
    Py_XDECREF(owner);
    return result;
}

static PyObject *periodic_alpha_auto(PyObject *module, PyObject *object) {
    double alpha = 0;
    brio_status status;
    call c;
    const brio_periodic_alpha *a = alpha_of(module, object);
    if (!a || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_periodic_alpha_auto(c.ctx, a, &alpha));
    return call_end(&c, status) ? NULL : PyFloat_FromDouble(alpha);
}

/* periodic_alpha_shape(complex, alpha): a mesh, and counts in a dict. */
static PyObject *periodic_alpha_shape(PyObject *module, PyObject *args) {
    PyObject *object, *result;
    double alpha;
    brio_periodic_shape_stats s = {.size = sizeof s};
    brio_mesh *mesh = NULL;
    brio_status status;
    call c;
    if (!PyArg_ParseTuple(args, "Od", &object, &alpha)) return NULL;
    const brio_periodic_alpha *a = alpha_of(module, object);
    if (!a || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_periodic_alpha_shape(c.ctx, a, alpha, &mesh, &s));
    result = call_end_with_mesh(&c, status, mesh);
#define COUNT(name) #name, (Py_ssize_t)s.name
    return result ? Py_BuildValue("(N{s:n,s:n,s:n,s:n,s:n,s:n,s:n,s:n,s:n,s:d,s:d})", result, COUNT(tetrahedra),
                                  COUNT(vertices), COUNT(split), COUNT(uncovered), COUNT(singular_vertices),
                                  COUNT(singular_edges), COUNT(singular_facets), COUNT(components), COUNT(euler),
                                  "area", s.area, "volume", s.volume)
                  : NULL;
#undef COUNT
}

/* --- locations --- */

static void free_periodic_locator(void *l) {
    brio_periodic_locator_free(l);
}

static PyObject *periodic_locator(PyObject *module, PyObject *args) {
    PyObject *object, *progress;
    int threads;
    brio_periodic_locator *l = NULL;
    brio_status status;
    call c;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    const brio_periodic *t = periodic_of(module, object);
    if (!t || call_begin(&c, state_of(module), threads, progress)) return NULL;
    CALL(c, status, brio_periodic_locator_new(c.ctx, t, &l));
    return call_end_with(&c, status, KIND_PERIODIC_LOCATOR, l, free_periodic_locator, object);
}

/* periodic_locate(locator, queries, nearest, out, threads, progress): out has a row of four numbers a query. */
static PyObject *periodic_locate(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *array, *progress;
    int threads, nearest, failed = -1;
    input q, out;
    call c;
    if (!PyArg_ParseTuple(args, "OOiOiO", &object, &queries, &nearest, &array, &threads, &progress)) return NULL;
    const brio_periodic_locator *l = handle_object(state_of(module), object, KIND_PERIODIC_LOCATOR);
    if (!l || input_open(&q, queries, "queries", 'd', 3)) return NULL;
    if (output_open(&out, array, "out", 'i', 4)) {
        input_close(&q);
        return NULL;
    }
    if (!input_has_rows(&out, "out", q.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        CALL(c, status,
             nearest ? brio_periodic_locator_least_power(c.ctx, l, q.data, q.rows, out.data)
                     : brio_periodic_locator_tetrahedra(c.ctx, l, q.data, q.rows, out.data));
        failed = call_end(&c, status);
    }
    input_close(&q);
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef periodic_methods[] = {
    {"periodic", periodic, METH_VARARGS, "periodic(points, weights, cell, open, threads, progress): a handle."},
    {"periodic_facts", periodic_facts, METH_O, "What is known of it, in a dict."},
    {"periodic_view", periodic_view, METH_VARARGS, "periodic_view(t, part): a view."},
    {"periodic_checksum", periodic_checksum, METH_O, "A hash that depends on no origin and no order."},
    {"periodic_check", periodic_check, METH_O, "Checks it exactly."},
    {"periodic_cells", periodic_cells, METH_VARARGS,
     "periodic_cells(t, box, vertices, quick, threads, progress): a dict."},
    {"periodic_alpha", periodic_alpha, METH_VARARGS, "periodic_alpha(t, threads, progress): a dict, and the complex."},
    {"periodic_alpha_by_points", periodic_alpha_by_points, METH_O, "The complex whose simplices name points."},
    {"periodic_alpha_auto", periodic_alpha_auto, METH_O, "The least alpha of one solid with all vertices."},
    {"periodic_alpha_shape", periodic_alpha_shape, METH_VARARGS,
     "periodic_alpha_shape(complex, alpha): a mesh, counts."},
    {"periodic_locator", periodic_locator, METH_VARARGS, "periodic_locator(t, threads, progress): a handle."},
    {"periodic_locate", periodic_locate, METH_VARARGS,
     "periodic_locate(locator, queries, nearest, out, threads, progress)"},
    {NULL, NULL, 0, NULL},
};
