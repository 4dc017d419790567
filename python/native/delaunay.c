/* Triangulations of space and of the plane: building, views, checks, and what scipy's arrays need. */
#include "native.h"

static void free_triangulation(void *t) {
    brio_triangulation_free(t);
}

static void free_triangulation2(void *t) {
    brio_triangulation2_free(t);
}

/* --- building --- */

/* Builds from points of `columns` coordinates; `flat` for points of a plane in space. */
static PyObject *build(PyObject *module, PyObject *args, int columns, int flat) {
    PyObject *points, *weights, *progress, *result = NULL;
    int threads;
    input p, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOiO", &points, &weights, &threads, &progress)) return NULL;
    if (input_borrow(&p, points, "points", 'd', columns)) return NULL;
    if (!input_borrow_weights(&w, weights, p.rows) && !call_begin(&c, state_of(module), threads, progress)) {
        brio_status status;
        if (columns == 3 && !flat) {
            brio_triangulation *t = NULL;
            CALL(c, status, brio_delaunay(c.ctx, p.data, w.data, p.rows, NULL, &t));
            result = call_end_with(&c, status, KIND_TRIANGULATION, t, free_triangulation, NULL);
        } else {
            brio_triangulation2 *t = NULL;
            CALL(c, status, (flat ? brio_delaunay2_flat : brio_delaunay2)(c.ctx, p.data, w.data, p.rows, NULL, &t));
            result = call_end_with(&c, status, KIND_TRIANGULATION2, t, free_triangulation2, NULL);
        }
    }
    input_close(&w);
    input_close(&p);
    return result;
}

static PyObject *delaunay(PyObject *module, PyObject *args) {
    return build(module, args, 3, 0);
}

static PyObject *delaunay2(PyObject *module, PyObject *args) {
    return build(module, args, 2, 0);
}

static PyObject *delaunay2_flat(PyObject *module, PyObject *args) {
    return build(module, args, 3, 1);
}

/* --- what is known of a triangulation, of either kind --- */

/* A triangulation as arrays of numbers: `vertices` vertices and as many mates a simplex. */
typedef struct {
    const brio_delaunay_stats *space; /* one of the two is NULL */
    const brio_delaunay2_stats *plane;
    const uint32_t *numbers, *representatives;
    size_t points, simplices, hull;
    uint32_t vertices;
} facts;

static int look_at(module_state *state, PyObject *object, facts *out) {
    handle *h = (handle *)object;
    *out = (facts){0};
    if (Py_TYPE(object) == state->handle_type && h->kind == KIND_TRIANGULATION2) {
        const brio_triangulation2 *t = h->record->object;
        const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
        *out = (facts){NULL,
                       s,
                       (const uint32_t *)brio_triangulation2_triangles(t),
                       brio_triangulation2_representatives(t),
                       s->points,
                       s->triangles,
                       s->hull_edges,
                       3};
        return 0;
    }
    const brio_triangulation *t = handle_object(state, object, KIND_TRIANGULATION);
    if (!t) return -1;
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    *out = (facts){s,
                   NULL,
                   (const uint32_t *)brio_triangulation_tetrahedra(t),
                   brio_triangulation_representatives(t),
                   s->points,
                   s->tetrahedra,
                   s->hull_facets,
                   4};
    return 0;
}

static PyObject *triangulation_facts(PyObject *module, PyObject *object) {
    facts f;
    if (look_at(state_of(module), object, &f)) return NULL;
    const brio_delaunay_stats *s = f.space;
    const brio_delaunay2_stats *p = f.plane;
#define FACT(name) (Py_ssize_t)(s ? s->name : p->name)
    return Py_BuildValue("{s:n,s:n,s:n,s:n,s:i,s:n,s:n}", "points", FACT(points), "vertices", FACT(vertices),
                         "duplicates", FACT(duplicates), "hidden", FACT(hidden), "dimension",
                         s ? s->dimension : p->dimension, "simplices", (Py_ssize_t)f.simplices, "hull",
                         (Py_ssize_t)f.hull);
#undef FACT
}

/* Views of the finite simplices' vertices (part 0) and mates (1), of the infinite simplices' vertices (2) and mates (3),
 * and the representatives (4). */
