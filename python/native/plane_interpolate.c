/* Interpolation in the plane.
 *
 * Natural neighbours: the triangles whose circles hold the query x are its cavity, and the vertices round the cavity are
 * its natural neighbours. Each has the weight of the area that the Voronoi cell of x would take from its own: the polygon
 * of the circumcentres of the cavity's triangles at that vertex and of the two new triangles at it. One way round the
 * cavity visits all of them. On the hull's boundary, and where rounding leaves no sound weights, the values are those of
 * the linear interpolation.
 *
 * Based on: Sibson. A brief description of natural neighbour interpolation. Interpreting Multivariate Data, 1981. */
#include "plane.h"
#include <math.h>

/* Values at points, and where the results go. */
typedef struct {
    const plane_locator *l;
    const double *values;
    size_t components;
} table;

/* Triangles in conflict with a query. mark[t] is `query` for those of the current one. */
typedef struct {
    uint32_t *mark, query;
    uint32_t *triangle;
    size_t count;
} cavity;

static void add(const table *v, uint32_t vertex, double weight, double *out) {
    const double *row = v->values + v->components * vertex;
    for (size_t k = 0; k < v->components; k++) out[k] += weight * row[k];
}

static double cross(const double *a, const double *b) {
    return a[0] * b[1] - a[1] * b[0];
}

static void relative(const double *p, const double *x, double *out) {
    out[0] = p[0] - x[0], out[1] = p[1] - x[1];
}

static void fill(double *out, size_t count, double value) {
    for (size_t k = 0; k < count; k++) out[k] = value;
}

/* --- linear --- */

static void interpolate_linear(const table *v, uint32_t t, const double *x, double *out) {
    double corner[3][2], part[3], all = 0;
    for (int i = 0; i < 3; i++) relative(plane_corner(v->l, t, i), x, corner[i]);
    for (int i = 0; i < 3; i++) all += part[i] = cross(corner[slot_after(i)], corner[slot_before(i)]);
    fill(out, v->components, 0);
    for (int i = 0; i < 3; i++) add(v, v->l->triangles[t].vertex[i], part[i] / all, out);
}

/* --- natural neighbours --- */

/* The centre of the circle through 0, a, b. */
static void centre_at_origin(const double *a, const double *b, double *out) {
    double aa = a[0] * a[0] + a[1] * a[1], bb = b[0] * b[0] + b[1] * b[1], d = 2 * cross(a, b);
    out[0] = (b[1] * aa - a[1] * bb) / d;
    out[1] = (a[0] * bb - b[0] * aa) / d;
}

/* The circumcentre of a triangle, relative to x. */
static void centre_of(const plane_locator *l, uint32_t t, const double *x, double *out) {
    double a[2], b[2], offset[2];
    const double *p = plane_corner(l, t, 0);
    relative(plane_corner(l, t, 1), p, a);
    relative(plane_corner(l, t, 2), p, b);
    centre_at_origin(a, b, out);
    relative(p, x, offset);
    out[0] += offset[0], out[1] += offset[1];
}

static void find_cavity(const plane_locator *l, cavity *c, uint32_t t, const double *x) {
    c->count = 1, c->triangle[0] = t, c->mark[t] = c->query;
    for (size_t n = 0; n < c->count; n++)
        for (int i = 0; i < 3; i++) {
            uint32_t other = l->triangles[c->triangle[n]].mate[i] >> 2;
            if (other >= l->count || c->mark[other] == c->query) continue;
            if (brio_incircle(plane_corner(l, other, 0), plane_corner(l, other, 1), plane_corner(l, other, 2), x,
                              NULL) <= 0)
                continue;
            c->mark[other] = c->query;
            c->triangle[c->count++] = other;
        }
}

/* An edge of the cavity's boundary: of triangle t, opposite to its slot i. */
typedef struct {
    uint32_t t;
    int i;
} edge;

static int is_boundary(const plane_locator *l, const cavity *c, edge e) {
    uint32_t other = l->triangles[e.t].mate[e.i] >> 2;
    return other >= l->count || c->mark[other] != c->query;
}

/* The centre of the circle through x and the ends of an edge, relative to x. */
static void centre_of_edge(const plane_locator *l, edge e, const double *x, double *out) {
    double a[2], b[2];
    relative(plane_corner(l, e.t, slot_after(e.i)), x, a);
    relative(plane_corner(l, e.t, slot_before(e.i)), x, b);
    centre_at_origin(a, b, out);
}

/* Goes round the vertex at the end of a boundary edge to the next boundary edge. Returns twice the area that x takes from
 * that vertex. */
