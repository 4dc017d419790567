/* A radix heap. Bucket b > 0 holds the entries whose priorities differ from `last` in bit b - 1 and in no higher bit.
 *
 * Bucket 0 is a binary heap of the entries with priorities equal to `last` or above. When bucket 0 is empty, `last`
 * becomes the highest priority in the first bucket that has entries. The entries of that bucket then move to lower
 * buckets. So an entry moves a few times, always to the end of an array, where a binary heap would move along a path in
 * memory.
 *
 * Based on: Ahuja, Mehlhorn, Orlin, Tarjan. Faster algorithms for the shortest path problem. JACM 1990.
 * Differs from the paper: priorities may rise. Those above `last` wait in bucket 0, too, and are taken first. */
#include "reconstruct/labels/pole_queue.h"
#include "base/memory.h"

#define HEAP_ITEM              uint64_t
#define HEAP_ABOVE(a, b, user) ((a) > (b))
#define HEAP_DOWN              entry_down
#define HEAP_UP                entry_up
#include "base/heap.h"

brio_pole_queue brio_pole_queue_new(brio_context *ctx, uint32_t most) {
    return (brio_pole_queue){.ctx = ctx, .last = most};
}

void brio_pole_queue_free(brio_pole_queue *q) {
    for (int b = 0; b < BRIO_POLE_BUCKETS; b++) brio_release(q->ctx, q->bucket[b]);
}

static uint32_t priority_of(uint64_t entry) {
    return (uint32_t)(entry >> 32);
}

static uint32_t pole_of(uint64_t entry) {
    return ~(uint32_t)entry;
}

static int bucket_of(const brio_pole_queue *q, uint32_t priority) {
    return priority >= q->last ? 0 : 32 - __builtin_clz(priority ^ q->last);
}

/* --- queue --- */

static inline brio_status add(brio_pole_queue *q, uint64_t entry) {
    int b = bucket_of(q, priority_of(entry));
    brio_status status = BRIO_RESERVE(q->ctx, q->bucket[b], q->capacity[b], q->size[b] + 1);
    if (status != BRIO_OK) return status;
    q->bucket[b][q->size[b]++] = entry;
    q->filled |= UINT64_C(1) << b;
    if (b == 0) entry_up(q->bucket[0], q->size[0] - 1, entry, NULL);
    return BRIO_OK;
}

brio_status brio_pole_queue_push(brio_pole_queue *q, uint32_t pole, uint32_t priority) {
    return add(q, (uint64_t)priority << 32 | (uint32_t)~pole);
}

static brio_status deal_out(brio_pole_queue *q, int b) {
    brio_status status = BRIO_OK;
    uint64_t highest = 0;
    for (size_t i = 0; i < q->size[b]; i++)
        if (q->bucket[b][i] > highest) highest = q->bucket[b][i];
    q->last = priority_of(highest);
    for (size_t i = 0; i < q->size[b]; i++) BRIO_TRY(add(q, q->bucket[b][i]));
    q->size[b] = 0;
    q->filled &= ~(UINT64_C(1) << b);
done:
    return status;
}

brio_status brio_pole_queue_pop(brio_pole_queue *q, uint32_t *pole, uint32_t *priority, bool *found) {
    brio_status status = BRIO_OK;
    *found = q->filled != 0;
    if (!*found) goto done;
    int b = __builtin_ctzll(q->filled);
    if (b > 0) BRIO_TRY(deal_out(q, b));
    *pole = pole_of(q->bucket[0][0]);
    *priority = priority_of(q->bucket[0][0]);
    size_t left = --q->size[0];
    if (left)
        entry_down(q->bucket[0], 0, left, q->bucket[0][left], NULL);
    else
        q->filled &= ~UINT64_C(1);
done:
    return status;
}

int brio_pole_queue_peek(const brio_pole_queue *q, uint32_t *poles) {
    if (!q->filled) return 0;
    int b = __builtin_ctzll(q->filled), count = q->size[b] < BRIO_POLE_PEEK ? (int)q->size[b] : BRIO_POLE_PEEK;
    /* a heap has its highest entry in front */
    const uint64_t *first = q->bucket[b] + (b ? q->size[b] - (size_t)count : 0);
    for (int i = 0; i < count; i++) poles[i] = pole_of(first[i]);
    return count;
}
