/* A priority queue of poles, for priorities that never rise above the last one taken. */
#ifndef BRIO_RECONSTRUCT_POLE_QUEUE_H
#define BRIO_RECONSTRUCT_POLE_QUEUE_H

#include "dual/poles.h"

typedef struct {
    uint64_t key; /* the bits of the priority, which order positive numbers as their values do */
    uint32_t pole;
} brio_pole_entry;

enum { BRIO_POLE_BUCKETS = 64 };

typedef struct {
    brio_context *ctx;
    uint64_t last;   /* key of the last pole taken */
    uint64_t filled; /* bit b: bucket b has entries; no sign, no bucket 64 */
    brio_pole_entry *bucket[BRIO_POLE_BUCKETS];
    size_t size[BRIO_POLE_BUCKETS], capacity[BRIO_POLE_BUCKETS];
} brio_pole_queue;

/** An empty queue for priorities from `most` downwards. */
brio_pole_queue brio_pole_queue_new(brio_context *ctx, double most);
void brio_pole_queue_free(brio_pole_queue *queue);

/** Adds a pole, which may be there already; the priority is positive and at most that of the last pole taken. */
brio_status brio_pole_queue_push(brio_pole_queue *queue, uint32_t pole, double priority);

/** Takes an entry of the highest priority, of several the one with the lowest pole; *found is false when there is none.
 *  O(1) amortised but for the ties. */
brio_status brio_pole_queue_pop(brio_pole_queue *queue, uint32_t *pole, double *priority, bool *found);

/** One of the poles that come up next; BRIO_NO_POLE when there is none. */
uint32_t brio_pole_queue_next(const brio_pole_queue *queue);

#endif
