/* How much memory a call will take. */
#include "native.h"
#include <math.h>

/* What is to be done with the points. */
typedef struct {
    int method; /* a brio_surface_method; -1: a triangulation */
    brio_surface_options surface;
    brio_periodic_options periodic; /* of a cell that is not NULL */
} task;

static brio_status estimate_surface(brio_context *ctx, const input *p, const brio_surface_options *o, uint64_t *bytes) {
    static const double USUAL = 6.8; /* tetrahedra a point, which brio_estimate_surface assumes */
    uint64_t tetrahedra = 0;
    brio_status status = brio_estimate_tetrahedra(ctx, p->data, NULL, p->rows, &tetrahedra);
    if (status != BRIO_OK) return status;
    return brio_estimate_surface(ctx, (size_t)fmax((double)p->rows, (double)tetrahedra / USUAL), o, bytes);
}

static brio_status estimate(brio_context *ctx, const input *p, const input *w, const task *t, uint64_t *bytes) {
    if (t->method >= 0) return estimate_surface(ctx, p, &t->surface, bytes);
    if (t->periodic.cell) return brio_estimate_periodic(ctx, p->data, w->data, p->rows, &t->periodic, bytes);
    if (p->columns == 3) return brio_estimate_delaunay(ctx, p->data, w->data, p->rows, NULL, bytes);
    *bytes = brio_estimate_delaunay2(p->rows, w->data != NULL);
    return BRIO_OK;
}

/* estimate(points, weights, (method, polygons, simplify, pieces), cell or None, (open, open, open), threads, progress): bytes;
 * method -1 is a triangulation. */
static PyObject *estimate_memory(PyObject *module, PyObject *args) {
    PyObject *points, *weights, *cell, *progress;
    int threads, failed = -1;
    uint64_t bytes = 0;
    Py_ssize_t pieces;
    task t = {.surface = {.size = sizeof t.surface}, .periodic = {.size = sizeof t.periodic}};
    input p, w = {.held = 0}, m = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OO(iiin)O(iii)iO", &points, &weights, &t.method, &t.surface.polygons,
                          &t.surface.simplify, &pieces, &cell, &t.periodic.open[0], &t.periodic.open[1],
                          &t.periodic.open[2], &threads, &progress))
        return NULL;
    if (input_open(&p, points, "points", 'd', -1)) return NULL;
    int has_space = p.columns == 3 || (p.columns == 2 && t.method < 0 && cell == Py_None);
    if (!has_space)
        PyErr_SetString(PyExc_ValueError, "points: 3 columns are wanted");
    else if (!input_open_weights(&w, weights, p.rows) &&
             (cell == Py_None || (!input_open(&m, cell, "cell", 'd', 3) && !input_has_rows(&m, "cell", 3))) &&
             !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        t.surface.method = (brio_surface_method)t.method;
        t.surface.pieces = (size_t)pieces;
        t.periodic.cell = m.data;
        CALL(c, status, estimate(c.ctx, &p, &w, &t, &bytes));
        failed = call_end(&c, status);
    }
    input_close(&m);
    input_close(&w);
    input_close(&p);
    return failed ? NULL : PyLong_FromUnsignedLongLong(bytes);
}

PyMethodDef estimate_methods[] = {
    {"estimate", estimate_memory, METH_VARARGS,
     "estimate(points, weights, (method, polygons, simplify, pieces), cell, open, threads, progress): bytes."},
    {NULL, NULL, 0, NULL},
};
