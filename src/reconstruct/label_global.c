/* Labelling of poles that minimises one energy: the sum of the weights that are violated, neighbours that intersect
 * deeply wanting the same label and opposite poles different ones.
 *
 * Edges of the second kind make the energy not submodular, so no single cut minimises it. Roof duality does what a cut
 * can: every pole has two nodes, itself and its complement; an edge for equal labels joins pole with pole and
 * complement with complement, an edge for different labels joins either pole with the other's complement. In a minimum
 * cut between the certain poles and their complements, a pole on the side of the source is outer and one whose
 * complement is there is inner, in a labelling of least energy; the others stay open.
 *
 * The weights are the balanced ones of the graph of poles. Certain here are also the poles beyond the box of the
 * samples. Only the region about the violated edges of the greedy labels takes part, since nearly all edges of a good
 * sample are at peace; a region is enlarged as long as labels change near its border. Where trouble is all over a large
 * sample the flow may have long ways: it is given up after some looks an edge, and all poles of the region are open.
 * Open poles begin with their greedy labels, and sets of them are toggled while that lowers the energy. Around the
 * present labels the energy of a set is that of a cut but for the violated edges, which want exactly one end toggled;
 * counted as a gain at one end and a loss at the other they bound the energy from above, equal when nothing is toggled.
 * So the set of least bound is no loss. The ends are drawn anew for each move.
 *
 * Based on: Hammer, Hansen, Simeone. Roof duality, complementation and persistency in quadratic 0-1 optimization.
 *           Mathematical Programming 1984.
 *           Boros, Hammer. Pseudo-Boolean optimization. Discrete Applied Mathematics 2002 (the doubled graph).
 *           Gorelick et al. Submodularization for binary pairwise energies. CVPR 2014 (the bound). */
#include "base/memory.h"
#include "base/rng.h"
#include "reconstruct/labelling.h"
#include "reconstruct/max_flow.h"
#include <math.h>
#include <string.h>

enum {
    WEIGHT_SCALE = 1 << 20,
    MOST_MOVES = 32,
    IDLE_MOVES = 4,
    LITTLE_WORK = 1 << 24, /* looks at arcs that a flow may always take */
    MOVED_EDGES = 1 << 27  /* all moves together, but for the first */
};

enum { HOPS = 8, OUTSIDE = 255 };

typedef struct {
    const brio_pole_graph *g;
    brio_context *ctx;
    uint8_t *label;
    uint8_t *certain, *open;
    uint8_t *depth;   /* of each pole: how many edges from trouble, OUTSIDE beyond the region */
    uint32_t *number; /* of each pole in the region: its place in pole[] */
    uint32_t *pole;   /* those of the region */
    size_t size;
    brio_flow_edge
        *edges; /* with an end in the region; capacity > 0: the same label is wanted; < 0: different labels */
    size_t num_edges, capacity;
} problem;

/* --- the region --- */

static bool disagree(const problem *pr, uint32_t a, uint32_t b, bool same_wanted) {
    return (pr->label[a] == pr->label[b]) != same_wanted;
}

/* Whether an edge of the pole is violated. */
static bool is_troubled(const problem *pr, uint32_t p) {
    const brio_pole_graph *g = pr->g;
    for (size_t e = g->first_opposite[p]; e < g->first_opposite[p + 1]; e++)
        if (g->opposite_weight[e] > 0 && disagree(pr, p, g->opposite_pole[e], false)) return true;
    for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
        if (g->edge_weight[e] != 0 && disagree(pr, p, g->edge_pole[e], g->edge_weight[e] > 0)) return true;
    return false;
}

static void reach(problem *pr, uint32_t p, uint8_t depth) {
    if (pr->certain[p] || pr->depth[p] != OUTSIDE) return;
    pr->depth[p] = depth;
    pr->pole[pr->size++] = p;
}

