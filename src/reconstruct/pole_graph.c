/* The graph of poles.
 *
 * An edge of the regular triangulation is read off the first tetrahedron of its ring. Most of the others see from their
 * own facets that a neighbour in the ring comes before them; only the rest walk round. One pass over the tetrahedra
 * counts the edges of each pole and remembers which tetrahedron leads which, a second one deals the edges out, and the
 * short list of each pole is sorted, so that the threads leave no trace.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.3.
 * Differs from the paper, in the balanced graph: where samples are few, its weights mislead. There the surest sign of one
 * label is a very deep intersection, balls that meet a little have different labels more often than not, and the two
 * poles of a badly shaped cell may have the same. */
#include "reconstruct/pole_graph.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/sort.h"
#include "surface/edge_rings.h"
#include "triangulation/ring.h"
#include <math.h>
#include <string.h>

enum { STEP = 1 << 21, AHEAD = 8 }; /* tetrahedra between two looks at the caller's wish to stop, and to fetch ahead */

/* Of balanced evidence. Chosen on cheese (genus 133, 68 found with plain weights, 123 with these, 113 to 126 nearby) and
 * held against random samples of smooth models, too few for them. */
static const double TOUCHING = -0.95, SHALLOW = -0.5, SHALLOW_WEIGHT = 0.1;

/* Workspace of the construction. */
typedef struct {
    brio_pole_graph *g;
    int threads;
    const uint32_t *representative;
    brio_pole_evidence evidence;
    uint8_t *leads;  /* of each finite tetrahedron, a bit for each of its edges that it leads and that says something */
    size_t *place;   /* of each pole, where its next edge goes */
    uint64_t *edges; /* (pole, bits of the weight) */
} builder;

