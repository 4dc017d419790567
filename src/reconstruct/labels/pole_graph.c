/* The graph of poles.
 *
 * A tetrahedron lists an edge if it comes before both of its neighbours in the ring round the edge. The first
 * tetrahedron of a ring does so, and seldom another one: removing duplicates from the pole's short list costs less than
 * walking round the ring for the first tetrahedron. The list is sorted, so the result does not depend on the threads.
 * Each edge is listed at its end of higher number, weighed, and then stored at both ends.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.3.
 * Differs from the paper, in the balanced graph: where samples are few, the paper's weights mislead. There a very deep
 * intersection is the surest sign of one label. Balls that intersect a little have different labels more often than
 * not. The two poles of a badly shaped cell may have the same label. */
#include "reconstruct/labels/pole_graph.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/sort.h"
#include "base/team.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* STEP: tetrahedra between two calls of the progress callback. All chosen. */
enum { STEP = 1 << 21, TETRAHEDRA_A_THREAD = 1 << 14, CHUNK = 1 << 10 };

/* Workspace of the construction. */
typedef struct {
    brio_pole_graph *g;
    int threads;  /* of all loops: there are fewer poles and samples than tetrahedra, but each takes longer */
    size_t start; /* the first tetrahedron of the step */
    const uint32_t *representative;
    brio_pole_evidence evidence;
    float *opposite;   /* #samples: the weight between the poles of the sample, 0 for no edge */
    size_t *first_low; /* #poles + 1: the neighbours of lower number of pole p are low[first_low[p]] to
                          low[first_low[p + 1] - 1] */
    uint64_t *low;     /* keys of such neighbours (key_of); NOTHING after the last one of each pole */
    size_t *place;     /* #poles: the index where the pole's next edge is stored; while edges are counted, their
                          number */
    uint64_t *edge;    /* the edges as keys (key_of) */
} builder;

static const uint64_t NOTHING = UINT64_MAX;

/* The weights of balanced evidence, chosen on one model, cheese. docs/decisions/008-balanced-weights.md lists the
 * results there and on sparse random samples of seven other models. */
static const double TOUCHING = -0.95, SHALLOW = -0.5, SHALLOW_WEIGHT = 0.1;

static const double *centre_of(const brio_pole_graph *g, uint32_t p) {
    return g->diagram->poles->centre + 3 * (size_t)p;
}

/* --- weights --- */

/* Returns the weight of two neighbours in the balanced graph. Where samples are few, balls that intersect deeply nearly
 * always have the same label, and balls that intersect a little mostly have different labels. An intersection at a
 * right angle, or one where the balls all but touch, says nothing. */
static double balanced_weight(double weight) {
    if (weight > 0) return weight < 1 ? weight * weight : 1;
    return weight > TOUCHING && weight < SHALLOW ? -SHALLOW_WEIGHT : 0;
}

/* Returns the factor of the weight between the poles of a cell. A badly shaped cell does not show where the surface is:
 * at an edge with too few samples both poles may be on one side. The sixth power is chosen. */
static double trust_in(double shape) {
    double share = shape / BRIO_TRUSTED_SHAPE;
    return share < 1 ? share * share * share * share * share * share : 1;
}

/* Computes the weight of the edge between neighbours p and q. Returns whether there is an edge. */
static bool weigh_neighbours(const builder *b, uint32_t p, uint32_t q, float *weight) {
    double of_balls = brio_ball_weight(b->g->diagram->poles, p, q);
    *weight = (float)(b->evidence.balanced ? balanced_weight(of_balls) : fmax(fmin(of_balls, 1), 0));
    return b->evidence.balanced ? *weight != 0 : of_balls > b->evidence.least;
}

/* --- edges as keys --- */

/* Returns an edge as a key, other end << 32 | bits of the weight, so that keys sort by the other end. */
static uint64_t key_of(uint32_t pole, float weight) {
    uint32_t bits;
    memcpy(&bits, &weight, sizeof bits);
    return (uint64_t)pole << 32 | bits;
}

static brio_signed_edge edge_of(uint64_t key) {
    brio_signed_edge e = {.node = (uint32_t)(key >> 32)};
    uint32_t bits = (uint32_t)key;
    memcpy(&e.weight, &bits, sizeof bits);
    return e;
}

/* Adds 1 to *count and returns its value before. Relaxed order suffices: other threads read the counts only after the
 * run, and each thread writes only at the index that it got. */
static inline size_t count_up(const builder *b, size_t *count) {
    return b->threads > 1 ? __atomic_fetch_add(count, 1, __ATOMIC_RELAXED) : (*count)++;
}

/* Sets first[p] to the sum of the counts before p, and count[p] to first[p]. */
static void first_places(size_t *first, size_t *count, size_t n) {
    first[n] = brio_counts_to_places(count, 1, n, 0);
    memcpy(first, count, n * sizeof *first);
}

