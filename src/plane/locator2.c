/* Makes the object that queries of the plane read (locator2.h).
 *
 * The grid has a square for every four triangles. A square keeps the triangle of lowest index whose first vertex is in it;
 * a square without one keeps that of the square before. So a walk takes a few steps where points are spread evenly. */
#include "plane/locator2.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "plane/plane_points.h"
#include <math.h>
#include <string.h>

enum { TRIANGLES_A_SQUARE = 4 };

static void find_box(brio_locator2 *l) {
    double extent[4] = {0};
    for (int k = 0; k < 2; k++) {
        l->low[k] = INFINITY, l->high[k] = -INFINITY;
        for (size_t p = 0; p < l->num_points; p++) {
            l->low[k] = fmin(l->low[k], l->record[p][k]);
            l->high[k] = fmax(l->high[k], l->record[p][k]);
        }
        extent[k] = l->high[k] - l->low[k];
        double scale = (double)l->side / extent[k];
        l->scale[k] = scale > 0 && scale < INFINITY ? scale : 0;
    }
    brio_plane_filter_set(&l->filter, extent, false);
}

static void fill_grid(brio_locator2 *l) {
    size_t squares = l->side * l->side;
    uint32_t last = 0;
    for (size_t s = 0; s < squares; s++) l->start[s] = BRIO_NO_TRIANGLE;
    for (size_t t = 0; t < l->num_finite; t++) {
        uint32_t *start = brio_locator2_square(l, l->record[l->triangle[t].vertex[0]]);
        if (*start == BRIO_NO_TRIANGLE) *start = (uint32_t)t;
    }
    for (size_t s = 0; s < squares; s++) {
        if (l->start[s] == BRIO_NO_TRIANGLE) l->start[s] = last;
        last = l->start[s];
    }
}

static brio_status take_triangles(brio_locator2 *l, const brio_triangulation2 *t) {
    brio_status status = BRIO_OK;
    if (!l->num_finite) return BRIO_OK;
    l->side = 1 + (size_t)sqrt((double)l->num_finite / TRIANGLES_A_SQUARE);
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->triangle, l->num_triangles));
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->corner, l->num_points));
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->start, l->side * l->side));
    memcpy(l->triangle, t->triangle, l->num_triangles * sizeof *l->triangle);
    for (size_t i = l->num_finite; i-- > 0;)
        for (int k = 0; k < 3; k++) l->corner[l->triangle[i].vertex[k]] = (uint32_t)i;
    find_box(l);
    fill_grid(l);
done:
    return status;
}

/* Copies the vertices of points on a line. The only vertex of points at one place is a line, too. */
static brio_status take_line(brio_locator2 *l, const brio_triangulation2 *t) {
    if (l->num_finite || !l->num_points) return BRIO_OK;
    brio_status status = BRIO_ALLOC(l->ctx, l->line, t->stats.vertices);
    if (status != BRIO_OK) return status;
    l->num_line = t->stats.vertices;
    if (t->line)
        memcpy(l->line, t->line, l->num_line * sizeof *l->line);
    else
        l->line[0] = t->representative[0];
    return BRIO_OK;
}

brio_status brio_locator2_new(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                              const double *weights, size_t num_points, brio_locator2 **out) {
    BRIO_DOOR;
    brio_locator2 *l = NULL;
    brio_plane_input given = {points, weights, num_points, 2, {0, 1, 2}, 0, NULL};
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, l, 1));
    l->ctx = ctx;
    l->num_points = num_points;
    l->num_finite = t->stats.triangles;
    l->num_triangles = t->stats.triangles + t->stats.hull_edges;
    l->weighted = weights != NULL;
    BRIO_TRY(brio_plane_take_points(ctx, t, &given, &l->record));
    BRIO_TRY(take_triangles(l, t));
    BRIO_TRY(take_line(l, t));
    *out = l;
    l = NULL;
done:
    brio_locator2_free(l);
    return status;
}

void brio_locator2_free(brio_locator2 *l) {
    if (!l) return;
    brio_release(l->ctx, l->triangle);
    brio_release(l->ctx, l->record);
    brio_release(l->ctx, l->corner);
    brio_release(l->ctx, l->start);
    brio_release(l->ctx, l->line);
    brio_release(l->ctx, l);
}
