/* Loops that read arrays in step with their index, where the arrays may be in scratch files.
 *
 * A page fault on a scratch file reads one page and waits for the disk (memory.h). A loop that goes along an array needs
 * no faults: what comes next is asked for in stretches while it works, and what it has written is handed to the disk, so
 * that its pages are free when others need them. In memory such a loop is brio_for. */
#ifndef BRIO_BASE_SWEEP_H
#define BRIO_BASE_SWEEP_H

#include "base/team.h"

/** An array of which a loop reads or writes row i when its index is i. */
typedef struct {
    const void *rows; /* a block of base/memory.h; NULL: none */
    size_t size;      /* bytes of a row */
    bool written;     /* whether the loop writes rows */
} brio_swept;

/* Most rows that are asked for at once: a stretch. Chosen. */
enum { BRIO_SWEEP_STRETCH = 1 << 13 };

#define BRIO_READS(array)  {(array), sizeof *(array), false}
#define BRIO_WRITES(array) {(array), sizeof *(array), true}

/** Announces rows [begin, end) of arrays. */
void brio_expect_rows(const brio_context *ctx, const brio_swept *swept, size_t num_swept, size_t begin, size_t end);

/** Hands rows [begin, end) of written arrays to the disk. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_settle_rows(brio_context *ctx, const brio_swept *swept, size_t num_swept, size_t begin, size_t end);

/** What brio_along does at the first row of a stretch. */
void brio_expect_next(const brio_context *ctx, size_t row, size_t n, const brio_swept *swept, size_t num_swept);

/* Announces, at the first row of a stretch, those of the next one: for loops over rows below n that are no brio_for.
 * brio_along(ctx, i, n, BRIO_READS(a), BRIO_READS(b)) */
#define brio_along(ctx, row, n, ...)                                                                                   \
    ((row) % BRIO_SWEEP_STRETCH == 0                                                                                   \
         ? brio_expect_next(ctx, row, n, (const brio_swept[]){__VA_ARGS__},                                            \
                            sizeof((const brio_swept[]){__VA_ARGS__}) / sizeof(brio_swept))                            \
         : (void)0)

/** Does what brio_for does, with arrays that are read in step. */
brio_status brio_sweep_arrays(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user,
                              const brio_swept *swept, size_t num_swept) __attribute__((warn_unused_result));

/* brio_sweep(ctx, threads, n, body, user, BRIO_READS(a), BRIO_WRITES(b)) */
#define brio_sweep(ctx, threads, n, body, user, ...)                                                                   \
    brio_sweep_arrays(ctx, threads, n, body, user, (const brio_swept[]){__VA_ARGS__},                                  \
                      sizeof((const brio_swept[]){__VA_ARGS__}) / sizeof(brio_swept))

#endif
