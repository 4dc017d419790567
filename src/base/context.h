/* The context behind the public handle: how all code reports failures, takes memory and reports progress.
 *
 * Error handling has two shapes. A function that has nothing to free returns at once: BRIO_FORWARD and BRIO_EXPECT. One
 * that has declares `brio_status status = BRIO_OK`; BRIO_TRY and BRIO_REQUIRE jump to its one label `done:`, where it
 * frees its workspace and returns the status. */
#ifndef BRIO_BASE_CONTEXT_H
#define BRIO_BASE_CONTEXT_H

#include "brio/brio.h"
#include "platform/thread.h"
#include <stdbool.h>

/* BRIO_PAGE: sizes of mappings are multiples of this. Both chosen. */
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
    bool custom;                       /* the allocator is the caller's: no mappings */
    int threads, most_threads;         /* as set (0: all processors), and the most that can be set */
    int processors;                    /* processors that the process could run on when the context was made */
    struct brio_team *team;            /* the threads (team.h); lies behind the context in its block */
    brio_mutex lock;                   /* protects the kept mappings and the message */
    size_t caller_limit;               /* bytes, 0 for none */
    size_t machine_limit;              /* bytes: the lesser of the machine's memory and the memory cgroup's limit */
    size_t live, peak;                 /* bytes of blocks outside scratch files, now and at most; atomic */
    brio_mapping kept[BRIO_MOST_KEPT]; /* unused mappings, see kept.h */
    int num_kept, keeping;
    size_t kept_bytes;
    char *scratch;        /* folder of mapped files, or NULL */
    bool scratch_in_runs; /* its missing pages are read with those about them (memory.c) */
    brio_progress_fn progress;
    void *progress_user;
    brio_bar bar;      /* the part that the running stage owns */
    const char *stage; /* what the callback was told last, NULL for nothing */
    double share;
    size_t unlooked;                              /* items of work since the callback was asked last */
    bool stopped;                                 /* the callback asked to stop, in the loop (team.h) that runs */
    const struct brio_experiment *experiment;     /* experiment.h; NULL: none */
    const struct brio_triangulator *triangulator; /* triangulation/triangulation.h; NULL: brio_delaunay */
    const struct brio_part_decider *decider;      /* reconstruct/labels/cut_in_parts.h; NULL: the threads */
    char message[512];
    char named[512];            /* the last sentence that names the rank where a failure was (ranks/exchange.h) */
    brio_failure failure, next; /* of the message; what is known so far of the failure that is about to come */
    uint64_t failures;          /* that were told in messages */
};

/** Stores a message in the context and returns the status. Threads may call this together. */
brio_status brio_fail(brio_context *ctx, brio_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Records what the failure that comes next is about: a reason; a point that its sentence names; the bytes of a block.
 *  In the arguments of brio_fail and of the macros below, which evaluate them after a failure only. */
void brio_reason_is(brio_context *ctx, brio_reason reason);
void brio_name_point(brio_context *ctx, size_t point);
void brio_block_is(brio_context *ctx, size_t bytes);

/** A status with its reason, and the index of a point, as arguments. */
#define BRIO_BECAUSE(ctx, reason, code) (brio_reason_is(ctx, BRIO_REASON_##reason), (code))
#define BRIO_POINT(ctx, point)          (brio_name_point(ctx, point), (point))

/** Reports that a fraction of a stage is done. Returns BRIO_OK, or BRIO_ERR_CANCELLED if the callback asked to stop.
 *  Only the thread that called the library may call this. */
brio_status brio_progress(brio_context *ctx, const char *stage, double fraction);

/** Asks the callback whether to stop, with what it was told last. Returns what brio_progress returns. */
brio_status brio_ask(brio_context *ctx);

/* BRIO_LOOK_EVERY: items of work between two looks; an item takes 1 ns to 2 us. Chosen. */
enum { BRIO_LOOK_EVERY = 1 << 14 };

/** Looks: counts `items` of work as done, and asks the callback whether to stop when they add up to BRIO_LOOK_EVERY.
 *  Every loop over data of the caller looks, or is a brio_for, so that the callback is asked within half a second of
 *  processor time. Returns BRIO_OK or BRIO_ERR_CANCELLED. Only the thread that called the library may call this. */
static inline brio_status brio_look(brio_context *ctx, size_t items) {
    ctx->unlooked += items;
    return ctx->unlooked < BRIO_LOOK_EVERY ? BRIO_OK : brio_ask(ctx);
}

/** Returns the part of the progress bar that the running function owns. A function that divides its part among stages
 *  asks for it first, and at its label `done:` takes all of it back: brio_progress_part(ctx, bar, 0, 1). */
static inline brio_bar brio_progress_bar(const brio_context *ctx) {
    return ctx->bar;
}

/** Gives the stage that follows the fractions `from` to `to` of the caller's bar. */
void brio_progress_part(brio_context *ctx, brio_bar bar, double from, double to);

/* --- in functions that have nothing to free --- */

/** Returns the result of a call unless it is BRIO_OK. */
#define BRIO_FORWARD(call)                                                                                             \
    do {                                                                                                               \
        const brio_status forwarded = (call);                                                                          \
        if (forwarded != BRIO_OK) return forwarded;                                                                    \
    } while (0)

/** If the condition is false, stores a message and returns `code`. */
#define BRIO_EXPECT(ctx, condition, code, ...)                                                                         \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            const brio_status refused = (code);                                                                        \
            brio_fail(ctx, refused, __VA_ARGS__);                                                                      \
            return refused; /* the compiler sees that it is not BRIO_OK */                                             \
        }                                                                                                              \
    } while (0)

/* --- in functions that free at their label done: --- */

/** Assigns the result of a call to `status`; jumps to `done` unless it is BRIO_OK. */
#define BRIO_TRY(call)                                                                                                 \
    do {                                                                                                               \
        status = (call);                                                                                               \
        if (status != BRIO_OK) goto done;                                                                              \
    } while (0)

/** If the condition is false, stores a message, assigns `code` to `status` and jumps to `done`. */
#define BRIO_REQUIRE(ctx, condition, code, ...)                                                                        \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            status = (code);                                                                                           \
            brio_fail(ctx, status, __VA_ARGS__);                                                                       \
            goto done;                                                                                                 \
        }                                                                                                              \
    } while (0)

#endif
