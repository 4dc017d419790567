/* Parallel insertion: each thread holds the part of the points where it works.
 *
 * A curve through the points is divided into segments, many more than threads. Each thread inserts a part of the points
 * that follow the curve. It walks through and destroys only tetrahedra all of whose finite vertices are in segments
 * that it holds, its zone: it takes a segment when it first meets a vertex there, and gives it back when it has moved
 * on. A point whose walk or cavity meets a segment of another thread is deferred, since that thread is at work there
 * now; later it will not be. The tetrahedra round a cavity share three vertices with it, so no other thread can destroy
 * them, and what is read of them does not change: their mates are written only through the facet that both share (P1 to
 * P4 in store.h, proved in docs/decisions/006-segments-held-by-threads.md). So threads never wait for each other, and
 * share nothing but the segments' marks and the count of slots, taken in large stretches. What is left when a thread
 * has tried all its points again goes into another pass, and at the end to one thread.
 *
 * The result is the one triangulation that exact predicates and the symbolic perturbation determine, whatever was
 * deferred.
 *
 * Based on: Marot, Pellerin, Remacle. One machine, one minute, three billion tetrahedra. IJNME 2019, for the ownership
 *           by vertices; Batista, Millman, Pion, Singler. Parallel geometric algorithms for multi-core computers. CGTA
 *           2010, for giving up instead of waiting.
 * Differs from both: zones of the curve are not fixed for a pass but follow the thread, and locks are neither of
 * tetrahedra nor of vertices but of segments, kept from one insertion to the next.
 */
#include "triangulation/parallel.h"
#include "base/memory.h"
#include "base/team.h"
#include "triangulation/insert.h"
#include "triangulation/zone.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    LEAST = 512, /* points to insert that are worth a thread */
    CROWD = 256, /* points in all that are worth a thread */
    PASSES = 4,  /* then one thread goes on */
    RETRIES = 4, /* of a thread's deferred points in a pass */
    STARTS = 32, /* places along a thread's part where it may begin */
    SEGMENT = 4, /* vertices in a segment when a pass begins */
    MOST_SEGMENTS = 1 << 16
};

/* What the threads of a pass share, beside the store. All but the last three fields are constant in a pass. */
typedef struct {
    brio_inserter *main; /* the one that works alone between passes, and rests in them */
    brio_store *store;
    uint32_t first; /* the records to insert, along the curve: those of the turns from `first` on, or those listed */
    uint32_t *list;
    size_t count;
    int shift; /* of ranks to segments */
    size_t segments;
    uint8_t *taken; /* of each segment; see brio_zone */
    int stop;       /* some thread failed; only hastens the others' end */
    int running;    /* threads at work */
} pass;

/* One thread's work in a pass. Made by the calling thread before the pass, and read by it after the pass. */
typedef struct {
    pass *pass;
    brio_inserter *inserter;
    brio_zone zone;
    size_t begin, end; /* of the records to insert */
    bool placed;       /* it has a tetrahedron to start from */
    uint32_t *deferred;
    size_t num_deferred, deferred_capacity;
    brio_status status;
} worker;

static inline uint32_t record_of(const pass *own, size_t i) {
    assert(i < own->count);
    return own->list ? own->list[i] : brio_record_at(own->store, own->first + i);
}

/* --- one thread --- */

/* Inserts a record, or defers it. Where the next walk starts stays in the zone (N1). */
static brio_status insert_in_zone(brio_inserter *ins, uint32_t p, brio_insertion *outcome) {
    *outcome = BRIO_DEFERRED;
    if (!brio_zone_has(ins->zone, p)) return BRIO_OK;
    assert(brio_zone_holds(ins->zone, p)); /* P4 */
    brio_status status = brio_insert(ins, p, outcome);
    if (status != BRIO_OK) return status; /* the store is good for nothing but to be freed */
    brio_owns(&ins->store->t, ins->zone, ins->walk.start);
    if (brio_zone_tidy(ins->zone) && *outcome != BRIO_INSERTED)
        ins->cavity.num_created = 0; /* the last star is no longer held (N2) */
    return BRIO_OK;
}

