/* The Voronoi or power diagram of points in the plane, as the dual of their triangulation: triangles with one circle
 * become one vertex, which is decided exactly, and the triangles round a point, in order, its region. */
#include "native.h"
#include <stdint.h>

typedef struct {
    const brio_triangle *triangles;
    size_t count, hull;
    const double *xy, *w; /* w: NULL without weights */
} diagram;

static uint32_t find_root(uint32_t *parent, uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
}

/* Whether the triangle beyond the edge opposite to slot i of t has the same circle. */
static int has_one_circle(const diagram *d, size_t t, uint32_t mate) {
    const uint32_t *v = d->triangles[t].vertex, other = d->triangles[mate >> 2].vertex[mate & 3];
    double weights[4];
    for (int i = 0; d->w && i < 4; i++) weights[i] = d->w[i < 3 ? v[i] : other];
    return !brio_incircle(d->xy + 2 * (size_t)v[0], d->xy + 2 * (size_t)v[1], d->xy + 2 * (size_t)v[2],
                          d->xy + 2 * (size_t)other, d->w ? weights : NULL);
}

/* Numbers the classes of triangles of one circle in the order of their first triangles. Returns how many there are. */
static uint32_t number_circles(const diagram *d, uint32_t *out) {
    uint32_t classes = 0;
    for (size_t t = 0; t < d->count; t++) out[t] = (uint32_t)t;
    for (size_t t = 0; t < d->count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t mate = d->triangles[t].mate[i], other = mate >> 2;
            if (other >= d->count || other < t || !has_one_circle(d, t, mate)) continue;
            uint32_t a = find_root(out, (uint32_t)t), b = find_root(out, other);
            out[a > b ? a : b] = a < b ? a : b; /* the root is the first triangle */
        }
    for (size_t t = 0; t < d->count; t++) out[t] = find_root(out, (uint32_t)t);
    for (size_t t = 0; t < d->count; t++) out[t] = out[t] == t ? classes++ : out[out[t]];
    return classes;
}

static int open_diagram(PyObject *module, PyObject *object, diagram *d) {
    const brio_triangulation2 *t = handle_object(state_of(module), object, KIND_TRIANGULATION2);
    if (!t) return -1;
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    *d = (diagram){brio_triangulation2_triangles(t), s->triangles, s->hull_edges, NULL, NULL};
    return 0;
}

/* circles(t, points, weights, out): out receives the class of each triangle. Returns the number of classes. */
static PyObject *circles(PyObject *module, PyObject *args) {
    PyObject *object, *points, *weights, *array;
    input p = {.held = 0}, w = {.held = 0}, out = {.held = 0};
    diagram d;
    Py_ssize_t classes = -1;
    if (!PyArg_ParseTuple(args, "OOOO", &object, &points, &weights, &array) || open_diagram(module, object, &d))
        return NULL;
    size_t rows = brio_triangulation2_stats(handle_object(state_of(module), object, KIND_TRIANGULATION2))->points;
    if (!input_open(&p, points, "points", 'd', 2) && !input_has_rows(&p, "points", rows) &&
        !input_open_weights(&w, weights, rows) && !handle_has_points(state_of(module), object, &p, &w) &&
        !output_open(&out, array, "out", 'I', 0) && !input_has_rows(&out, "out", d.count)) {
        d.xy = p.data, d.w = w.data;
        Py_BEGIN_ALLOW_THREADS classes = (Py_ssize_t)number_circles(&d, out.data);
        Py_END_ALLOW_THREADS
    }
    input_close(&p);
    input_close(&w);
    input_close(&out);
    return classes < 0 ? NULL : PyLong_FromSsize_t(classes);
}

/* --- regions --- */

static int slot_of(const brio_triangle *t, uint32_t vertex) {
    return t->vertex[0] == vertex ? 0 : t->vertex[1] == vertex ? 1 : 2;
}

/* The triangle before t, clockwise round the vertex in slot i, or after it. */
static uint32_t beside(const diagram *d, uint32_t t, int i, int after) {
    return d->triangles[t].mate[(i + (after ? 1 : 2)) % 3] >> 2;
}

/* The triangle where the region of a vertex begins: the first one counterclockwise from the hull, or t inside. */
static uint32_t first_round(const diagram *d, uint32_t t, uint32_t vertex) {
    uint32_t at = t;
    for (;;) {
        uint32_t before = beside(d, at, slot_of(&d->triangles[at], vertex), 0);
        if (before >= d->count) return at;
        if (before == t) return t;
        at = before;
    }
}

/* Writes the classes round a vertex, counterclockwise, each once, -1 first at the hull. Returns how many there are. */
static size_t write_region(const diagram *d, const uint32_t *class, uint32_t t, uint32_t vertex, int64_t *out) {
    size_t n = 0;
    uint32_t first = first_round(d, t, vertex), at = first;
    int open = beside(d, first, slot_of(&d->triangles[first], vertex), 0) >= d->count;
    if (open) out[n++] = -1;
    do {
        if (!n || out[n - 1] != (int64_t) class[at]) out[n++] = (int64_t) class[at];
        at = beside(d, at, slot_of(&d->triangles[at], vertex), 1);
    } while (at < d->count && at != first);
    if (n > 1 && out[0] == out[n - 1]) n--;
    return n;
}

/* regions(t, classes, first, offsets, items): `first` has a triangle of each point, or -1. */
static PyObject *regions(PyObject *module, PyObject *args) {
    PyObject *object, *arrays[4];
    input class = {.held = 0}, first = {.held = 0}, offsets = {.held = 0}, items = {.held = 0};
    diagram d;
    int done = 0;
    if (!PyArg_ParseTuple(args, "OOOOO", &object, &arrays[0], &arrays[1], &arrays[2], &arrays[3]) ||
        open_diagram(module, object, &d))
        return NULL;
    size_t rows = brio_triangulation2_stats(handle_object(state_of(module), object, KIND_TRIANGULATION2))->points;
    if (!input_open(&class, arrays[0], "classes", 'I', 0) && !input_has_rows(&class, "classes", d.count) &&
        !input_open(&first, arrays[1], "first", 'i', 0) && !input_has_rows(&first, "first", rows) &&
        !output_open(&offsets, arrays[2], "offsets", 'l', 0) && !input_has_rows(&offsets, "offsets", rows + 1) &&
        !output_open(&items, arrays[3], "items", 'l', 0) && !input_has_rows(&items, "items", 3 * d.count + d.hull)) {
        const int32_t *t = first.data;
        int64_t *offset = offsets.data, *item = items.data;
        offset[0] = 0;
        for (size_t p = 0; p < rows; p++) {
            int sound = t[p] >= 0 && (size_t)t[p] < d.count &&
                        d.triangles[t[p]].vertex[slot_of(&d.triangles[t[p]], (uint32_t)p)] == p;
            offset[p + 1] = offset[p];
            if (sound)
                offset[p + 1] += (int64_t)write_region(&d, class.data, (uint32_t)t[p], (uint32_t)p, item + offset[p]);
        }
        done = 1;
    }
    input_close(&class);
    input_close(&first);
    input_close(&offsets);
    input_close(&items);
    if (!done) return NULL;
    Py_RETURN_NONE;
}

PyMethodDef dual_methods[] = {
    {"circles", circles, METH_VARARGS, "circles(t, points, weights, out): classes of triangles with one circle."},
    {"regions", regions, METH_VARARGS, "regions(t, classes, first, offsets, items)"},
    {NULL, NULL, 0, NULL},
};
