/* Makes the object that queries of the plane read (locator2.h).
 *
 * The grid has a square for every four triangles. A square keeps the triangle of lowest index whose first vertex is in
 * it; a square without one keeps that of the square before. So a walk takes a few steps where points are spread
 * evenly. */
#include "plane/locator2.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "plane/plane_frame.h"
#include "plane/plane_points.h"
#include <assert.h>
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
        assert(last < l->num_finite); /* I3 */
    }
}

static brio_status take_triangles(brio_locator2 *l, const brio_triangulation2 *t) {
    if (!l->num_finite) return BRIO_OK;
    l->side = 1 + (size_t)sqrt((double)l->num_finite / TRIANGLES_A_SQUARE);
    BRIO_FORWARD(BRIO_ALLOC(l->ctx, l->triangle, l->num_triangles));
    BRIO_FORWARD(BRIO_ALLOC(l->ctx, l->corner, l->num_points));
    BRIO_FORWARD(BRIO_ALLOC(l->ctx, l->start, l->side * l->side));
    assert(l->num_finite <= l->num_triangles);
    memcpy(l->triangle, t->triangle, l->num_triangles * sizeof *l->triangle);
    for (size_t i = l->num_finite; i-- > 0;)
        for (int k = 0; k < 3; k++) l->corner[l->triangle[i].vertex[k]] = (uint32_t)i;
    find_box(l);
    fill_grid(l);
    return BRIO_OK;
}

/* Copies the vertices of points on a line. The only vertex of points at one place is a line, too. */
static brio_status take_line(brio_locator2 *l, const brio_triangulation2 *t) {
    if (l->num_finite || !l->num_points) return BRIO_OK;
    brio_status status = BRIO_ALLOC(l->ctx, l->line, t->stats.vertices);
    if (status != BRIO_OK) return status;
    assert(!t->line || t->line_count == t->stats.vertices);
    l->num_line = t->stats.vertices;
    if (t->line)
        memcpy(l->line, t->line, l->num_line * sizeof *l->line);
    else
        l->line[0] = t->representative[0];
    return BRIO_OK;
}

/* --- points on a line up to rounding --- */

/* Returns whether all triangles are flat up to the rounding of coordinates. In usual triangulations the first one is
 * not. */
static bool is_line(const brio_locator2 *l) {
    double greatest = 0;
    for (int k = 0; k < 2; k++) greatest = fmax(greatest, fmax(fabs(l->low[k]), fabs(l->high[k])));
    for (size_t t = 0; t < l->num_finite; t++) {
        double edge[3][2], longest = 0;
        for (int i = 0; i < 3; i++) {
            const double *a = l->record[l->triangle[t].vertex[i]], *b = l->record[l->triangle[t].vertex[(i + 1) % 3]];
            for (int k = 0; k < 2; k++) edge[i][k] = b[k] / greatest - a[k] / greatest;
            longest = fmax(longest, hypot(edge[i][0], edge[i][1]));
        }
        if (fabs(edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]) > BRIO_FLAT_ROUNDING * longest) return false;
    }
    return true;
}

static int compare_places(uint32_t a, uint32_t b, const void *along) {
    const double *x = along;
    return x[a] != x[b] ? (x[a] > x[b]) - (x[a] < x[b]) : (a > b) - (a < b);
}

/* Lists the vertices along the coordinate of the greater extent. */
static brio_status line_up(brio_locator2 *l, const brio_triangulation2 *t) {
    brio_status status = BRIO_OK;
    double *along = NULL;
    if (!l->num_finite || !is_line(l)) return BRIO_OK;
    int k = l->high[1] - l->low[1] > l->high[0] - l->low[0];
    BRIO_TRY(BRIO_ALLOC(l->ctx, along, l->num_points));
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->line, t->stats.vertices));
    for (size_t p = 0; p < l->num_points; p++) {
        along[p] = l->record[p][k];
        if (t->representative[p] == p) l->line[l->num_line++] = (uint32_t)p;
    }
    BRIO_TRY(brio_sort_many_indices(l->ctx, l->line, l->num_line, compare_places, along));
done:
    brio_release(l->ctx, along);
    return status;
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
    BRIO_TRY(line_up(l, t));
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
