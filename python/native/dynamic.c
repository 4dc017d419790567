/* Triangulations that live, in open space or in space that repeats. Each has its own context, since its calls work with the context that made it; one call at
 * a time uses it. */
#include "native.h"
#include <string.h>

typedef struct {
    brio_context *ctx;
    brio_dynamic *d;
    brio_dynamic_periodic *wrapped; /* in space that repeats; then d is NULL */
    int busy;                       /* a call uses it; atomic */
} living;

static void free_living(void *object) {
    living *l = object;
    brio_dynamic_free(l->d);
    brio_dynamic_periodic_free(l->wrapped);
    brio_context_free(l->ctx);
    free(l);
}

/* Returns the object for a call that it alone has until `leave`, or NULL with an exception set. */
static living *enter(PyObject *module, PyObject *object) {
    living *l = handle_object(state_of(module), object, KIND_DYNAMIC);
    if (l && __atomic_exchange_n(&l->busy, 1, __ATOMIC_ACQUIRE)) {
        PyErr_SetString(PyExc_RuntimeError, "another thread is in a call of this triangulation");
        return NULL;
    }
    return l;
}

static void leave(living *l) {
    __atomic_store_n(&l->busy, 0, __ATOMIC_RELEASE);
}

/* dynamic_new(weighted): one without points. */
static PyObject *dynamic_new(PyObject *module, PyObject *args) {
    int weighted;
    call c;
    if (!PyArg_ParseTuple(args, "i", &weighted) || call_begin(&c, state_of(module), 0, Py_None)) return NULL;
    living *l = calloc(1, sizeof *l);
    brio_status status = l ? brio_context_new(NULL, &l->ctx) : BRIO_ERR_NO_MEMORY;
    if (status == BRIO_OK) CALL(c, status, brio_dynamic_new(l->ctx, NULL, NULL, 0, weighted, &l->d));
    if (status != BRIO_OK && l) {
        free_living(l);
        l = NULL;
    }
    return call_end_with(&c, status, KIND_DYNAMIC, l, free_living, NULL);
}

/* dynamic_new_periodic(points, weights, weighted, cell, open, reach, threads, progress): one in space that repeats. */
static PyObject *dynamic_new_periodic(PyObject *module, PyObject *args) {
    PyObject *points, *weights, *cell, *progress, *result = NULL;
    int threads;
    brio_periodic_options o = {.size = sizeof o};
    input p = {.held = 0}, w = {.held = 0}, m = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOiO(iii)diO", &points, &weights, &o.weighted, &cell, &o.open[0], &o.open[1],
                          &o.open[2], &o.reach, &threads, &progress))
        return NULL;
    living *l = calloc(1, sizeof *l);
    if (!l || brio_context_new(NULL, &l->ctx) != BRIO_OK) {
        free(l);
        return PyErr_NoMemory();
    }
    if (!input_open(&p, points, "points", 'd', 3) && !input_open_weights(&w, weights, p.rows) &&
        !input_open(&m, cell, "cell", 'd', 3) && !input_has_rows(&m, "cell", 3) &&
        !call_begin_in(&c, state_of(module), l->ctx, threads, progress)) {
        brio_status status;
        o.cell = m.data;
        CALL(c, status, brio_dynamic_periodic_new(l->ctx, p.data, w.data, p.rows, &o, &l->wrapped));
        if (!call_end(&c, status) && !call_begin(&c, state_of(module), 0, Py_None)) {
            result = call_end_with(&c, BRIO_OK, KIND_DYNAMIC, l, free_living, NULL);
            l = NULL; /* the handle has it, or it is freed */
        }
    }
    if (l) free_living(l);
    input_close(&m);
    input_close(&w);
    input_close(&p);
    return result;
}