static PyObject *triangulation_view(PyObject *module, PyObject *args) {
    PyObject *object;
    int part;
    facts f;
    if (!PyArg_ParseTuple(args, "Oi", &object, &part) || look_at(state_of(module), object, &f)) return NULL;
    if (part == 4) return array_new(state_of(module), object, layout_of(f.representatives, 'I', f.points, 0));
    const uint32_t *first = f.numbers + (part & 1 ? f.vertices : 0) + (part & 2 ? 2 * f.vertices * f.simplices : 0);
    layout shown =
        layout_of(f.numbers ? first : NULL, part & 1 ? 'I' : 'i', part & 2 ? f.hull : f.simplices, f.vertices);
    shown.strides[0] *= 2; /* a simplex: vertices, then mates */
    return array_new(state_of(module), object, shown);
}

/* Writes the simplex beyond each facet, -1 at the hull. */
static PyObject *triangulation_neighbors(PyObject *module, PyObject *args) {
    PyObject *object, *array;
    facts f;
    input out;
    if (!PyArg_ParseTuple(args, "OO", &object, &array) || look_at(state_of(module), object, &f)) return NULL;
    if (output_open(&out, array, "out", 'i', (int)f.vertices)) return NULL;
    int wrong = input_has_rows(&out, "out", f.simplices);
    int32_t *to = out.data;
    for (size_t t = 0; !wrong && t < f.simplices; t++)
        for (uint32_t i = 0; i < f.vertices; i++) {
            uint32_t mate = f.numbers[(2 * t + 1) * f.vertices + i] >> 2;
            *to++ = mate < f.simplices ? (int32_t)mate : -1;
        }
    input_close(&out);
    if (wrong) return NULL;
    Py_RETURN_NONE;
}

/* Writes for each point the first simplex that has it, -1 for points that are no vertices. */
static PyObject *triangulation_vertex_simplices(PyObject *module, PyObject *args) {
    PyObject *object, *array;
    facts f;
    input out;
    if (!PyArg_ParseTuple(args, "OO", &object, &array) || look_at(state_of(module), object, &f)) return NULL;
    if (output_open(&out, array, "out", 'i', 0)) return NULL;
    int wrong = input_has_rows(&out, "out", f.points);
    int32_t *to = out.data;
    for (size_t p = 0; !wrong && p < f.points; p++) to[p] = -1;
    for (size_t t = wrong ? 0 : f.simplices; t-- > 0;)
        for (uint32_t i = 0; i < f.vertices; i++) to[f.numbers[2 * t * f.vertices + i]] = (int32_t)t;
    input_close(&out);
    if (wrong) return NULL;
    Py_RETURN_NONE;
}

/* The vertices of points on a line, in their order; of other inputs, nothing. */
static PyObject *triangulation_line(PyObject *module, PyObject *object) {
    size_t count = 0;
    const brio_triangulation2 *t = handle_object(state_of(module), object, KIND_TRIANGULATION2);
    if (!t) return NULL;
    const uint32_t *line = brio_triangulation2_line(t, &count);
    return array_new(state_of(module), object, layout_of(line, 'I', count, 0));
}

/* --- checks --- */

typedef struct {
    facts f;
    const void *t;
    input points, weights;
    call c;
} check;

/* Reads (handle, points, weights, threads, progress) and begins a call. Returns 0 or -1 with an exception set. */
static int check_begin(check *k, PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *progress;
    int threads;
    if (!PyArg_ParseTuple(args, "OOOiO", &object, &points, &weights, &threads, &progress)) return -1;
    if (look_at(state_of(module), object, &k->f)) return -1;
    k->t = ((handle *)object)->record->object;
    k->weights = (input){.held = 0};
    if (input_open(&k->points, points, "points", 'd', k->f.plane ? k->f.plane->coordinates : 3)) return -1;
    if (!input_has_rows(&k->points, "points", k->f.points) && !input_open_weights(&k->weights, weights, k->f.points) &&
        !handle_has_points(state_of(module), object, &k->points, &k->weights) &&
        !call_begin(&k->c, state_of(module), threads, progress))
        return 0;
    input_close(&k->points);
    input_close(&k->weights);
    return -1;
}

static int check_end(check *k, brio_status status) {
    input_close(&k->points);
    input_close(&k->weights);
    return call_end(&k->c, status);
}

static PyObject *triangulation_verify(PyObject *module, PyObject *args) {
    check k;
    brio_status status;
    if (check_begin(&k, module, args)) return NULL;
    const double *p = k.points.data, *w = k.weights.data;
    CALL(k.c, status,
         k.f.plane ? brio_triangulation2_check(k.c.ctx, k.t, p, w, k.f.points)
                   : brio_triangulation_check(k.c.ctx, k.t, p, w, k.f.points));
    if (check_end(&k, status)) return NULL;
    Py_RETURN_NONE;
}

