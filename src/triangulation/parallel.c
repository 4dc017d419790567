/* Parallel insertion: each thread holds the part of the points where it works.
 *
 * A curve through the points is divided into segments, many more than threads. Each thread inserts a part of the points
 * that follow the curve. It walks through and destroys only tetrahedra all of whose finite vertices are in segments that
 * it holds, its zone: it takes a segment when it first meets a vertex there, and gives it back when it has moved on. A
 * point whose walk or cavity meets a segment of another thread is deferred, since that thread is at work there now;
 * later it will not be. The tetrahedra round a cavity share three vertices with it, so no other thread can destroy them,
 * and what is read of them does not change: their mates are written only through the facet that both share. So threads
 * never wait for each other, and share nothing but the segments' marks and the count of slots, taken in large stretches.
 * What is left when a thread has tried all its points again goes into another pass, and at the end to one thread.
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
#include "base/memory.h"
#include "base/team.h"
#include "triangulation/kernel.h"
#include <math.h>
#include <string.h>
#include <time.h>

enum {
    STRETCH = 4096, /* slots taken at once */
    LEAST = 512,    /* points to insert that are worth a thread */
    CROWD = 256,    /* points in all that are worth a thread */
    PASSES = 4,     /* then one thread goes on */
    RETRIES = 4,    /* of a thread's deferred points in a pass */
    STARTS = 32,    /* places along a thread's part where it may begin */
    SEGMENT = 4,    /* vertices in a segment when a pass begins */
    MOST_SEGMENTS = 1 << 16
};

/* What the threads of a pass share. */
typedef struct brio_pass {
    brio_kernel *main;
    uint32_t first; /* the records to insert, along the curve: from `first` on, or those listed */
    uint32_t *list;
    size_t count;
    int shift; /* of ranks to segments */
    size_t segments;
    uint8_t *taken; /* of each segment */
    size_t next_slot, last_slot;
    int stop;    /* some thread failed; only hastens the others' end */
    int running; /* threads at work */
} brio_pass;

/* One thread's work in a pass. */
typedef struct {
    brio_kernel kernel;
    brio_zone zone;
    size_t begin, end; /* of the records to insert */
    bool placed;       /* it has a tetrahedron to start from */
    uint32_t *deferred;
    size_t num_deferred, deferred_capacity;
    brio_status status;
} worker;

static inline uint32_t record_of(const brio_pass *pass, size_t i) {
    return pass->list ? pass->list[i] : pass->first + (uint32_t)i;
}

/* --- slots --- */

/* What is left of a stretch becomes unused slots. */
static brio_status give_back_stretch(brio_kernel *k) {
    size_t left = k->capacity - k->t.count;
    brio_status status = BRIO_RESERVE(k->ctx, k->unused, k->unused_capacity, k->num_unused + left);
    if (status != BRIO_OK) return status;
    for (; k->t.count < k->capacity; k->t.count++) {
        k->state[k->t.count] = TET_UNUSED;
        k->unused[k->num_unused++] = (uint32_t)k->t.count;
    }
    return BRIO_OK;
}

