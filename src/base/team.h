/* The threads of a context, and the loops that they share.
 *
 * A context owns a team. Member 0 is the thread that calls the library; the team creates the others when work first asks
 * for them, and keeps them, asleep, until the context is freed. Where the system refuses a thread, the team is smaller.
 * Work that a member starts from within work runs in that member alone. */
#ifndef BRIO_BASE_TEAM_H
#define BRIO_BASE_TEAM_H

#include "base/context.h"

typedef struct brio_team brio_team;

/** One thread of a team that runs something together. */
typedef struct brio_member {
    brio_team *team; /* NULL for a member that is alone */
    int thread;      /* 0 to threads - 1; 0 is the thread that called */
    int threads;     /* members of this run */
} brio_member;

typedef void (*brio_work_fn)(void *user, const brio_member *member);

/** The body of a loop over indices: does [begin, end). `thread` is the member's number. */
typedef void (*brio_part_fn)(void *user, size_t begin, size_t end, int thread);

/** The size in bytes of the memory for a team of at most `most` threads. */
size_t brio_team_bytes(int most);

/** Makes a team with no thread but the caller's, in memory of that many bytes. */
brio_team *brio_team_begin(void *memory, int most, int processors);

/** Ends the threads of a team. Its memory is the caller's. */
void brio_team_end(brio_team *team);

/** Processors that this process may run on, at least 1. */
int brio_processors(void);

/** The number of threads for n items of which `least` are worth a thread: at least 1, at most the context's setting.
 *  Creates the threads that are missing. Workspace for each thread is sized with this number, and the same number is
 *  given to the functions below. */
int brio_threads(brio_context *ctx, size_t n, size_t least);

/** Calls work(user, member) in that many threads at once and returns when all have returned. */
void brio_run(brio_context *ctx, int threads, brio_work_fn work, void *user);

/** Waits until every member of the run is here. What any of them wrote before is then seen by all. */
void brio_barrier(const brio_member *member);

/** Calls body once in each thread, with equal parts of [0, n) in the threads' order. */
void brio_for(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user);

/** Calls body for chunks of [0, n), each taken by the next thread that is free. */
void brio_for_chunks(brio_context *ctx, int threads, size_t n, size_t chunk, brio_part_fn body, void *user);

/** Keeps the first failure that the members of a run report to *shared, which starts as BRIO_OK. */
static inline void brio_report(brio_status *shared, brio_status own) {
    brio_status none = BRIO_OK;
    if (own != BRIO_OK) __atomic_compare_exchange_n(shared, &none, own, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
}

/** Where part i of n equal parts of [0, size) begins. */
static inline size_t brio_part(size_t size, int i, int n) {
    return size / (size_t)n * (size_t)i + size % (size_t)n * (size_t)i / (size_t)n;
}

#endif
