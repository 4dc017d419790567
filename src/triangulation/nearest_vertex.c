/* The vertex of least power distance, by descent along edges: in a regular triangulation a vertex without a nearer
 * neighbour is the nearest of all.
 *
 * Samples of a sphere hide thousands of poles behind a few vertices with thousands of neighbours each. Searching the
 * whole star for every hidden point would be quadratic. So the search of a large star leaves a memory. The difference
 * of the power distances to vertex v and to a neighbour u changes by at most 2 |u - v| per unit of length. So within
 * some radius of the point only the rivals matter: neighbours whose power distance hardly differed. */
#include "triangulation/nearest_vertex.h"
#include "base/memory.h"
#include "base/vector.h"
#include <assert.h>
#include <string.h>

enum { LARGE_STAR = 256 };

/* Differences below this share of their terms may be rounding errors; chosen. */
static const double TRUSTED = 1e-9;
/* Far more than squares of subnormal differences can lose; chosen. */
static const double LOSS = 0x1p-900;

brio_status brio_nearest_new(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, const uint32_t *vertex_tet,
                             brio_nearest *out) {
    *out = (brio_nearest){.ctx = ctx, .t = t, .num_points = num_points, .vertex_tet = vertex_tet};
    for (int i = 0; i < BRIO_NEAREST_MEMORIES; i++) out->memory[i].vertex = t->infinite;
    brio_status status = BRIO_ALLOC_ZERO(ctx, out->seen, num_points);
    return status == BRIO_OK ? brio_star_new(ctx, t->count, &out->star) : status;
}

void brio_nearest_free(brio_nearest *n) {
    if (!n->ctx) return;
    for (int i = 0; i < BRIO_NEAREST_MEMORIES; i++) brio_release(n->ctx, n->memory[i].rival);
    brio_star_free(n->ctx, &n->star);
    brio_release(n->ctx, n->seen);
}

static bool is_point(const brio_nearest *n, uint32_t v) {
    return v < n->num_points;
}

/* Returns the vertex nearer to x by power distance; ties are lexicographic. */
static uint32_t nearer(const brio_nearest *n, const double *x, uint32_t u, uint32_t v) {
    const brio_record *r = n->t->record;
    if (u == v || !is_point(n, u)) return v;
    if (!is_point(n, v)) return u;
    int sign = brio_power_compare(x, r[u], r[v]);
    if (sign == 0) sign = brio_lexicographic(r[u], r[v]);
    return sign < 0 ? u : v;
}

/* Compares neighbour u with vertex m->vertex as seen from m->centre: u becomes a rival, or bounds the radius. */
static brio_status remember(brio_nearest *n, brio_nearest_memory *m, uint32_t u) {
    const double *a = n->t->record[m->vertex], *b = n->t->record[u];
    double to_a = brio_square_distance(m->centre, a), to_b = brio_square_distance(m->centre, b);
    double margin = to_b - b[3] - (to_a - a[3]);
    if (margin > TRUSTED * (to_a + to_b + fabs(a[3]) + fabs(b[3])) + LOSS) {
        m->radius = fmin(m->radius, margin / (4 * sqrt(brio_square_distance(a, b))));
        return BRIO_OK;
    }
    brio_status status = BRIO_RESERVE(n->ctx, m->rival, m->capacity, m->num_rivals + 1);
    if (status == BRIO_OK) m->rival[m->num_rivals++] = u;
    return status;
}

static brio_status remember_star(brio_nearest *n, uint32_t v, const double *x) {
    brio_nearest_memory *m = &n->memory[v % BRIO_NEAREST_MEMORIES];
    brio_status status = BRIO_OK;
    m->vertex = v;
    memcpy(m->centre, x, sizeof m->centre);
    m->radius = INFINITY;
    m->num_rivals = 0;
    for (size_t i = 0; i < 4 * n->star.size; i++) {
        uint32_t u = n->t->tet[n->star.tet[i / 4]].vertex[i % 4];
        if (u != v && is_point(n, u)) BRIO_TRY(remember(n, m, u));
    }
done:
    if (status != BRIO_OK) m->vertex = n->t->infinite;
    return status;
}

static const brio_nearest_memory *recall(const brio_nearest *n, uint32_t v, const double *x) {
    const brio_nearest_memory *m = &n->memory[v % BRIO_NEAREST_MEMORIES];
    return m->vertex == v && sqrt(brio_square_distance(x, m->centre)) < m->radius ? m : NULL;
}

/* Finds the nearest of a vertex and its neighbours. */
static brio_status look_around(brio_nearest *n, const double *x, uint32_t v, uint32_t *best) {
    const brio_nearest_memory *m = recall(n, v, x);
    *best = v;
    if (m) {
        for (size_t i = 0; i < m->num_rivals; i++) *best = nearer(n, x, *best, m->rival[i]);
        return BRIO_OK;
    }
    brio_status status = brio_star_collect(n->ctx, n->t, v, n->vertex_tet[v], SIZE_MAX, &n->star);
    if (status != BRIO_OK) return status;
    assert(v < n->num_points && n->look < UINT32_MAX);
    n->look++;
    for (size_t i = 0; i < 4 * n->star.size; i++) { /* each neighbour is in about five of these tetrahedra */
        uint32_t u = n->t->tet[n->star.tet[i / 4]].vertex[i % 4];
        if (!is_point(n, u) || n->seen[u] == n->look) continue;
        n->seen[u] = n->look;
        *best = nearer(n, x, *best, u);
    }
    return n->star.size > LARGE_STAR ? remember_star(n, v, x) : BRIO_OK;
}

brio_status brio_nearest_vertex(brio_nearest *n, uint32_t tet, const double *x, uint32_t *best) {
    const uint32_t *v = n->t->tet[tet].vertex;
    assert(brio_has_tet(n->t, tet));
    uint32_t next = nearer(n, x, nearer(n, x, v[0], v[1]), nearer(n, x, v[2], v[3]));
    do {
        *best = next;
        brio_status status = look_around(n, x, *best, &next);
        if (status != BRIO_OK) return status;
        assert(is_point(n, next));
    } while (next != *best);
    return BRIO_OK;
}
