/* Alpha complexes and alpha shapes. */
#include "mesh.h"

/* Returns how many coordinates the points of a triangulation have, or 0 with an exception set. */
static int handle_coordinates(module_state *state, PyObject *object) {
    if (Py_TYPE(object) == state->handle_type && ((handle *)object)->kind == KIND_TRIANGULATION2)
        return brio_triangulation2_stats(((handle *)object)->record->object)->coordinates;
    return handle_object(state, object, KIND_TRIANGULATION) ? 3 : 0;
}

void alpha_release(void *complex) {
    brio_alpha_complex_free(complex);
    free(complex);
}

PyObject *alpha_views(module_state *state, PyObject *owner, const brio_alpha_complex *a) {
    const size_t dimensions = a->triangulation2 ? 3 : 4;
    PyObject *lists[4];
    for (int n = 0; n < 4; n++) lists[n] = PyList_New((Py_ssize_t)dimensions);
    for (size_t k = 0; k < dimensions; k++) {
        const layout shown[4] = {
            layout_of(a->simplices[k], 'I', a->counts[k], k + 1), layout_of(a->values[k], 'd', a->counts[k], 0),
            layout_of(a->solid[k], 'd', a->counts[k], 0), layout_of(a->gabriel[k], '?', a->counts[k], 0)};
        for (int n = 0; n < 4; n++)
            if (lists[n]) PyList_SetItem(lists[n], (Py_ssize_t)k, array_new(state, owner, shown[n]));
    }
    return Py_BuildValue("{s:N,s:N,s:N,s:N,s:O}", "simplices", lists[0], "values", lists[1], "solid", lists[2],
                         "gabriel", lists[3], "complex", owner);
}

/* Runs the call for a triangulation of space or of the plane. */
static PyObject *run_values(call *c, handle *of, const input *p, const input *w, brio_alpha_complex *a) {
    brio_status status;
    const void *t = of->record->object;
    a->size = sizeof *a;
    if (of->kind == KIND_TRIANGULATION)
        CALL(*c, status, brio_alpha_values(c->ctx, t, p->data, w->data, p->rows, a));
    else
        CALL(*c, status, brio_alpha_values2(c->ctx, t, p->data, w->data, p->rows, a));
    return call_end_with(c, status, KIND_ALPHA, a, alpha_release, (PyObject *)of);
}

/* alpha_values(t, points, weights, threads, progress): a dict of lists of arrays, and the complex. */
static PyObject *alpha_values(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *progress, *owner = NULL, *result = NULL;
    int threads;
    input p, w = {.held = 0};
    call c;
    module_state *state = state_of(module);
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &weights, &threads, &progress)) return NULL;
    int columns = handle_coordinates(state, object);
    if (!columns || input_open(&p, points, "points", 'd', columns)) return NULL;
    brio_alpha_complex *a = calloc(1, sizeof *a);
    if (!a)
        PyErr_NoMemory();
    else if (input_open_weights(&w, weights, p.rows) || handle_has_points(state, object, &p, &w) ||
             call_begin(&c, state, threads, progress))
        free(a);
    else
        owner = run_values(&c, (handle *)object, &p, &w, a);
    input_close(&p);
    input_close(&w);
    if (owner) result = alpha_views(state, owner, a);
    Py_XDECREF(owner);
    return result;
}

/* alpha_order(complex, out): the simplices as they enter. */
static PyObject *alpha_order(PyObject *module, PyObject *args) {
    PyObject *object, *array;
    input out;
    call c;
    int failed = -1;
    if (!PyArg_ParseTuple(args, "OO", &object, &array)) return NULL;
    const brio_alpha_complex *a = handle_object(state_of(module), object, KIND_ALPHA);
    if (!a || output_open(&out, array, "out", 'I', 0)) return NULL;
    if (!input_has_rows(&out, "out", a->counts[0] + a->counts[1] + a->counts[2] + a->counts[3]) &&
        !call_begin(&c, state_of(module), 0, Py_None)) {
        brio_status status;
        CALL(c, status, brio_alpha_order(c.ctx, a, out.data));
        failed = call_end(&c, status);
    }
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

static PyObject *alpha_auto(PyObject *module, PyObject *object) {
    call c;
    brio_status status;
    double alpha = 0;
    const brio_alpha_complex *a = handle_object(state_of(module), object, KIND_ALPHA);
    if (!a || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    CALL(c, status, brio_alpha_auto(c.ctx, a, &alpha));
    return call_end(&c, status) ? NULL : PyFloat_FromDouble(alpha);
}

/* alpha_shape(complex, points, weights, alpha): a mesh, and counts in a dict. */
static PyObject *alpha_shape(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *result = NULL;
    double alpha;
    input p, w = {.held = 0};
    call c;
    brio_alpha_shape_stats s = {0};
    if (!PyArg_ParseTuple(args, "OOOd", &object, &points, &weights, &alpha)) return NULL;
    const brio_alpha_complex *a = handle_object(state_of(module), object, KIND_ALPHA);
    if (!a || input_open(&p, points, "points", 'd', -1)) return NULL;
    if (!input_open_weights(&w, weights, p.rows) &&
        !handle_has_points(state_of(module), ((handle *)object)->base, &p, &w) &&
        !call_begin(&c, state_of(module), 0, Py_None)) {
        brio_status status;
        brio_mesh *mesh = NULL;
        CALL(c, status, brio_alpha_shape(c.ctx, p.data, a, alpha, &mesh, &s));
        result = call_end_with_mesh(&c, status, mesh);
    }
    input_close(&p);
    input_close(&w);
#define COUNT(name) #name, (Py_ssize_t)s.name
    return result ? Py_BuildValue("(N{s:n,s:n,s:n,s:n,s:n,s:n,s:n})", result, COUNT(tetrahedra), COUNT(vertices),
                                  COUNT(split), COUNT(uncovered), COUNT(singular_vertices), COUNT(singular_edges),
                                  COUNT(singular_facets))
                  : NULL;
#undef COUNT
}

PyMethodDef alpha_methods[] = {
    {"alpha_values", alpha_values, METH_VARARGS, "alpha_values(t, points, weights, threads, progress)"},
    {"alpha_order", alpha_order, METH_VARARGS, "alpha_order(complex, out)"},
    {"alpha_auto", alpha_auto, METH_O, "The least alpha of one solid with all vertices."},
    {"alpha_shape", alpha_shape, METH_VARARGS, "alpha_shape(complex, points, weights, alpha): a mesh, and counts."},
    {NULL, NULL, 0, NULL},
};