static brio_status try_point(worker *w, uint32_t p) {
    brio_insertion outcome = BRIO_DEFERRED;
    if (w->placed) BRIO_FORWARD(insert_in_zone(w->inserter, p, &outcome));
    if (outcome != BRIO_DEFERRED) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(w->pass->store->ctx, w->deferred, w->deferred_capacity, w->num_deferred + 1));
    w->deferred[w->num_deferred++] = p;
    return BRIO_OK;
}

/* Reports progress: that of one thread stands for that of all. */
static brio_status report(worker *w, size_t i) {
    const pass *own = w->pass;
    assert(w->begin < w->end && i <= w->end);
    double done = (double)own->first + (double)(i - w->begin) / (double)(w->end - w->begin) * (double)own->count;
    return brio_inserter_report(w->inserter, done / (double)own->store->num_points);
}

static bool is_report_due(const brio_inserter *ins) {
    return brio_inserter_work(ins) >= ins->report_at;
}

/* Tries the deferred points again. */
static brio_status try_again(worker *w) {
    size_t count = w->num_deferred;
    w->num_deferred = 0;
    for (size_t i = 0; i < count; i++) {
        if (__atomic_load_n(&w->pass->stop, __ATOMIC_RELAXED)) break;
        BRIO_FORWARD(try_point(w, w->deferred[i]));
        if (is_report_due(w->inserter)) BRIO_FORWARD(report(w, w->end));
    }
    return BRIO_OK;
}

/* Reports progress, in the calling thread, from when it is done with its part until the other threads are. It sleeps
 * for a share of the time that it has waited, so that it is late by no more than that share. */
static brio_status wait_for_others(worker *w) {
    const double SHARE = 1.0 / 16, LEAST_SLEEP = 2e-5, MOST_SLEEP = 1e-2, BETWEEN = 0.05;
    double start = brio_seconds(), told = start, now = start;
    while (__atomic_load_n(&w->pass->running, __ATOMIC_ACQUIRE) > 0) {
        double sleep = fmin(fmax(SHARE * (now - start), LEAST_SLEEP), MOST_SLEEP);
        brio_sleep(sleep);
        now = brio_seconds();
        if (now - told < BETWEEN) continue;
        told = now;
        BRIO_FORWARD(report(w, w->end));
    }
    return BRIO_OK;
}

/* Does a thread's part of a pass. A failed insertion may have left its cavity half filled: then the thread's segments
 * stay taken. */
static brio_status work(worker *w) {
    brio_inserter *ins = w->inserter;
    pass *own = w->pass;
    brio_status status = BRIO_OK;
    for (size_t i = w->begin; i < w->end && !__atomic_load_n(&own->stop, __ATOMIC_RELAXED); i++) {
        BRIO_TRY(try_point(w, record_of(own, i)));
        if (is_report_due(ins)) BRIO_TRY(report(w, i));
    }
    ins->stats.deferred = w->num_deferred;
    for (int i = 0; i < RETRIES && w->num_deferred && w->placed; i++) BRIO_TRY(try_again(w));
done:
    if (status == BRIO_OK) brio_zone_leave(&w->zone);
    __atomic_sub_fetch(&own->running, 1, __ATOMIC_RELEASE);
    if (status == BRIO_OK && ins->reports && own->store->ctx->progress) status = wait_for_others(w);
    if (status != BRIO_OK) __atomic_store_n(&own->stop, 1, __ATOMIC_RELAXED);
    return status;
}

static void work_as_member(void *user, const brio_member *m) {
    worker *w = (worker *)user + m->thread;
    w->status = work(w);
}

/* --- workers --- */

/* Finds a tetrahedron along the worker's part that the worker can hold. Returns whether there is one. */
static bool place_worker(worker *w) {
    brio_inserter *ins = w->inserter, *main = w->pass->main;
    const brio_store *store = w->pass->store;
    size_t n = w->end - w->begin;
    for (size_t i = 0; i < STARTS && n; i++) {
        const double *p = store->record[record_of(w->pass, w->begin + i * n / STARTS)];
        ins->walk.start = main->walk.start = brio_inserter_walk(main, p, UINT64_MAX);
        if (brio_owns(&store->t, ins->zone, ins->walk.start)) return true;
        brio_zone_leave(&w->zone);
    }
    return false;
}

