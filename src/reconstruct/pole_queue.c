/* A radix heap: bucket b holds the entries whose keys differ from the last key taken in bit b - 1 and in no higher one.
 *
 * Bucket 0 has the last key's equals, as a heap by their poles. When it is empty, the first bucket that is not is dealt
 * out anew around its greatest key, each entry to a bucket before it: an entry moves a few times, each time to the end
 * of an array, where a common heap would go down a tree in memory.
 *
 * Based on: Ahuja, Mehlhorn, Orlin, Tarjan. Faster algorithms for the shortest path problem. JACM 1990. */
#include "reconstruct/pole_queue.h"
#include "base/memory.h"
#include <string.h>

brio_pole_queue brio_pole_queue_new(brio_context *ctx, double most) {
    brio_pole_queue q = {.ctx = ctx};
    memcpy(&q.last, &most, sizeof most);
    return q;
}

void brio_pole_queue_free(brio_pole_queue *q) {
    for (int b = 0; b < BRIO_POLE_BUCKETS; b++) brio_release(q->ctx, q->bucket[b]);
}

static int bucket_of(const brio_pole_queue *q, uint64_t key) {
    return key == q->last ? 0 : 64 - __builtin_clzll(key ^ q->last);
}

/* --- the heap of equals --- */

static void lift_last(brio_pole_entry *heap, size_t size) {
    brio_pole_entry e = heap[size - 1];
    size_t i = size - 1;
    for (; i > 0 && e.pole < heap[(i - 1) / 2].pole; i = (i - 1) / 2) heap[i] = heap[(i - 1) / 2];
    heap[i] = e;
}

static void drop_first(brio_pole_entry *heap, size_t size) {
    brio_pole_entry last = heap[size - 1];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < size - 1; i = child) {
        if (child + 1 < size - 1 && heap[child + 1].pole < heap[child].pole) child++;
        if (last.pole <= heap[child].pole) break;
        heap[i] = heap[child];
    }
    heap[i] = last;
}

/* --- queue --- */

static inline brio_status add(brio_pole_queue *q, brio_pole_entry e) {
    int b = bucket_of(q, e.key);
    brio_status status = BRIO_RESERVE(q->ctx, q->bucket[b], q->capacity[b], q->size[b] + 1);
    if (status != BRIO_OK) return status;
    q->bucket[b][q->size[b]++] = e;
    q->filled |= UINT64_C(1) << b;
    if (b == 0) lift_last(q->bucket[0], q->size[0]);
    return BRIO_OK;
}

brio_status brio_pole_queue_push(brio_pole_queue *q, uint32_t pole, double priority) {
    brio_pole_entry e = {.pole = pole};
    memcpy(&e.key, &priority, sizeof priority);
    return add(q, e);
}

static brio_status deal_out(brio_pole_queue *q, int b) {
    brio_status status = BRIO_OK;
    q->last = 0;
    for (size_t i = 0; i < q->size[b]; i++)
        if (q->bucket[b][i].key > q->last) q->last = q->bucket[b][i].key;
    for (size_t i = 0; i < q->size[b]; i++) BRIO_TRY(add(q, q->bucket[b][i]));
    q->size[b] = 0;
    q->filled &= ~(UINT64_C(1) << b);
done:
    return status;
}

brio_status brio_pole_queue_pop(brio_pole_queue *q, uint32_t *pole, double *priority, bool *found) {
    brio_status status = BRIO_OK;
    *found = q->filled != 0;
    if (!*found) goto done;
    int b = __builtin_ctzll(q->filled);
    if (b > 0) BRIO_TRY(deal_out(q, b));
    *pole = q->bucket[0][0].pole;
    memcpy(priority, &q->last, sizeof *priority);
    drop_first(q->bucket[0], q->size[0]--);
    if (!q->size[0]) q->filled &= ~UINT64_C(1);
done:
    return status;
}

uint32_t brio_pole_queue_next(const brio_pole_queue *q) {
    if (!q->filled) return BRIO_NO_POLE;
    int b = __builtin_ctzll(q->filled);
    return q->bucket[b][q->size[b] - 1].pole;
}
