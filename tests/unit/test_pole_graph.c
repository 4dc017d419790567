/* The graph of poles against all pairs of vertices of the triangulation, the queue of poles against a search through all
 * of its entries, and blocks of poles settled by roof duality against all labels of a block. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "reconstruct/power_crust/labeled_poles.h"
#include "reconstruct/labels/pole_queue.h"
#include "reconstruct/labels/roof_duality.h"
#include "trial.h"

/* --- graph --- */

enum { SAMPLES = 300 };

static bool has_edge(const brio_pole_graph *g, uint32_t p, uint32_t q, double weight) {
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].node == q && fabs((double)g->edge[e].weight - weight) < 1e-6) return true;
    return false;
}

static size_t count_edges(const brio_pole_graph *g, uint32_t p, uint32_t q, bool opposite) {
    size_t count = 0;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        count += g->edge[e].node == q && (g->edge[e].weight < 0) == opposite;
    return count;
}

/* Each pair of vertices of a tetrahedron that intersects deeply is an edge, once, and no other pair is but, in the balanced
 * graph, those that intersect a little. */
static void check_neighbours(const brio_pole_graph *g, double least, bool balanced) {
    size_t n = g->diagram->poles->count, found = 0, listed = 0;
    uint8_t *pair = calloc(n * n, 1);
    for (size_t tet = 0; tet < g->diagram->num_finite; tet++)
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                pair[n * g->diagram->power.tet[tet].vertex[i] + g->diagram->power.tet[tet].vertex[j]] = 1;
    for (uint32_t p = 0; p < n; p++)
        for (uint32_t q = 0; q < n; q++) {
            if (p == q || !pair[n * p + q]) continue;
            double weight = brio_ball_weight(g->diagram->poles, p, q);
            size_t count = count_edges(g, p, q, false);
            EXPECT(count == (weight > least), "poles %u, %u: %zu edges of weight %g", p, q, count, weight);
            double wanted = fmax(0, fmin(1, balanced ? weight * weight : weight));
            if (count) EXPECT(has_edge(g, p, q, wanted), "poles %u, %u: %g", p, q, weight);
            if (balanced && weight > -0.95 && weight < -0.5)
                EXPECT(has_edge(g, p, q, -0.1), "poles %u, %u: %g", p, q, weight);
            found += count;
        }
    for (uint32_t p = 0; p < n; p++)
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++) listed += !(g->edge[e].weight < 0);
    EXPECT(found > 0 && listed >= found, "%zu, %zu", listed, found);
    free(pair);
}

/* The poles of a sample have an edge of the cosine of their angle, less where the cell is badly shaped and this counts. */
static void check_opposite(const brio_pole_graph *g, bool balanced, size_t *doubted) {
    for (size_t s = 0; s < g->diagram->num_samples; s++) {
        uint32_t p = g->diagram->poles->of_sample[2 * s], q = g->diagram->poles->of_sample[2 * s + 1];
        if (p == BRIO_NO_POLE || q == BRIO_NO_POLE || p == q) continue;
        const double *x = g->diagram->samples + 3 * s, *a = g->diagram->poles->centre + 3 * (size_t)p,
                     *b = g->diagram->poles->centre + 3 * (size_t)q;
        double ab = 0, aa = 0, bb = 0, trust = balanced ? fmin(1, pow(g->diagram->poles->shape[s] / 1.3, 6)) : 1;
        for (int k = 0; k < 3; k++) {
            ab += (a[k] - x[k]) * (b[k] - x[k]);
            aa += (a[k] - x[k]) * (a[k] - x[k]);
            bb += (b[k] - x[k]) * (b[k] - x[k]);
        }
        if (ab < 0) EXPECT(has_edge(g, p, q, trust * ab / sqrt(aa * bb)), "sample %zu", s);
        EXPECT(count_edges(g, p, q, true) == count_edges(g, q, p, true), "sample %zu", s);
        *doubted += trust < 1;
    }
}

