/* The threads of a context, and loops that they share.
 *
 * A context owns a team. Member 0 is the thread that calls the library. The team creates the other threads when they
 * are first needed and keeps them, asleep, until the context is freed. If the system refuses a thread, the team is
 * smaller. A run that a member starts within a run uses that member only. */
#ifndef BRIO_BASE_TEAM_H
#define BRIO_BASE_TEAM_H

#include "base/context.h"
#include <assert.h>

typedef struct brio_team brio_team;

/** One thread of a run. */
typedef struct brio_member {
    brio_team *team; /* NULL in a run of one member */
    int thread;      /* 0 to threads - 1; 0 is the thread that called */
    int threads;     /* the number of members in the run */
} brio_member;

typedef void (*brio_work_fn)(void *user, const brio_member *member);

/** The body of a loop over indices: works on [begin, end).   thread  the number of the member. */
typedef void (*brio_part_fn)(void *user, size_t begin, size_t end, int thread);

/** Returns the bytes of memory for a team of at most `most` threads. */
size_t brio_team_bytes(int most);

/** Makes a team of the caller's thread only.   memory  brio_team_bytes(most) bytes, owned by the caller. */
brio_team *brio_team_begin(void *memory, int most, int processors);

/** Ends the threads of a team. Does not free its memory. */
void brio_team_end(brio_team *team);

/** Returns the number of threads for n items if `least` items are worth a thread: at least 1, at most the context's
 *  setting. Creates the threads that are missing. The caller sizes its workspace for each thread by this number, and
 *  passes the same number to the functions below. */
int brio_threads(brio_context *ctx, size_t n, size_t least);

/** Calls work(user, member) in `threads` threads at once. Returns when all calls have returned. */
void brio_run(brio_context *ctx, int threads, brio_work_fn work, void *user);

/** Returns whether the caller is the thread that called the library: no run with several members goes on. Only then may
 *  it look (brio_look). */
bool brio_may_look(const brio_context *ctx);

/** Waits until every member of the run has called this. Afterwards each member sees what the others wrote before. */
void brio_barrier(const brio_member *member);

/** Divides [0, n) into equal parts in the order of the threads, and calls body for each piece of each part, in
 *  ascending order. A part has many pieces: body's work is to be in proportion to its piece (else: brio_for_parts).
 *  Between pieces the calling thread looks (brio_look): where the callback asks to stop, all threads do. Returns
 *  BRIO_OK or BRIO_ERR_CANCELLED: then some of the pieces were left out. */
brio_status brio_for(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user)
    __attribute__((warn_unused_result));

/** Divides [0, n) as brio_for does, and calls body once for each part: for a body that reads all data, whatever its
 *  part is. So it takes a slice of the data that is read within half a second. Looks at the end. */
brio_status brio_for_parts(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user)
    __attribute__((warn_unused_result));

/** Calls body for chunks of [0, n). Each chunk goes to the next thread that is free, in ascending order. Looks between
 *  chunks, and returns what brio_for returns. */
brio_status brio_for_chunks(brio_context *ctx, int threads, size_t n, size_t chunk, brio_part_fn body, void *user)
    __attribute__((warn_unused_result));

/** Stores a member's status in *shared if that is its first failure. *shared starts as BRIO_OK; members may call this
 *  together. */
static inline void brio_report(brio_status *shared, brio_status own) {
    brio_status none = BRIO_OK;
    if (own != BRIO_OK) __atomic_compare_exchange_n(shared, &none, own, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
}

/** Returns where part i of n equal parts of [0, size) begins. */
static inline size_t brio_part(size_t size, int i, int n) {
    assert(0 <= i && i <= n && n > 0);
    return size / (size_t)n * (size_t)i + size % (size_t)n * (size_t)i / (size_t)n;
}

/* --- loops along arrays that may be in scratch files ---
 *
 * A page fault on a scratch file reads one page and waits for the disk (memory.h). A loop that goes along an array
 * needs no faults: what comes next is asked for in stretches while it works, and what it has written is handed to the
 * disk, so that its pages are free when others need them. In memory such a loop is brio_for. */

/** An array of which a loop reads or writes row i when its index is i. */
typedef struct {
    const void *rows; /* a block of base/memory.h; NULL: none */
    size_t size;      /* bytes of a row; 0 ends a list of arrays */
    bool written;     /* whether the loop writes rows */
} brio_swept;

/* Most rows that are asked for at once: a stretch. Chosen. */
enum { BRIO_SWEEP_STRETCH = 1 << 13 };

#define BRIO_READS(array)                                                                                              \
    { (array), sizeof *(array), false }
#define BRIO_WRITES(array)                                                                                             \
    { (array), sizeof *(array), true }

/** Announces rows [begin, end) of a list of arrays. */
void brio_expect_rows(const brio_context *ctx, const brio_swept *swept, size_t begin, size_t end);

/** Hands rows [begin, end) of written arrays to the disk. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_settle_rows(brio_context *ctx, const brio_swept *swept, size_t begin, size_t end);

/** Announces, at the first row of a stretch, a stretch that comes soon; n is the number of all rows. */
void brio_expect_next(const brio_context *ctx, size_t row, size_t n, const brio_swept *swept);

/* BRIO_ARRAYS(BRIO_READS(a), BRIO_WRITES(b)): a list of arrays. */
#define BRIO_ARRAYS(...) ((const brio_swept[]){__VA_ARGS__, {NULL, 0, false}})

/* brio_along(ctx, i, n, BRIO_READS(a), BRIO_READS(b)) announces rows for a loop over i below n that is no brio_for. */
#define brio_along(ctx, row, n, ...)                                                                                   \
    ((row) % BRIO_SWEEP_STRETCH == 0 ? brio_expect_next(ctx, row, n, BRIO_ARRAYS(__VA_ARGS__)) : (void)0)

/** Does what brio_for does, for a body that goes along arrays with its index. */
brio_status brio_sweep_arrays(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user,
                              const brio_swept *swept) __attribute__((warn_unused_result));

/* brio_sweep(ctx, threads, n, body, user, BRIO_READS(a), BRIO_WRITES(b)) */
#define brio_sweep(ctx, threads, n, body, user, ...)                                                                   \
    brio_sweep_arrays(ctx, threads, n, body, user, BRIO_ARRAYS(__VA_ARGS__))

#endif