/* Makes the worker of thread i and places it in its zone. */
static brio_status worker_new(pass *own, int i, int threads, worker *w) {
    brio_context *ctx = own->store->ctx;
    const brio_inserter *main = own->main;
    brio_status status = BRIO_OK;
    *w = (worker){.pass = own,
                  .begin = brio_part(own->count, i, threads),
                  .end = brio_part(own->count, i + 1, threads),
                  .status = BRIO_ERR_INTERNAL /* until it has worked */};
    BRIO_TRY(brio_zone_new(ctx, own->store->rank, own->shift, own->segments, own->taken, &w->zone));
    BRIO_TRY(brio_inserter_new(own->store, &w->inserter));
    w->inserter->zone = &w->zone;
    w->inserter->long_walks = main->long_walks;
    w->inserter->done = main->done;
    w->inserter->reports = i == 0;
    w->placed = place_worker(w);
done:
    return status;
}

/* Frees what a worker owns; NULL pointers inside are accepted. */
static void worker_free(worker *w, brio_context *ctx) {
    brio_inserter_free(w->inserter);
    brio_zone_free(ctx, &w->zone);
    brio_release(ctx, w->deferred);
    *w = (worker){0};
}

/* Gives the main inserter the slots that the worker has left, and what it counted. */
static brio_status leave_pass(worker *w) {
    brio_inserter *ins = w->inserter, *main = w->pass->main;
    brio_store *store = w->pass->store;
    BRIO_FORWARD(brio_inserter_return_stretch(ins));
    BRIO_FORWARD(BRIO_RESERVE(store->ctx, main->unused, main->unused_capacity, main->num_unused + ins->num_unused));
    if (ins->num_unused) memcpy(main->unused + main->num_unused, ins->unused, ins->num_unused * sizeof *ins->unused);
    assert(main->num_unused + ins->num_unused <= main->unused_capacity); /* N4 */
    main->num_unused += ins->num_unused;
    ins->num_unused = 0;
    main->stats.created += ins->stats.created;
    main->stats.destroyed += ins->stats.destroyed;
    main->stats.insphere_calls += ins->stats.insphere_calls;
    main->stats.deferred += ins->stats.deferred;
    main->stats.locate_seconds += ins->stats.locate_seconds;
    main->walk.steps += ins->walk.steps;
    main->filter.unsettled += ins->filter.unsettled;
    /* once a thread has left its zone, others may destroy the tetrahedron where it stopped; that of the last is left */
    if (ins->stats.created && store->state[ins->walk.start] == TET_PLAIN) main->walk.start = ins->walk.start;
    main->done = fmax(main->done, ins->done);
    return BRIO_OK;
}

/* --- passes --- */

/* Divides the curve into segments so that each has some vertices already. */
static brio_status divide_curve(pass *own, size_t inserted) {
    brio_context *ctx = own->store->ctx;
    size_t points = own->store->num_points,
           most = inserted / SEGMENT < MOST_SEGMENTS ? inserted / SEGMENT : MOST_SEGMENTS;
    own->shift = 0;
    while (points >> own->shift > most) own->shift++;
    assert(own->shift < 32);
    own->segments = (points >> own->shift) + 1;
    brio_release(ctx, own->taken);
    return BRIO_ALLOC_ZERO(ctx, own->taken, own->segments);
}

/* Makes room for the slots of a pass: as many a point as up to now, and some more. */
static brio_status reserve_slots(pass *own, size_t inserted, int threads) {
    brio_store *store = own->store;
    assert(inserted > 0 && store->t.count <= store->max_tetrahedra && own->main->num_unused <= store->t.count);
    double each = (double)(store->t.count - own->main->num_unused) / (double)inserted;
    size_t more = (size_t)(1.04 * each * (double)own->count) + (size_t)threads * 2 * BRIO_SLOT_STRETCH;
    size_t room = store->max_tetrahedra - store->t.count;
    return brio_store_reserve(store, more < room ? more : room);
}

#ifndef NDEBUG
/* Returns whether the inserter that works alone owns each slot without a tetrahedron (I5, I6, N4), and starts at a
 * tetrahedron (N1). The slots that are handed out after a pass all have a state. */