static double take_area(const plane_locator *l, const cavity *c, edge *e, const double *x) {
    double first[2], last[2], next[2], area = 0;
    centre_of_edge(l, *e, x, first);
    last[0] = first[0], last[1] = first[1];
    edge at = {e->t, slot_after(e->i)}; /* the edge from the vertex on, of the same triangle */
    for (;;) {
        centre_of(l, at.t, x, next);
        area += cross(last, next);
        last[0] = next[0], last[1] = next[1];
        if (is_boundary(l, c, at)) break;
        uint32_t mate = l->triangles[at.t].mate[at.i];
        at = (edge){mate >> 2, slot_after((int)(mate & 3))};
    }
    centre_of_edge(l, at, x, next);
    area += cross(last, next) + cross(next, first);
    *e = at;
    return fabs(area);
}

/* Returns 0 if there are no sound weights. */
static int interpolate_natural(const table *v, cavity *c, uint32_t t, const double *x, double *out) {
    edge begin = {t, 0};
    double all = 0;
    find_cavity(v->l, c, t, x);
    for (size_t n = 0; n < 3 * c->count; n++) {
        begin = (edge){c->triangle[n / 3], (int)(n % 3)};
        if (is_boundary(v->l, c, begin)) break;
    }
    fill(out, v->components, 0);
    edge e = begin;
    do {
        uint32_t vertex = v->l->triangles[e.t].vertex[slot_before(e.i)];
        double area = take_area(v->l, c, &e, x);
        all += area;
        add(v, vertex, area, out);
    } while (e.t != begin.t || e.i != begin.i);
    for (size_t k = 0; k < v->components; k++) out[k] /= all;
    return all > 0 && all < INFINITY;
}

/* Whether x is on an edge of the hull, or at a vertex. */
static int is_at_border(const plane_locator *l, uint32_t t, const double *x) {
    int zeros = 0, hull = 0;
    for (int i = 0; i < 3; i++) {
        int turn = plane_turn(plane_corner(l, t, slot_after(i)), plane_corner(l, t, slot_before(i)), x);
        zeros += turn == 0;
        hull += turn == 0 && (l->triangles[t].mate[i] >> 2) >= l->count;
    }
    return hull || zeros > 1;
}

/* --- queries --- */

static brio_status interpolate_all(call *k, const table *v, cavity *c, const input *q, double *out) {
    const double *x = q->view.buf;
    for (size_t i = 0; i < q->rows; i++, x += 2, out += v->components) {
        if (i % 256 == 0 && call_look(k, "interpolate", (double)i / (double)q->rows)) return BRIO_ERR_CANCELLED;
        int32_t t = plane_find(v->l, x);
        if (t == LOST) return BRIO_ERR_CHECK;
        c->query = (uint32_t)i + 1;
        if (t < 0)
            fill(out, v->components, (double)NAN);
        else if (!c->mark || is_at_border(v->l, (uint32_t)t, x) || !interpolate_natural(v, c, (uint32_t)t, x, out))
            interpolate_linear(v, (uint32_t)t, x, out);
    }
    return BRIO_OK;
}

/* The arrays of an interpolation. */
typedef struct {
    input queries, values, out;
} arrays;

static int run(module_state *state, const plane_locator *l, arrays *a, int natural, PyObject *progress) {
    call k;
    brio_status status = BRIO_ERR_NO_MEMORY;
    const table v = {l, a->values.data, a->values.columns};
    cavity c = {.mark = natural ? calloc(l->count + 1, sizeof *c.mark) : NULL,
                .triangle = natural ? malloc((l->count + 1) * sizeof *c.triangle) : NULL};
    int failed = call_begin(&k, state, 1, progress);
    if (!failed) {
        if (!natural || (c.mark && c.triangle)) CALL(k, status, interpolate_all(&k, &v, &c, &a->queries, a->out.data));
        failed = call_end_saying(&k, status, plane_sentence(status));
    }
    free(c.mark);
    free(c.triangle);
    return failed;
}

PyObject *plane_interpolate(PyObject *module, PyObject *args) {
    PyObject *object, *queries, *values, *array, *progress;
    int natural, failed = -1;
    arrays a = {{.held = 0}, {.held = 0}, {.held = 0}};
    if (!PyArg_ParseTuple(args, "OOOiOO", &object, &queries, &values, &natural, &array, &progress)) return NULL;
    const plane_locator *l = handle_object(state_of(module), object, KIND_LOCATOR2);
    if (l && !input_open(&a.queries, queries, "queries", 'd', 2) && !input_open(&a.values, values, "values", 'd', -1) &&
        !output_open(&a.out, array, "out", 'd', (int)a.values.columns) &&
        !input_has_rows(&a.out, "out", a.queries.rows) && !input_has_rows(&a.values, "values", l->points))
        failed = run(state_of(module), l, &a, natural, progress);
    input_close(&a.queries);
    input_close(&a.values);
    input_close(&a.out);
    if (failed) return NULL;
    Py_RETURN_NONE;
}
