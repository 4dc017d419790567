/* The context behind the public handle, and the ways every other part reports failure, takes memory, and shows
 * progress. Error handling in one shape everywhere: a function keeps `brio_status status = BRIO_OK`, uses BRIO_TRY and
 * BRIO_REQUIRE, which jump to its one label `done:`, and frees its workspace there. */
#ifndef BRIO_BASE_CONTEXT_H
#define BRIO_BASE_CONTEXT_H

#include "brio/brio.h"
#include <pthread.h>
#include <stdbool.h>

enum { BRIO_MOST_KEPT = 64, BRIO_PAGE = 1 << 14 };

typedef struct {
    void *base;
    size_t size; /* a multiple of BRIO_PAGE */
} brio_mapping;

/** A part of the progress bar, in fractions of the whole bar. */
typedef struct {
    double from, to;
} brio_bar;

struct brio_context {
    brio_allocator allocator;
    bool custom;                       /* allocator is the caller's: no mappings */
    int threads, most_threads;         /* as set; 0 = all; and the most that can be set */
    int processors;                    /* that the process might run on when the context was made */
    struct brio_team *team;            /* the threads, see team.h; behind the context in its block */
    pthread_mutex_t lock;              /* of the kept mappings and the message */
    size_t caller_limit;               /* bytes, 0 = none */
    size_t machine_limit;              /* of the memory cgroup and the machine */
    size_t live, peak;                 /* bytes of anonymous memory; updated atomically */
    brio_mapping kept[BRIO_MOST_KEPT]; /* given back by blocks, see kept.h */
    int num_kept, keeping;
    size_t kept_bytes;
    char *scratch; /* folder of mapped files, or NULL */
    brio_progress_fn progress;
    void *progress_user;
    brio_bar bar; /* the part that the running stage owns */
    char message[512];
};

/** Stores the sentence for the status and returns the status. */
brio_status brio_fail(brio_context *ctx, brio_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Tells the caller how far a stage is; BRIO_ERR_CANCELLED when the caller wants to stop. */
brio_status brio_progress(brio_context *ctx, const char *stage, double fraction);

/** The part of the progress bar that the caller owns. A function that divides it among stages asks for it first, and at
 *  its label `done:` takes all of it back: brio_progress_part(ctx, bar, 0, 1). */
static inline brio_bar brio_progress_bar(const brio_context *ctx) {
    return ctx->bar;
}

/** Gives the stage that follows the fractions `from` to `to` of the caller's bar. */
void brio_progress_part(brio_context *ctx, brio_bar bar, double from, double to);

/** Seconds of a monotonic clock. */
double brio_seconds(void);

#define BRIO_TRY(call)                                                                                                 \
    do {                                                                                                               \
        status = (call);                                                                                               \
        if (status != BRIO_OK) goto done;                                                                              \
    } while (0)

#define BRIO_REQUIRE(ctx, condition, code, ...)                                                                        \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            status = brio_fail(ctx, code, __VA_ARGS__);                                                                \
            goto done;                                                                                                 \
        }                                                                                                              \
    } while (0)

#endif
