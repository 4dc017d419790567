/* The public queries of the plane for triangles and for vertices.
 *
 * The vertex of least power distance: a walk to the query, or to the point of the box nearest to it, and a descent
 * along edges from there (plane_nearest.c). On a line the vertices stand in order, and each is nearer than the next one
 * from some place on, so halving finds the nearest. */
#include "base/float_state.h"
#include "plane/plane_holder.h"
#include "plane/plane_nearest.h"

static brio_status answer_triangle(void *user, brio_plane_querent *q, size_t index, const double *x) {
    ((uint32_t *)user)[index] = brio_plane_find_holder(q, x).triangle;
    return BRIO_OK;
}

brio_status brio_locator2_triangles(brio_context *ctx, const brio_locator2 *l, const double *queries,
                                    size_t num_queries, uint32_t *triangles) {
    BRIO_DOOR;
    const brio_plane_batch b = {l, queries, num_queries, "locate", answer_triangle, triangles};
    return brio_plane_answer_all(ctx, brio_plane_query_threads(ctx, num_queries), &b);
}

/* --- vertices --- */

static uint32_t nearest_on_line(const brio_plane_querent *q, const double *x) {
    const brio_locator2 *l = q->l;
    size_t low = 0, high = l->num_line;
    if (!high) return BRIO_INFINITE;
    while (low + 1 < high) {
        size_t middle = low + (high - low) / 2;
        if (brio_plane_is_nearer(&q->filter, x, l->record[l->line[middle]], l->record[l->line[middle - 1]]))
            low = middle;
        else
            high = middle;
    }
    return l->line[low];
}

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

static brio_status answer_vertex(void *user, brio_plane_querent *q, size_t index, const double *x) {
    const brio_locator2 *l = q->l;
    uint32_t *vertex = (uint32_t *)user + index;
    const brio_plane_view view = brio_locator2_view(l);
    const brio_plane_nearest nearest = {&view, &q->filter, l->num_points, l->corner};
    uint64_t steps = 0;
    if (!l->num_finite) {
        *vertex = nearest_on_line(q, x);
        return BRIO_OK;
    }
    const double near[4] = {clamp(x[0], l->low[0], l->high[0]), clamp(x[1], l->low[1], l->high[1]), 0, 0};
    uint32_t t = brio_plane_walk(&view, &q->filter, *brio_locator2_square(l, near), near, &steps);
    *vertex = brio_plane_nearest_vertex(&nearest, t, x);
    return BRIO_OK;
}

brio_status brio_locator2_least_power(brio_context *ctx, const brio_locator2 *l, const double *queries,
                                      size_t num_queries, uint32_t *vertices) {
    BRIO_DOOR;
    const brio_plane_batch b = {l, queries, num_queries, "nearest", answer_vertex, vertices};
    return brio_plane_answer_all(ctx, brio_plane_query_threads(ctx, num_queries), &b);
}
