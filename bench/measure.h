/* What the benchmarks in C share: draws, clocks, and the end at a failure. */
#ifndef BENCH_MEASURE_H
#define BENCH_MEASURE_H

#include "brio/brio.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static uint64_t state = 1; /* of the draws */

/* Draws a number of [0, 1). */
static inline double draw(void) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-53;
}

/* Returns the seconds of a clock: of the wall, or of the processor. */
static inline double seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Ends the program with the sentence of a call that failed. */
static inline void check(brio_context *ctx, brio_status status) {
    if (status == BRIO_OK) return;
    fprintf(stderr, "%s\n", brio_message(ctx));
    exit(1);
}

#endif
