/* Location in the plane: a walk from a triangle near the query.
 *
 * A square of the grid keeps a triangle that has a vertex in it, so that a walk takes a few steps where points are spread
 * evenly. The visibility walk enters no triangle twice in a regular triangulation; one that takes more steps than there
 * are triangles is lost, because the points are others than those that were triangulated.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002; Shewchuk. Adaptive precision
 * floating-point arithmetic and fast robust geometric predicates. DCG 1997, for the bound of the filter. */
#include "plane.h"
#include <math.h>
#include <string.h>

int plane_turn(const double *a, const double *b, const double *c) {
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), det = left - right;
    double bound = 3.3306690738754716e-16 * (fabs(left) + fabs(right)) + 1e-300; /* (3 + 16 eps) eps, and underflow */
    if (det > bound) return 1;
    if (det < -bound) return -1;
    return brio_orient2d(a, b, c);
}

/* --- the grid --- */

static size_t square_of(const plane_locator *l, const double *x) {
    size_t at[2];
    for (int k = 0; k < 2; k++) {
        double place = (x[k] - l->low[k]) * l->scale[k];
        at[k] = !(place > 0) ? 0 : place < (double)l->side ? (size_t)place : l->side - 1;
    }
    return at[1] * l->side + at[0];
}

static void measure(plane_locator *l) {
    double high[2] = {-INFINITY, -INFINITY};
    l->low[0] = l->low[1] = INFINITY;
    for (size_t p = 0; p < 2 * l->points; p++) {
        l->low[p & 1] = fmin(l->low[p & 1], l->xy[p]);
        high[p & 1] = fmax(high[p & 1], l->xy[p]);
    }
    for (int k = 0; k < 2; k++) {
        double length = high[k] - l->low[k], scale = (double)l->side / length;
        l->scale[k] = length > 0 && scale < INFINITY ? scale : 0;
    }
}

static void fill_grid(plane_locator *l) {
    size_t squares = l->side * l->side;
    for (size_t s = 0; s < squares; s++) l->start[s] = UINT32_MAX;
    for (size_t t = l->count; t-- > 0;) l->start[square_of(l, plane_corner(l, (uint32_t)t, 0))] = (uint32_t)t;
    uint32_t last = 0;
    for (size_t s = 0; s < squares; s++) {
        if (l->start[s] == UINT32_MAX) l->start[s] = last;
        last = l->start[s];
    }
}

static void locator2_free(void *object) {
    plane_locator *l = object;
    free(l->xy);
    free(l->start);
    free(l);
}

static plane_locator *locator2_new(const brio_triangulation2 *t, const double *xy) {
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    plane_locator *l = calloc(1, sizeof *l);
    if (!l) return NULL;
    l->triangles = brio_triangulation2_triangles(t);
    l->count = s->triangles, l->hull = s->hull_edges, l->points = s->points;
    l->side = 1 + (size_t)sqrt((double)l->count / 4);
    l->xy = malloc(2 * sizeof *xy * (l->points + 1));
    l->start = malloc(l->side * l->side * sizeof *l->start);
    if (!l->xy || !l->start) {
        locator2_free(l);
        return NULL;
    }
    memcpy(l->xy, xy, 2 * sizeof *xy * l->points);
    measure(l);
    fill_grid(l);
    return l;
}

/* locator2(t, points, weights): the locator reads the triangles of t, which it keeps. */
static PyObject *locator2(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights;
    input p, w = {.held = 0};
    call c;
    if (!PyArg_ParseTuple(args, "OOO", &object, &points, &weights)) return NULL;
    const brio_triangulation2 *t = handle_object(state_of(module), object, KIND_TRIANGULATION2);
    if (!t || input_open(&p, points, "points", 'd', 2)) return NULL;
    PyObject *result = NULL;
    if (!input_has_rows(&p, "points", brio_triangulation2_stats(t)->points) &&
        !input_open_weights(&w, weights, p.rows) && !handle_has_points(state_of(module), object, &p, &w) &&
        !call_begin(&c, state_of(module), 1, Py_None)) {
        plane_locator *l = locator2_new(t, p.data);
        if (!l) PyErr_NoMemory();
        result = call_end_with(&c, BRIO_OK, KIND_LOCATOR2, l, locator2_free, object);
    }
    input_close(&p);
    input_close(&w);
    return result;
}