/* --- neighbours of lower number --- */

/* Counts the edge between p and q at its end of higher number or, if the array `low` exists, stores it there. */
static inline void note(const builder *b, uint32_t p, uint32_t q) {
    uint32_t lower = p < q ? p : q;
    size_t at = count_up(b, &b->place[p < q ? q : p]);
    if (b->low) b->low[at] = key_of(lower, 0);
}

/* EDGES[set]: bit e is set if the two neighbours in the ring round edge e, which joins the slots PAIR[e], are behind
 * facets in `set`. */
static const uint8_t PAIR[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
static const uint8_t EDGES[16] = {0, 0, 0, 32, 0, 16, 4, 52, 0, 8, 2, 42, 1, 25, 7, 63};

/* Lists the edges of a tetrahedron for which both neighbours in the ring have higher numbers. */
static inline void note_tetrahedron(const builder *b, uint32_t tet) {
    const brio_tetrahedron *t = &b->g->diagram->power.tet[tet];
    unsigned later = 0;
    for (unsigned i = 0; i < 4; i++) later |= (unsigned)(brio_tet_of(t->mate[i]) > tet) << i;
    for (unsigned edges = EDGES[later]; edges; edges &= edges - 1) {
        const uint8_t *e = PAIR[__builtin_ctz(edges)];
        note(b, t->vertex[e[0]], t->vertex[e[1]]);
    }
}

static void note_tetrahedra(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) note_tetrahedron(b, (uint32_t)(b->start + tet));
}

static void note_hidden(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        if (b->representative[p] != p) note(b, (uint32_t)p, b->representative[p]);
}

static brio_status note_all(builder *b, double from, double to) {
    const brio_pole_graph *g = b->g;
    brio_status status = BRIO_OK;
    for (b->start = 0; b->start < g->diagram->num_finite; b->start += STEP) {
        size_t count = g->diagram->num_finite - b->start < STEP ? g->diagram->num_finite - b->start : STEP;
        BRIO_TRY(
            brio_progress(g->ctx, "label", from + (to - from) * (double)b->start / (double)g->diagram->num_finite));
        BRIO_TRY(brio_for_chunks(g->ctx, b->threads, count, CHUNK, note_tetrahedra, b));
    }
    BRIO_TRY(brio_for(g->ctx, b->threads, g->diagram->poles->count, note_hidden, b));
done:
    return status;
}

/* Keeps each neighbour of lower number of pole p once, with its weight, if there is an edge, and counts the edge at
 * both ends. */
static void weigh(const builder *b, uint32_t p) {
    uint64_t *low = b->low + b->first_low[p], last = NOTHING;
    size_t size = b->first_low[p + 1] - b->first_low[p], kept = 0;
    brio_sort_keys(low, size);
    for (size_t i = 0; i < size; i++) {
        if (low[i] == last) continue;
        last = low[i];
        uint32_t q = (uint32_t)(last >> 32);
        float weight;
        if (!weigh_neighbours(b, p, q, &weight)) continue;
        low[kept++] = key_of(q, weight);
        count_up(b, &b->place[p]);
        count_up(b, &b->place[q]);
    }
    if (kept < size) low[kept] = NOTHING;
}

static void weigh_part(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    for (size_t p = begin; p < end; p++) weigh(user, (uint32_t)p);
}

static brio_status list_neighbours(builder *b) {
    brio_status status = BRIO_OK;
    brio_context *ctx = b->g->ctx;
    size_t n = b->g->diagram->poles->count;
    BRIO_TRY(BRIO_ALLOC(ctx, b->first_low, n + 1));
    BRIO_TRY(note_all(b, 0, 0.15));
    first_places(b->first_low, b->place, n);
    BRIO_TRY(BRIO_ALLOC(ctx, b->low, b->first_low[n]));
    BRIO_TRY(note_all(b, 0.15, 0.3));
    memset(b->place, 0, n * sizeof *b->place);
    BRIO_TRY(brio_for_chunks(ctx, b->threads, n, CHUNK, weigh_part, b));
done:
    return status;
}

/* --- opposite poles --- */

static double dot_from(const double *o, const double *p, const double *q) {
    return (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]) + (p[2] - o[2]) * (q[2] - o[2]);
}

/* Returns the weight between the two poles of a sample, or 0 if there is no edge. */
static float opposite_weight(const builder *b, size_t sample) {
    const brio_pole_graph *g = b->g;
    uint32_t p = g->diagram->poles->of_sample[2 * sample], q = g->diagram->poles->of_sample[2 * sample + 1];
    if (p == BRIO_NO_POLE || q == BRIO_NO_POLE) return 0;
    const double *s = g->diagram->samples + 3 * sample, *x = centre_of(g, p), *y = centre_of(g, q);
    double cosine = dot_from(s, x, y) / sqrt(dot_from(s, x, x) * dot_from(s, y, y));
    double trust = b->evidence.balanced ? trust_in(g->diagram->poles->shape[sample]) : 1;
    return cosine < 0 ? (float)(trust * fmax(cosine, -1)) : 0;
}

