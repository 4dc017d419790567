/* The filtration values of the alpha complex of points in the plane: of every triangle, edge and vertex of a
 * triangulation.
 *
 * As in space (alpha_values.c), one dimension lower: a triangle has the squared radius of its circle, an edge that of
 * its smallest circle if neither apex of its triangles is strictly inside, decided exactly, or else the least value of
 * its triangles. Points of the plane are points of space with z = 0: the smallest spheres have the radii of the
 * circles.
 *
 * Based on: Edelsbrunner, Kirkpatrick, Seidel. On the shape of a set of points in the plane. IEEE Trans. Inf. Theory
 * 1983.
 *           Edelsbrunner. The union of balls and its dual shape. DCG 1995. */
#include "alpha/simplex_values.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include <assert.h>
#include <math.h>

enum { CHUNK = 1 << 16 }; /* of simplices, between two looks at the progress callback */

typedef struct {
    brio_context *ctx;
    const brio_triangle *triangle;
    size_t num_finite, num_points;
    brio_records records;
    brio_alpha_complex *out;
} evaluation;

static void find_triangle(const evaluation *e, size_t t) {
    brio_alpha_complex *c = e->out;
    uint32_t *vertex = c->simplices[2] + 3 * t;
    brio_put_simplex(e->triangle[t].vertex, 3, vertex);
    c->values[2][t] = c->solid[2][t] = brio_own_value(&e->records, vertex, 3);
    c->gabriel[2][t] = 1;
}

/* Finds edge n, which has the handle h. */
static void find_edge(const evaluation *e, uint32_t h, size_t n) {
    const uint32_t *own = e->triangle[h >> 2].vertex, slot = h & 3, mate = e->triangle[h >> 2].mate[slot];
    assert(h >> 2 < e->num_finite && slot < 3 && (mate & 3) < 3);
    const uint32_t side[2] = {h, mate}, seen[2] = {own[(slot + 1) % 3], own[(slot + 2) % 3]};
    uint32_t *vertex = e->out->simplices[1] + 2 * n;
    brio_put_simplex(seen, 2, vertex);
    double value = INFINITY;
    bool gabriel = true;
    for (int s = 0; s < 2; s++) {
        uint32_t t = side[s] >> 2;
        if (t >= e->num_finite) continue;
        value = fmin(value, e->out->values[2][t]);
        gabriel = gabriel && !brio_is_inside(&e->records, vertex, 2, e->triangle[t].vertex[side[s] & 3]);
    }
    e->out->solid[1][n] = value;
    if (gabriel) value = fmin(value, brio_own_value(&e->records, vertex, 2));
    e->out->values[1][n] = value;
    e->out->gabriel[1][n] = gabriel;
}

/* Returns whether an edge is found at this handle: its lower handle, or that of its finite triangle, since finite
 * triangles come first. */
static bool is_first(const evaluation *e, size_t t, uint32_t slot) {
    return 4 * (uint32_t)t + slot < e->triangle[t].mate[slot];
}

static void count_simplices(const evaluation *e, uint32_t *place) {
    size_t *counts = e->out->counts;
    counts[2] = e->num_finite;
    for (size_t t = 0; t < e->num_finite; t++)
        for (uint32_t i = 0; i < 3; i++) {
            counts[1] += is_first(e, t, i);
            place[e->triangle[t].vertex[i]] = 1;
        }
    for (size_t p = 0; p < e->num_points; p++)
        if (place[p]) place[p] = (uint32_t)counts[0]++;
}

static brio_status evaluate(const evaluation *e, const uint32_t *place) {
    brio_alpha_complex *c = e->out;
    size_t edges = 0;
    for (size_t t = 0; t < e->num_finite; t++) {
        if (t % CHUNK == 0) BRIO_FORWARD(brio_progress(e->ctx, "values", 0.5 * (double)t / (double)e->num_finite));
        find_triangle(e, t);
        for (int i = 0; i < 3; i++) c->simplices[0][place[e->triangle[t].vertex[i]]] = e->triangle[t].vertex[i];
    }
    for (size_t t = 0; t < e->num_finite; t++) {
        if (t % CHUNK == 0)
            BRIO_FORWARD(brio_progress(e->ctx, "values", 0.5 + 0.5 * (double)t / (double)e->num_finite));
        for (uint32_t i = 0; i < 3; i++)
            if (is_first(e, t, i)) find_edge(e, 4 * (uint32_t)t + i, edges++);
    }
    assert(edges == c->counts[1] && c->counts[0] + c->counts[2] == edges + 1); /* Euler: a disk */
    return brio_find_vertex_values(e->ctx, c, &e->records, place);
}

static brio_status find_values(evaluation *e, const double *points, int coordinates, const double *weights) {
    brio_status status = BRIO_OK;
    uint32_t *place = NULL;
    BRIO_TRY(brio_records_take(e->ctx, points, coordinates, weights, e->num_points, &e->records));
    BRIO_TRY(BRIO_ALLOC_ZERO(e->ctx, place, e->num_points));
    count_simplices(e, place);
    BRIO_TRY(brio_alpha_room(e->ctx, e->out));
    BRIO_TRY(evaluate(e, place));
done:
    brio_release(e->ctx, e->records.of);
    brio_release(e->ctx, place);
    return status;
}

brio_status brio_alpha_values2(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                               const double *weights, size_t num_points, brio_alpha_complex *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    brio_alpha_complex mine = {.size = sizeof mine, .context = ctx, .triangulation2 = t};
    evaluation e = {.ctx = ctx,
                    .triangle = brio_triangulation2_triangles(t),
                    .num_finite = s->triangles,
                    .num_points = num_points,
                    .out = &mine};
    brio_status size = BRIO_CHECK_OWNER(ctx, brio_alpha_complex, out, triangulation2);
    if (size != BRIO_OK) return size;
    BRIO_REQUIRE(ctx, num_points == s->points, BRIO_ERR_ARGUMENT, "the triangulation has %zu points, not %zu",
                 s->points, num_points);
    BRIO_REQUIRE(ctx, s->dimension == 2, BRIO_ERR_NO_ANSWER,
                 "%zu vertices (%zu points are hidden) of dimension %d have no triangles, so no alpha complex",
                 s->vertices, s->hidden, s->dimension);
    BRIO_TRY(find_values(&e, points, s->coordinates, weights));
done:
    if (status != BRIO_OK) brio_alpha_complex_free(&mine);
    if (status != BRIO_OK) mine = (brio_alpha_complex){.size = sizeof mine};
    BRIO_GIVE(brio_alpha_complex, out, &mine);
    return status;
}
