/* Least distances between a triangle and a surface, by the hierarchy of boxes about the surface's triangles.
 *
 * Two triangles that do not meet are closest in two points of which one is a corner, or in points of two edges. A box
 * is skipped where one of five directions separates it from the triangle by more than the least distance found: the
 * axes together, the normal of the triangle, and the normals of its edges in its plane.
 *
 * Based on: Ericson. Real-time collision detection. 2005, sections 5.1.9 (segments) and 5.2.1 (separating axes). */
#include "mesh/triangle_distance.h"
#include "base/vector.h"
#include "mesh/triangles_cross.h"
#include <math.h>
#include <string.h>

enum { MOST_LEVELS = 64, SLABS = 4 };

/* The triangle, with slabs that contain it: direction of length 1 (or 0: no slab), least and greatest height. */
typedef struct {
    const double *const *corner;
    brio_box box;
    struct {
        double direction[3], low, high;
    } slab[SLABS];
} query;

static void add_slab(query *q, int i, const double *direction) {
    double length = brio_length(direction);
    q->slab[i].low = INFINITY;
    q->slab[i].high = -INFINITY;
    for (int k = 0; k < 3; k++) q->slab[i].direction[k] = length > 0 ? direction[k] / length : 0;
    for (int c = 0; c < 3; c++) {
        double height = brio_dot(q->slab[i].direction, q->corner[c]);
        q->slab[i].low = fmin(q->slab[i].low, height);
        q->slab[i].high = fmax(q->slab[i].high, height);
    }
}

static query query_of(const double *const corners[3]) {
    query q = {.corner = corners};
    double edge[3][3], normal[3], across[3];
    for (int k = 0; k < 3; k++) {
        q.box.low[k] = fmin(corners[0][k], fmin(corners[1][k], corners[2][k]));
        q.box.high[k] = fmax(corners[0][k], fmax(corners[1][k], corners[2][k]));
        for (int c = 0; c < 3; c++) edge[c][k] = corners[(c + 1) % 3][k] - corners[c][k];
    }
    brio_cross(edge[0], edge[1], normal);
    add_slab(&q, 0, normal);
    for (int c = 0; c < 3; c++) {
        brio_cross(q.slab[0].direction, edge[c], across);
        add_slab(&q, 1 + c, across);
    }
    return q;
}

/* Returns a lower bound on the squared distance between the triangle and a box. */
static double box_distance(const query *q, const brio_box *b) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(fmax(b->low[k] - q->box.high[k], q->box.low[k] - b->high[k]), 0);
        square += d * d;
    }
    for (int i = 0; i < SLABS; i++) {
        const double *n = q->slab[i].direction;
        double middle = 0, reach = 0;
        for (int k = 0; k < 3; k++) {
            middle += n[k] * 0.5 * (b->low[k] + b->high[k]);
            reach += fabs(n[k]) * 0.5 * (b->high[k] - b->low[k]);
        }
        double d = fmax(fmax(middle - reach - q->slab[i].high, q->slab[i].low - middle - reach), 0);
        square = fmax(square, d * d);
    }
    return square * (1 - 0x1p-40); /* rounding */
}

/* Returns the squared distance of segments ab and cd; writes the point of ab. */
static double segment_distance(const double *a, const double *b, const double *c, const double *d, double *at) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = d[k] - c[k], w[k] = a[k] - c[k];
    double uu = brio_dot(u, u), vv = brio_dot(v, v), uv = brio_dot(u, v), uw = brio_dot(u, w), vw = brio_dot(v, w);
    double determinant = uu * vv - uv * uv;
    double s = determinant > 0 ? fmin(fmax((uv * vw - uw * vv) / determinant, 0), 1) : 0;
    double t = vv > 0 ? fmin(fmax((uv * s + vw) / vv, 0), 1) : 0;
    s = uu > 0 ? fmin(fmax((uv * t - uw) / uu, 0), 1) : 0;
    double square = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + s * u[k];
        double gap = at[k] - (c[k] + t * v[k]);
        square += gap * gap;
    }
    return square;
}

static void keep_nearer(double square, const double *at, double *best, double *out) {
    if (square >= *best) return;
    *best = square;
    memcpy(out, at, 3 * sizeof *out);
}

/* Lowers *best to the squared distance from a triangle of the tree. */
static void measure(const query *q, const brio_triangle_tree *tree, size_t triangle, double *best, double *out) {
    const double *mine[3], *other[3];
    double at[3];
    for (int c = 0; c < 3; c++) {
        mine[c] = q->corner[c];
        other[c] = tree->vertices + 3 * (size_t)tree->triangles[triangle][c];
    }
    for (int i = 0; i < 3; i++) {
        brio_closest_on_triangle(tree, triangle, mine[i], at);
        keep_nearer(brio_square_distance(mine[i], at), mine[i], best, out);
        brio_closest_on_corners(mine, other[i], at);
        keep_nearer(brio_square_distance(other[i], at), at, best, out);
        for (int j = 0; j < 3; j++)
            keep_nearer(segment_distance(mine[i], mine[(i + 1) % 3], other[j], other[(j + 1) % 3], at), at, best, out);
    }
    if (*best > 0 && brio_triangles_cross(mine, other)) {
        for (int k = 0; k < 3; k++) at[k] = (mine[0][k] + mine[1][k] + mine[2][k]) / 3;
        keep_nearer(0, at, best, out);
    }
}

double brio_triangle_distance(const brio_triangle_tree *tree, const double *const corners[3], double bound,
                              double *at) {
    struct {
        size_t node, low, high;
    } stack[MOST_LEVELS], r;
    query q = query_of(corners);
    int depth = 0;
    double best = bound;
    stack[depth].node = stack[depth].low = 0;
    stack[depth++].high = tree->num_triangles;
    while (depth > 0) {
        r = stack[--depth];
        if (box_distance(&q, &tree->boxes[r.node]) >= best) continue;
        if (r.high - r.low <= BRIO_LEAF_TRIANGLES) {
            for (size_t t = r.low; t < r.high; t++) measure(&q, tree, t, &best, at);
            continue;
        }
        size_t middle = r.low + (r.high - r.low) / 2;
        stack[depth].node = 2 * r.node + 1, stack[depth].low = r.low, stack[depth++].high = middle;
        stack[depth].node = 2 * r.node + 2, stack[depth].low = middle, stack[depth++].high = r.high;
    }
    return best < bound ? best : INFINITY;
}
