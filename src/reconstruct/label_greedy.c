/* Greedy labelling of poles: the surest first.
 *
 * Each unlabelled pole holds two beliefs, in and out, between 0 (unknown) and 1 (certain). The pole of highest priority
 * is labelled by the larger belief and passes its strength on, weakened by the weight of the edge: opposite poles are
 * pushed to the opposite label, deeply intersecting neighbours to the same. A pole with evidence for both labels is
 * "confused" and waits until the end of the queue. Equal priorities go by the poles' canonical numbers.
 *
 * The queue is a heap of (priority, pole) in which a pole that changes its priority gets a new entry and leaves the old
 * one, which is passed over when it comes up. Poles without evidence are in no heap: when only confused ones are left
 * there, a cursor takes the others in the order of their numbers. So the heap holds little more than the front.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: poles on the hull of the regular triangulation are certainly outer too, and what is certain
 * is never pushed. */
#include "base/memory.h"
#include "reconstruct/labelling.h"

/* Beliefs of a pole, out and in; both SETTLED once no evidence can change them. */
typedef struct {
    double belief[2];
} node;

typedef struct {
    double priority;
    uint32_t pole;
} entry;

typedef struct {
    brio_context *ctx;
    const brio_pole_graph *g;
    uint8_t *label;
    node *nodes;
    uint8_t *certain;
    entry *heap;
    size_t size, capacity;
    uint32_t cursor; /* poles before it are labelled or have evidence */
    size_t labelled;
} queue;

#define SETTLED INFINITY

/* --- heap --- */

static inline bool before(const entry *a, const entry *b) {
    return a->priority != b->priority ? a->priority > b->priority : a->pole < b->pole;
}

enum { ARITY = 4 };

static brio_status heap_push(queue *q, entry e) {
    brio_status status = BRIO_RESERVE(q->ctx, q->heap, q->capacity, q->size + 1);
    if (status != BRIO_OK) return status;
    size_t i = q->size++;
    for (; i > 0 && before(&e, &q->heap[(i - 1) / ARITY]); i = (i - 1) / ARITY) q->heap[i] = q->heap[(i - 1) / ARITY];
    q->heap[i] = e;
    return BRIO_OK;
}

static size_t best_child(const queue *q, size_t i) {
    size_t first = ARITY * i + 1, end = first + ARITY < q->size ? first + ARITY : q->size, best = first;
    for (size_t child = first + 1; child < end; child++)
        if (before(&q->heap[child], &q->heap[best])) best = child;
    return best;
}

static void heap_pop(queue *q) {
    entry last = q->heap[--q->size];
    size_t i = 0;
    for (size_t child; ARITY * i + 1 < q->size; i = child) {
        child = best_child(q, i);
        if (!before(&q->heap[child], &last)) break;
        q->heap[i] = q->heap[child];
    }
    if (q->size) q->heap[i] = last;
}

/* --- beliefs --- */

static double priority_of(const node *n) {
    double out = n->belief[0], in = n->belief[1];
    return out > 0 && in > 0 ? fabs(in - out) - 1 : fmax(in, out);
}

/* Evidence of strength `belief` for the side (0 out, 1 in) of a pole. */
static inline brio_status offer(queue *q, uint32_t p, int side, double belief) {
    node *n = &q->nodes[p];
    if (!(belief > n->belief[side])) return BRIO_OK;
    n->belief[side] = belief;
    return heap_push(q, (entry){priority_of(n), p});
}

static brio_status pass_on(queue *q, uint32_t p, int side, double strength) {
    const brio_pole_graph *g = q->g;
    brio_status status = BRIO_OK;
    for (size_t e = g->first_opposite[p]; e < g->first_opposite[p + 1]; e++)
        BRIO_TRY(offer(q, g->opposite_pole[e], !side, strength * g->opposite_weight[e]));
    for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
        BRIO_TRY(offer(q, g->edge_pole[e], side, strength * (double)g->edge_weight[e]));
done:
    return status;
}

/* Labels the pole whose turn it is. */
static brio_status label_pole(queue *q, uint32_t p, brio_labelling_stats *stats) {
    double out = q->nodes[p].belief[0], in = q->nodes[p].belief[1];
    int side = in > out;
    if (q->certain[p]) {
        side = q->label[p] == BRIO_LABEL_INNER;
        out = in = 1;
        q->certain[p] = 0;
    } else {
        stats->confused += out > 0 && in > 0;
    }
    q->label[p] = side ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    q->nodes[p] = (node){{SETTLED, SETTLED}};
    q->labelled++;
    return pass_on(q, p, side, side ? in : out);
}

/* --- queue --- */

/* Certain poles are outer; labelled ones are as certain of their labels. */
static brio_status queue_new(queue *q) {
    brio_status status = BRIO_OK;
    size_t n = q->g->poles->count;
    BRIO_TRY(BRIO_ALLOC_ZERO(q->ctx, q->nodes, n));
    BRIO_TRY(BRIO_ALLOC(q->ctx, q->certain, n));
    brio_label_certain(q->g, q->certain);
    for (uint32_t p = 0; p < n; p++) {
        if (q->label[p] != BRIO_LABEL_NONE) q->certain[p] = 1;
        if (!q->certain[p]) continue;
        q->nodes[p] = (node){{SETTLED, SETTLED}};
        BRIO_TRY(heap_push(q, (entry){1, p}));
    }
done:
    return status;
}

static bool is_current(const queue *q, const entry *e) {
    return q->certain[e->pole] || priority_of(&q->nodes[e->pole]) == e->priority;
}

/* The first entry that is up to date, or NULL. */
static const entry *heap_first(queue *q) {
    while (q->size && !is_current(q, &q->heap[0])) heap_pop(q);
    return q->size ? &q->heap[0] : NULL;
}

/* The first pole without evidence; the number of poles when there is none. */
static uint32_t next_without_evidence(queue *q) {
    size_t n = q->g->poles->count;
    while (q->cursor < n && (q->nodes[q->cursor].belief[0] > 0 || q->nodes[q->cursor].belief[1] > 0)) q->cursor++;
    return q->cursor;
}

static uint32_t next_pole(queue *q) {
    const entry *first = heap_first(q);
    if (!first || first->priority < 0) {
        uint32_t p = next_without_evidence(q);
        if (p < q->g->poles->count) return p;
    }
    uint32_t pole = first->pole;
    heap_pop(q);
    return pole;
}

brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    brio_status status = BRIO_OK;
    queue q = {.ctx = g->ctx, .g = g, .label = label};
    size_t n = g->poles->count;
    BRIO_TRY(queue_new(&q));
    while (q.labelled < n) {
        if (q.labelled % 65536 == 0)
            BRIO_TRY(brio_progress(g->ctx, "label", 0.5 + 0.5 * (double)q.labelled / (double)n));
        BRIO_TRY(label_pole(&q, next_pole(&q), stats));
    }
done:
    brio_release(g->ctx, q.nodes);
    brio_release(g->ctx, q.certain);
    brio_release(g->ctx, q.heap);
    return status;
}