static void edges_are_those_of_the_triangulation_and_the_samples(void) {
    static double p[3 * SAMPLES];
    brio_surface_options o = CRUST_OPTIONS;
    size_t doubted = 0;
    for (int shape = 0; shape < 4; shape++)
        for (int labeling = 0; labeling < TRIAL_LABELINGS; labeling++) {
            brio_context *ctx = new_context();
            brio_pole_request request;
            brio_labeled_poles l;
            brio_laboratory *lab;
            EXPECT(trial_labeling(ctx, labeling, &o.poles, &lab) == BRIO_OK);
            if (shape == 0) uniform_points(1, SAMPLES, p);
            if (shape == 1) clustered_points(2, SAMPLES, p);
            if (shape == 2) sphere_points(3, SAMPLES, p);
            if (shape == 3) integer_points(4, SAMPLES, 5, p);
            EXPECT(brio_pole_request_of(ctx, &o.poles, o.noise, o.seed, &request) == BRIO_OK);
            EXPECT(brio_labeled_poles_find(ctx, p, SAMPLES, &request, &l) == BRIO_OK, "%s", brio_message(ctx));
            bool balanced = labeling == BRIO_LABELING_GLOBAL;
            check_neighbours(&l.graph, labeling == TRIAL_THEORETICAL ? BRIO_DEEP_WEIGHT : 0, balanced);
            check_opposite(&l.graph, balanced, &doubted);
            brio_labeled_poles_free(&l);
            brio_laboratory_free(lab);
            EXPECT(brio_context_memory(ctx) == 0);
            brio_context_free(ctx);
        }
    EXPECT(doubted > 100, "%zu", doubted);
}

/* --- queue --- */