/* --- the walk --- */

/* Walks to a finite triangle whose closure holds x, and stores the signs of x beside its edges. */
static int32_t walk(const plane_locator *l, const double *x, int turns[3]) {
    uint32_t t = l->start[square_of(l, x)];
    for (size_t steps = 0; steps <= l->count + l->hull; steps++) {
        int out = -1;
        for (int i = 0; i < 3 && out < 0; i++) {
            turns[i] = plane_turn(plane_corner(l, t, slot_after(i)), plane_corner(l, t, slot_before(i)), x);
            if (turns[i] < 0) out = i;
        }
        if (out < 0) return (int32_t)t;
        t = l->triangles[t].mate[out] >> 2;
        if (t >= l->count) return NO_TRIANGLE;
    }
    return LOST;
}

/* The lowest index of the triangles round the vertex in slot i of t: first one way round, then, from the hull, the other. */
static uint32_t lowest_at_vertex(const plane_locator *l, uint32_t t, int i) {
    uint32_t lowest = t, vertex = l->triangles[t].vertex[i];
    for (int way = 0; way < 2; way++) {
        uint32_t at = t;
        int slot = i;
        for (size_t steps = 0; steps <= l->count; steps++) {
            at = l->triangles[at].mate[way ? slot_before(slot) : slot_after(slot)] >> 2;
            if (at >= l->count) break;
            if (at == t) return lowest;
            for (slot = 0; slot < 2 && l->triangles[at].vertex[slot] != vertex;) slot++;
            lowest = at < lowest ? at : lowest;
        }
    }
    return lowest;
}

int32_t plane_find(const plane_locator *l, const double *x) {
    int turns[3];
    if (!l->count) return NO_TRIANGLE;
    int32_t found = walk(l, x, turns);
    if (found < 0) return found;
    uint32_t t = (uint32_t)found, other;
    for (int i = 0; i < 3; i++) {
        if (turns[i]) continue;
        if (!turns[slot_after(i)]) return (int32_t)lowest_at_vertex(l, t, slot_before(i));
        if (!turns[slot_before(i)]) return (int32_t)lowest_at_vertex(l, t, slot_after(i));
        other = l->triangles[t].mate[i] >> 2;
        return (int32_t)(other < t ? other : t);
    }
    return found;
}

/* --- queries --- */

static brio_status find_all(call *c, const plane_locator *l, const input *q, int32_t *out) {
    const double *x = q->view.buf;
    for (size_t i = 0; i < q->rows; i++) {
        if (i % 1024 == 0 && call_look(c, "locate", (double)i / (double)q->rows)) return BRIO_ERR_CANCELLED;
        out[i] = plane_find(l, x + 2 * i);
        if (out[i] == LOST) return BRIO_ERR_CHECK;
    }
    return BRIO_OK;
}

const char *plane_sentence(brio_status status) {
    return status == BRIO_ERR_CHECK ? "the points are not those of the triangulation: were they changed?"
                                    : brio_status_string(status);
}

/* locate2(locator, queries, out, progress) */
static PyObject *locate2(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *array, *progress;
    input q, out;
    call c;
    int failed = -1;
    if (!PyArg_ParseTuple(args, "OOOO", &object, &queries, &array, &progress)) return NULL;
    const plane_locator *l = handle_object(state_of(module), object, KIND_LOCATOR2);
    if (!l || input_open(&q, queries, "queries", 'd', 2)) return NULL;
    if (output_open(&out, array, "out", 'i', 0)) {
        input_close(&q);
        return NULL;
    }
    if (!input_has_rows(&out, "out", q.rows) && !call_begin(&c, state_of(module), 1, progress)) {
        brio_status status;
        CALL(c, status, find_all(&c, l, &q, out.data));
        failed = call_end_saying(&c, status, plane_sentence(status));
    }
    input_close(&q);
    input_close(&out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef plane_methods[] = {
    {"locator2", locator2, METH_VARARGS, "locator2(t, points, weights)"},
    {"locate2", locate2, METH_VARARGS, "locate2(locator, queries, out, progress)"},
    {"interpolate2", plane_interpolate, METH_VARARGS, "interpolate2(locator, queries, values, natural, out, progress)"},
    {NULL, NULL, 0, NULL},
};