brio_status brio_pass_reserve(brio_kernel *k, size_t more) {
    brio_pass *pass = k->pass;
    size_t size = more > STRETCH ? more : STRETCH, begin;
    brio_status status = give_back_stretch(k);
    if (status != BRIO_OK) return status;
    begin = __atomic_load_n(&pass->next_slot, __ATOMIC_RELAXED);
    do { /* taken only when it fits: giving back what did not could give away another thread's slots */
        if (begin + size > pass->last_slot) return BRIO_DEFERRED;
    } while (
        !__atomic_compare_exchange_n(&pass->next_slot, &begin, begin + size, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
    k->t.count = begin;
    k->capacity = begin + size;
    return BRIO_OK;
}

/* --- one thread --- */

/* Inserts a record, or BRIO_DEFERRED. Where the next walk starts stays in the zone. */
static brio_status insert_in_zone(brio_kernel *k, uint32_t p) {
    brio_zone *zone = k->t.zone;
    if (!brio_zone_has(zone, p)) return BRIO_DEFERRED;
    uint64_t created = k->stats.created;
    brio_status status = brio_kernel_insert(k, p);
    brio_owns(&k->t, k->walk.start);
    if (brio_zone_tidy(zone) && k->stats.created == created)
        k->cavity.num_created = 0; /* the last star is no longer held */
    return status;
}

static brio_status defer(worker *w, uint32_t p) {
    brio_status status = BRIO_RESERVE(w->kernel.ctx, w->deferred, w->deferred_capacity, w->num_deferred + 1);
    if (status == BRIO_OK) w->deferred[w->num_deferred++] = p;
    return status;
}

static brio_status try_point(worker *w, uint32_t p) {
    brio_status status = w->placed ? insert_in_zone(&w->kernel, p) : BRIO_DEFERRED;
    return status == BRIO_DEFERRED ? defer(w, p) : status;
}

/* Progress of a thread stands for that of all. */
static brio_status report(worker *w, size_t i) {
    const brio_pass *pass = w->kernel.pass;
    double done = (double)pass->first + (double)(i - w->begin) / (double)(w->end - w->begin) * (double)pass->count;
    return brio_kernel_report(&w->kernel, done / (double)w->kernel.num_points);
}

/* Once more what was deferred. */
static brio_status try_again(worker *w) {
    brio_status status = BRIO_OK;
    size_t count = w->num_deferred;
    w->num_deferred = 0;
    for (size_t i = 0; i < count; i++) {
        if (__atomic_load_n(&w->kernel.pass->stop, __ATOMIC_RELAXED)) break;
        BRIO_TRY(try_point(w, w->deferred[i]));
        if (brio_kernel_work(&w->kernel) >= w->kernel.report_at) BRIO_TRY(report(w, w->end));
    }
done:
    return status;
}

/* The calling thread, done with its part, reports progress until the others are done with theirs. It sleeps for a share
 * of the time that it has waited, so that it is late by no more than that share. */
static brio_status wait_for_others(worker *w) {
    const double SHARE = 1.0 / 16, LEAST_SLEEP = 2e-5, MOST_SLEEP = 1e-2, BETWEEN = 0.05;
    brio_pass *pass = w->kernel.pass;
    brio_status status = BRIO_OK;
    double start = brio_seconds(), told = start, now = start;
    while (__atomic_load_n(&pass->running, __ATOMIC_ACQUIRE) > 0) {
        double sleep = fmin(fmax(SHARE * (now - start), LEAST_SLEEP), MOST_SLEEP);
        nanosleep(&(struct timespec){0, (long)(1e9 * sleep)}, NULL);
        now = brio_seconds();
        if (now - told < BETWEEN) continue;
        told = now;
        BRIO_TRY(report(w, w->end));
    }
done:
    return status;
}

/* A failed insertion may have left its cavity half filled: then the thread's segments stay taken. */
static brio_status work(worker *w, bool reports) {
    brio_pass *pass = w->kernel.pass;
    brio_status status = BRIO_OK;
    w->kernel.reports = reports;
    __atomic_add_fetch(&pass->running, 1, __ATOMIC_RELAXED);
    for (size_t i = w->begin; i < w->end && !__atomic_load_n(&pass->stop, __ATOMIC_RELAXED); i++) {
        BRIO_TRY(try_point(w, record_of(pass, i)));
        if (brio_kernel_work(&w->kernel) >= w->kernel.report_at) BRIO_TRY(report(w, i));
    }
    w->kernel.stats.deferred = w->num_deferred;
    for (int i = 0; i < RETRIES && w->num_deferred && w->placed; i++) BRIO_TRY(try_again(w));
done:
    if (status == BRIO_OK) brio_zone_leave(&w->zone);
    __atomic_sub_fetch(&pass->running, 1, __ATOMIC_RELEASE);
    if (status == BRIO_OK && reports && w->kernel.ctx->progress) status = wait_for_others(w);
    if (status != BRIO_OK) __atomic_store_n(&pass->stop, 1, __ATOMIC_RELAXED);
    return status;
}

/* --- workers --- */

/* A kernel with the main one's arrays and its own workspace. */
static brio_status join_pass(worker *w, brio_pass *pass) {
    brio_kernel *k = &w->kernel, *main = pass->main;
    brio_cavity cavity = k->cavity;
    brio_star star = k->star;
    uint32_t *unused = k->unused;
    size_t unused_capacity = k->unused_capacity;
    *k = *main;
    k->pass = pass;
    k->t.count = k->capacity = 0;
    k->unused = unused, k->unused_capacity = unused_capacity, k->num_unused = 0;
    k->star = star;
    k->cavity = cavity;
    k->cavity.local = main->cavity.local;
    k->cavity.num_created = 0;
    k->stats = (brio_delaunay_stats){0};
    k->filter.unsettled = k->walk.steps = 0;
    k->report_at = 0;
    if (k->cavity.table) return BRIO_OK;
    brio_status status = BRIO_ALLOC(k->ctx, k->cavity.table, BRIO_TABLE);
    return status == BRIO_OK ? brio_cavity_reserve(k->ctx, &k->cavity, 64) : status;
}

/* Gives the main kernel what the thread has left and counted. */
static brio_status leave_pass(worker *w, brio_pass *pass) {
    brio_kernel *k = &w->kernel, *main = pass->main;
    brio_status status = BRIO_OK;
    BRIO_TRY(give_back_stretch(k));
    BRIO_TRY(BRIO_RESERVE(k->ctx, main->unused, main->unused_capacity, main->num_unused + k->num_unused));
    if (k->num_unused) memcpy(main->unused + main->num_unused, k->unused, k->num_unused * sizeof *k->unused);
    main->num_unused += k->num_unused;
    main->stats.created += k->stats.created;
    main->stats.destroyed += k->stats.destroyed;
    main->stats.insphere_calls += k->stats.insphere_calls;
    main->stats.deferred += k->stats.deferred;
    main->stats.locate_seconds += k->stats.locate_seconds;
    main->walk.steps += k->walk.steps;
    main->filter.unsettled += k->filter.unsettled;
    /* once a thread has left its zone, others may destroy the tetrahedron where it stopped; that of the last is left */
    if (k->stats.created && main->state[k->walk.start] == TET_PLAIN) main->walk.start = k->walk.start;
    main->done = fmax(main->done, k->done);
done:
    return status;
}

static void worker_free(worker *w) {
    w->kernel.cavity.local = NULL; /* the main kernel's */
    brio_cavity_free(w->kernel.ctx, &w->kernel.cavity);
    brio_release(w->kernel.ctx, w->kernel.star.tet);
    brio_release(w->kernel.ctx, w->kernel.unused);
    brio_release(w->kernel.ctx, w->deferred);
    brio_zone_free(w->kernel.ctx, &w->zone);
}

/* --- passes --- */

/* Finds a tetrahedron along the worker's part that it can hold; whether there is one. */
static bool place_worker(worker *w, brio_pass *pass) {
    brio_kernel *k = &w->kernel, *main = pass->main;
    size_t n = w->end - w->begin;
    for (size_t i = 0; i < STARTS && n; i++) {
        const double *p = main->record[record_of(pass, w->begin + i * n / STARTS)];
        k->walk.start = main->walk.start = main->engine->walk(&main->t, &main->filter, &main->walk, p, UINT64_MAX);
        if (brio_owns(&k->t, k->walk.start)) return true;
        brio_zone_leave(&w->zone);
    }
    return false;
}

/* Segments of the curve so that each has some vertices already. */
static brio_status divide_curve(brio_pass *pass, size_t inserted) {
    size_t points = pass->main->num_points,
           most = inserted / SEGMENT < MOST_SEGMENTS ? inserted / SEGMENT : MOST_SEGMENTS;
    pass->shift = 0;
    while (points >> pass->shift > most) pass->shift++;
    pass->segments = (points >> pass->shift) + 1;
    brio_release(pass->main->ctx, pass->taken);
    return BRIO_ALLOC_ZERO(pass->main->ctx, pass->taken, pass->segments);
}

static brio_status start_pass(brio_pass *pass, worker *workers, int threads) {
    brio_status status = BRIO_OK;
    for (int i = 0; i < threads; i++) {
        worker *w = &workers[i];
        w->begin = brio_part(pass->count, i, threads);
        w->end = brio_part(pass->count, i + 1, threads);
        w->num_deferred = 0;
        BRIO_TRY(join_pass(w, pass));
        brio_zone_free(pass->main->ctx, &w->zone);
        BRIO_TRY(brio_zone_new(pass->main->ctx, pass->main->rank, pass->shift, pass->segments, pass->taken, &w->zone));
        w->kernel.t.zone = &w->zone;
        w->placed = place_worker(w, pass);
    }
done:
    return status;
}

/* Slots for a pass: as many a point as up to now, and some more. */
static brio_status reserve_slots(brio_pass *pass, size_t inserted, int threads) {
    brio_kernel *main = pass->main;
    double each = (double)(main->t.count - main->num_unused) / (double)inserted;
    size_t more = (size_t)(1.04 * each * (double)pass->count) + (size_t)threads * 2 * STRETCH, room;
    room = main->max_tetrahedra - main->t.count;
    brio_status status = brio_kernel_reserve(main, more < room ? more : room);
    pass->next_slot = main->t.count;
    pass->last_slot = main->capacity;
    return status;
}

static void work_as_member(void *user, const brio_member *m) {
    worker *w = (worker *)user + m->thread;
    w->status = work(w, m->thread == 0);
}

/* One pass over the records; afterwards the deferred ones are in *left. */
static brio_status run_pass(brio_pass *pass, worker *workers, int threads, uint32_t **left, size_t *num_left) {
    brio_status status = BRIO_OK;
    brio_run(pass->main->ctx, threads, work_as_member, workers);
    size_t total = 0;
    for (int w = 0; w < threads; w++) {
        BRIO_TRY(workers[w].status);
        BRIO_TRY(leave_pass(&workers[w], pass));
        total += workers[w].num_deferred;
    }
    pass->main->t.count = pass->next_slot;
    pass->main->cavity.num_created = 0; /* its last star may be gone */
    BRIO_TRY(BRIO_ALLOC(pass->main->ctx, *left, total));
    *num_left = 0;
    for (int w = 0; w < threads; w++) {
        if (!workers[w].num_deferred) continue;
        memcpy(*left + *num_left, workers[w].deferred, workers[w].num_deferred * sizeof **left);
        *num_left += workers[w].num_deferred;
    }
done:
    return status;
}

static int useful_threads(size_t count, size_t inserted, int most) {
    size_t threads = count / LEAST < inserted / CROWD ? count / LEAST : inserted / CROWD;
    return threads < (size_t)most ? (int)threads : most;
}

brio_status brio_kernel_insert_parallel(brio_kernel *k, size_t begin, size_t end) {
    brio_status status = BRIO_OK;
    brio_pass pass = {.main = k, .first = (uint32_t)begin, .count = end - begin};
    int most = brio_threads(k->ctx, pass.count, LEAST);
    worker *workers = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, workers, (size_t)most));
    for (int w = 0; w < most; w++) workers[w].kernel.ctx = k->ctx;
    for (int n = 0; n < PASSES; n++) {
        size_t inserted = end - pass.count, num_left = 0;
        int threads = useful_threads(pass.count, inserted, most);
        uint32_t *left = NULL;
        if (threads < 2) break;
        BRIO_TRY(reserve_slots(&pass, inserted, threads));
        BRIO_TRY(divide_curve(&pass, inserted));
        BRIO_TRY(start_pass(&pass, workers, threads));
        BRIO_TRY(run_pass(&pass, workers, threads, &left, &num_left));
        bool stuck = num_left > pass.count / 2;
        brio_release(k->ctx, pass.list);
        pass.list = left;
        pass.count = num_left;
        if (stuck) break;
    }
    for (size_t i = 0; i < pass.count; i++) {
        BRIO_TRY(brio_kernel_insert(k, record_of(&pass, i)));
        if (brio_kernel_work(k) >= k->report_at) BRIO_TRY(brio_kernel_report(k, (double)end / (double)k->num_points));
    }
    k->stats.serial += pass.count;
done:
    for (int w = 0; workers && w < most; w++) worker_free(&workers[w]);
    brio_release(k->ctx, workers);
    brio_release(k->ctx, pass.list);
    brio_release(k->ctx, pass.taken);
    return status;
}