/* Priorities fall most of the time, and rise now and then. */
static void highest_priority_and_lowest_pole_come_first(void) {
    enum { MOST = 400 };
    brio_context *ctx = new_context();
    for (uint64_t trial = 0; trial < 40; trial++) {
        brio_rng rng = brio_rng_new(trial);
        uint32_t highest = trial % 2 ? 50 : UINT32_C(1) << 30, priority[MOST], pole[MOST];
        size_t n = 0;
        brio_pole_queue q = brio_pole_queue_new(ctx, highest);
        for (int step = 0; step < 3000; step++) {
            if (n < MOST && brio_rng_below(&rng, 5) < 3) {
                priority[n] = brio_rng_below(&rng, highest + 1), pole[n] = brio_rng_below(&rng, 100);
                EXPECT(brio_pole_queue_push(&q, pole[n], priority[n]) == BRIO_OK);
                n++;
                continue;
            }
            uint32_t p = 0, key = 0;
            bool found;
            size_t best = 0;
            EXPECT(brio_pole_queue_pop(&q, &p, &key, &found) == BRIO_OK && found == (n > 0));
            for (size_t i = 1; i < n; i++)
                if (priority[i] > priority[best] || (priority[i] == priority[best] && pole[i] < pole[best])) best = i;
            if (n == 0) continue;
            EXPECT(p == pole[best] && key == priority[best], "trial %d, step %d", (int)trial, step);
            priority[best] = priority[--n], pole[best] = pole[n];
        }
        brio_pole_queue_free(&q);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- blocks --- */

enum { NODES = 60, EDGES = 150 };

/* Nodes at random places, and random edges between near numbers, so that there are rounds of several blocks. */
typedef struct {
    brio_signed_graph g;
    double centre[3 * NODES];
    size_t first[NODES + 1];
    brio_signed_edge edge[2 * EDGES];
    uint8_t label[NODES], fixed[NODES];
} random_graph;

static void make_graph(random_graph *r, brio_context *ctx, uint64_t seed) {
    brio_rng rng = brio_rng_new(seed);
    uint32_t a[EDGES], b[EDGES];
    float w[EDGES];
    size_t count = 0;
    for (int e = 0; e < EDGES; e++) {
        a[e] = brio_rng_below(&rng, NODES), b[e] = (a[e] + 1 + brio_rng_below(&rng, 6)) % NODES;
        w[e] = (float)brio_rng_below(&rng, 9) / 4 - 1; /* 0, too; sums are exact */
    }
    for (uint32_t p = 0; p < NODES; p++) {
        r->first[p] = count;
        for (int e = 0; e < EDGES; e++)
            if (a[e] == p || b[e] == p) r->edge[count++] = (brio_signed_edge){a[e] == p ? b[e] : a[e], w[e]};
        for (int k = 0; k < 3; k++) r->centre[3 * p + (uint32_t)k] = p + brio_rng_double(&rng);
        r->label[p] = brio_rng_below(&rng, 2) ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        r->fixed[p] = brio_rng_below(&rng, 5) == 0;
    }
    r->first[NODES] = count;
    r->g = (brio_signed_graph){
        .ctx = ctx, .count = NODES, .position = r->centre, .exponent = 10, .first = r->first, .edge = r->edge};
}

static void check_blocks(const random_graph *r, const brio_node_blocks *b) {
    size_t round[NODES], places = 0;
    for (size_t i = 0; i < b->num_blocks; i++) round[i] = SIZE_MAX;
    for (size_t k = 0; k < b->num_rounds; k++) {
        EXPECT(b->first_round[k] < b->first_round[k + 1]);
        for (size_t i = b->first_round[k]; i < b->first_round[k + 1]; i++) round[b->block[i]] = k;
    }
    for (uint32_t p = 0; p < NODES; p++) {
        if (b->place[p] == BRIO_NO_PLACE) continue;
        EXPECT(b->node[b->place[p]] == p && !r->fixed[p]);
        places++;
    }
    EXPECT(places == b->count);
    for (size_t i = 0, end = 0; i < b->num_blocks; end += b->end[i] - b->begin[i], i++)
        EXPECT(b->end[i] > b->begin[i] && b->end[i] - b->begin[i] <= (size_t)1 << b->bits && end <= b->count);
    for (uint32_t p = 0; p < NODES; p++)
        for (size_t e = r->first[p]; e < r->first[p + 1] && !r->fixed[p]; e++) {
            uint32_t q = r->edge[e].node, here = b->place[p], there = b->place[q];
            if (r->edge[e].weight != 0 && brio_label_violates(r->label, p, r->edge[e]))
                EXPECT(here != BRIO_NO_PLACE && round[b->of[here]] != SIZE_MAX, "violated edge of pole %u", p);
            if (here == BRIO_NO_PLACE || there == BRIO_NO_PLACE || b->of[here] == b->of[there]) continue;
            size_t mine = round[b->of[here]], other = round[b->of[there]];
            EXPECT(mine != other || mine == SIZE_MAX, "poles %u and %u change together", p, q);
        }
}

static void blocks_of_a_round_are_apart(void) {
    static random_graph r;
    brio_context *ctx = new_context();
    size_t shared = 0;
    for (uint64_t trial = 0; trial < 300; trial++) {
        brio_node_blocks b, again;
        make_graph(&r, ctx, trial);
        brio_context_set_threads(ctx, 1);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){1 + (int)(trial % 4), NODES, trial},
                                     &b) == BRIO_OK);
        check_blocks(&r, &b);
        brio_context_set_threads(ctx, 3);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){1 + (int)(trial % 4), NODES, trial},
                                     &again) == BRIO_OK);
        EXPECT(again.num_rounds == b.num_rounds && !memcmp(again.place, b.place, sizeof *b.place * NODES) &&
               !memcmp(again.block, b.block, sizeof *b.block * b.first_round[b.num_rounds]));
        shared += b.first_round[b.num_rounds] > b.num_rounds;
        brio_node_blocks_free(&b);
        brio_node_blocks_free(&again);
    }
    EXPECT(shared > 100, "rounds of several blocks: %zu", shared);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Windows of the curve, of one block and larger, change no block, and of two that an edge joins the first stays the
 * first. */