static const uint8_t PAIR[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static const double *centre_of(const brio_pole_graph *g, uint32_t p) {
    return g->poles->centre + 3 * (size_t)p;
}

static inline double weight_of(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    const double *a = centre_of(g, p), *b = centre_of(g, q);
    double pp = g->poles->square[p], qq = g->poles->square[q], x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return (pp + qq - (x * x + y * y + z * z)) / (2 * sqrt(pp * qq));
}

/* What two balls say of their labels where samples may be few: there, too, deeply intersecting ones nearly always have
 * the same label, at a right angle they tell nothing, and balls that intersect a little mostly have different ones.
 * Balls that all but touch can be anywhere. */
static double balanced_weight(double weight) {
    if (weight > 0) return weight < 1 ? weight * weight : 1;
    return weight > TOUCHING && weight < SHALLOW ? -SHALLOW_WEIGHT : 0;
}

/* A badly shaped cell does not tell where the surface is: at an edge with too few samples both poles may well be on one
 * side. */
static double trust_in(double shape) {
    double share = shape / BRIO_TRUSTED_SHAPE;
    return share < 1 ? share * share * share * share * share * share : 1;
}

double brio_pole_graph_weight(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    return weight_of(g, p, q);
}

/* --- neighbours --- */

static bool says_something(const builder *b, double weight) {
    return b->evidence.balanced ? balanced_weight(weight) != 0 : weight > b->evidence.least;
}

static void count_edge(const builder *b, uint32_t p, uint32_t q) {
    __atomic_fetch_add(&b->place[p], 1, __ATOMIC_RELAXED);
    __atomic_fetch_add(&b->place[q], 1, __ATOMIC_RELAXED);
}

static void put_edge(const builder *b, uint32_t p, uint32_t q, double weight) {
    float w = (float)(b->evidence.balanced ? balanced_weight(weight) : fmin(fmax(weight, 0), 1));
    uint32_t bits;
    memcpy(&bits, &w, sizeof bits);
    b->edges[__atomic_fetch_add(&b->place[p], 1, __ATOMIC_RELAXED)] = (uint64_t)q << 32 | bits;
    b->edges[__atomic_fetch_add(&b->place[q], 1, __ATOMIC_RELAXED)] = (uint64_t)p << 32 | bits;
}

static void count_tetrahedron(const builder *b, uint32_t tet) {
    const uint32_t *v = b->g->power.tet[tet].vertex;
    b->leads[tet] = 0;
    for (int e = 0; e < 6; e++) {
        uint32_t p = v[PAIR[e][0]], q = v[PAIR[e][1]];
        if (!brio_ring_may_lead(&b->g->power, tet, PAIR[e][0], PAIR[e][1])) continue;
        if (!says_something(b, weight_of(b->g, p, q))) continue;
        if (!brio_ring_size(&b->g->power, tet, PAIR[e][0], PAIR[e][1])) continue;
        b->leads[tet] |= (uint8_t)(1 << e);
        count_edge(b, p, q);
    }
}

static void put_tetrahedron(const builder *b, uint32_t tet) {
    const uint32_t *v = b->g->power.tet[tet].vertex;
    for (int e = 0; e < 6; e++) {
        uint32_t p = v[PAIR[e][0]], q = v[PAIR[e][1]];
        if (b->leads[tet] >> e & 1) put_edge(b, p, q, weight_of(b->g, p, q));
    }
}

static void put_hidden(const builder *b, uint32_t p, bool count) {
    uint32_t r = b->representative[p];
    double weight;
    if (r == p || !says_something(b, weight = weight_of(b->g, p, r))) return;
    if (count)
        count_edge(b, p, r);
    else
        put_edge(b, p, r, weight);
}

/* Counts all edges, or deals them out. */
static brio_status pass(const builder *b, bool count, double from, double to) {
    const brio_pole_graph *g = b->g;
    brio_status status = BRIO_OK;
    for (size_t begin = 0; begin < g->num_finite; begin += STEP) {
        size_t end = g->num_finite - begin < STEP ? g->num_finite : begin + STEP;
        BRIO_TRY(brio_progress(g->ctx, "label", from + (to - from) * (double)begin / (double)g->num_finite));
        BRIO_OMP(parallel for schedule(dynamic, 1024) num_threads(b->threads))
        for (size_t tet = begin; tet < end; tet++) {
            if (count) {
                if (tet + AHEAD < end) brio_ring_fetch(&g->power, tet + AHEAD);
                count_tetrahedron(b, (uint32_t)tet);
            } else if (b->leads[tet]) {
                put_tetrahedron(b, (uint32_t)tet);
            }
        }
    }
    BRIO_OMP(parallel for num_threads(b->threads))
    for (size_t p = 0; p < g->poles->count; p++) put_hidden(b, (uint32_t)p, count);
done:
    return status;
}

/* first[p] = sum of the counts before p; counts become places. */
static void first_places(size_t *first, size_t *count, size_t n) {
    first[0] = 0;
    for (size_t p = 0; p < n; p++) {
        first[p + 1] = first[p] + count[p];
        count[p] = first[p];
    }
}

static void sort_edges(const builder *b) {
    const brio_pole_graph *g = b->g;
    BRIO_OMP(parallel for schedule(dynamic, 1024) num_threads(b->threads))
    for (size_t p = 0; p < g->poles->count; p++) {
        brio_sort_keys(b->edges + g->first_edge[p], g->first_edge[p + 1] - g->first_edge[p]);
        for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++) {
            uint32_t bits = (uint32_t)b->edges[e];
            g->edge_pole[e] = (uint32_t)(b->edges[e] >> 32);
            memcpy(&g->edge_weight[e], &bits, sizeof bits);
        }
    }
}

static brio_status list_neighbours(brio_pole_graph *g, const uint32_t *representative, brio_pole_evidence evidence) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    size_t n = g->poles->count;
    builder b = {.g = g, .threads = brio_context_threads(ctx), .representative = representative, .evidence = evidence};
    BRIO_TRY(BRIO_ALLOC(ctx, b.leads, g->num_finite));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, b.place, n));
    BRIO_TRY(BRIO_ALLOC(ctx, g->first_edge, n + 1));
    BRIO_TRY(pass(&b, true, 0, 0.3));
    first_places(g->first_edge, b.place, n);
    BRIO_TRY(BRIO_ALLOC(ctx, b.edges, g->first_edge[n]));
    BRIO_TRY(pass(&b, false, 0.3, 0.4));
    BRIO_TRY(BRIO_ALLOC(ctx, g->edge_pole, g->first_edge[n]));
    BRIO_TRY(BRIO_ALLOC(ctx, g->edge_weight, g->first_edge[n]));
    sort_edges(&b);