/* The poles at most so many edges from a violated one, breadth first. */
static void mark_region(problem *pr, uint8_t hops) {
    const brio_pole_graph *g = pr->g;
    pr->size = 0;
    for (size_t p = 0; p < g->poles->count; p++) pr->depth[p] = OUTSIDE;
    for (uint32_t p = 0; p < g->poles->count; p++)
        if (is_troubled(pr, p)) reach(pr, p, 0);
    for (size_t i = 0; i < pr->size && pr->depth[pr->pole[i]] < hops; i++) {
        uint32_t p = pr->pole[i];
        uint8_t next = pr->depth[p] + 1;
        for (size_t e = g->first_opposite[p]; e < g->first_opposite[p + 1]; e++) reach(pr, g->opposite_pole[e], next);
        for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++) reach(pr, g->edge_pole[e], next);
    }
    pr->size = 0; /* poles follow a curve, which keeps neighbours near in memory */
    for (uint32_t p = 0; p < g->poles->count; p++) {
        if (pr->depth[p] == OUTSIDE) continue;
        pr->number[p] = (uint32_t)pr->size;
        pr->pole[pr->size++] = p;
    }
}

/* --- the energy as a list of edges --- */

static int32_t whole_weight(double weight) {
    return (int32_t)lround(weight * WEIGHT_SCALE);
}

static brio_status add_edge(problem *pr, uint32_t a, uint32_t b, int32_t weight) {
    brio_status status = BRIO_RESERVE(pr->ctx, pr->edges, pr->capacity, pr->num_edges + 1);
    if (status == BRIO_OK && weight) pr->edges[pr->num_edges++] = (brio_flow_edge){a, b, weight};
    return status;
}

/* Both ends see an edge; it is listed at the lower one, or at the one in the region. */
static bool is_first_end(const problem *pr, uint32_t p, uint32_t other) {
    return p < other || pr->depth[other] == OUTSIDE;
}

static brio_status collect_edges(problem *pr) {
    const brio_pole_graph *g = pr->g;
    brio_status status = BRIO_OK;
    pr->num_edges = 0;
    for (size_t i = 0; i < pr->size; i++) {
        uint32_t p = pr->pole[i];
        for (size_t e = g->first_opposite[p]; e < g->first_opposite[p + 1]; e++)
            if (is_first_end(pr, p, g->opposite_pole[e]) && g->opposite_weight[e] > 0)
                BRIO_TRY(add_edge(pr, p, g->opposite_pole[e], -whole_weight(g->opposite_weight[e])));
        for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
            if (is_first_end(pr, p, g->edge_pole[e]))
                BRIO_TRY(add_edge(pr, p, g->edge_pole[e], whole_weight((double)g->edge_weight[e])));
    }
done:
    return status;
}

/* --- roof duality --- */

/* Doubles the graph of the region: node i is the pole, node n + i its complement; what labels beyond the region want is
 * a terminal. The number of edges. */
static size_t double_edges(const problem *pr, brio_flow_edge *doubled, int64_t *terminal) {
    uint32_t n = (uint32_t)pr->size;
    size_t count = 0;
    for (size_t e = 0; e < pr->num_edges; e++) {
        brio_flow_edge x = pr->edges[e];
        bool same = x.capacity > 0;
        int32_t capacity = same ? x.capacity : -x.capacity;
        uint32_t a = pr->number[x.a];
        if (pr->depth[x.b] == OUTSIDE) {
            int64_t outer = (pr->label[x.b] == BRIO_LABEL_OUTER) == same ? capacity : -capacity;
            terminal[a] += outer;
            terminal[n + a] -= outer;
            continue;
        }
        uint32_t b = pr->number[x.b], shift = same ? 0 : n;
        doubled[count++] = (brio_flow_edge){a, b + shift, capacity};
        doubled[count++] = (brio_flow_edge){a + n, b + n - shift, capacity};
    }
    return count;
}

static brio_status settle_by_roof_duality(problem *pr) {
    brio_status status = BRIO_OK;
    brio_flow_edge *doubled = NULL;
    int64_t *terminal = NULL;
    uint8_t *side = NULL;
    size_t n = pr->size;
    bool ended;
    BRIO_TRY(BRIO_ALLOC(pr->ctx, doubled, 2 * pr->num_edges));
    BRIO_TRY(BRIO_ALLOC_ZERO(pr->ctx, terminal, 2 * n));
    BRIO_TRY(BRIO_ALLOC(pr->ctx, side, 2 * n));
    size_t count = double_edges(pr, doubled, terminal);
    BRIO_TRY(brio_max_flow(pr->ctx, 2 * n, doubled, count, terminal, side, LITTLE_WORK + 4 * count, &ended));
    for (size_t i = 0; i < n; i++) {
        bool outer = ended && side[i] == BRIO_FLOW_SOURCE, inner = ended && side[n + i] == BRIO_FLOW_SOURCE;
        uint32_t p = pr->pole[i];
        pr->open[p] = !outer && !inner;
        if (outer) pr->label[p] = BRIO_LABEL_OUTER;
        if (inner) pr->label[p] = BRIO_LABEL_INNER;
    }
done:
    brio_release(pr->ctx, doubled);
    brio_release(pr->ctx, terminal);
    brio_release(pr->ctx, side);
    return status;
}