static void windows_keep_the_order_of_joined_blocks(void) {
    static random_graph r;
    brio_context *ctx = new_context();
    size_t more = 0;
    for (uint64_t trial = 0; trial < 300; trial++) {
        brio_node_blocks b, in_windows;
        size_t round[NODES], later[NODES], wrong = 0;
        make_graph(&r, ctx, trial);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){1, NODES, trial}, &b) == BRIO_OK);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){1, trial % 12, trial}, &in_windows) ==
               BRIO_OK);
        check_blocks(&r, &in_windows);
        EXPECT(in_windows.num_blocks == b.num_blocks && in_windows.num_rounds >= b.num_rounds);
        EXPECT(in_windows.first_round[in_windows.num_rounds] == b.first_round[b.num_rounds]);
        more += in_windows.num_rounds > b.num_rounds;
        for (size_t i = 0; i < b.num_blocks; i++) round[i] = later[i] = SIZE_MAX;
        for (size_t k = 0; k < b.num_rounds; k++)
            for (size_t i = b.first_round[k]; i < b.first_round[k + 1]; i++) round[b.block[i]] = k;
        for (size_t k = 0; k < in_windows.num_rounds; k++)
            for (size_t i = in_windows.first_round[k]; i < in_windows.first_round[k + 1]; i++)
                later[in_windows.block[i]] = k;
        for (uint32_t p = 0; p < NODES; p++)
            for (size_t e = r.first[p]; e < r.first[p + 1]; e++) {
                uint32_t here = b.place[p], there = b.place[r.edge[e].node];
                if (here == BRIO_NO_PLACE || there == BRIO_NO_PLACE) continue;
                wrong += (round[b.of[here]] < round[b.of[there]]) != (later[b.of[here]] < later[b.of[there]]);
            }
        EXPECT(wrong == 0, "trial %d: %zu edges", (int)trial, wrong);
        brio_node_blocks_free(&b);
        brio_node_blocks_free(&in_windows);
    }
    EXPECT(more > 100, "more rounds than in one window: %zu", more);
    brio_context_free(ctx);
}

/* Moves the nodes from NEAR on far away, and leaves out the edges between them and the others. */
enum { NEAR = 40 };
static void part_graph(random_graph *r, double far) {
    size_t count = 0, begin = 0;
    for (uint32_t p = 0; p < NODES; p++) {
        size_t end = r->first[p + 1];
        r->first[p] = count;
        for (size_t e = begin; e < end; e++)
            if ((p < NEAR) == (r->edge[e].node < NEAR)) r->edge[count++] = r->edge[e];
        begin = end;
        for (uint32_t k = 0; k < 3 && p >= NEAR; k++) r->centre[3 * p + k] += far;
    }
    r->first[NODES] = count;
    r->g.exponent = 50;
}

/* Returns how many pairs of near nodes are in one block with some nodes far away, or without, and not in both. */
static size_t count_parted(const brio_node_blocks *a, const brio_node_blocks *b) {
    size_t parted = 0;
    for (uint32_t p = 0; p < NEAR; p++)
        for (uint32_t q = 0; q < p; q++) {
            if (a->place[p] == BRIO_NO_PLACE || a->place[q] == BRIO_NO_PLACE) continue;
            bool one = a->of[a->place[p]] == a->of[a->place[q]];
            parted += one != (b->of[b->place[p]] == b->of[b->place[q]]);
        }
    return parted;
}

