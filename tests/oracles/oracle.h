/* What the oracles' programs share: random numbers that a seed and the number of an input determine, options of the command
 * line, and the end of a program whose results are wrong. Nothing here is the library's: its public header alone is known. */
#ifndef BRIO_TESTS_ORACLE_H
#define BRIO_TESTS_ORACLE_H

#include "brio/brio.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- random numbers: xorshift64*, started by two steps of a linear generator --- */

typedef struct {
    uint64_t state;
} dice;

static inline uint64_t roll(dice *d) {
    d->state ^= d->state >> 12, d->state ^= d->state << 25, d->state ^= d->state >> 27;
    return d->state * UINT64_C(2685821657736338717);
}

/** The numbers of input `index` of a run with this seed. */
static inline dice dice_of(uint64_t seed, uint64_t index) {
    uint64_t x = (seed * UINT64_C(6364136223846793005) + index) * UINT64_C(6364136223846793005) + 1442695040888963407u;
    dice d = {(x ^ x >> 29) * UINT64_C(2862933555777941757) | 1};
    for (int i = 0; i < 4; i++) roll(&d);
    return d;
}

static inline uint32_t below(dice *d, uint32_t n) {
    return (uint32_t)((roll(d) >> 32) * n >> 32);
}

/** Whether an event of probability 1 / n happens. */
static inline bool one_in(dice *d, uint32_t n) {
    return below(d, n) == 0;
}

/* --- the command line: --inputs N --seed S --first I; --inputs 1 --first I repeats input I --- */

typedef struct {
    uint64_t inputs, seed, first;
} oracle_run;

static inline oracle_run oracle_arguments(int argc, char **argv, uint64_t inputs) {
    oracle_run r = {inputs, 1, 0};
    for (int i = 1; i + 1 < argc; i += 2) {
        uint64_t x = strtoull(argv[i + 1], NULL, 10);
        if (!strcmp(argv[i], "--inputs")) r.inputs = x;
        if (!strcmp(argv[i], "--seed")) r.seed = x;
        if (!strcmp(argv[i], "--first")) r.first = x;
    }
    return r;
}

static inline brio_context *oracle_context(void) {
    brio_context *ctx;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) exit(2);
    brio_context_set_threads(ctx, 1);
    return ctx;
}

static inline void print_points(const double *points, const double *weights, size_t n, size_t coordinates) {
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < coordinates; k++) printf(" %a", points[coordinates * i + k]);
        if (weights) printf("  weight %a", weights[i]);
        printf("\n");
    }
}

#endif
