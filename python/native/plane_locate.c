/* Queries of triangulations of the plane, by the library's locators. */
#include "native.h"

static void free_locator2(void *locator) {
    brio_locator2_free(locator);
}

/* locator2(t, points, weights): the locator keeps the handle of t, which knows the number of points. */
static PyObject *locator2(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *result = NULL;
    input p, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOO", &object, &points, &weights)) return NULL;
    const brio_triangulation2 *t = handle_object(state_of(module), object, KIND_TRIANGULATION2);
    if (!t || input_borrow(&p, points, "points", 'd', 2)) return NULL;
    if (!input_borrow_weights(&w, weights, p.rows) && !call_begin(&c, state_of(module), 1, Py_None)) {
        brio_locator2 *l = NULL;
        brio_status status;
        CALL(c, status, brio_locator2_new(c.ctx, t, p.data, w.data, p.rows, &l));
        result = call_end_with(&c, status, KIND_LOCATOR2, l, free_locator2, object);
    }
    input_close(&p);
    input_close(&w);
    return result;
}

/* locate2(locator, queries, out, progress) */
static PyObject *locate2(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *array, *progress;
    input q, out;
    call c;
    int failed = -1;
    if (!PyArg_ParseTuple(args, "OOOO", &object, &queries, &array, &progress)) return NULL;
    const brio_locator2 *l = handle_object(state_of(module), object, KIND_LOCATOR2);
    if (!l || input_borrow(&q, queries, "queries", 'd', 2)) return NULL;
    if (output_open(&out, array, "out", 'i', 0)) {
        input_close(&q);
        return NULL;
    }
    if (!input_has_rows(&out, "out", q.rows) && !call_begin(&c, state_of(module), 1, progress)) {
        brio_status status;
        CALL(c, status, brio_locator2_triangles(c.ctx, l, q.data, q.rows, out.data));
        failed = call_end(&c, status);
    }
    input_close(&q);
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

/* The arrays of an interpolation. */
typedef struct {
    input queries, values, out;
} interpolation_arrays;

static int run(module_state *state, const brio_locator2 *l, interpolation_arrays *a, int natural, PyObject *progress) {
    call c;
    brio_status status;
    brio_interpolation options = {0};
    if (call_begin(&c, state, 1, progress)) return -1;
    options.method = natural ? BRIO_INTERPOLATION_NATURAL : BRIO_INTERPOLATION_LINEAR;
    options.values = a->values.data;
    options.components = a->values.columns;
    CALL(c, status, brio_locator2_interpolate(c.ctx, l, a->queries.data, a->queries.rows, &options, a->out.data));
    return call_end(&c, status);
}

static size_t points_of(PyObject *locator) {
    const handle *t = (const handle *)((const handle *)locator)->base;
    return brio_triangulation2_stats(t->record->object)->points;
}

/* interpolate2(locator, queries, values, natural, out, progress) */
static PyObject *interpolate2(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *values, *array, *progress;
    int natural, failed = -1;
    interpolation_arrays a = {{.held = 0}, {.held = 0}, {.held = 0}};
    if (!PyArg_ParseTuple(args, "OOOiOO", &object, &queries, &values, &natural, &array, &progress)) return NULL;
    const brio_locator2 *l = handle_object(state_of(module), object, KIND_LOCATOR2);
    if (l && !input_borrow(&a.queries, queries, "queries", 'd', 2) &&
        !input_open(&a.values, values, "values", 'd', -1) &&
        !output_open(&a.out, array, "out", 'd', (int)a.values.columns) &&
        !input_has_rows(&a.out, "out", a.queries.rows) && !input_has_rows(&a.values, "values", points_of(object)))
        failed = run(state_of(module), l, &a, natural, progress);
    input_close(&a.queries);
    input_close(&a.values);
    input_close(&a.out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef plane_methods[] = {
    {"locator2", locator2, METH_VARARGS, "locator2(t, points, weights)"},
    {"locate2", locate2, METH_VARARGS, "locate2(locator, queries, out, progress)"},
    {"interpolate2", interpolate2, METH_VARARGS, "interpolate2(locator, queries, values, natural, out, progress)"},
    {NULL, NULL, 0, NULL},
};
