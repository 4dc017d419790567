/* A priority queue of poles, fast if a new priority is seldom above the last one taken. */
#ifndef BRIO_RECONSTRUCT_POLE_QUEUE_H
#define BRIO_RECONSTRUCT_POLE_QUEUE_H

#include "dual/poles.h"

/* BRIO_POLE_BUCKETS: bucket 0 and one for each bit of a priority. BRIO_POLE_PEEK: chosen. */
enum { BRIO_POLE_BUCKETS = 33, BRIO_POLE_PEEK = 4 };

typedef struct {
    brio_context *ctx;
    uint32_t last;                       /* the priority taken last; only bucket 0 has higher ones */
    uint64_t filled;                     /* bit b: bucket b has entries */
    uint64_t *bucket[BRIO_POLE_BUCKETS]; /* entries: priority << 32 | ~pole */
    size_t size[BRIO_POLE_BUCKETS], capacity[BRIO_POLE_BUCKETS];
} brio_pole_queue;

/** Makes an empty queue.   most  the highest priority that is expected; higher ones are allowed, and slower. */
brio_pole_queue brio_pole_queue_new(brio_context *ctx, uint32_t most);
void brio_pole_queue_free(brio_pole_queue *queue);

/** Adds an entry; the pole may have other entries.
 *  Cost: O(1) amortised if the priority is below the last one taken, otherwise O(log n) for the n entries at or above
 *  it.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_pole_queue_push(brio_pole_queue *queue, uint32_t pole, uint32_t priority);

/** Takes the entry of the highest priority; among equals, that of the lowest pole. *found is false if the queue is
 *  empty.
 *  Cost: O(1) amortised, and O(log n) for the n entries at or above the last priority taken.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_pole_queue_pop(brio_pole_queue *queue, uint32_t *pole, uint32_t *priority, bool *found);

/** Writes up to BRIO_POLE_PEEK poles that are likely to be taken soon. Returns their number. */
int brio_pole_queue_peek(const brio_pole_queue *queue, uint32_t *poles);

#endif