/* --- moves --- */

static bool violated(const problem *pr, const brio_flow_edge *x) {
    return (pr->label[x->a] == pr->label[x->b]) != (x->capacity > 0);
}

static void toggle(problem *pr, uint32_t p) {
    pr->label[p] = pr->label[p] == BRIO_LABEL_INNER ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER;
}

/* The edges between poles, an open one among them, as of a cut around the present labels: satisfied edges between open
 * poles are edges of the cut, what any other edge wants is a terminal. A pole on the side of the sink is toggled.
 * number  the place of each open pole among them. */
static size_t bound_edges(const problem *pr, const uint32_t *number, brio_rng *rng, brio_flow_edge *cut,
                          int64_t *terminal) {
    size_t count = 0;
    for (size_t e = 0; e < pr->num_edges; e++) {
        const brio_flow_edge *x = &pr->edges[e];
        bool a = pr->open[x->a], b = pr->open[x->b];
        int64_t weight = x->capacity > 0 ? x->capacity : -x->capacity;
        if (!a && !b) continue;
        if (!violated(pr, x)) {
            if (a && b)
                cut[count++] = (brio_flow_edge){number[x->a], number[x->b], (int32_t)weight};
            else
                terminal[number[a ? x->a : x->b]] += weight;
            continue;
        }
        bool gain_at_a = a && (!b || brio_rng_below(rng, 2));
        if (a) terminal[number[x->a]] += gain_at_a ? -weight : weight;
        if (b) terminal[number[x->b]] += gain_at_a ? weight : -weight;
    }
    return count;
}

/* What toggling all the poles on the side of the sink would save. */
static int64_t saving(const problem *pr, const uint32_t *number, const uint8_t *side) {
    int64_t sum = 0;
    for (size_t e = 0; e < pr->num_edges; e++) {
        const brio_flow_edge *x = &pr->edges[e];
        bool a = pr->open[x->a] && side[number[x->a]] == BRIO_FLOW_SINK;
        bool b = pr->open[x->b] && side[number[x->b]] == BRIO_FLOW_SINK;
        if (a == b) continue;
        int64_t weight = x->capacity > 0 ? x->capacity : -x->capacity;
        sum += violated(pr, x) ? weight : -weight;
    }
    return sum;
}

typedef struct {
    uint32_t *number, *pole; /* of a pole among the open ones, and back */
    size_t count;
    brio_flow_edge *cut;
    int64_t *terminal;
    uint8_t *side;
} mover;

static brio_status move_by_cut(problem *pr, mover *m, brio_rng *rng, int64_t *saved) {
    brio_status status = BRIO_OK;
    bool ended;
    for (size_t i = 0; i < m->count; i++) m->terminal[i] = 0;
    size_t num_edges = bound_edges(pr, m->number, rng, m->cut, m->terminal);
    BRIO_TRY(brio_max_flow(pr->ctx, m->count, m->cut, num_edges, m->terminal, m->side, UINT64_MAX, &ended));
    *saved = saving(pr, m->number, m->side);
    for (size_t i = 0; i<m->count && * saved> 0; i++)
        if (m->side[i] == BRIO_FLOW_SINK) toggle(pr, m->pole[i]);
done:
    return status;
}

static brio_status list_open(problem *pr, mover *m) {
    brio_status status = BRIO_OK;
    brio_context *ctx = pr->ctx;
    size_t n = pr->g->poles->count, edges = 0;
    for (size_t p = 0; p < n; p++) m->count += pr->open[p];
    if (!m->count) return BRIO_OK;
    for (size_t e = 0; e < pr->num_edges; e++) edges += pr->open[pr->edges[e].a] || pr->open[pr->edges[e].b];
    BRIO_TRY(BRIO_ALLOC(ctx, m->number, n));
    BRIO_TRY(BRIO_ALLOC(ctx, m->pole, m->count));
    BRIO_TRY(BRIO_ALLOC(ctx, m->cut, edges));
    BRIO_TRY(BRIO_ALLOC(ctx, m->terminal, m->count));
    BRIO_TRY(BRIO_ALLOC(ctx, m->side, m->count));
    for (size_t p = 0, i = 0; p < n; p++)
        if (pr->open[p]) m->pole[i] = (uint32_t)p, m->number[p] = (uint32_t)i++;
    /* only edges with an open pole matter from here on */
    edges = 0;
    for (size_t e = 0; e < pr->num_edges; e++)
        if (pr->open[pr->edges[e].a] || pr->open[pr->edges[e].b]) pr->edges[edges++] = pr->edges[e];
    pr->num_edges = edges;
done:
    return status;
}