/* dynamic_insert(object, points, weights, threads, progress): the index of the first. */
static PyObject *dynamic_insert(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *progress;
    int threads, failed = -1;
    uint32_t first = 0;
    input p, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &weights, &threads, &progress)) return NULL;
    living *l = enter(module, object);
    if (!l) return NULL;
    if (!input_open(&p, points, "points", 'd', 3)) {
        if (!input_open_weights(&w, weights, p.rows) &&
            !call_begin_in(&c, state_of(module), l->ctx, threads, progress)) {
            brio_status status;
            CALL(c, status,
                 l->wrapped ? brio_dynamic_periodic_insert(l->wrapped, p.data, w.data, p.rows, &first)
                            : brio_dynamic_insert(l->d, p.data, w.data, p.rows, &first));
            failed = call_end(&c, status);
        }
        input_close(&w);
        input_close(&p);
    }
    leave(l);
    return failed ? NULL : PyLong_FromUnsignedLong(first);
}

static brio_status change(living *l, const uint32_t *indices, const double *points, const double *weights,
                          size_t rows) {
    if (l->wrapped)
        return points    ? brio_dynamic_periodic_move(l->wrapped, indices, points, weights, rows)
               : weights ? brio_dynamic_periodic_reweight(l->wrapped, indices, weights, rows)
                         : brio_dynamic_periodic_remove(l->wrapped, indices, rows);
    return points    ? brio_dynamic_move(l->d, indices, points, weights, rows)
           : weights ? brio_dynamic_reweight(l->d, indices, weights, rows)
                     : brio_dynamic_remove(l->d, indices, rows);
}

/* dynamic_change(object, indices, points, weights, threads, progress): removes the points of these indices where points
 * and weights are None; else moves or reweights them. indices None: all. */
