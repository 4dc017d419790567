/* The Delaunay edges of points in the plane, as lists of neighbours; and how slender the Voronoi cells along links are.
 *
 * Each triangle, infinite ones included, gives its finite edges in its own direction. So each edge is listed once from
 * either of its ends, with the corner of the triangle to its left.
 *
 * Based on: Amenta, Bern, Eppstein. The crust and the beta-skeleton. GMIP 1998: the edges of a curve that is sampled
 * densely enough are Delaunay edges. */
#include "base/memory.h"
#include "curve/work.h"

/* A Voronoi edge up to this many times as long as its link is short. Chosen: squares have 1, and two curves twice as
 * far apart as their points have 2. */
static const double SHORT = 1.25;

double brio_curve_turn(const brio_curve_work *w, uint32_t o, uint32_t p, uint32_t q, int *left) {
    double a[2], b[2];
    brio_curve_direction(w, o, p, a);
    brio_curve_direction(w, p, q, b);
    double cross = a[0] * b[1] - a[1] * b[0];
    if (left) *left = cross >= 0 ? 1 : -1;
    return atan2(fabs(cross), a[0] * b[0] + a[1] * b[1]);
}

/* Calls `add` for the directed edges of all triangles between finite corners. */
#define FOR_EDGES(t, i, add)                                                                                           \
    for (size_t t = 0; t < count; t++)                                                                                 \
        for (int i = 0; i < 3; i++)                                                                                    \
            if (triangle[t].vertex[(i + 1) % 3] != BRIO_INFINITE && triangle[t].vertex[(i + 2) % 3] != BRIO_INFINITE)  \
    add

static brio_status list_triangles(brio_curve_work *w, const brio_triangulation2 *t) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    size_t count = brio_triangulation2_stats(t)->triangles + brio_triangulation2_stats(t)->hull_edges;
    FOR_EDGES(f, i, w->start[triangle[f].vertex[(i + 1) % 3] + 2]++);
    for (size_t p = 0; p < w->num_rows; p++) w->start[p + 2] += w->start[p + 1];
    size_t total = w->start[w->num_rows + 1];
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->neighbour, total));
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->apex, total));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, w->gap, total));
    BRIO_FORWARD(brio_look(w->ctx, count));
    FOR_EDGES(f, i, {
        uint32_t slot = w->start[triangle[f].vertex[(i + 1) % 3] + 1]++;
        w->neighbour[slot] = triangle[f].vertex[(i + 2) % 3];
        w->apex[slot] = triangle[f].vertex[i];
    });
    return BRIO_OK;
}

/* Lists the edges of points on a line. */
static brio_status list_line(brio_curve_work *w, const brio_triangulation2 *t) {
    size_t count, total = 0;
    const uint32_t *line = brio_triangulation2_line(t, &count);
    for (size_t i = 0; i < count; i++) w->start[line[i] + 2] = (uint32_t)((i > 0) + (i + 1 < count));
    for (size_t p = 0; p < w->num_rows; p++) w->start[p + 2] += w->start[p + 1];
    total = w->start[w->num_rows + 1];
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->neighbour, total));
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->apex, total));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, w->gap, total));
    for (size_t k = 0; k < total; k++) w->apex[k] = BRIO_NO_ROW;
    for (size_t i = 0; i < count; i++) {
        if (i > 0) w->neighbour[w->start[line[i] + 1]++] = line[i - 1];
        if (i + 1 < count) w->neighbour[w->start[line[i] + 1]++] = line[i + 1];
    }
    return BRIO_OK;
}

brio_status brio_curve_edges(brio_curve_work *w) {
    brio_status status = BRIO_OK;
    brio_triangulation2 *t = NULL;
    BRIO_TRY(brio_delaunay2(w->ctx, *w->at, NULL, w->num_rows, NULL, &t));
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, w->start, w->num_rows + 2));
    BRIO_TRY(brio_triangulation2_stats(t)->dimension < 2 ? list_line(w, t) : list_triangles(w, t));
    BRIO_TRY(BRIO_ALLOC(w->ctx, w->link, w->num_rows));
    BRIO_TRY(BRIO_ALLOC(w->ctx, w->wished, w->num_rows));
    BRIO_TRY(BRIO_ALLOC(w->ctx, w->changed, 2 * w->num_rows));
    BRIO_TRY(BRIO_ALLOC_ZERO(w->ctx, w->listed, w->num_rows));
    for (size_t p = 0; p < w->num_rows; p++)
        for (int k = 0; k < 2; k++) w->link[p][k] = w->wished[p][k] = BRIO_NO_ROW;
done:
    brio_triangulation2_free(t);
    return status;
}

void brio_curve_work_free(brio_curve_work *w) {
    brio_release(w->ctx, w->start);
    brio_release(w->ctx, w->neighbour);
    brio_release(w->ctx, w->apex);
    brio_release(w->ctx, w->gap);
    brio_release(w->ctx, w->link);
    brio_release(w->ctx, w->wished);
    brio_release(w->ctx, w->changed);
    brio_release(w->ctx, w->listed);
}

/* Returns the cotangent of the angle at row c of the triangle p, q, c; infinite outside the hull. */
static double cotangent(const brio_curve_work *w, uint32_t p, uint32_t q, uint32_t c) {
    double a[2], b[2];
    if (c == BRIO_NO_ROW) return INFINITY;
    brio_curve_direction(w, c, p, a);
    brio_curve_direction(w, c, q, b);
    return (a[0] * b[0] + a[1] * b[1]) / fabs(a[0] * b[1] - a[1] * b[0]);
}

/* Returns the apex of the edge from p to q. */
static uint32_t apex_of(const brio_curve_work *w, uint32_t p, uint32_t q) {
    uint32_t k = w->start[p];
    while (w->neighbour[k] != q) k++;
    return w->apex[k];
}

size_t brio_curve_count_fat(const brio_curve_work *w) {
    size_t fat = 0;
    for (uint32_t p = 0; p < w->num_rows; p++)
        for (int k = 0; k < 2; k++) {
            uint32_t q = w->link[p][k];
            if (q == BRIO_NO_ROW || q < p) continue;
            double sum = cotangent(w, p, q, apex_of(w, p, q)) + cotangent(w, p, q, apex_of(w, q, p));
            fat += sum / 2 < SHORT;
        }
    return fat;
}
