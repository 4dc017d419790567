/* Greedy labelling of poles: the surest first.
 *
 * Each unlabelled pole holds two beliefs, in and out, between 0 (unknown) and 1 (certain). The pole of highest priority
 * is labelled by the larger belief and passes its strength on, weakened by the weight of the edge: opposite poles are
 * pushed to the opposite label, deeply intersecting neighbours to the same. A pole with evidence for both labels is
 * "confused" and waits until the end of the queue. Equal priorities go by the poles' canonical numbers.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: poles on the hull of the regular triangulation are certainly outer too, and what is certain
 * is never pushed. */
#include "base/memory.h"
#include "reconstruct/labelling.h"

typedef struct {
    size_t num_poles;
    double *belief[2]; /* out, in */
    double *priority;
    uint32_t *heap, *place; /* binary heap of unlabelled poles, and where each is; NO_PLACE once labelled */
    size_t heap_size;
    uint8_t *certain;
    /* of the pole whose label is being passed on */
    double strength;
    int side; /* 0 out, 1 in: which belief of the visited pole grows */
} queue;

enum { NO_PLACE = UINT32_MAX };

static bool before(const queue *q, uint32_t a, uint32_t b) {
    return q->priority[a] != q->priority[b] ? q->priority[a] > q->priority[b] : a < b;
}

static void put(queue *q, size_t at, uint32_t pole) {
    q->heap[at] = pole;
    q->place[pole] = (uint32_t)at;
}

static void sift_up(queue *q, size_t at, uint32_t pole) {
    for (; at > 0 && before(q, pole, q->heap[(at - 1) / 2]); at = (at - 1) / 2) put(q, at, q->heap[(at - 1) / 2]);
    put(q, at, pole);
}

static void sift_down(queue *q, size_t at, uint32_t pole) {
    for (size_t child; (child = 2 * at + 1) < q->heap_size; at = child) {
        if (child + 1 < q->heap_size && before(q, q->heap[child + 1], q->heap[child])) child++;
        if (!before(q, q->heap[child], pole)) break;
        put(q, at, q->heap[child]);
    }
    put(q, at, pole);
}

static uint32_t pop(queue *q) {
    uint32_t top = q->heap[0], last = q->heap[--q->heap_size];
    if (q->heap_size) sift_down(q, 0, last);
    q->place[top] = NO_PLACE;
    return top;
}

static bool confused_pole(const queue *q, uint32_t p) {
    return q->belief[0][p] > 0 && q->belief[1][p] > 0;
}

static void update_priority(queue *q, uint32_t p) {
    double out = q->belief[0][p], in = q->belief[1][p], old = q->priority[p];
    q->priority[p] = confused_pole(q, p) ? fabs(in - out) - 1 : fmax(in, out);
    if (q->priority[p] > old)
        sift_up(q, q->place[p], p);
    else if (q->priority[p] < old)
        sift_down(q, q->place[p], p);
}

static void push(uint32_t p, double weight, void *user) {
    queue *q = user;
    double belief = q->strength * weight;
    if (q->place[p] == NO_PLACE || q->certain[p] || !(belief > q->belief[q->side][p])) return;
    q->belief[q->side][p] = belief;
    update_priority(q, p);
}

/* Certain poles are outer; labelled ones are as certain of their labels. */
static void mark_certain(const brio_pole_graph *g, const uint8_t *label, queue *q) {
    brio_label_certain(g, q->certain);
    for (uint32_t p = 0; p < q->num_poles; p++) {
        if (label[p] != BRIO_LABEL_NONE) q->certain[p] = 1;
        if (q->certain[p]) q->belief[label[p] == BRIO_LABEL_INNER][p] = 1;
    }
}

static brio_status queue_new(const brio_pole_graph *g, const uint8_t *label, queue *q) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    size_t n = g->poles->count;
    q->num_poles = q->heap_size = n;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, q->belief[0], n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, q->belief[1], n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, q->priority, n));
    BRIO_TRY(BRIO_ALLOC(ctx, q->heap, n));
    BRIO_TRY(BRIO_ALLOC(ctx, q->place, n));
    BRIO_TRY(BRIO_ALLOC(ctx, q->certain, n));
    mark_certain(g, label, q);
    for (uint32_t p = 0; p < n; p++) put(q, p, p);
    for (uint32_t p = 0; p < n; p++) update_priority(q, p);
done:
    return status;
}

static void queue_free(brio_context *ctx, queue *q) {
    brio_release(ctx, q->belief[0]);
    brio_release(ctx, q->belief[1]);
    brio_release(ctx, q->priority);
    brio_release(ctx, q->heap);
    brio_release(ctx, q->place);
    brio_release(ctx, q->certain);
}

brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats) {
    brio_status status = BRIO_OK;
    queue q = {0};
    BRIO_TRY(queue_new(g, label, &q));
    while (q.heap_size) {
        if (q.heap_size % 65536 == 0)
            BRIO_TRY(brio_progress(g->ctx, "label", 1 - 0.5 * (double)q.heap_size / (double)q.num_poles));
        uint32_t p = pop(&q);
        int inner = q.belief[1][p] > q.belief[0][p];
        label[p] = inner ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        stats->confused += confused_pole(&q, p);
        q.strength = q.belief[inner][p];
        q.side = !inner;
        brio_pole_graph_opposite(g, p, push, &q);
        q.side = inner;
        for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
            push(g->edge_pole[e], (double)g->edge_weight[e], &q);
    }
done:
    queue_free(g->ctx, &q);
    return status;
}
