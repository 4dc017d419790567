/* The graph of poles: deep edges between neighbours in one array, read off the star of each pole once. */
#include "reconstruct/pole_graph.h"
#include "base/memory.h"
#include <math.h>

enum { NONE = UINT32_MAX };

/* Workspace of the construction. */
typedef struct {
    brio_pole_graph *g;
    const uint32_t *representative;
    uint32_t *vertex_tet;                 /* a tetrahedron of each pole with a cell */
    uint32_t *first_hidden, *next_hidden; /* list of the hidden poles of each representative */
    uint32_t *seen;                       /* last pole whose neighbours this one was offered to */
    brio_star star;
    double least_weight;
    size_t num_edges, pole_capacity, weight_capacity;
} builder;

static brio_status filled(brio_context *ctx, uint32_t **array, size_t n, uint32_t value) {
    brio_status status = BRIO_ALLOC(ctx, *array, n);
    if (status == BRIO_OK)
        for (size_t i = 0; i < n; i++) (*array)[i] = value;
    return status;
}

static const double *centre_of(const brio_pole_graph *g, uint32_t p) {
    return g->poles->centre + 3 * (size_t)p;
}

double brio_pole_graph_weight(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    const double *a = centre_of(g, p), *b = centre_of(g, q);
    double pp = g->poles->square[p], qq = g->poles->square[q], x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return (pp + qq - (x * x + y * y + z * z)) / (2 * sqrt(pp * qq));
}

/* Room for one more edge is there; written always, counted when it is deep enough. */
static inline void add_edge(builder *b, uint32_t p, uint32_t q) {
    double weight = brio_pole_graph_weight(b->g, p, q);
    b->g->edge_pole[b->num_edges] = q;
    b->g->edge_weight[b->num_edges] = (float)fmin(weight, 1);
    b->num_edges += weight > b->least_weight;
}

static brio_status reserve_edges(builder *b, size_t more) {
    brio_context *ctx = b->g->ctx;
    brio_status status = BRIO_RESERVE(ctx, b->g->edge_pole, b->pole_capacity, b->num_edges + more);
    if (status != BRIO_OK) return status;
    return BRIO_RESERVE(ctx, b->g->edge_weight, b->weight_capacity, b->num_edges + more);
}

static brio_status add_neighbours(builder *b, uint32_t p) {
    brio_pole_graph *g = b->g;
    brio_status status = BRIO_OK;
    if (b->representative[p] != p) {
        BRIO_TRY(reserve_edges(b, 1));
        add_edge(b, p, b->representative[p]);
        goto done;
    }
    for (uint32_t q = b->first_hidden[p]; q != NONE; q = b->next_hidden[q]) {
        BRIO_TRY(reserve_edges(b, 1));
        add_edge(b, p, q);
    }
    BRIO_TRY(brio_star_collect(g->ctx, &g->power, p, b->vertex_tet[p], SIZE_MAX, &b->star));
    BRIO_TRY(reserve_edges(b, b->star.size + 1)); /* fewer neighbours than tetrahedra */
    b->seen[p] = p;
    for (size_t n = 0; n < b->star.size; n++)
        for (size_t i = 0; i < 4; i++) {
            uint32_t q = g->power.tet[b->star.tet[n]].vertex[i];
            if (q == BRIO_INFINITE || b->seen[q] == p) continue;
            b->seen[q] = p;
            add_edge(b, p, q);
        }
done:
    return status;
}