/* Once cells were halved 21 times in each direction, and no more. */
static void blocks_do_not_depend_on_nodes_far_away(void) {
    static random_graph r;
    brio_context *ctx = new_context();
    size_t several = 0;
    for (uint64_t trial = 0; trial < 120; trial++) {
        brio_node_blocks alone, beside;
        int bits = 1 + (int)(trial % 3);
        make_graph(&r, ctx, trial);
        part_graph(&r, trial % 2 ? 0x1p30 : 0x1p48);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){bits, NODES, trial}, &beside) ==
               BRIO_OK);
        memset(r.fixed + NEAR, 1, NODES - NEAR);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){bits, NODES, trial}, &alone) == BRIO_OK);
        size_t parted = count_parted(&alone, &beside);
        EXPECT(parted == 0, "%zu pairs", parted);
        several += alone.num_blocks > 2 && beside.count > alone.count;
        brio_node_blocks_free(&alone);
        brio_node_blocks_free(&beside);
    }
    EXPECT(several > 100, "%zu", several);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static double energy_of(const random_graph *r) {
    double energy = NAN;
    EXPECT(brio_label_energy(&r->g, r->label, &energy) == BRIO_OK);
    return energy;
}

/* The least energy over all labels of the poles of a block. */
static double least_energy(random_graph *r, const uint32_t *pole, size_t size) {
    uint8_t kept[NODES];
    double least = INFINITY;
    memcpy(kept, r->label, sizeof kept);
    for (unsigned set = 0; set < 1u << size; set++) {
        for (size_t i = 0; i < size; i++) r->label[pole[i]] = set >> i & 1 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        least = fmin(least, energy_of(r));
    }
    memcpy(r->label, kept, sizeof kept);
    return least;
}

/* All labels of a block: nothing gets worse, and a block without open poles has the best ones. */
static void settled_blocks_have_least_energy(void) {
    enum { BITS = 3 };
    static random_graph r;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    brio_roof roof = {.flow = brio_flow_new(ctx)};
    size_t closed = 0, improved = 0;
    for (uint64_t trial = 0; trial < 60; trial++) {
        brio_node_blocks b;
        make_graph(&r, ctx, trial);
        EXPECT(brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){BITS, NODES, trial}, &b) == BRIO_OK);
        for (size_t block = 0; block < b.num_blocks; block++) {
            size_t begin = b.begin[block], size = b.end[block] - begin;
            double before = energy_of(&r), least = least_energy(&r, b.node + begin, size);
            roof.undecided = 0;
            EXPECT(brio_roof_settle(&roof, &r.g, &b, block, r.label) == BRIO_OK);
            double after = energy_of(&r);
            EXPECT(after <= before && after >= least, "%g, %g, least %g", before, after, least);
            if (roof.undecided == 0) EXPECT(after == least, "%g, least %g", after, least);
            closed += roof.undecided == 0, improved += after < before;
        }
        brio_node_blocks_free(&b);
    }
    EXPECT(closed > 60 && improved > 60, "%zu, %zu", closed, improved);
    brio_roof_free(&roof);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status settle_random_blocks(brio_context *ctx) {
    static random_graph r;
    brio_node_blocks b;
    brio_roof roof = {.flow = brio_flow_new(ctx)};
    make_graph(&r, ctx, 5);
    brio_context_set_threads(ctx, 2);
    brio_status status = brio_node_blocks_find(&r.g, r.label, r.fixed, (brio_block_rule){3, NODES, 5}, &b);
    for (size_t block = 0; status == BRIO_OK && block < b.num_blocks; block++)
        status = brio_roof_settle(&roof, &r.g, &b, block, r.label);
    brio_node_blocks_free(&b);
    brio_roof_free(&roof);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(settle_random_blocks);
}

SUITE(test_pole_graph) {
    RUN(edges_are_those_of_the_triangulation_and_the_samples);
    RUN(highest_priority_and_lowest_pole_come_first);
    RUN(blocks_of_a_round_are_apart);
    RUN(windows_keep_the_order_of_joined_blocks);
    RUN(blocks_do_not_depend_on_nodes_far_away);
    RUN(settled_blocks_have_least_energy);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
