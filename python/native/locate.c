/* Queries of triangulations of space, by the library's locators. */
#include "native.h"

static void free_locator(void *locator) {
    brio_locator_free(locator);
}

static PyObject *locator(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *progress, *result = NULL;
    int threads;
    input p, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &weights, &threads, &progress)) return NULL;
    const brio_triangulation *t = handle_object(state_of(module), object, KIND_TRIANGULATION);
    if (!t || input_borrow(&p, points, "points", 'd', 3)) return NULL;
    if (!input_borrow_weights(&w, weights, p.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        brio_locator *l = NULL;
        brio_status status;
        CALL(c, status, brio_locator_new(c.ctx, t, p.data, w.data, p.rows, &l));
        result = call_end_with(&c, status, KIND_LOCATOR, l, free_locator, NULL);
    }
    input_close(&w);
    input_close(&p);
    return result;
}

typedef enum { FIND_SIMPLEX = 0, FIND_LEAST_POWER = 1, FIND_NEAREST = 2 } what_to_find;

/* locate(locator, queries, what, out, threads, progress): out has a number a query, or of FIND_NEAREST several. */
static PyObject *locate(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *array, *progress;
    int threads, what, failed = -1;
    input q, out;
    call c;
    if (!PyArg_ParseTuple(args, "OOiOiO", &object, &queries, &what, &array, &threads, &progress)) return NULL;
    const brio_locator *l = handle_object(state_of(module), object, KIND_LOCATOR);
    if (!l || input_borrow(&q, queries, "queries", 'd', 3)) return NULL;
    if (output_open(&out, array, "out", 'i', what == FIND_NEAREST ? -1 : 0)) {
        input_close(&q);
        return NULL;
    }
    if (!input_has_rows(&out, "out", q.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        CALL(c, status,
             what == FIND_NEAREST       ? brio_locator_nearest(c.ctx, l, q.data, q.rows, out.columns, out.data)
             : what == FIND_LEAST_POWER ? brio_locator_least_power(c.ctx, l, q.data, q.rows, out.data)
                                        : brio_locator_tetrahedra(c.ctx, l, q.data, q.rows, out.data));
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

static void close_arrays(interpolation_arrays *a) {
    input_close(&a->queries);
    input_close(&a->values);
    input_close(&a->out);
}

/* interpolate(locator, queries, values, method, points, out, threads, progress): values has `points` rows. */
static PyObject *interpolate(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *values, *array, *progress;
    int method, threads, failed = -1;
    Py_ssize_t points;
    interpolation_arrays a = {{.held = 0}, {.held = 0}, {.held = 0}};
    call c;
    if (!PyArg_ParseTuple(args, "OOOinOiO", &object, &queries, &values, &method, &points, &array, &threads, &progress))
        return NULL;
    const brio_locator *l = handle_object(state_of(module), object, KIND_LOCATOR);
    if (l && !input_borrow(&a.queries, queries, "queries", 'd', 3) &&
        !input_open(&a.values, values, "values", 'd', -1) &&
        !output_open(&a.out, array, "out", 'd', (int)a.values.columns) &&
        !input_has_rows(&a.out, "out", a.queries.rows) && !input_has_rows(&a.values, "values", (size_t)points) &&
        !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        brio_interpolation options = {0};
        options.method = (brio_interpolation_method)method;
        options.values = a.values.data;
        options.components = a.values.columns;
        CALL(c, status, brio_locator_interpolate(c.ctx, l, a.queries.data, a.queries.rows, &options, a.out.data));
        failed = call_end(&c, status);
    }
    close_arrays(&a);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef locate_methods[] = {
    {"locator", locator, METH_VARARGS, "locator(t, points, weights, threads, progress)"},
    {"locate", locate, METH_VARARGS, "locate(locator, queries, what, out, threads, progress)"},
    {"interpolate", interpolate, METH_VARARGS,
     "interpolate(locator, queries, values, method, points, out, threads, progress)"},
    {NULL, NULL, 0, NULL},
};
