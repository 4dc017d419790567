/* Cuts in closed parts: the sides of one flow through the whole, for all parts, orders and beginnings. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/labels/cut_in_parts.h"
#include "reconstruct/labels/max_flow.h"

enum { MOST_NODES = 600 };

/* A graph with at most four arcs a node. An arc of itself leads to no node. */
typedef struct {
    size_t num_nodes;
    uint32_t mate[4 * MOST_NODES];
    int32_t capacity[4 * MOST_NODES], terminal[MOST_NODES];
    size_t undecided; /* nodes that parts of the graph left undecided */
} graph;

static void read_nodes(const void *user, size_t begin, size_t end, uint32_t *mate, int32_t *capacity,
                       int32_t *terminal) {
    const graph *g = user;
    memcpy(terminal, g->terminal + begin, (end - begin) * sizeof *terminal);
    for (size_t arc = 4 * begin; arc < 4 * end; arc++) {
        bool none = g->mate[arc] == arc;
        *mate++ = none ? BRIO_NO_MATE : g->mate[arc];
        *capacity++ = none ? 0 : g->capacity[arc];
    }
}

/* --- graphs --- */

/* The finite tetrahedra of a random set of points. */
static void make_tetrahedra(brio_context *ctx, uint64_t seed, size_t points, graph *g) {
    double p[3 * 100];
    brio_triangulation *d = NULL;
    uniform_points(seed, points, p);
    EXPECT(brio_delaunay(ctx, p, NULL, points, NULL, &d) == BRIO_OK);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(d);
    g->num_nodes = brio_triangulation_stats(d)->tetrahedra;
    EXPECT(g->num_nodes <= MOST_NODES);
    for (uint32_t arc = 0; arc < 4 * g->num_nodes; arc++) {
        uint32_t mate = tet[arc / 4].mate[arc % 4];
        g->mate[arc] = mate < 4 * g->num_nodes ? mate : arc;
    }
    brio_triangulation_free(d);
}

/* A chain of nodes in the order of the parts, each with arcs 0 and 1 to those before and after it. */
static void make_chain(size_t n, graph *g) {
    g->num_nodes = n;
    for (uint32_t arc = 0; arc < 4 * n; arc++) g->mate[arc] = arc;
    for (uint32_t v = 0; v + 1 < n; v++) g->mate[4 * v + 1] = 4 * v + 4, g->mate[4 * v + 4] = 4 * v + 1;
}

/* Gives the arcs random capacities below `most`: 0 and ties among them. */
static void set_capacities(brio_rng *rng, uint32_t most, graph *g) {
    for (uint32_t arc = 0; arc < 4 * g->num_nodes; arc++)
        if (g->mate[arc] >= arc) g->capacity[arc] = g->capacity[g->mate[arc]] = (int32_t)brio_rng_below(rng, most);
}

/* Gives one node in `rare` a terminal of up to `most`, of either sign. */
static void set_terminals(brio_rng *rng, uint32_t most, uint32_t rare, graph *g) {
    for (size_t v = 0; v < g->num_nodes; v++)
        g->terminal[v] = brio_rng_below(rng, rare) ? 0 : (int32_t)brio_rng_below(rng, 2 * most + 1) - (int32_t)most;
}

/* --- who decides --- */

/* Collects all parts before any is decided, decides them from copies of their arrays, and keeps them, each in another
 * order: as other processes would. */
static brio_status decide_elsewhere(void *user, brio_parts *p) {
    graph *g = user;
    brio_context *ctx = p->g->ctx;
    brio_part_cut *cut = calloc(p->num_parts, sizeof *cut);
    uint8_t(*label)[MOST_NODES] = calloc(p->num_parts, sizeof *label);
    for (size_t i = 0; i < p->num_parts; i++) {
        brio_part_cut own;
        EXPECT(brio_parts_collect(p, i, &own) == BRIO_OK);
        EXPECT(own.num_nodes == brio_part_nodes(p, i));
        size_t n = own.num_nodes;
        EXPECT(brio_part_cut_new(ctx, n, false, &cut[i]) == BRIO_OK);
        memcpy(cut[i].mate, own.mate, 16 * n);
        memcpy(cut[i].capacity, own.capacity, 16 * n);
        memcpy(cut[i].terminal, own.terminal, 4 * n);
        memcpy(cut[i].outside, own.outside, 4 * n);
        brio_part_cut_free(ctx, &own);
    }
    for (size_t i = p->num_parts; i-- > 0;) EXPECT(brio_part_cut_decide(ctx, &cut[i], i % 2, label[i]) == BRIO_OK);
    for (size_t k = 0; k < p->num_parts; k++) {
        size_t i = (k + p->num_parts / 2) % p->num_parts;
        EXPECT(brio_parts_keep(p, i, NULL, label[i]) == BRIO_OK);
        if (p->g->user == g) g->undecided += p->num_left[i];
    }
    for (size_t i = 0; i < p->num_parts; i++) brio_part_cut_free(ctx, &cut[i]);
    free(cut);
    free(label);
    return BRIO_OK;
}

