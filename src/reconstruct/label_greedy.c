/* Greedy labelling of poles: the surest first.
 *
 * Each unlabelled pole holds two beliefs, in and out, between 0 (unknown) and 1 (certain). The pole of highest priority
 * is labelled by the larger belief and passes its strength on, weakened by the weight of the edge: opposite poles are
 * pushed to the opposite label, deeply intersecting neighbours to the same. A pole with evidence for both labels is
 * "confused" and waits until the end of the queue. Equal priorities go by the poles' canonical numbers.
 *
 * Poles without evidence and confused ones come last, and beliefs are passed on weakened, so that until then no
 * priority rises above the last one taken, and the queue is a radix heap. A pole whose belief grows gets a new entry;
 * the old one is passed over when it comes up. The confused poles then go through a common heap in the same way.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: poles on the hull of the regular triangulation are certainly outer too, and what is certain
 * is never pushed. */
#include "base/memory.h"
#include "reconstruct/labelling.h"
#include "reconstruct/pole_queue.h"

/* Beliefs of a pole, out and in; both SETTLED once no evidence can change them. And where its edges begin: poles come up
 * all over the surface, and what is fetched for one of them should be in one place. */
typedef struct {
    double belief[2];
    size_t opposite, edge;
} node;

#define SETTLED INFINITY

typedef struct {
    double priority;
    uint32_t pole;
} entry;

typedef struct {
    brio_context *ctx;
    const brio_pole_graph *g;
    uint8_t *label;
    node *nodes;
    brio_pole_queue sure;
    bool all_confused; /* the poles that are left */
    entry *heap;       /* of them */
    size_t size, capacity;
    size_t labelled;
} labeller;

/* --- heap of confused poles --- */

static inline bool before(const entry *a, const entry *b) {
    return a->priority != b->priority ? a->priority > b->priority : a->pole < b->pole;
}

static brio_status heap_push(labeller *l, entry e) {
    brio_status status = BRIO_RESERVE(l->ctx, l->heap, l->capacity, l->size + 1);
    if (status != BRIO_OK) return status;
    size_t i = l->size++;
    for (; i > 0 && before(&e, &l->heap[(i - 1) / 2]); i = (i - 1) / 2) l->heap[i] = l->heap[(i - 1) / 2];
    l->heap[i] = e;
    return BRIO_OK;
}

static entry heap_pop(labeller *l) {
    entry top = l->heap[0], last = l->heap[--l->size];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < l->size; i = child) {
        if (child + 1 < l->size && before(&l->heap[child + 1], &l->heap[child])) child++;
        if (!before(&l->heap[child], &last)) break;
        l->heap[i] = l->heap[child];
    }
    if (l->size) l->heap[i] = last;
    return top;
}

/* --- beliefs --- */

static bool is_confused(const node *n) {
    return n->belief[0] > 0 && n->belief[1] > 0;
}

static double confusion(const node *n) {
    return fabs(n->belief[1] - n->belief[0]) - 1;
}

/* Evidence of strength `belief` for the side (0 out, 1 in) of a pole. */
static inline brio_status offer(labeller *l, uint32_t p, int side, double belief) {
    node *n = &l->nodes[p];
    if (!(belief > n->belief[side])) return BRIO_OK;
    n->belief[side] = belief;
    if (l->all_confused) return heap_push(l, (entry){confusion(n), p});
    return is_confused(n) ? BRIO_OK : brio_pole_queue_push(&l->sure, p, belief);
}

/* Calls for everything at once that the pole's edges need. */
static void fetch(const labeller *l, const node *n, const node *end) {
    const brio_pole_graph *g = l->g;
    __builtin_prefetch(&g->opposite_pole[n->opposite]);
    __builtin_prefetch(&g->opposite_weight[n->opposite]);
    __builtin_prefetch(&g->edge_weight[n->edge]);
    for (size_t e = n->edge; e < end->edge; e++) __builtin_prefetch(&l->nodes[g->edge_pole[e]]);
}

