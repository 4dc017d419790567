/* A priority queue of poles, for priorities that seldom rise above the last one taken. */
#ifndef BRIO_RECONSTRUCT_POLE_QUEUE_H
#define BRIO_RECONSTRUCT_POLE_QUEUE_H

#include "dual/poles.h"

enum { BRIO_POLE_BUCKETS = 33, BRIO_POLE_PEEK = 4 };

typedef struct {
    brio_context *ctx;
    uint32_t last;                       /* no entry outside of bucket 0 has a higher priority */
    uint64_t filled;                     /* bit b: bucket b has entries */
    uint64_t *bucket[BRIO_POLE_BUCKETS]; /* entries: the priority, and below it the complement of the pole */
    size_t size[BRIO_POLE_BUCKETS], capacity[BRIO_POLE_BUCKETS];
} brio_pole_queue;

/** An empty queue; `most` is the highest priority to expect for now. */
brio_pole_queue brio_pole_queue_new(brio_context *ctx, uint32_t most);
void brio_pole_queue_free(brio_pole_queue *queue);

/** Adds a pole, which may be there already. O(1) amortised, but for a priority that is above the last one taken:
 *  O(log n), n being the number of those. */
brio_status brio_pole_queue_push(brio_pole_queue *queue, uint32_t pole, uint32_t priority);

/** Takes an entry of the highest priority, of several the one with the lowest pole; *found is false when there is none.
 *  O(1) amortised but for ties and for what was above the last one. */
brio_status brio_pole_queue_pop(brio_pole_queue *queue, uint32_t *pole, uint32_t *priority, bool *found);

/** Some poles that come up soon, at most BRIO_POLE_PEEK; their number. */
int brio_pole_queue_peek(const brio_pole_queue *queue, uint32_t *poles);

#endif
