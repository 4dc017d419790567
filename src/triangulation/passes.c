/* Passes and zones: each thread holds the part of the triangulation where it works.
 *
 * A curve through the points is divided into segments, many more than threads. Each thread does a part of the items,
 * which follow the curve. It walks through and destroys only tetrahedra all of whose finite vertices are in segments
 * that it holds, its zone: it takes a segment when it first meets a vertex there, and gives it back when it has moved
 * on. An item whose walk or hole meets a segment of another thread is deferred, since that thread is at work there
 * now; later it will not be. The tetrahedra round a hole share three vertices with it, so no other thread can destroy
 * them, and what is read of them does not change: their mates are written only through the facet that both share (P1 to
 * P4 in store.h, proved in docs/decisions/006-segments-held-by-threads.md). So threads never wait for each other, and
 * share nothing but the segments' marks. What is left when a thread has tried all its items again goes into another
 * pass, and at the end to one thread.
 *
 * Based on: Marot, Pellerin, Remacle. One machine, one minute, three billion tetrahedra. IJNME 2019, for the ownership
 *           by vertices; Batista, Millman, Pion, Singler. Parallel geometric algorithms for multi-core computers. CGTA
 *           2010, for giving up instead of waiting.
 * Differs from both: zones of the curve are not fixed for a pass but follow the thread, and locks are neither of
 * tetrahedra nor of vertices but of segments, kept from one change to the next.
 */
#include "triangulation/passes.h"
#include "base/memory.h"
#include "base/stress.h"
#include "base/team.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    CROWD = 256, /* vertices that are worth a thread */
    PASSES = 4,  /* then one thread goes on */
    RETRIES = 4, /* of a thread's deferred items in a pass */
    SEGMENT = 4, /* vertices in a segment when a pass begins */
    SEGMENTS_KEPT = 8,
    MOST_SEGMENTS = 1 << 16
};

/* One thread's work in a pass. Made by the calling thread before the pass, and read by it after the pass. */
typedef struct {
    brio_passes *passes;
    brio_pass_part part;
    brio_zone zone;
    void *hand;
    uint32_t *deferred, *alone;
    size_t num_deferred, deferred_capacity, first_deferred, num_alone, alone_capacity;
    brio_status status;
} worker;

/* --- zones --- */

brio_status brio_zone_new(brio_context *ctx, const uint32_t *rank, int shift, size_t segments, uint8_t *taken,
                          brio_zone *out) {
    assert(0 <= shift && shift < 32 && segments > 0);
    *out = (brio_zone){.rank = rank, .shift = shift, .taken = taken, .now = 1};
    brio_status status = BRIO_ALLOC_ZERO(ctx, out->held, segments);
    return status == BRIO_OK ? BRIO_ALLOC(ctx, out->segment, segments) : status;
}

void brio_zone_free(brio_context *ctx, brio_zone *zone) {
    brio_release(ctx, zone->held);
    brio_release(ctx, zone->segment);
    *zone = (brio_zone){0};
}

/* Synchronizes with the thread that gave the segment back: what that one wrote to tetrahedra with a vertex there is
 * seen. */
bool brio_zone_take(brio_zone *zone, uint32_t segment) {
    uint8_t *taken = &zone->taken[segment], none = 0;
    assert(zone->held[segment] == 0);
    brio_stress();
    if (__atomic_load_n(taken, __ATOMIC_RELAXED)) return false;
    if (!__atomic_compare_exchange_n(taken, &none, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED)) return false;
    zone->segment[zone->count++] = segment;
    return true;
}

static void give_back(brio_zone *zone, uint32_t segment) {
    assert(__atomic_load_n(&zone->taken[segment], __ATOMIC_RELAXED) == 1); /* only its holder gives it back */
    zone->held[segment] = 0;
    brio_stress();
    __atomic_store_n(&zone->taken[segment], 0, __ATOMIC_RELEASE);
}

bool brio_zone_tidy(brio_zone *zone) {
    assert(zone->now != 0);
    size_t kept = 0, count = zone->count;
    uint8_t now = zone->now++;
    if (zone->now == 0) zone->now = 1;
    if (count <= SEGMENTS_KEPT) return false;
    for (size_t i = 0; i < count; i++) {
        if (zone->held[zone->segment[i]] == now)
            zone->segment[kept++] = zone->segment[i];
        else
            give_back(zone, zone->segment[i]);
    }
    zone->count = kept;
    return kept < count;
}

