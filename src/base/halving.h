/* Divide and conquer by threads, where every division halves a range. */
#ifndef BRIO_BASE_HALVING_H
#define BRIO_BASE_HALVING_H

#include "base/context.h"

/** A recursion that cuts the range [0, count), then both of its halves, and so on. The middle of [begin, end) is
 *  begin + (end - begin) / 2. */
typedef struct {
    size_t count;
    size_t gap;   /* 0: the middle place begins the second half; 1: the middle place is in neither half */
    size_t least; /* ranges with more places may be cut by `cut`; at least as many as `finish` leaves uncut, plus gap */
    /* Cuts a range. Called by several threads for different ranges. */
    void (*cut)(const void *user, size_t begin, size_t middle, size_t end);
    /* Does a range with the whole recursion below the range.   depth  cuts above the range. */
    void (*finish)(const void *user, size_t begin, size_t end, int depth);
    const void *user;
} brio_halving;

/** Runs the recursion. Which ranges go to `cut` and which to `finish` depends on the number of threads. */
brio_status brio_halve(brio_context *ctx, const brio_halving *halving);

#endif