/* --- the check --- */

/* Finds the sides by one flow through the list of all edges. */
static void cut_whole(brio_context *ctx, const graph *g, uint8_t *label) {
    static brio_flow_edge edge[2 * MOST_NODES];
    static int64_t terminal[MOST_NODES];
    static uint8_t side[MOST_NODES];
    size_t n = 0;
    brio_flow flow = brio_flow_new(ctx);
    for (uint32_t arc = 0; arc < 4 * g->num_nodes; arc++)
        if (g->mate[arc] > arc) edge[n++] = (brio_flow_edge){arc / 4, g->mate[arc] / 4, g->capacity[arc]};
    for (size_t v = 0; v < g->num_nodes; v++) terminal[v] = g->terminal[v];
    EXPECT(brio_flow_maximum(&flow, g->num_nodes, edge, n, terminal, side) == BRIO_OK);
    for (size_t v = 0; v < g->num_nodes; v++)
        label[v] = side[v] == BRIO_FLOW_SINK ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    brio_flow_free(&flow);
}

static void expect_cut(brio_context *ctx, const brio_cut_graph *cut, size_t size, const brio_part_decider *decider,
                       const uint8_t *expected, uint64_t trial) {
    uint8_t label[MOST_NODES];
    memset(label, 0xAA, sizeof label);
    EXPECT(brio_cut_in_parts(cut, size, decider, label) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(!memcmp(label, expected, cut->num_nodes), "trial %llu, parts of %zu", (unsigned long long)trial, size);
}

/* Cuts a graph in 1 to 12 parts, by threads and elsewhere. */
static void check_parts(brio_context *ctx, graph *g, uint64_t trial) {
    uint8_t expected[MOST_NODES];
    brio_cut_graph cut = {.ctx = ctx, .num_nodes = g->num_nodes, .read = read_nodes, .user = g};
    brio_part_decider elsewhere = {.decide = decide_elsewhere, .user = g};
    cut_whole(ctx, g, expected);
    for (size_t parts = 1; parts <= 12; parts++) {
        size_t size = (g->num_nodes + parts - 1) / parts;
        expect_cut(ctx, &cut, size, NULL, expected, trial);
        if (trial % 4 == 0) expect_cut(ctx, &cut, size, &elsewhere, expected, trial);
    }
    expect_cut(ctx, &cut, 1, NULL, expected, trial);
    expect_cut(ctx, &cut, 0, NULL, expected, trial);
}

/* --- tests --- */

static void parts_of_tetrahedra_have_the_sides_of_one_flow(void) {
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    for (uint64_t trial = 0; trial < 120; trial++) {
        brio_rng rng = brio_rng_new(trial);
        brio_context_set_threads(ctx, 1 + (int)(trial % 3));
        make_tetrahedra(ctx, trial, 10 + trial % 60, g);
        set_capacities(&rng, 1 + (uint32_t)(trial % 7), g);
        set_terminals(&rng, 1 + (uint32_t)(trial % 5), 1 + (uint32_t)(trial % 9), g);
        check_parts(ctx, g, trial);
    }
    free(g);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* The largest numbers that are allowed: what is outside counts twice. */
static void large_capacities_do_not_overflow(void) {
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    for (uint64_t trial = 0; trial < 20; trial++) {
        brio_rng rng = brio_rng_new(trial);
        make_tetrahedra(ctx, trial, 60, g);
        set_capacities(&rng, 1 << 27, g);
        set_terminals(&rng, 1 << 29, 1, g);
        check_parts(ctx, g, trial);
    }
    free(g);
    brio_context_free(ctx);
}

/* Few terminals and arcs that outweigh them: sides are decided far away, and parts decide next to nothing. */
static void what_no_part_decides_is_cut_as_a_whole(void) {
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    uint8_t label[MOST_NODES];
    brio_part_decider elsewhere = {.decide = decide_elsewhere, .user = g};
    for (uint64_t trial = 0; trial < 30; trial++) {
        brio_rng rng = brio_rng_new(trial);
        if (trial % 2)
            make_chain(500, g);
        else
            make_tetrahedra(ctx, trial, 80, g);
        set_capacities(&rng, 3, g);
        for (size_t arc = 0; arc < 4 * g->num_nodes; arc++) g->capacity[arc] += 20;
        set_terminals(&rng, 1, 40, g);
        check_parts(ctx, g, trial);
        brio_cut_graph cut = {.ctx = ctx, .num_nodes = g->num_nodes, .read = read_nodes, .user = g};
        g->undecided = 0;
        EXPECT(brio_cut_in_parts(&cut, 25, &elsewhere, label) == BRIO_OK);
        EXPECT(g->undecided > g->num_nodes * 9 / 10, "%zu of %zu", g->undecided, g->num_nodes);
    }
    free(g);
    brio_context_free(ctx);
}

/* The source at one end of a chain, the sink at the other: the weakest arc is cut, of those that tie the one that is
 * nearest to the sink. */
static void ties_are_cut_next_to_the_sink(void) {
    enum { N = 400, WEAK = 150, LAST = 310 };
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    uint8_t label[MOST_NODES];
    make_chain(N, g);
    for (uint32_t v = 0; v + 1 < N; v++)
        g->capacity[4 * v + 1] = g->capacity[4 * v + 4] = v == WEAK || v == LAST ? 3 : 4 + (int32_t)(v % 3);
    g->terminal[0] = 5, g->terminal[N - 1] = -5;
    brio_cut_graph cut = {.ctx = ctx, .num_nodes = N, .read = read_nodes, .user = g};
    for (size_t size = 1; size < N; size += 13) {
        EXPECT(brio_cut_in_parts(&cut, size, NULL, label) == BRIO_OK);
        for (size_t v = 0; v < N; v++)
            EXPECT(label[v] == (v <= LAST ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER), "node %zu, parts of %zu", v, size);
    }
    free(g);
    brio_context_free(ctx);
}

/* A cut that begins from the flow of the last one, with other terminals and other parts. */
static void the_last_flow_does_not_matter(void) {
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    int32_t residual[4 * MOST_NODES];
    uint8_t expected[MOST_NODES];
    for (uint64_t trial = 0; trial < 60; trial++) {
        brio_rng rng = brio_rng_new(trial);
        brio_context_set_threads(ctx, 1 + (int)(trial % 3));
        make_tetrahedra(ctx, trial, 20 + trial % 50, g);
        set_capacities(&rng, 6, g);
        brio_cut_graph cut = {
            .ctx = ctx, .num_nodes = g->num_nodes, .read = read_nodes, .user = g, .residual = residual};
        for (int turn = 0; turn < 5; turn++) {
            set_terminals(&rng, 4, 1, g);
            cut_whole(ctx, g, expected);
            expect_cut(ctx, &cut, trial % 3 ? 40 : 1 + brio_rng_below(&rng, 200), NULL, expected, trial);
            cut.has_flow = true;
        }
    }
    free(g);
    brio_context_free(ctx);
}

static brio_status cut_small_graph(brio_context *ctx) {
    static graph g;
    uint8_t label[MOST_NODES];
    brio_cut_graph cut = {.ctx = ctx, .num_nodes = 60, .read = read_nodes, .user = &g};
    make_chain(60, &g);
    for (size_t arc = 0; arc < 240; arc++) g.capacity[arc] = 2;
    g.terminal[0] = 1, g.terminal[59] = -1;
    return brio_cut_in_parts(&cut, 7, NULL, label);
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(cut_small_graph);
}

static brio_status decide_nothing(void *user, brio_parts *p) {
    (void)user;
    return brio_fail(p->g->ctx, BRIO_ERR_CANCELLED, "no");
}

static void failures_of_who_decides_are_returned(void) {
    brio_context *ctx = new_context();
    graph *g = calloc(1, sizeof *g);
    uint8_t label[MOST_NODES];
    make_chain(20, g);
    brio_cut_graph cut = {.ctx = ctx, .num_nodes = 20, .read = read_nodes, .user = g};
    EXPECT(brio_cut_in_parts(&cut, 3, &(brio_part_decider){.decide = decide_nothing}, label) == BRIO_ERR_CANCELLED);
    EXPECT(brio_context_memory(ctx) == 0);
    free(g);
    brio_context_free(ctx);
}

SUITE(test_part_cut) {
    RUN(parts_of_tetrahedra_have_the_sides_of_one_flow);
    RUN(large_capacities_do_not_overflow);
    RUN(what_no_part_decides_is_cut_as_a_whole);
    RUN(ties_are_cut_next_to_the_sink);
    RUN(the_last_flow_does_not_matter);
    RUN(every_failed_allocation_is_a_status);
    RUN(failures_of_who_decides_are_returned);
    return harness_end();
}