void brio_zone_leave(brio_zone *zone) {
    while (zone->count) give_back(zone, zone->segment[--zone->count]);
}

/* --- one thread --- */

static brio_status put(brio_context *ctx, uint32_t **list, size_t *capacity, size_t *count, uint32_t item) {
    BRIO_FORWARD(BRIO_RESERVE(ctx, *list, *capacity, *count + 1));
    (*list)[(*count)++] = item;
    return BRIO_OK;
}

static brio_status try_item(worker *w, uint32_t item) {
    brio_context *ctx = w->passes->ctx;
    brio_attempt outcome = BRIO_TRY_LATER;
    BRIO_FORWARD(w->passes->work->attempt(w->hand, item, &outcome));
    if (outcome == BRIO_TRIED) return BRIO_OK;
    if (outcome == BRIO_TRY_ALONE) return put(ctx, &w->alone, &w->alone_capacity, &w->num_alone, item);
    return put(ctx, &w->deferred, &w->deferred_capacity, &w->num_deferred, item);
}

/* Reports progress: that of one thread stands for that of all. */
static brio_status report(worker *w, size_t i) {
    size_t begin = w->part.begin, end = w->part.end;
    assert(begin < end && i <= end);
    return w->passes->work->report(w->hand, (double)(i - begin) / (double)(end - begin));
}

static bool must_stop(const worker *w) {
    return __atomic_load_n(&w->passes->stop, __ATOMIC_RELAXED);
}

/* Tries the deferred items again. */
static brio_status try_again(worker *w) {
    size_t count = w->num_deferred;
    w->num_deferred = 0;
    for (size_t i = 0; i < count && !must_stop(w); i++) {
        BRIO_FORWARD(try_item(w, w->deferred[i]));
        if (w->passes->work->due(w->hand)) BRIO_FORWARD(report(w, w->part.end));
    }
    return BRIO_OK;
}

/* Reports progress, in the calling thread, from when it is done with its part until the other threads are. It sleeps
 * for a share of the time that it has waited, so that it is late by no more than that share. */
static brio_status wait_for_others(worker *w) {
    const double SHARE = 1.0 / 16, LEAST_SLEEP = 2e-5, MOST_SLEEP = 1e-2, BETWEEN = 0.05;
    double start = brio_seconds(), told = start, now = start;
    while (__atomic_load_n(&w->passes->running, __ATOMIC_ACQUIRE) > 0) {
        double sleep = fmin(fmax(SHARE * (now - start), LEAST_SLEEP), MOST_SLEEP);
        brio_sleep(sleep);
        now = brio_seconds();
        if (now - told < BETWEEN) continue;
        told = now;
        BRIO_FORWARD(report(w, w->part.end));
    }
    return BRIO_OK;
}

/* Does a thread's part of a pass. A failed attempt may have left a hole half filled: then the thread's segments stay
 * taken. */
static brio_status work(worker *w) {
    brio_passes *p = w->passes;
    brio_status status = BRIO_OK;
    for (size_t i = w->part.begin; i < w->part.end && !must_stop(w); i++) {
        BRIO_TRY(try_item(w, brio_pass_item(p, i)));
        if (p->work->due(w->hand)) BRIO_TRY(report(w, i));
    }
    w->first_deferred = w->num_deferred;
    for (int i = 0; i < RETRIES && w->num_deferred; i++) BRIO_TRY(try_again(w));
done:
    if (status == BRIO_OK) brio_zone_leave(&w->zone);
    __atomic_sub_fetch(&p->running, 1, __ATOMIC_RELEASE);
    if (status == BRIO_OK && w->part.thread == 0 && p->ctx->progress) status = wait_for_others(w);
    if (status != BRIO_OK) __atomic_store_n(&p->stop, 1, __ATOMIC_RELAXED);
    return status;
}

static void work_as_member(void *user, const brio_member *m) {
    worker *w = (worker *)user + m->thread;
    w->status = work(w);
}

/* Makes the worker of thread i and places it in its zone. */
static brio_status worker_new(brio_passes *p, int i, int threads, worker *w) {
    *w = (worker){.passes = p,
                  .part = {p, brio_part(p->count, i, threads), brio_part(p->count, i + 1, threads), i, threads},
                  .status = BRIO_ERR_INTERNAL /* until it has worked */};
    BRIO_FORWARD(brio_zone_new(p->ctx, p->rank, p->shift, p->segments, p->taken, &w->zone));
    return p->work->enter(p->user, &w->zone, &w->part, &w->hand);
}

