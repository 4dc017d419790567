/* The check of inputs in a plane, on a line, or at one position. They have no tetrahedra, so only the representatives
 * and the counts are checked.
 *
 * One apex off the plane (two off a line) makes the input three-dimensional. The plane (line) then contains a facet
 * (an edge) of the convex hull. The regular triangulation restricted to a face of the hull is the regular
 * triangulation of the points in that face, so the same points own a cell. The solid triangulation is computed and
 * checked exactly.
 *
 * The solid triangulation has the representatives of the flat input, because the apexes represent no point. The weight
 * of an apex is the least weight of all points. At a point x, the power distance of x is -w(x). The power distance of
 * a vertex that hides x is at most -w(x). That of an apex is more, because the apex is not at x. */
#include "base/memory.h"
#include "triangulation/check.h"
#include "triangulation/triangulation.h"
#include <string.h>

/* Returns whether p is off the affine hull of `count` records in general position. */
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

/* Appends apexes to `points` (which has room for three more) until the points are three-dimensional. Returns the
 * number of all points. */
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

/* Checks an input without points or at one position. The heaviest point represents the others; among equal weights,
 * the one with the lowest index. */
static brio_status check_one_position(brio_context *ctx, const brio_triangulation *t, const double *weights) {
    size_t n = t->stats.points, best = 0;
    for (size_t p = 1; p < n; p++)
        if (weights && weights[p] > weights[best]) best = p;
    for (size_t p = 0; p < n; p++)
        BRIO_EXPECT(ctx, t->representative[p] == best, BRIO_ERR_CHECK, "point %zu is represented by %u instead of %zu",
                    BRIO_POINT(ctx, p), t->representative[p], best);
    BRIO_EXPECT(ctx, t->stats.vertices == (n > 0) && t->stats.duplicates == n - (n > 0) && t->stats.hidden == 0,
                BRIO_ERR_CHECK, "%zu points at one position are counted as %zu vertices, %zu duplicates, %zu hidden", n,
                t->stats.vertices, t->stats.duplicates, t->stats.hidden);
    return BRIO_OK;
}

/* Compares a result with the checked triangulation of its points and the apexes after them. */
static brio_status compare_with_solid(brio_context *ctx, const brio_triangulation *t, const brio_triangulation *solid) {
    size_t n = t->stats.points, vertices = solid->stats.vertices - (solid->stats.points - n);
    for (size_t p = 0; p < n; p++)
        BRIO_EXPECT(ctx, t->representative[p] == solid->representative[p], BRIO_ERR_CHECK,
                    "point %zu is represented by %u instead of %u", BRIO_POINT(ctx, p), t->representative[p],
                    solid->representative[p]);
    BRIO_EXPECT(ctx,
                t->stats.vertices == vertices && t->stats.duplicates == solid->stats.duplicates &&
                    t->stats.hidden == solid->stats.hidden,
                BRIO_ERR_CHECK, "%zu vertices, %zu duplicates and %zu hidden points are counted as %zu, %zu and %zu",
                vertices, solid->stats.duplicates, solid->stats.hidden, t->stats.vertices, t->stats.duplicates,
                t->stats.hidden);
    return BRIO_OK;
}

/* Copies the weights, and gives each apex the least weight of all. */
static brio_status copy_weights(brio_context *ctx, const double *weights, size_t n, size_t total, double **out) {
    double *w = NULL, least = weights[0];
    brio_status status = BRIO_ALLOC(ctx, w, total);
    if (status != BRIO_OK) return status;
    memcpy(w, weights, n * sizeof *w);
    for (size_t p = 0; p < n; p++) least = fmin(least, w[p]);
    for (size_t p = n; p < total; p++) w[p] = least;
    *out = w;
    return BRIO_OK;
}

brio_status brio_check_flat(brio_context *ctx, const brio_triangulation *t, const double *points,
                            const double *weights) {
    brio_status status = BRIO_OK;
    size_t n = t->stats.points;
    double *lifted = NULL, *w = NULL;
    brio_triangulation *solid = NULL;
    BRIO_REQUIRE(ctx, t->stats.tetrahedra == 0 && t->stats.hull_facets == 0, BRIO_ERR_CHECK,
                 "points of dimension %d have tetrahedra", t->stats.dimension);
    if (t->stats.dimension <= 0) {
        status = check_one_position(ctx, t, weights);
        goto done;
    }
    BRIO_TRY(BRIO_ALLOC(ctx, lifted, 3 * (n + 3)));
    memcpy(lifted, points, 3 * n * sizeof *lifted);
    size_t total = add_apexes(lifted, n, reach_of(points, n));
    if (weights) BRIO_TRY(copy_weights(ctx, weights, n, total, &w));
    brio_delaunay_options options = {0};
    options.leave_hidden = t->leaves_hidden;
    BRIO_TRY(brio_delaunay(ctx, lifted, w, total, &options, &solid));
    BRIO_REQUIRE(ctx, solid->stats.dimension == 3, BRIO_ERR_INTERNAL, "no point off a flat input was found");
    BRIO_TRY(brio_triangulation_check(ctx, solid, lifted, w, total));
    BRIO_TRY(compare_with_solid(ctx, t, solid));
done:
    brio_release(ctx, lifted);
    brio_release(ctx, w);
    brio_triangulation_free(solid);
    return status;
}