static brio_status improve_open(problem *pr) {
    brio_status status = BRIO_OK;
    brio_rng rng = brio_rng_new(1);
    mover m = {0};
    BRIO_TRY(list_open(pr, &m));
    size_t most = MOVED_EDGES / (pr->num_edges + 1) + 1;
    if (most > MOST_MOVES) most = MOST_MOVES;
    for (size_t move = 0, idle = 0; m.count && move < most && idle < IDLE_MOVES; move++) {
        int64_t saved = 0;
        BRIO_TRY(move_by_cut(pr, &m, &rng, &saved));
        idle = saved > 0 ? 0 : idle + 1;
    }
done:
    brio_release(pr->ctx, m.number);
    brio_release(pr->ctx, m.pole);
    brio_release(pr->ctx, m.cut);
    brio_release(pr->ctx, m.terminal);
    brio_release(pr->ctx, m.side);
    return status;
}

/* --- the whole --- */

/* A solid is inside the convex hull of its surface, so a pole beyond the box of the samples is outer. Only now: given to
 * the greedy labelling, whose mistakes spread, more certain poles were seen to mislead it on sparse samples. */
static void settle_beyond_box(problem *pr) {
    const brio_pole_graph *g = pr->g;
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t s = 0; s < g->num_samples; s++) {
            low = fmin(low, g->samples[3 * s + k]);
            high = fmax(high, g->samples[3 * s + k]);
        }
        for (size_t p = 0; p < g->poles->count; p++) {
            double x = g->poles->centre[3 * p + k];
            if (x < low || x > high) pr->certain[p] = 1, pr->label[p] = BRIO_LABEL_OUTER;
        }
    }
}

/* Whether what was toggled came near the border of the region. */
static bool touches_border(const problem *pr, const uint8_t *before, uint8_t hops) {
    for (size_t i = 0; i < pr->size; i++) {
        uint32_t p = pr->pole[i];
        if (pr->depth[p] + 1 >= hops && pr->label[p] != before[p]) return true;
    }
    return false;
}

/* Least energy in the region about the violated edges, the labels beyond being what they are; in a larger one where that
 * is too small to tell. */
static brio_status minimise(problem *pr, const uint8_t *before) {
    brio_status status = BRIO_OK;
    size_t n = pr->g->poles->count;
    for (int hops = HOPS; hops < OUTSIDE; hops *= 2) {
        memcpy(pr->label, before, n);
        memset(pr->open, 0, n);
        mark_region(pr, (uint8_t)hops);
        BRIO_TRY(collect_edges(pr));
        BRIO_TRY(settle_by_roof_duality(pr));
        BRIO_TRY(improve_open(pr));
        if (!touches_border(pr, before, (uint8_t)hops)) break;
    }
done:
    return status;
}

brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    brio_status status = BRIO_OK;
    size_t n = g->poles->count;
    problem pr = {.g = g, .ctx = g->ctx, .label = label};
    uint8_t *before = NULL;
    BRIO_TRY(brio_label_greedy(g, label, stats));
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, pr.certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, pr.open, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, pr.depth, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, pr.number, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, pr.pole, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, before, n));
    brio_label_certain(g, pr.certain);
    settle_beyond_box(&pr);
    stats->energy_greedy = brio_label_energy(g, label);
    memcpy(before, label, n);
    BRIO_TRY(minimise(&pr, before));
    for (size_t p = 0; p < n; p++) stats->open += pr.open[p], stats->toggled += label[p] != before[p];
    stats->energy = brio_label_energy(g, label);
done:
    brio_release(g->ctx, pr.certain);
    brio_release(g->ctx, pr.open);
    brio_release(g->ctx, pr.depth);
    brio_release(g->ctx, pr.number);
    brio_release(g->ctx, pr.pole);
    brio_release(g->ctx, pr.edges);
    brio_release(g->ctx, before);
    return status;
}