/* Frees what a worker owns; NULL pointers inside are accepted. */
static void worker_free(worker *w, const brio_passes *p) {
    if (w->hand) p->work->free(w->hand);
    brio_zone_free(p->ctx, &w->zone);
    brio_release(p->ctx, w->deferred);
    brio_release(p->ctx, w->alone);
    *w = (worker){0};
}

/* --- passes --- */

/* Divides the curve into segments so that each has some vertices already. */
static brio_status divide_curve(brio_passes *p, size_t vertices) {
    size_t most = vertices / SEGMENT < MOST_SEGMENTS ? vertices / SEGMENT : MOST_SEGMENTS;
    p->shift = 0;
    while (p->ranks >> p->shift > most) p->shift++;
    assert(p->shift < 32);
    p->segments = (p->ranks >> p->shift) + 1;
    brio_release(p->ctx, p->taken);
    return BRIO_ALLOC_ZERO(p->ctx, p->taken, p->segments);
}

/* Lists what the workers have left: for another pass, and for one thread alone. */
static brio_status gather(brio_passes *p, const worker *workers, int threads) {
    size_t left = 0;
    for (int i = 0; i < threads; i++) left += workers[i].num_deferred;
    brio_release(p->ctx, p->list);
    p->count = 0;
    BRIO_FORWARD(BRIO_ALLOC(p->ctx, p->list, left));
    for (int i = 0; i < threads; i++) {
        const worker *w = &workers[i];
        if (w->num_deferred) memcpy(p->list + p->count, w->deferred, w->num_deferred * sizeof *p->list);
        p->count += w->num_deferred;
        BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->alone, p->alone_capacity, p->num_alone + w->num_alone));
        if (w->num_alone) memcpy(p->alone + p->num_alone, w->alone, w->num_alone * sizeof *p->alone);
        p->num_alone += w->num_alone;
    }
    return BRIO_OK;
}

/* Runs one pass over the items. The list of items becomes that of the deferred ones. What hands leave is taken over
 * after failures, too. */
static brio_status run_pass(brio_passes *p, worker *workers, int threads) {
    brio_status status = BRIO_OK;
    int made = 0;
    for (; made < threads && status == BRIO_OK; made++) status = worker_new(p, made, threads, &workers[made]);
    if (status == BRIO_OK) {
        p->running = (size_t)threads;
        brio_run(p->ctx, threads, work_as_member, workers);
        assert(p->running == 0);
    }
    for (int i = 0; i < made; i++) {
        worker *w = &workers[i];
        if (status == BRIO_OK) status = w->status;
        brio_status left = w->hand ? p->work->leave(p->user, w->hand, w->first_deferred) : BRIO_OK;
        if (status == BRIO_OK) status = left;
    }
    if (status == BRIO_OK && p->work->passed) p->work->passed(p->user);
    if (status == BRIO_OK) status = gather(p, workers, threads);
    for (int i = 0; i < made; i++) worker_free(&workers[i], p);
    return status;
}

static int useful_threads(const brio_passes *p, size_t vertices, int most) {
    size_t least = p->work->least;
    size_t threads = p->count / least < vertices / CROWD ? p->count / least : vertices / CROWD;
    return threads < (size_t)most ? (int)threads : most;
}

brio_status brio_passes_run(brio_passes *p, int most) {
    brio_status status = BRIO_OK;
    worker *workers = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(p->ctx, workers, (size_t)most));
    for (int n = 0; n < PASSES; n++) {
        size_t count = p->count, vertices = p->vertices - count;
        int threads = useful_threads(p, vertices, most);
        if (threads < 2) break;
        BRIO_TRY(p->work->prepare(p->user, count, threads));
        BRIO_TRY(divide_curve(p, vertices));
        BRIO_TRY(run_pass(p, workers, threads));
        if (p->count > count / 2) break;
    }
    if (p->num_alone == 0) goto done;
    BRIO_TRY(BRIO_RESIZE(p->ctx, p->list, p->count + p->num_alone)); /* a pass has made the list */
    memcpy(p->list + p->count, p->alone, p->num_alone * sizeof *p->list);
    p->count += p->num_alone;
    p->num_alone = 0;
done:
    brio_release(p->ctx, workers);
    return status;
}

void brio_passes_free(brio_passes *p) {
    brio_release(p->ctx, p->list);
    brio_release(p->ctx, p->alone);
    brio_release(p->ctx, p->taken);
}
