/* The check of inputs in a plane, on a line, or at one position, which have no tetrahedra.
 *
 * Points off the hull (two for a line) make the input three-dimensional without changing which of its points own a
 * cell: they are chosen here, given to the triangulation as plain points, and its result is checked exactly in three
 * dimensions. Its vertices must then be the vertices in question. */
#include "base/memory.h"
#include "triangulation/check.h"
#include "triangulation/triangulation.h"
#include <string.h>

/* Extends `count` records in general position by the first one off their hull. */
static bool extends(const brio_record *r, const size_t corner[4], int count, const double *p) {
    switch (count) {
    case 1:
        return !brio_same_position(r[corner[0]], p);
    case 2:
        return !brio_collinear(r[corner[0]], r[corner[1]], p);
    default:
        return brio_orient3d(r[corner[0]], r[corner[1]], r[corner[2]], p) != 0;
    }
}

int brio_dimension(const brio_record *r, size_t n) {
    size_t corner[4] = {0};
    int count = n > 0;
    for (size_t p = 1; p < n && count < 4; p++)
        if (extends(r, corner, count, r[p])) corner[count++] = p;
    return count - 1;
}

/* Appends to `points` (room for three more) until they are three-dimensional; their number. */
static size_t add_apexes(double *points, size_t n, double reach) {
    brio_record r[4];
    size_t corner[4] = {0, 1, 2, 3};
    int count = 0;
    for (size_t p = 0; p < n && count < 3; p++) {
        memcpy(r[count], points + 3 * p, 3 * sizeof **r);
        if (count == 0 || extends((const brio_record *)r, corner, count, r[count])) count++;
    }
    for (; count < 4; count++, n++)
        for (int axis = 2; axis >= 0; axis--) {
            double *apex = points + 3 * n;
            memcpy(apex, r[0], 3 * sizeof *apex);
            apex[axis] = apex[axis] > 0 ? apex[axis] - reach : apex[axis] + reach;
            memcpy(r[count], apex, 3 * sizeof *apex);
            if (extends((const brio_record *)r, corner, count, r[count])) break;
        }
    return n;
}

static double reach_of(const double *points, size_t n) {
    double most = 0;
    for (size_t i = 0; i < 3 * n; i++) most = fmax(most, fabs(points[i]));
    return fmin(fmax(most, 1e-300), 8e307);
}

brio_status brio_check_flat(brio_context *ctx, const brio_triangulation *t, const double *points,
                            const double *weights) {
    brio_status status = BRIO_OK;
    size_t n = t->stats.points;
    double *lifted = NULL, *w = NULL;
    brio_triangulation *solid = NULL;
    if (t->stats.dimension <= 0) {
        BRIO_REQUIRE(ctx, t->stats.vertices == (n > 0), BRIO_ERR_CHECK, "one position has %zu vertices",
                     t->stats.vertices);
        goto done;
    }
    BRIO_TRY(BRIO_ALLOC(ctx, lifted, 3 * (n + 3)));
    memcpy(lifted, points, 3 * n * sizeof *lifted);
    size_t total = add_apexes(lifted, n, reach_of(points, n));
    if (weights) {
        BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w, total));
        memcpy(w, weights, n * sizeof *w);
    }
    BRIO_TRY(brio_delaunay(ctx, lifted, w, total, NULL, &solid));
    BRIO_REQUIRE(ctx, solid->stats.dimension == 3, BRIO_ERR_INTERNAL, "no point off a flat input was found");
    BRIO_TRY(brio_triangulation_check(ctx, solid, lifted, w, total));
    for (size_t p = 0; p < n; p++) {
        bool vertex = t->representative[p] == p, expected = solid->representative[p] == p;
        BRIO_REQUIRE(ctx, vertex == expected, BRIO_ERR_CHECK, "point %zu should %sbe a vertex", p,
                     expected ? "" : "not ");
    }
done:
    brio_release(ctx, lifted);
    brio_release(ctx, w);
    brio_triangulation_free(solid);
    return status;
}