static void weigh_opposite(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const brio_pole_graph *g = b->g;
    (void)thread;
    for (size_t s = begin; s < end; s++) {
        b->opposite[s] = opposite_weight(b, s);
        if (!(b->opposite[s] < 0)) continue;
        count_up(b, &b->place[g->diagram->poles->of_sample[2 * s]]);
        count_up(b, &b->place[g->diagram->poles->of_sample[2 * s + 1]]);
    }
}

static brio_status list_opposite(builder *b) {
    brio_context *ctx = b->g->ctx;
    brio_status status = BRIO_ALLOC(ctx, b->opposite, b->g->diagram->num_samples);
    if (status == BRIO_OK) status = brio_for(ctx, b->threads, b->g->diagram->num_samples, weigh_opposite, b);
    return status;
}

/* --- the graph --- */

static void deal(const builder *b, uint32_t p, uint32_t q, float weight) {
    b->edge[count_up(b, &b->place[p])] = key_of(q, weight);
    b->edge[count_up(b, &b->place[q])] = key_of(p, weight);
}

static void deal_out_neighbours(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        for (size_t i = b->first_low[p]; i < b->first_low[p + 1] && b->low[i] != NOTHING; i++) {
            brio_signed_edge e = edge_of(b->low[i]);
            deal(b, (uint32_t)p, e.node, e.weight);
        }
}

static void deal_out_opposite(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const uint32_t *of_sample = b->g->diagram->poles->of_sample;
    (void)thread;
    for (size_t s = begin; s < end; s++)
        if (b->opposite[s] < 0) deal(b, of_sample[2 * s], of_sample[2 * s + 1], b->opposite[s]);
}

/* Sorts the edges of each pole, and overwrites each key by the edge that it stands for, in place. */
static void sort_edges(void *user, size_t begin, size_t end, int thread) {
    const builder *b = user;
    const brio_pole_graph *g = b->g;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        brio_sort_keys(b->edge + g->first[p], g->first[p + 1] - g->first[p]);
        for (size_t i = g->first[p]; i < g->first[p + 1]; i++) {
            brio_signed_edge e = edge_of(b->edge[i]);
            memcpy(&b->edge[i], &e, sizeof e);
        }
    }
}

#ifndef NDEBUG
/* Returns whether the run of each pole's edges leads to other poles, in ascending order. */
static bool runs_are_sorted(const brio_pole_graph *g) {
    size_t n = g->diagram->poles->count;
    if (g->first[0] != 0) return false;
    for (size_t p = 0; p < n; p++) {
        if (g->first[p + 1] < g->first[p]) return false;
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
            if (g->edge[e].node >= n || g->edge[e].node == p) return false;
            if (e > g->first[p] && g->edge[e].node < g->edge[e - 1].node) return false;
        }
    }
    return true;
}
#endif

static brio_status list_edges(brio_pole_graph *g, const uint32_t *representative, brio_pole_evidence evidence) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    size_t n = g->diagram->poles->count;
    int threads = brio_threads(ctx, g->diagram->num_finite, TETRAHEDRA_A_THREAD);
    builder b = {.g = g, .threads = threads, .representative = representative, .evidence = evidence};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, b.place, n));
    BRIO_TRY(list_neighbours(&b));
    BRIO_TRY(list_opposite(&b));
    BRIO_TRY(BRIO_ALLOC(ctx, g->first, n + 1));
    first_places(g->first, b.place, n);
    BRIO_TRY(BRIO_ALLOC(ctx, b.edge, g->first[n]));
    BRIO_TRY(brio_for(ctx, threads, n, deal_out_neighbours, &b));
    BRIO_TRY(brio_for(ctx, threads, g->diagram->num_samples, deal_out_opposite, &b));
    BRIO_TRY(brio_for_chunks(ctx, threads, n, CHUNK, sort_edges, &b));
    g->edge = (brio_signed_edge *)b.edge; /* sort_edges overwrote the keys by edges, which have the same size */
    assert(runs_are_sorted(g));
done:
    if (status != BRIO_OK) brio_release(ctx, b.edge);
    brio_release(ctx, b.opposite);
    brio_release(ctx, b.first_low);
    brio_release(ctx, b.low);
    brio_release(ctx, b.place);
    return status;
}

brio_status brio_pole_graph_new(brio_context *ctx, const brio_power_diagram *diagram, brio_pole_evidence evidence,
                                brio_pole_graph *g) {
    *g = (brio_pole_graph){.ctx = ctx, .diagram = diagram};
    return list_edges(g, diagram->representative, evidence);
}

void brio_pole_graph_free(brio_pole_graph *g) {
    brio_release(g->ctx, g->first);
    brio_release(g->ctx, g->edge);
}