done:
    brio_release(ctx, b.leads);
    brio_release(ctx, b.place);
    brio_release(ctx, b.edges);
    return status;
}

/* --- opposite poles --- */

static double dot_from(const double *o, const double *p, const double *q) {
    return (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]) + (p[2] - o[2]) * (q[2] - o[2]);
}

/* The other pole of sample i / 2 than the one on side i % 2, and the weight of the edge between them. */
static void set_opposite(brio_pole_graph *g, size_t e, size_t i, bool balanced) {
    uint32_t p = g->poles->of_sample[i], q = g->poles->of_sample[i ^ 1];
    const double *s = g->samples + 3 * (i / 2), *a = centre_of(g, p), *b = centre_of(g, q);
    double weight = -dot_from(s, a, b) / sqrt(dot_from(s, a, a) * dot_from(s, b, b));
    g->opposite_pole[e] = q;
    g->opposite_weight[e] = weight > 0 ? fmin(weight, 1) : 0;
    if (balanced) g->opposite_weight[e] *= trust_in(g->poles->shape[i / 2]);
}

static bool has_both(const brio_pole_graph *g, size_t i) {
    return g->poles->of_sample[i] != BRIO_NO_POLE && g->poles->of_sample[i ^ 1] != BRIO_NO_POLE;
}

static brio_status list_opposite(brio_pole_graph *g, bool balanced) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    size_t n = g->poles->count, *place = NULL, *pairs = NULL; /* 2 sample + side of each edge */
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, n));
    BRIO_TRY(BRIO_ALLOC(ctx, g->first_opposite, n + 1));
    for (size_t i = 0; i < 2 * g->num_samples; i++)
        if (has_both(g, i)) place[g->poles->of_sample[i]]++;
    first_places(g->first_opposite, place, n);
    size_t num_edges = g->first_opposite[n];
    BRIO_TRY(BRIO_ALLOC(ctx, pairs, num_edges));
    BRIO_TRY(BRIO_ALLOC(ctx, g->opposite_pole, num_edges));
    BRIO_TRY(BRIO_ALLOC(ctx, g->opposite_weight, num_edges));
    for (size_t i = 0; i < 2 * g->num_samples; i++)
        if (has_both(g, i)) pairs[place[g->poles->of_sample[i]]++] = i;
    BRIO_OMP(parallel for num_threads(brio_context_threads(ctx)))
    for (size_t e = 0; e < num_edges; e++) set_opposite(g, e, pairs[e], balanced);
done:
    brio_release(ctx, place);
    brio_release(ctx, pairs);
    return status;
}

/* --- the graph --- */

brio_status brio_pole_graph_new(brio_context *ctx, const brio_poles *poles, const double *samples, size_t num_samples,
                                const brio_triangulation *power, brio_pole_evidence evidence, brio_pole_graph *g) {
    brio_status status = BRIO_OK;
    const brio_stats *stats = brio_triangulation_stats(power);
    *g = (brio_pole_graph){.ctx = ctx, .poles = poles, .samples = samples, .num_samples = num_samples};
    g->num_finite = stats->tetrahedra;
    /* the view is read only: the structure is shared with code that builds triangulations */
    g->power = (brio_tetrahedra){.tet = (brio_tetrahedron *)brio_triangulation_tetrahedra(power),
                                 .count = stats->tetrahedra + stats->hull_facets,
                                 .infinite = BRIO_INFINITE};
    BRIO_TRY(list_opposite(g, evidence.balanced));
    BRIO_TRY(list_neighbours(g, brio_triangulation_representatives(power), evidence));
done:
    return status;
}

void brio_pole_graph_free(brio_pole_graph *g) {
    brio_release(g->ctx, g->first_opposite);
    brio_release(g->ctx, g->opposite_pole);
    brio_release(g->ctx, g->opposite_weight);
    brio_release(g->ctx, g->first_edge);
    brio_release(g->ctx, g->edge_pole);
    brio_release(g->ctx, g->edge_weight);
}
