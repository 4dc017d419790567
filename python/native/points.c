/* Points chosen among points, and for other positions the nearest points. */
#include "native.h"
#include <string.h>

/* A call (points, ..., out, threads, progress), where `out` has an element a point. */
typedef struct {
    input p, out;
    call c;
} point_call;

static int point_call_begin(point_call *k, PyObject *module, PyObject *points, PyObject *out, int threads,
                            PyObject *progress) {
    k->out = (input){.held = 0};
    if (input_open(&k->p, points, "points", 'd', 3)) return -1;
    if (!output_open(&k->out, out, "out", '?', 0) && !input_has_rows(&k->out, "out", k->p.rows) &&
        !call_begin(&k->c, state_of(module), threads, progress))
        return 0;
    input_close(&k->out);
    input_close(&k->p);
    return -1;
}

static PyObject *point_call_end(point_call *k, brio_status status) {
    input_close(&k->out);
    input_close(&k->p);
    if (call_end(&k->c, status)) return NULL;
    Py_RETURN_NONE;
}

/* thin(points, spacing, out, threads, progress): out is a mask of the chosen points. */
static PyObject *thin(PyObject *module, PyObject *args) {
    PyObject *points, *out, *progress;
    double spacing;
    int threads;
    point_call k;
    brio_status status;
    if (!PyArg_ParseTuple(args, "OdOiO", &points, &spacing, &out, &threads, &progress)) return NULL;
    if (point_call_begin(&k, module, points, out, threads, progress)) return NULL;
    CALL(k.c, status, brio_thin(k.c.ctx, k.p.data, k.p.rows, spacing, k.out.data, NULL));
    return point_call_end(&k, status);
}

/* outliers(points, neighbours, factor, out, threads, progress): out is a mask of the outliers. */
static PyObject *outliers(PyObject *module, PyObject *args) {
    PyObject *points, *out, *progress;
    brio_outliers_options o = {0};
    int neighbours, threads;
    point_call k;
    brio_status status;
    if (!PyArg_ParseTuple(args, "OidOiO", &points, &neighbours, &o.factor, &out, &threads, &progress)) return NULL;
    if (point_call_begin(&k, module, points, out, threads, progress)) return NULL;
    CALL(k.c, status, brio_outliers(k.c.ctx, k.p.data, k.p.rows, neighbours, &o, k.out.data));
    return point_call_end(&k, status);
}

/* --- the point nearest to each position --- */

/* Makes a mesh of the points, with their indices as the property that is carried. */
static brio_status numbered_points(brio_context *ctx, const input *p, brio_mesh **out) {
    void *data = NULL;
    brio_status status = brio_mesh_new(ctx, out);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(*out, p->data, p->rows);
    if (status == BRIO_OK) status = brio_mesh_add_property(*out, "index", BRIO_SCALAR_UINT32, &data);
    for (uint32_t *index = data, k = 0; status == BRIO_OK && k < p->rows; k++) index[k] = k;
    return status;
}

static brio_status find_nearest(brio_context *ctx, const input *points, const input *queries, uint32_t *out) {
    brio_mesh *from = NULL, *to = NULL;
    brio_status status = numbered_points(ctx, points, &from);
    if (status == BRIO_OK) status = brio_mesh_new(ctx, &to);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(to, queries->data, queries->rows);
    if (status == BRIO_OK) status = brio_mesh_carry_properties(ctx, from, NULL, to);
    if (status == BRIO_OK && queries->rows)
        memcpy(out, brio_mesh_property(to, "index")->data, queries->rows * sizeof *out);
    brio_mesh_free(from);
    brio_mesh_free(to);
    return status;
}

/* nearest(points, queries, out, threads, progress): out is the index of the point nearest to each query, as
 * brio_mesh_carry_properties chooses it. Python carries values of any type by it. */
static PyObject *nearest(PyObject *module, PyObject *args) {
    PyObject *points, *queries, *array, *progress;
    int threads, failed = -1;
    input p, q = {.held = 0}, out = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOiO", &points, &queries, &array, &threads, &progress)) return NULL;
    if (input_open(&p, points, "points", 'd', 3)) return NULL;
    if (!input_open(&q, queries, "queries", 'd', 3) && !output_open(&out, array, "out", 'I', 0) &&
        !input_has_rows(&out, "out", q.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        CALL(c, status, find_nearest(c.ctx, &p, &q, out.data));
        failed = call_end(&c, status);
    }
    input_close(&p);
    input_close(&q);
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef points_methods[] = {
    {"thin", thin, METH_VARARGS, "thin(points, spacing, out, threads, progress): out is a mask."},
    {"outliers", outliers, METH_VARARGS,
     "outliers(points, neighbours, factor, out, threads, progress): out is a mask."},
    {"nearest", nearest, METH_VARARGS, "nearest(points, queries, out, threads, progress): out is an index a query."},
    {NULL, NULL, 0, NULL},
};
