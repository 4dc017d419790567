/* The graph of poles. Neighbours are read off the star of a pole when they are asked for; nothing is stored an edge. */
#include "reconstruct/pole_graph.h"
#include "base/memory.h"
#include <math.h>

enum { NONE = UINT32_MAX };

static brio_status filled(brio_context *ctx, uint32_t **array, size_t n, uint32_t value) {
    brio_status status = BRIO_ALLOC(ctx, *array, n);
    if (status == BRIO_OK)
        for (size_t i = 0; i < n; i++) (*array)[i] = value;
    return status;
}

brio_status brio_pole_graph_new(brio_context *ctx, const brio_poles *poles, const double *samples, size_t num_samples,
                                const brio_triangulation *power, brio_pole_graph *g) {
    brio_status status = BRIO_OK;
    const brio_stats *stats = brio_triangulation_stats(power);
    size_t n = poles->count, tets = stats->tetrahedra + stats->hull_facets;
    *g = (brio_pole_graph){.ctx = ctx, .poles = poles, .samples = samples, .num_samples = num_samples};
    g->num_finite = stats->tetrahedra;
    g->representative = brio_triangulation_representatives(power);
    /* the view is read only: the structure is shared with code that builds triangulations */
    g->power = (brio_tetrahedra){(uint32_t *)brio_triangulation_tetrahedra(power),
                                 (uint32_t *)brio_triangulation_mates(power), tets, BRIO_INFINITE, NULL};
    BRIO_TRY(filled(ctx, &g->vertex_tet, n, NONE));
    BRIO_TRY(filled(ctx, &g->first_of_pole, n, NONE));
    BRIO_TRY(filled(ctx, &g->next_of_pole, 2 * num_samples, NONE));
    BRIO_TRY(filled(ctx, &g->first_hidden, n, NONE));
    BRIO_TRY(filled(ctx, &g->next_hidden, n, NONE));
    BRIO_TRY(filled(ctx, &g->seen, n, 0));
    BRIO_TRY(brio_star_new(ctx, tets, &g->star));
    for (size_t i = 0; i < 4 * tets; i++)
        if (g->power.vertex[i] != BRIO_INFINITE) g->vertex_tet[g->power.vertex[i]] = (uint32_t)(i / 4);
    for (size_t i = 2 * num_samples; i-- > 0;) {
        uint32_t p = poles->of_sample[i];
        if (p == BRIO_NO_POLE) continue;
        g->next_of_pole[i] = g->first_of_pole[p];
        g->first_of_pole[p] = (uint32_t)i;
    }
    for (size_t p = n; p-- > 0;) {
        uint32_t r = g->representative[p];
        if (r == p) continue;
        g->next_hidden[p] = g->first_hidden[r];
        g->first_hidden[r] = (uint32_t)p;
    }
done:
    return status;
}

void brio_pole_graph_free(brio_pole_graph *g) {
    brio_release(g->ctx, g->vertex_tet);
    brio_release(g->ctx, g->first_of_pole);
    brio_release(g->ctx, g->next_of_pole);
    brio_release(g->ctx, g->first_hidden);
    brio_release(g->ctx, g->next_hidden);
    brio_release(g->ctx, g->seen);
    brio_star_free(g->ctx, &g->star);
}

static double dot_from(const double *o, const double *p, const double *q) {
    return (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]) + (p[2] - o[2]) * (q[2] - o[2]);
}

static const double *centre_of(const brio_pole_graph *g, uint32_t p) { return g->poles->centre + 3 * (size_t)p; }

void brio_pole_graph_opposite(const brio_pole_graph *g, uint32_t p, brio_pole_visit_fn visit, void *user) {
    for (uint32_t i = g->first_of_pole[p]; i != NONE; i = g->next_of_pole[i]) {
        uint32_t q = g->poles->of_sample[i ^ 1];
        if (q == BRIO_NO_POLE) continue;
        const double *s = g->samples + 3 * (size_t)(i / 2), *a = centre_of(g, p), *b = centre_of(g, q);
        double weight = -dot_from(s, a, b) / sqrt(dot_from(s, a, a) * dot_from(s, b, b));
        if (weight > 0) visit(q, fmin(weight, 1), user);
    }
}

/* Visits q when the balls of p and q intersect deeply. */
static void visit_neighbour(const brio_pole_graph *g, uint32_t p, uint32_t q, brio_pole_visit_fn visit, void *user) {
    const double *a = centre_of(g, p), *b = centre_of(g, q);
    double pp = g->poles->square[p], qq = g->poles->square[q], x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    double weight = (pp + qq - (x * x + y * y + z * z)) / (2 * sqrt(pp) * sqrt(qq));
    if (weight > 0) visit(q, fmin(weight, 1), user);
}

brio_status brio_pole_graph_neighbours(brio_pole_graph *g, uint32_t p, brio_pole_visit_fn visit, void *user) {
    uint32_t r = g->representative[p];
    if (r != p) {
        visit_neighbour(g, p, r, visit, user);
        return BRIO_OK;
    }
    for (uint32_t q = g->first_hidden[p]; q != NONE; q = g->next_hidden[q]) visit_neighbour(g, p, q, visit, user);
    brio_status status = brio_star_collect(g->ctx, &g->power, p, g->vertex_tet[p], &g->star);
    if (status != BRIO_OK) return status;
    g->seen[p] = ++g->visit;
    for (size_t n = 0; n < g->star.size; n++)
        for (size_t i = 0; i < 4; i++) {
            uint32_t q = g->power.vertex[4 * (size_t)g->star.tet[n] + i];
            if (q == BRIO_INFINITE || g->seen[q] == g->visit) continue;
            g->seen[q] = g->visit;
            visit_neighbour(g, p, q, visit, user);
        }
    return BRIO_OK;
}
