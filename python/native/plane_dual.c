/* The Voronoi or power diagram of points in the plane, by the library. */
#include "native.h"

static void free_diagram2(void *diagram) {
    brio_diagram2_free(diagram);
}

/* Sets an item of a dict to a view; steals it. Returns 0, or -1 with an exception set. */
static int put(PyObject *dict, const char *name, PyObject *view) {
    int failed = !view || PyDict_SetItemString(dict, name, view);
    Py_XDECREF(view);
    return failed ? -1 : 0;
}

static PyObject *views(module_state *state, PyObject *owner, const brio_diagram2 *d) {
    PyObject *dict = PyDict_New();
    if (!dict) return NULL;
    if (put(dict, "vertices", array_new(state, owner, layout_of(d->vertices, 'd', d->num_vertices, 2))) ||
        put(dict, "triangle_vertex",
            array_new(state, owner, layout_of(d->triangle_vertex, 'I', d->num_triangles, 0))) ||
        put(dict, "offsets", array_new(state, owner, layout_of(d->offsets, 'L', d->num_points + 1, 0))) ||
        put(dict, "items", array_new(state, owner, layout_of(d->items, 'i', d->offsets[d->num_points], 0))))
        Py_CLEAR(dict);
    return dict;
}

/* voronoi2(t, points, weights): a dict of arrays. */
static PyObject *voronoi2(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *owner = NULL, *result = NULL;
    input p, w = {.held = 0};
    brio_diagram2 *made = NULL;
    call c;
    module_state *state = state_of(module);
    if (!PyArg_ParseTuple(args, "OOO", &object, &points, &weights)) return NULL;
    const brio_triangulation2 *t = handle_object(state, object, KIND_TRIANGULATION2);
    if (!t || input_borrow(&p, points, "points", 'd', 2)) return NULL;
    if (!input_borrow_weights(&w, weights, p.rows) && !call_begin(&c, state, 1, Py_None)) {
        brio_status status;
        CALL(c, status, brio_voronoi2(c.ctx, t, p.data, w.data, p.rows, &made));
        owner = call_end_with(&c, status, KIND_DIAGRAM2, made, free_diagram2, NULL);
    }
    input_close(&p);
    input_close(&w);
    if (owner) result = views(state, owner, made);
    Py_XDECREF(owner);
    return result;
}

PyMethodDef dual_methods[] = {
    {"voronoi2", voronoi2, METH_VARARGS, "voronoi2(t, points, weights): a dict of arrays."},
    {NULL, NULL, 0, NULL},
};
