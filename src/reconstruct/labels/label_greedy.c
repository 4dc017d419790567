/* Greedy labeling of poles: the surest first.
 *
 * Each unlabeled pole holds two beliefs, in and out, between 0 (unknown) and 1 (certain). The pole of highest priority
 * is labeled by the larger belief and passes its strength on, weakened by the weight of the edge: opposite poles are
 * pushed to the opposite label, deeply intersecting neighbours to the same. A pole with evidence for both labels is
 * "confused" and waits until the end of the queue. Equal priorities go by the poles' canonical numbers.
 *
 * Poles without evidence and confused ones come last, and beliefs are passed on weakened, so that until then no
 * priority rises above the last one taken, and seldom after: the queue is a radix heap. A pole whose priority changes
 * gets a new entry; the old one is passed over when it comes up.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: poles on the hull of the regular triangulation are certainly outer too, and what is certain
 * is never pushed. */
#include "base/memory.h"
#include "reconstruct/labels/labeling.h"
#include "reconstruct/labels/pole_queue.h"
#include <math.h>
#include <string.h>

/* Beliefs of a pole, out and in; both SETTLED once no evidence can change them. A belief is the upper half of a double,
 * which 20 binary digits are enough for, and the range of which strengths need far from the hull. And where the pole's
 * edges begin: poles come up all over the surface, and what is fetched for one of them should be in one place. */
typedef struct {
    uint32_t belief[2];
    size_t first;
} node;

enum { CERTAIN = 0x3ff00000 /* 1.0 */ };
#define SETTLED UINT32_MAX

typedef struct {
    brio_context *ctx;
    const brio_pole_graph *g;
    uint8_t *label;
    node *nodes;
    brio_pole_queue queue; /* of the poles that are not confused, then of those that are */
    bool all_confused;     /* the poles that are left */
    size_t labeled;
    uint32_t ahead[BRIO_POLE_PEEK]; /* poles that come up soon, whose nodes were called for */
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

/* Evidence of some strength for the side (0 out, 1 in) of a pole. */
static inline brio_status offer(labeller *l, uint32_t p, int side, double strength) {
    node *n = &l->nodes[p];
    uint32_t belief = belief_of(strength);
    if (belief <= n->belief[side]) return BRIO_OK;
    n->belief[side] = belief;
    if (l->all_confused) return brio_pole_queue_push(&l->queue, p, clarity(n));
    return is_confused(n) ? BRIO_OK : brio_pole_queue_push(&l->queue, p, belief);
}

static brio_status pass_on(labeller *l, uint32_t p, int side, double strength) {
    const brio_pole_edge *edge = l->g->edge, *from = edge + l->nodes[p].first, *end = edge + l->nodes[p + 1].first;
    brio_status status = BRIO_OK;
    for (const brio_pole_edge *e = from; e < end; e++) __builtin_prefetch(&l->nodes[e->pole]);
    for (const brio_pole_edge *e = from; e < end; e++)
        BRIO_TRY(offer(l, e->pole, e->weight < 0 ? !side : side, strength * fabs((double)e->weight)));
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

/* Certain poles are outer; labeled ones are as certain of their labels. */
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

/* Calls for what the next poles need: first their nodes, the next time their edges. */
static inline void look_ahead(labeller *l) {
    for (int i = 0; i < l->num_ahead; i++) {
        const brio_pole_edge *edge = l->g->edge + l->nodes[l->ahead[i]].first;
        __builtin_prefetch(edge);
        __builtin_prefetch(edge + 8);
    }
    l->num_ahead = brio_pole_queue_peek(&l->queue, l->ahead);
    for (int i = 0; i < l->num_ahead; i++) __builtin_prefetch(&l->nodes[l->ahead[i]]);
}

/* Takes the pole of highest priority that is still what it was when it got it. */
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

/* Nothing reaches these: they are outer, and pass nothing on. */
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

brio_status brio_label_finish(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    for (size_t p = 0; p < g->diagram->poles->count; p++) stats->unreached += label[p] == BRIO_LABEL_NONE;
    return stats->unreached ? brio_label_greedy(g, label, stats) : BRIO_OK;
}
