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

#endif