static PyObject *dynamic_change(PyObject *module, PyObject *args) {
    PyObject *object, *indices, *points, *weights, *progress;
    int threads, failed = -1;
    input i = {.held = 0}, p = {.held = 0}, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOOOiO", &object, &indices, &points, &weights, &threads, &progress)) return NULL;
    living *l = enter(module, object);
    if (!l) return NULL;
    int opened = indices == Py_None || !input_open(&i, indices, "indices", 'I', 0);
    opened = opened && (points == Py_None || !input_open(&p, points, "points", 'd', 3));
    size_t rows = indices != Py_None ? i.rows : p.rows;
    opened = opened && (points == Py_None || !input_has_rows(&p, "points", rows));
    opened = opened && !input_open_weights(&w, weights, rows);
    if (opened && !call_begin_in(&c, state_of(module), l->ctx, threads, progress)) {
        brio_status status;
        CALL(c, status,
             change(l, indices == Py_None ? NULL : i.data, points == Py_None ? NULL : p.data,
                    weights == Py_None ? NULL : w.data, rows));
        failed = call_end(&c, status);
    }
    input_close(&i);
    input_close(&p);
    input_close(&w);
    leave(l);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

static PyObject *wrapped_facts(const living *l) {
    brio_dynamic_periodic_stats s = {.size = sizeof s};
    brio_dynamic_periodic_facts(l->wrapped, &s);
    const double *c = s.cell;
    return Py_BuildValue("{s:n,s:n,s:n,s:i,s:i,s:d,s:d,s:d,s:d,s:K,s:K,s:K,s:K,s:(ddddddddd)}", "indices",
                         (Py_ssize_t)s.indices, "points", (Py_ssize_t)s.points, "translates", (Py_ssize_t)s.translates,
                         "directions", s.directions, "dimension", s.dimension, "cell_volume", s.cell_volume,
                         "cell_moved", s.cell_moved, "moved", s.moved, "reach", s.reach, "in_place",
                         (unsigned long long)s.in_place, "replaced", (unsigned long long)s.replaced, "anew",
                         (unsigned long long)s.anew, "snapshots", (unsigned long long)s.snapshots, "cell", c[0], c[1],
                         c[2], c[3], c[4], c[5], c[6], c[7], c[8]);
}

static PyObject *dynamic_facts(PyObject *module, PyObject *object) {
    living *l = enter(module, object);
    if (!l) return NULL;
    if (l->wrapped) {
        PyObject *facts = wrapped_facts(l);
        leave(l);
        return facts;
    }
    brio_dynamic_stats s = {.size = sizeof s};
    brio_dynamic_facts(l->d, &s);
    leave(l);
    return Py_BuildValue("{s:n,s:n,s:n,s:n,s:n,s:i,s:K,s:K,s:K}", "indices", (Py_ssize_t)s.indices, "points",
                         (Py_ssize_t)s.points, "vertices", (Py_ssize_t)s.vertices, "simplices",
                         (Py_ssize_t)s.tetrahedra, "hull", (Py_ssize_t)s.hull_facets, "dimension", s.dimension,
                         "in_place", (unsigned long long)s.in_place, "replaced", (unsigned long long)s.replaced, "anew",
                         (unsigned long long)s.anew);
}

static size_t count_points(const living *l) {
    brio_dynamic_stats s = {.size = sizeof s};
    brio_dynamic_periodic_stats p = {.size = sizeof p};
    if (l->wrapped)
        brio_dynamic_periodic_facts(l->wrapped, &p);
    else
        brio_dynamic_facts(l->d, &s);
    return s.points + p.points;
}

/* Returns the indices, points and weights, each a bytearray, as they are now. */
static PyObject *copy_points(const living *l) {
    const Py_ssize_t count = (Py_ssize_t)count_points(l),
                     size[3] = {sizeof(uint32_t), 3 * sizeof(double), sizeof(double)};
    PyObject *rows[3] = {NULL}, *result = NULL;
    for (int k = 0; k < 3; k++)
        if (!(rows[k] = PyByteArray_FromStringAndSize(NULL, size[k] * count))) goto done;
    uint32_t *indices = (uint32_t *)PyByteArray_AsString(rows[0]);
    double *points = (double *)PyByteArray_AsString(rows[1]), *weights = (double *)PyByteArray_AsString(rows[2]);
    if (l->wrapped)
        brio_dynamic_periodic_points(l->wrapped, indices, points, weights);
    else
        brio_dynamic_points(l->d, indices, points, weights);
    result = PyTuple_Pack(3, rows[0], rows[1], rows[2]);
done:
    for (int k = 0; k < 3; k++) Py_XDECREF(rows[k]);
    return result;
}

/* dynamic_points(object): its indices, points and weights as bytearrays of one moment. */
static PyObject *dynamic_points(PyObject *module, PyObject *object) {
    living *l = enter(module, object);
    if (!l) return NULL;
    PyObject *result = copy_points(l);
    leave(l);
    return result;
}

/* dynamic_neighbors(object, index): a bytes object of numbers of 32 bits; in space that repeats four for each neighbour, its
 * point and its shift. */
static PyObject *dynamic_neighbors(PyObject *module, PyObject *args) {
    PyObject *object, *result = NULL;
    unsigned index;
    const uint32_t *neighbours = NULL;
    const brio_image *images = NULL;
    size_t count;
    call c;
    if (!PyArg_ParseTuple(args, "OI", &object, &index)) return NULL;
    living *l = enter(module, object);
    if (!l) return NULL;
    if (!call_begin_in(&c, state_of(module), l->ctx, 1, Py_None)) {
        brio_status status;
        CALL(c, status,
             l->wrapped ? brio_dynamic_periodic_neighbours(l->wrapped, index, &images, &count)
                        : brio_dynamic_neighbours(l->d, index, &neighbours, &count));
        if (!call_end(&c, status))
            result =
                PyBytes_FromStringAndSize(l->wrapped ? (const char *)images : (const char *)neighbours,
                                          (Py_ssize_t)(count * (l->wrapped ? sizeof *images : sizeof *neighbours)));
    }
    leave(l);
    return result;
}

/* dynamic_locate(object, queries, out): the four vertices for each query; in space that repeats each with a shift. */
static PyObject *dynamic_locate(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *array;
    input q = {.held = 0}, out = {.held = 0};
    int failed = -1;
    call c;
    if (!PyArg_ParseTuple(args, "OOO", &object, &queries, &array)) return NULL;
    living *l = enter(module, object);
    if (!l) return NULL;
    if (!input_open(&q, queries, "queries", 'd', 3) && !output_open(&out, array, "out", 'I', l->wrapped ? 16 : 4) &&
        !input_has_rows(&out, "out", q.rows) && !call_begin_in(&c, state_of(module), l->ctx, 1, Py_None)) {
        brio_status status = BRIO_OK;
        const double *x = q.data;
        uint32_t *v = out.data;
        brio_image image[4];
        for (size_t i = 0; i < q.rows && status == BRIO_OK; i++) {
            status = l->wrapped ? brio_dynamic_periodic_locate(l->wrapped, x + 3 * i, image)
                                : brio_dynamic_locate(l->d, x + 3 * i, v + 4 * i);
            if (l->wrapped) memcpy(v + 16 * i, image, sizeof image);
        }
        failed = call_end(&c, status);
    }
    input_close(&q);
    input_close(&out);
    leave(l);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

static void free_snapshot(void *t) {
    brio_triangulation_free(t);
}
static void free_wrapped_snapshot(void *t) {
    brio_periodic_free(t);
}

/* dynamic_snapshot(object, threads, progress): a triangulation of the points by ascending index; and the indices, points and
 * weights of the same moment. */
static PyObject *dynamic_snapshot(PyObject *module, PyObject *args) {
    PyObject *object, *progress, *result = NULL;
    int threads;
    brio_triangulation *t = NULL;
    brio_periodic *p = NULL;
    call c;
    if (!PyArg_ParseTuple(args, "OiO", &object, &threads, &progress)) return NULL;
    living *l = enter(module, object);
    if (!l) return NULL;
    if (!call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        CALL(c, status,
             l->wrapped ? brio_dynamic_periodic_snapshot(c.ctx, l->wrapped, &p)
                        : brio_dynamic_snapshot(c.ctx, l->d, &t));
        result = l->wrapped ? call_end_with(&c, status, KIND_PERIODIC, p, free_wrapped_snapshot, NULL)
                            : call_end_with(&c, status, KIND_TRIANGULATION, t, free_snapshot, NULL);
    }
    PyObject *points = result ? copy_points(l) : NULL;
    leave(l);
    if (points) return Py_BuildValue("NN", result, points);
    Py_XDECREF(result);
    return NULL;
}

PyMethodDef dynamic_methods[] = {
    {"dynamic_new", dynamic_new, METH_VARARGS, "dynamic_new(weighted)"},
    {"dynamic_new_periodic", dynamic_new_periodic, METH_VARARGS,
     "dynamic_new_periodic(points, weights, weighted, cell, open, reach, threads, progress)"},
    {"dynamic_insert", dynamic_insert, METH_VARARGS, "dynamic_insert(d, points, weights, threads, progress)"},
    {"dynamic_change", dynamic_change, METH_VARARGS, "dynamic_change(d, indices, points, weights, threads, progress)"},
    {"dynamic_facts", dynamic_facts, METH_O, "dynamic_facts(d)"},
    {"dynamic_points", dynamic_points, METH_O, "dynamic_points(d)"},
    {"dynamic_neighbors", dynamic_neighbors, METH_VARARGS, "dynamic_neighbors(d, index)"},
    {"dynamic_locate", dynamic_locate, METH_VARARGS, "dynamic_locate(d, queries, out)"},
    {"dynamic_snapshot", dynamic_snapshot, METH_VARARGS, "dynamic_snapshot(d, threads, progress)"},
    {NULL, NULL, 0, NULL},
};