static bool slots_are_accounted_for(const brio_inserter *ins) {
    const brio_store *s = ins->store;
    size_t unused = 0;
    if (ins->next_slot != ins->end_slot || s->state[ins->walk.start] != TET_PLAIN) return false;
    for (size_t slot = 0; slot < s->t.count; slot++) {
        if (s->state[slot] != TET_PLAIN && s->state[slot] != TET_UNUSED) return false;
        unused += s->state[slot] == TET_UNUSED;
    }
    for (size_t i = 0; i < ins->num_unused; i++)
        if (s->state[ins->unused[i]] != TET_UNUSED) return false;
    return unused == ins->num_unused;
}
#endif

/* Runs one pass over the records. The list of records becomes that of the deferred ones. */
static brio_status run_pass(pass *own, worker *workers, int threads) {
    brio_context *ctx = own->store->ctx;
    brio_status status = BRIO_OK;
    uint32_t *left = NULL;
    size_t num_left = 0;
    for (int i = 0; i < threads; i++) BRIO_TRY(worker_new(own, i, threads, &workers[i]));
    own->running = threads;
    brio_run(ctx, threads, work_as_member, workers);
    for (int i = 0; i < threads; i++) {
        BRIO_TRY(workers[i].status);
        BRIO_TRY(leave_pass(&workers[i]));
        num_left += workers[i].num_deferred;
    }
    own->main->cavity.num_created = 0; /* its last star may be gone (N2) */
    assert(slots_are_accounted_for(own->main) && own->running == 0);
    BRIO_TRY(BRIO_ALLOC(ctx, left, num_left));
    brio_release(ctx, own->list);
    own->list = left;
    own->count = 0;
    for (int i = 0; i < threads; i++) {
        const worker *w = &workers[i];
        if (w->num_deferred) memcpy(left + own->count, w->deferred, w->num_deferred * sizeof *left);
        own->count += w->num_deferred;
    }
done:
    for (int i = 0; i < threads; i++) worker_free(&workers[i], ctx);
    return status;
}

static int useful_threads(size_t count, size_t inserted, int most) {
    size_t threads = count / LEAST < inserted / CROWD ? count / LEAST : inserted / CROWD;
    return threads < (size_t)most ? (int)threads : most;
}

/* Inserts what the passes have left, by the main inserter alone. */
static brio_status insert_rest(pass *own, double done) {
    brio_inserter *ins = own->main;
    for (size_t i = 0; i < own->count; i++) {
        brio_insertion outcome;
        BRIO_FORWARD(brio_insert(ins, record_of(own, i), &outcome));
        assert(outcome != BRIO_DEFERRED);
        if (is_report_due(ins)) BRIO_FORWARD(brio_inserter_report(ins, done));
    }
    ins->stats.serial += own->count;
    return BRIO_OK;
}

brio_status brio_insert_parallel(brio_inserter *ins, size_t begin, size_t end) {
    brio_context *ctx = ins->store->ctx;
    brio_status status = BRIO_OK;
    pass own = {.main = ins, .store = ins->store, .first = (uint32_t)begin, .count = end - begin};
    int most = brio_threads(ctx, own.count, LEAST);
    worker *workers = NULL;
    assert(ins->locator == &brio_strategy_walk); /* workers walk, and keep no tables of other strategies up to date */
    assert(ins->store->rank && !ins->zone && begin <= end && end <= ins->store->num_points);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, workers, (size_t)most));
    for (int n = 0; n < PASSES; n++) {
        size_t count = own.count, inserted = end - count;
        int threads = useful_threads(count, inserted, most);
        if (threads < 2) break;
        BRIO_TRY(reserve_slots(&own, inserted, threads));
        BRIO_TRY(divide_curve(&own, inserted));
        BRIO_TRY(run_pass(&own, workers, threads));
        if (own.count > count / 2) break;
    }
    BRIO_TRY(insert_rest(&own, (double)end / (double)ins->store->num_points));
done:
    brio_release(ctx, workers);
    brio_release(ctx, own.list);
    brio_release(ctx, own.taken);
    return status;
}