static brio_status add_all_neighbours(builder *b) {
    brio_pole_graph *g = b->g;
    brio_context *ctx = g->ctx;
    brio_status status = BRIO_OK;
    size_t n = g->poles->count;
    BRIO_TRY(filled(ctx, &b->vertex_tet, n, NONE));
    BRIO_TRY(filled(ctx, &b->first_hidden, n, NONE));
    BRIO_TRY(filled(ctx, &b->next_hidden, n, NONE));
    BRIO_TRY(filled(ctx, &b->seen, n, NONE));
    BRIO_TRY(brio_star_new(ctx, g->power.count, &b->star));
    for (size_t i = 0; i < 4 * g->power.count; i++) {
        uint32_t v = g->power.tet[i / 4].vertex[i % 4];
        if (v != BRIO_INFINITE) b->vertex_tet[v] = (uint32_t)(i / 4);
    }
    for (size_t p = n; p-- > 0;) {
        uint32_t r = b->representative[p];
        if (r == p) continue;
        b->next_hidden[p] = b->first_hidden[r];
        b->first_hidden[r] = (uint32_t)p;
    }
    BRIO_TRY(BRIO_ALLOC(ctx, g->first_edge, n + 1));
    for (size_t p = 0; p < n; p++) {
        if (p % 65536 == 0) BRIO_TRY(brio_progress(ctx, "label", 0.5 * (double)p / (double)n));
        g->first_edge[p] = b->num_edges;
        BRIO_TRY(add_neighbours(b, (uint32_t)p));
    }
    g->first_edge[n] = b->num_edges;
done:
    brio_release(ctx, b->vertex_tet);
    brio_release(ctx, b->first_hidden);
    brio_release(ctx, b->next_hidden);
    brio_release(ctx, b->seen);
    brio_star_free(ctx, &b->star);
    return status;
}

static brio_status list_samples(brio_pole_graph *g) {
    brio_status status = BRIO_OK;
    BRIO_TRY(filled(g->ctx, &g->first_of_pole, g->poles->count, NONE));
    BRIO_TRY(filled(g->ctx, &g->next_of_pole, 2 * g->num_samples, NONE));
    for (size_t i = 2 * g->num_samples; i-- > 0;) {
        uint32_t p = g->poles->of_sample[i];
        if (p == BRIO_NO_POLE) continue;
        g->next_of_pole[i] = g->first_of_pole[p];
        g->first_of_pole[p] = (uint32_t)i;
    }
done:
    return status;
}

brio_status brio_pole_graph_new(brio_context *ctx, const brio_poles *poles, const double *samples, size_t num_samples,
                                const brio_triangulation *power, double least_weight, brio_pole_graph *g) {
    brio_status status = BRIO_OK;
    const brio_stats *stats = brio_triangulation_stats(power);
    *g = (brio_pole_graph){.ctx = ctx, .poles = poles, .samples = samples, .num_samples = num_samples};
    g->num_finite = stats->tetrahedra;
    /* the view is read only: the structure is shared with code that builds triangulations */
    g->power = (brio_tetrahedra){.tet = (brio_tetrahedron *)brio_triangulation_tetrahedra(power),
                                 .count = stats->tetrahedra + stats->hull_facets,
                                 .infinite = BRIO_INFINITE};
    builder b = {.g = g, .representative = brio_triangulation_representatives(power), .least_weight = least_weight};
    BRIO_TRY(list_samples(g));
    BRIO_TRY(add_all_neighbours(&b));
done:
    return status;
}

void brio_pole_graph_free(brio_pole_graph *g) {
    brio_release(g->ctx, g->first_of_pole);
    brio_release(g->ctx, g->next_of_pole);
    brio_release(g->ctx, g->first_edge);
    brio_release(g->ctx, g->edge_pole);
    brio_release(g->ctx, g->edge_weight);
}

static double dot_from(const double *o, const double *p, const double *q) {
    return (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]) + (p[2] - o[2]) * (q[2] - o[2]);
}

void brio_pole_graph_opposite(const brio_pole_graph *g, uint32_t p, brio_pole_visit_fn visit, void *user) {
    for (uint32_t i = g->first_of_pole[p]; i != NONE; i = g->next_of_pole[i]) {
        uint32_t q = g->poles->of_sample[i ^ 1];
        if (q == BRIO_NO_POLE) continue;
        const double *s = g->samples + 3 * (size_t)(i / 2), *a = centre_of(g, p), *b = centre_of(g, q);
        double weight = -dot_from(s, a, b) / sqrt(dot_from(s, a, a) * dot_from(s, b, b));
        if (weight > 0) visit(q, fmin(weight, 1), user);
    }
}