static brio_status pass_on(labeller *l, uint32_t p, int side, double strength) {
    const brio_pole_graph *g = l->g;
    brio_status status = BRIO_OK;
    const node *n = &l->nodes[p], *end = n + 1;
    fetch(l, n, end);
    for (size_t e = n->opposite; e < end->opposite; e++)
        BRIO_TRY(offer(l, g->opposite_pole[e], !side, strength * g->opposite_weight[e]));
    for (size_t e = n->edge; e < end->edge; e++)
        BRIO_TRY(offer(l, g->edge_pole[e], g->edge_weight[e] < 0 ? !side : side,
                       strength * fabs((double)g->edge_weight[e])));
done:
    return status;
}

static void mark_settled(labeller *l, size_t p) {
    l->nodes[p].belief[0] = l->nodes[p].belief[1] = SETTLED;
}

static brio_status settle(labeller *l, uint32_t p, int side, double strength) {
    if (l->labelled++ % 65536 == 0) {
        double share = (double)l->labelled / (double)l->g->poles->count;
        brio_status status = brio_progress(l->ctx, "label", 0.5 + 0.5 * (share < 1 ? share : 1));
        if (status != BRIO_OK) return status;
    }
    l->label[p] = side ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    mark_settled(l, p);
    return pass_on(l, p, side, strength);
}

/* --- in order of priority --- */

/* Certain poles are outer; labelled ones are as certain of their labels. */
static brio_status settle_certain(labeller *l) {
    brio_status status = BRIO_OK;
    size_t n = l->g->poles->count;
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

static brio_status settle_sure(labeller *l) {
    brio_status status = BRIO_OK;
    for (;;) {
        uint32_t p;
        double priority;
        bool found;
        BRIO_TRY(brio_pole_queue_pop(&l->sure, &p, &priority, &found));
        if (!found) break;
        uint32_t next = brio_pole_queue_next(&l->sure);
        if (next != BRIO_NO_POLE) __builtin_prefetch(&l->nodes[next]);
        const node *n = &l->nodes[p];
        if (is_confused(n) || fmax(n->belief[0], n->belief[1]) != priority) continue; /* SETTLED is confused too */
        BRIO_TRY(settle(l, p, n->belief[1] > 0, priority));
    }
done:
    return status;
}

/* Nothing reaches these: they are outer, and pass nothing on. */
static void settle_without_evidence(labeller *l) {
    for (size_t p = 0; p < l->g->poles->count; p++) {
        if (l->nodes[p].belief[0] > 0 || l->nodes[p].belief[1] > 0) continue;
        l->label[p] = BRIO_LABEL_OUTER;
        mark_settled(l, p);
    }
}

static brio_status settle_confused(labeller *l, brio_labelling_stats *stats) {
    brio_status status = BRIO_OK;
    l->all_confused = true;
    for (uint32_t p = 0; p < l->g->poles->count; p++)
        if (l->label[p] == BRIO_LABEL_NONE) BRIO_TRY(heap_push(l, (entry){confusion(&l->nodes[p]), p}));
    while (l->size) {
        entry e = heap_pop(l);
        const node *n = &l->nodes[e.pole];
        if (!(confusion(n) == e.priority)) continue; /* NaN once it is settled */
        int side = n->belief[1] > n->belief[0];
        stats->confused++;
        BRIO_TRY(settle(l, e.pole, side, n->belief[side]));
    }
done:
    return status;
}

static brio_status nodes_new(labeller *l) {
    size_t n = l->g->poles->count;
    brio_status status = BRIO_ALLOC(l->ctx, l->nodes, n + 1);
    if (status != BRIO_OK) return status;
    for (size_t p = 0; p <= n; p++) l->nodes[p] = (node){{0, 0}, l->g->first_opposite[p], l->g->first_edge[p]};
    return BRIO_OK;
}

brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    brio_status status = BRIO_OK;
    labeller l = {.ctx = g->ctx, .g = g, .label = label, .sure = brio_pole_queue_new(g->ctx, 1)};
    BRIO_TRY(nodes_new(&l));
    BRIO_TRY(settle_certain(&l));
    BRIO_TRY(settle_sure(&l));
    settle_without_evidence(&l);
    BRIO_TRY(settle_confused(&l, stats));
done:
    brio_pole_queue_free(&l.sure);
    brio_release(g->ctx, l.nodes);
    brio_release(g->ctx, l.heap);
    return status;
}

brio_status brio_label_finish(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    for (size_t p = 0; p < g->poles->count; p++) stats->unreached += label[p] == BRIO_LABEL_NONE;
    return stats->unreached ? brio_label_greedy(g, label, stats) : BRIO_OK;
}
