/* Points in a plane, on a line, or at one position, completed to a set of dimension 3.
 *
 * Let q be a point off the plane of points of dimension 2. Every tetrahedron of all points has q as a vertex, and its
 * sphere meets the plane in the circle of the other three: the tetrahedra are cones over the Delaunay (regular)
 * triangulation of the plane. On a line the same holds for the edge between two added points. An added point is a corner
 * of the convex hull, so it is never hidden and hides no point. */
#include "cells/flat_points.h"
#include "base/memory.h"
#include "predicates/predicates.h"
#include <math.h>
#include <string.h>

/* Points that span what was seen so far. */
typedef struct {
    const double *point[4];
    int count;
} basis;

static bool is_outside(const basis *b, const double *x) {
    switch (b->count) {
    case 1:
        return !brio_same_position(b->point[0], x);
    case 2:
        return !brio_collinear(b->point[0], b->point[1], x);
    case 3:
        return brio_orient3d(b->point[0], b->point[1], b->point[2], x) != 0;
    default:
        return b->count == 0;
    }
}

static bool extend(basis *b, const double *x) {
    if (!is_outside(b, x)) return false;
    b->point[b->count++] = x;
    return true;
}

/* Writes the first point moved along axis k by about the size of the point set. */
static void move_first(const double *points, size_t n, int k, double *x) {
    double most = 0;
    for (size_t i = 0; i < 3 * n; i++) {
        double way = fabs(points[i] * 0.5 - points[i % 3] * 0.5);
        most = way > most ? way : most;
    }
    double step = fmax(most, fabs(points[k]) * 0x1p-20);
    memcpy(x, points, 3 * sizeof *x);
    if (!(step > 0)) step = 1;
    x[k] += points[k] > 0 ? -step : step;
}

brio_status brio_complete_flat_points(brio_context *ctx, const double *points, const double *weights, size_t n,
                                      brio_completed_points *out) {
    brio_status status = BRIO_OK;
    double *x = NULL, *w = NULL;
    basis b = {{0}, 0};
    *out = (brio_completed_points){0};
    BRIO_TRY(BRIO_ALLOC(ctx, x, 3 * (n + BRIO_MOST_ADDED)));
    if (weights) BRIO_TRY(BRIO_ALLOC(ctx, w, n + BRIO_MOST_ADDED));
    memcpy(x, points, 3 * n * sizeof *x);
    for (size_t i = n; i < n + BRIO_MOST_ADDED; i++) memcpy(x + 3 * i, points, 3 * sizeof *x);
    for (size_t i = 0; w && i < n + BRIO_MOST_ADDED; i++) w[i] = weights[i < n ? i : 0];
    for (size_t i = 0; i < n && b.count < 4; i++) extend(&b, x + 3 * i);
    for (int k = 0; k < 3 && b.count < 4; k++) {
        double *next = x + 3 * (n + out->added);
        move_first(points, n, k, next);
        if (extend(&b, next))
            out->added++;
        else
            memcpy(next, points, 3 * sizeof *x);
    }
    out->points = x;
    out->weights = w;
    x = w = NULL;
done:
    brio_release(ctx, x);
    brio_release(ctx, w);
    return status;
}