static PyObject *triangulation_checksum(PyObject *module, PyObject *args) {
    check k;
    brio_status status;
    uint64_t sum = 0;
    if (check_begin(&k, module, args)) return NULL;
    const double *p = k.points.data;
    CALL(k.c, status,
         k.f.plane ? brio_triangulation2_checksum(k.c.ctx, k.t, p, &sum)
                   : brio_triangulation_checksum(k.c.ctx, k.t, p, &sum));
    if (check_end(&k, status)) return NULL;
    return PyLong_FromUnsignedLongLong(sum);
}

/* triangulation_has_points(t, points, weights): raises an error if t was made of others. */
static PyObject *triangulation_has_points(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights;
    facts f;
    input p, w = {.held = 0};
    int wrong = -1;
    if (!PyArg_ParseTuple(args, "OOO", &object, &points, &weights) || look_at(state_of(module), object, &f))
        return NULL;
    if (input_borrow(&p, points, "points", 'd', f.plane ? f.plane->coordinates : 3)) return NULL;
    if (!input_borrow_weights(&w, weights, p.rows)) wrong = handle_has_points(state_of(module), object, &p, &w);
    input_close(&w);
    input_close(&p);
    if (wrong) return NULL;
    Py_RETURN_NONE;
}

/* --- neighbourhoods --- */

static void free_incidences(void *object) {
    brio_incidences_free(object);
    free(object);
}

/* Lists the neighbours of each vertex (what = 0) or the tetrahedra at it (1), of a triangulation of space: offsets and
 * items. */
static PyObject *triangulation_lists(PyObject *module, PyObject *args) {
    PyObject *object;
    int what;
    brio_status status;
    call c;
    module_state *state = state_of(module);
    if (!PyArg_ParseTuple(args, "Oi", &object, &what)) return NULL;
    const brio_triangulation *t = handle_object(state, object, KIND_TRIANGULATION);
    brio_incidences *lists = t ? calloc(1, sizeof *lists) : NULL;
    if (t && !lists) PyErr_NoMemory();
    if (!lists || call_begin(&c, state, 1, Py_None)) {
        free(lists);
        return NULL;
    }
    CALL(c, status, (what ? brio_triangulation_incident_tetrahedra : brio_triangulation_neighbours)(c.ctx, t, lists));
    PyObject *owner = call_end_with(&c, status, KIND_INCIDENCES, lists, free_incidences, NULL);
    if (!owner) return NULL;
    size_t items = lists->offsets ? lists->offsets[lists->count] : 0;
    PyObject *result =
        Py_BuildValue("(NN)", array_new(state, owner, layout_of(lists->offsets, 'L', lists->count + 1, 0)),
                      array_new(state, owner, layout_of(lists->items, 'i', items, 0)));
    Py_DECREF(owner);
    return result;
}

PyMethodDef delaunay_methods[] = {
    {"delaunay", delaunay, METH_VARARGS, "delaunay(points, weights, threads, progress): triangulates #P by 3 points."},
    {"delaunay2", delaunay2, METH_VARARGS,
     "delaunay2(points, weights, threads, progress): triangulates #P by 2 points."},
    {"delaunay2_flat", delaunay2_flat, METH_VARARGS, "As delaunay2, of #P by 3 points in one plane."},
    {"triangulation_facts", triangulation_facts, METH_O, "Counts, in a dict."},
    {"triangulation_view", triangulation_view, METH_VARARGS, "triangulation_view(t, part): a view of its numbers."},
    {"triangulation_neighbors", triangulation_neighbors, METH_VARARGS, "triangulation_neighbors(t, out)"},
    {"triangulation_vertex_simplices", triangulation_vertex_simplices, METH_VARARGS,
     "triangulation_vertex_simplices(t, out)"},
    {"triangulation_line", triangulation_line, METH_O, "The vertices of points on a line."},
    {"triangulation_verify", triangulation_verify, METH_VARARGS,
     "triangulation_verify(t, points, weights, threads, progress): checks exactly."},
    {"triangulation_has_points", triangulation_has_points, METH_VARARGS,
     "triangulation_has_points(t, points, weights): raises an error if t was made of others."},
    {"triangulation_checksum", triangulation_checksum, METH_VARARGS,
     "triangulation_checksum(t, points, weights, threads, progress)"},
    {"triangulation_lists", triangulation_lists, METH_VARARGS, "triangulation_lists(t, what): offsets and items."},
    {NULL, NULL, 0, NULL},
};
