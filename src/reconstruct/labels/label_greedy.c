/* Greedy labeling of poles: the pole with the strongest evidence comes first.
 *
 * Each pole without a label holds two beliefs, inner and outer, between 0 (unknown) and 1 (certain). The pole of
 * highest priority takes the label of its larger belief. It passes this belief on along its edges, times |weight|: to
 * opposite poles for the opposite label, to deeply intersecting neighbours for the same label. A pole with evidence for
 * both labels is "confused" and waits until only confused poles are left. Among equal priorities the pole of the lowest
 * number comes first.
 *
 * Weights are at most 1, so no priority rises above the last one taken until the confused poles begin, and seldom after
 * that: the queue is a radix heap. A pole whose priority changes gets a new entry in the queue; its old entry is
 * skipped when it comes up.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: poles on the hull of the regular triangulation are certainly outer, too, and the beliefs of
 *                         certain poles never change. */
#include "base/memory.h"
#include "reconstruct/labels/labeling.h"
#include "reconstruct/labels/pole_queue.h"
#include <math.h>
#include <string.h>

/* What is known of a pole. belief[0] is for outer, belief[1] for inner; both are SETTLED once no evidence can change
 * them. A belief is the upper half of a double: its 20 binary digits suffice, and strengths far from the hull need its
 * exponents. `first` is a copy of the graph's first[p], so that one cache miss brings all that a pole needs. */
typedef struct {
    uint32_t belief[2];
    size_t first;
} node;

enum { CERTAIN = 0x3ff00000 /* the upper half of the double 1.0 */ };
#define SETTLED UINT32_MAX

typedef struct {
    brio_context *ctx;
    const brio_pole_graph *g;
    uint8_t *label;
    node *nodes;
    brio_pole_queue queue; /* the poles that are not confused; after these, the confused poles */
    bool all_confused;     /* only confused poles are left */
    size_t labeled;
    uint32_t ahead[BRIO_POLE_PEEK]; /* poles that are likely to be next, whose nodes were prefetched */
    int num_ahead;
} labeller;

/* --- beliefs --- */

static inline uint32_t belief_of(double strength) {
    uint64_t bits;
    memcpy(&bits, &strength, sizeof bits);
    return (uint32_t)(bits >> 32);
}

static inline double strength_of(uint32_t belief) {
    uint64_t bits = (uint64_t)belief << 32;
    double strength;
    memcpy(&strength, &bits, sizeof bits);
    return strength;
}

static bool is_settled(const node *n) {
    return n->belief[0] == SETTLED;
}

static bool is_confused(const node *n) {
    return n->belief[0] > 0 && n->belief[1] > 0;
}

static uint32_t clarity(const node *n) {
    return belief_of(fabs(strength_of(n->belief[1]) - strength_of(n->belief[0])));
}

/* Raises the belief of pole p in a side (0 outer, 1 inner) to `strength`, if it is lower, and queues the pole again. */
static inline brio_status offer(labeller *l, uint32_t p, int side, double strength) {
    node *n = &l->nodes[p];
    uint32_t belief = belief_of(strength);
    if (belief <= n->belief[side]) return BRIO_OK;
    n->belief[side] = belief;
    if (l->all_confused) return brio_pole_queue_push(&l->queue, p, clarity(n));
    return is_confused(n) ? BRIO_OK : brio_pole_queue_push(&l->queue, p, belief);
}

static brio_status pass_on(labeller *l, uint32_t p, int side, double strength) {
    const brio_signed_edge *edge = l->g->edge, *from = edge + l->nodes[p].first, *end = edge + l->nodes[p + 1].first;
    brio_status status = BRIO_OK;
    for (const brio_signed_edge *e = from; e < end; e++) __builtin_prefetch(&l->nodes[e->node]);
    for (const brio_signed_edge *e = from; e < end; e++)
        BRIO_TRY(offer(l, e->node, e->weight < 0 ? !side : side, strength * fabs((double)e->weight)));
done:
    return status;
}

static void mark_settled(labeller *l, size_t p) {
    l->nodes[p].belief[0] = l->nodes[p].belief[1] = SETTLED;
}

static brio_status settle(labeller *l, uint32_t p, int side, double strength) {
    if (l->labeled++ % 65536 == 0) {
        double share = (double)l->labeled / (double)l->g->diagram->poles->count;
        brio_status status = brio_progress(l->ctx, "label", 0.5 + 0.5 * (share < 1 ? share : 1));
        if (status != BRIO_OK) return status;
    }
    l->label[p] = side ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    mark_settled(l, p);
    return pass_on(l, p, side, strength);
}

/* --- in order of priority --- */

/* Settles the poles that are certain (outer) or labeled already (by their labels), with strength 1. */
static brio_status settle_certain(labeller *l) {
    brio_status status = BRIO_OK;
    size_t n = l->g->diagram->poles->count;
    uint8_t *certain = NULL;
    BRIO_TRY(BRIO_ALLOC(l->ctx, certain, n));
    brio_label_certain(l->g, certain);
    for (size_t p = 0; p < n; p++) certain[p] |= l->label[p] != BRIO_LABEL_NONE;
    for (size_t p = 0; p < n; p++)
        if (certain[p]) mark_settled(l, p);
    for (uint32_t p = 0; p < n; p++)
        if (certain[p]) BRIO_TRY(settle(l, p, l->label[p] == BRIO_LABEL_INNER, 1));
done:
    brio_release(l->ctx, certain);
    return status;
}

/* Prefetches what the next poles need: the edges of the poles whose nodes were prefetched last time, and the nodes of
 * the poles that come after. */
static inline void look_ahead(labeller *l) {
    for (int i = 0; i < l->num_ahead; i++) {
        const brio_signed_edge *edge = l->g->edge + l->nodes[l->ahead[i]].first;
        __builtin_prefetch(edge);
        __builtin_prefetch(edge + 8);
    }
    l->num_ahead = brio_pole_queue_peek(&l->queue, l->ahead);
    for (int i = 0; i < l->num_ahead; i++) __builtin_prefetch(&l->nodes[l->ahead[i]]);
}

/* Takes the pole of highest priority, skipping entries that are not up to date. */
static brio_status next_pole(labeller *l, uint32_t *p, bool *found) {
    brio_status status = BRIO_OK;
    for (;;) {
        uint32_t priority;
        BRIO_TRY(brio_pole_queue_pop(&l->queue, p, &priority, found));
        if (!*found) break;
        look_ahead(l);
        const node *n = &l->nodes[*p];
        if (is_settled(n)) continue;
        if (l->all_confused ? clarity(n) == priority : !is_confused(n) && (n->belief[0] | n->belief[1]) == priority)
            break;
    }
done:
    return status;
}

static brio_status settle_queued(labeller *l) {
    brio_status status = BRIO_OK;
    for (;;) {
        uint32_t p;
        bool found;
        BRIO_TRY(next_pole(l, &p, &found));
        if (!found) break;
        const node *n = &l->nodes[p];
        int side = n->belief[1] > n->belief[0];
        BRIO_TRY(settle(l, p, side, strength_of(n->belief[side])));
    }
done:
    return status;
}

/* Makes the poles that no evidence reached outer. They pass nothing on. */
static void settle_without_evidence(labeller *l) {
    for (size_t p = 0; p < l->g->diagram->poles->count; p++) {
        if (l->nodes[p].belief[0] > 0 || l->nodes[p].belief[1] > 0) continue;
        l->label[p] = BRIO_LABEL_OUTER;
        mark_settled(l, p);
    }
}

static brio_status settle_confused(labeller *l, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    l->all_confused = true;
    brio_pole_queue_free(&l->queue);
    l->queue = brio_pole_queue_new(l->ctx, CERTAIN);
    for (uint32_t p = 0; p < l->g->diagram->poles->count; p++) {
        if (l->label[p] != BRIO_LABEL_NONE) continue;
        stats->confused++;
        BRIO_TRY(brio_pole_queue_push(&l->queue, p, clarity(&l->nodes[p])));
    }
    BRIO_TRY(settle_queued(l));
done:
    return status;
}

static brio_status nodes_new(labeller *l) {
    size_t n = l->g->diagram->poles->count;
    brio_status status = BRIO_ALLOC(l->ctx, l->nodes, n + 1);
    if (status != BRIO_OK) return status;
    for (size_t p = 0; p <= n; p++) l->nodes[p] = (node){{0, 0}, l->g->first[p]};
    return BRIO_OK;
}

void brio_label_certain(const brio_pole_graph *g, uint8_t *certain) {
    memcpy(certain, g->diagram->poles->bounding, g->diagram->poles->count);
    for (size_t tet = g->diagram->num_finite; tet < g->diagram->power.count; tet++)
        for (int i = 0; i < 3; i++) certain[g->diagram->power.tet[tet].vertex[i]] = 1;
}

brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    labeller l = {.ctx = g->ctx, .g = g, .label = label, .queue = brio_pole_queue_new(g->ctx, CERTAIN)};
    BRIO_TRY(nodes_new(&l));
    BRIO_TRY(settle_certain(&l));
    BRIO_TRY(settle_queued(&l));
    settle_without_evidence(&l);
    BRIO_TRY(settle_confused(&l, stats));
done:
    brio_pole_queue_free(&l.queue);
    brio_release(g->ctx, l.nodes);
    return status;
}
