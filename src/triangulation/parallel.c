/* Parallel insertion: each thread owns a part of the points.
 *
 * A pass divides the points into zones, one a thread. A thread walks through and destroys only tetrahedra all of whose
 * finite vertices are in its zone, and inserts its points in their order; a point whose walk or cavity would leave the
 * zone is deferred. The tetrahedra round a cavity share three vertices with it, so no other thread can destroy them,
 * and what it reads there does not change: their mates are written only through the facet that both share. So threads
 * need no locks and share nothing but the count of slots, taken in large stretches. The first pass divides the curve
 * that the points follow. Deferred points lie along the borders of its zones; each later pass takes another curve,
 * which cuts space elsewhere. What is left at the end is inserted by one thread.
 *
 * The result is the one triangulation that exact predicates and the symbolic perturbation determine, whatever was
 * deferred.
 *
 * Based on: Marot, Pellerin, Remacle. One machine, one minute, three billion tetrahedra. IJNME 2019.
 * Differs from the paper: a walk that is blocked starts again from one of the hints that were located along the zone.
 */
#include "base/memory.h"
#include "base/parallel.h"
#include "base/sort.h"
#include "order/hilbert.h"
#include "triangulation/kernel.h"
#include <string.h>

enum {
    STRETCH = 4096, /* slots taken at once */
    LEAST = 512,    /* points to insert that are worth a thread */
    CROWD = 4096,   /* points in all that make a zone which is not all border */
    PASSES = 6,     /* then one thread goes on */
    HINTS = 32,     /* tetrahedra located along a zone before its pass */
    PROGRESS_EVERY = 4096
};

/* What the threads of a pass share. */
typedef struct brio_team {
    brio_kernel *main;
    uint32_t first; /* the records to insert: from `first` on, or those listed; zone by zone, along the curve in each */
    uint32_t *list;
    size_t count;
    size_t next_slot, last_slot;
    int stop; /* some thread failed */
} brio_team;

/* One thread's work in a pass. */
typedef struct {
    brio_kernel kernel;
    brio_zone zone;
    size_t begin, end; /* of the records to insert */
    uint32_t *deferred;
    size_t num_deferred, deferred_capacity;
    uint32_t hint[HINTS];
    brio_status status;
} worker;

static inline uint32_t record_of(const brio_team *team, size_t i) {
    return team->list ? team->list[i] : team->first + (uint32_t)i;
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

brio_status brio_team_reserve(brio_kernel *k, size_t more) {
    brio_team *team = k->team;
    size_t size = more > STRETCH ? more : STRETCH, begin;
    brio_status status = give_back_stretch(k);
    if (status != BRIO_OK) return status;
    begin = __atomic_load_n(&team->next_slot, __ATOMIC_RELAXED);
    do { /* taken only when it fits: giving back what did not could give away another thread's slots */
        if (begin + size > team->last_slot) return BRIO_DEFERRED;
    } while (
        !__atomic_compare_exchange_n(&team->next_slot, &begin, begin + size, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
    k->t.count = begin;
    k->capacity = begin + size;
    return BRIO_OK;
}

/* --- one thread --- */

/* Inserts a point; where its walk is blocked, once more from the hint of its part of the zone. */
static brio_status try_point(worker *w, size_t i) {
    brio_kernel *k = &w->kernel;
    uint32_t p = record_of(k->team, i);
    brio_status status = brio_kernel_insert(k, p);
    if (status == BRIO_DEFERRED && k->walk.blocked) {
        uint32_t hint = w->hint[(i - w->begin) * HINTS / (w->end - w->begin)];
        if (hint != BRIO_NO_TET && k->state[hint] != TET_UNUSED) {
            k->walk.start = hint;
            status = brio_kernel_insert(k, p);
        }
    }
    if (status != BRIO_DEFERRED) return status;
    status = BRIO_RESERVE(k->ctx, w->deferred, w->deferred_capacity, w->num_deferred + 1);
    if (status == BRIO_OK) w->deferred[w->num_deferred++] = p;
    return status;
}

/* Progress of a thread stands for that of all. */
static brio_status report(const worker *w, size_t i) {
    const brio_team *team = w->kernel.team;
    double done = (double)team->first + (double)(i - w->begin) / (double)(w->end - w->begin) * (double)team->count;
    return brio_progress(w->kernel.ctx, "insert", done / (double)w->kernel.num_points);
}

static brio_status work(worker *w, bool reports) {
    brio_team *team = w->kernel.team;
    brio_status status = BRIO_OK;
    w->num_deferred = 0;
    for (size_t i = w->begin; i < w->end && !__atomic_load_n(&team->stop, __ATOMIC_RELAXED); i++) {
        BRIO_TRY(try_point(w, i));
        if (reports && (i - w->begin) % PROGRESS_EVERY == 0) BRIO_TRY(report(w, i));
    }
done:
    if (status != BRIO_OK) __atomic_store_n(&team->stop, 1, __ATOMIC_RELAXED);
    return status;
}

/* --- teams --- */

/* A kernel with the main one's arrays and its own workspace. */
static brio_status join_team(worker *w, brio_team *team) {
    brio_kernel *k = &w->kernel, own = *k, *main = team->main;
    *k = *main;
    k->team = team;
    k->t.count = k->capacity = 0;
    k->unused = own.unused, k->unused_capacity = own.unused_capacity, k->num_unused = 0;
    k->star = own.star;
    k->cavity = own.cavity;
    k->cavity.local = main->cavity.local;
    k->cavity.num_created = 0;
    k->stats = (brio_stats){0};
    k->filter.unsettled = k->walk.steps = 0;
    if (k->cavity.table) return BRIO_OK;
    brio_status status = BRIO_ALLOC(k->ctx, k->cavity.table, BRIO_TABLE);
    return status == BRIO_OK ? brio_cavity_reserve(k->ctx, &k->cavity, 64) : status;
}

/* Gives the main kernel what the thread has left and counted. */
static brio_status leave_team(worker *w, brio_team *team) {
    brio_kernel *k = &w->kernel, *main = team->main;
    brio_status status = BRIO_OK;
    BRIO_TRY(give_back_stretch(k));
    BRIO_TRY(BRIO_RESERVE(k->ctx, main->unused, main->unused_capacity, main->num_unused + k->num_unused));
    if (k->num_unused) memcpy(main->unused + main->num_unused, k->unused, k->num_unused * sizeof *k->unused);
    main->num_unused += k->num_unused;
    main->stats.created += k->stats.created;
    main->stats.destroyed += k->stats.destroyed;
    main->stats.insphere_calls += k->stats.insphere_calls;
    main->stats.deferred += w->num_deferred;
    main->walk.steps += k->walk.steps;
    main->filter.unsettled += k->filter.unsettled;
    if (k->stats.created) main->walk.start = k->walk.start;
done:
    return status;
}

static void worker_free(worker *w) {
    w->kernel.cavity.local = NULL; /* the main kernel's */
    brio_cavity_free(w->kernel.ctx, &w->kernel.cavity);
    brio_release(w->kernel.ctx, w->kernel.star.tet);
    brio_release(w->kernel.ctx, w->kernel.unused);
    brio_release(w->kernel.ctx, w->deferred);
}

/* --- passes --- */

/* Locates tetrahedra along the worker's zone that are its own. */
static void place_hints(worker *w, brio_team *team) {
    brio_kernel *main = team->main;
    size_t n = w->end - w->begin;
    w->kernel.walk.start = BRIO_NO_TET;
    for (size_t h = 0; h < HINTS; h++) {
        const double *p = main->record[record_of(team, w->begin + h * n / HINTS)];
        uint32_t tet = main->engine->walk(&main->t, &main->filter, &main->walk, p, UINT64_MAX);
        bool own = brio_owns(&w->kernel.t, tet);
        main->walk.start = tet;
        w->hint[h] = own ? tet : BRIO_NO_TET;
        if (own && w->kernel.walk.start == BRIO_NO_TET) w->kernel.walk.start = tet;
    }
    if (w->kernel.walk.start == BRIO_NO_TET) w->kernel.walk.start = main->walk.start; /* blocked there at once */
}

/* Sorts the listed records along another curve; *key receives the keys of all records before `end`. */
static brio_status list_along(brio_team *team, size_t end, int variant, int threads, uint32_t **key) {
    brio_kernel *k = team->main;
    uint64_t *items = NULL, *spare = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(k->ctx, *key, end));
    BRIO_TRY(BRIO_ALLOC(k->ctx, items, team->count));
    BRIO_TRY(BRIO_ALLOC(k->ctx, spare, team->count));
    brio_hilbert_variant(*k->record, 4, end, variant, threads, *key);
    for (size_t i = 0; i < team->count; i++) items[i] = (uint64_t)(*key)[team->list[i]] << 32 | team->list[i];
    BRIO_TRY(brio_sort_items(k->ctx, items, spare, team->count, 30, threads));
    for (size_t i = 0; i < team->count; i++) team->list[i] = (uint32_t)items[i];
done:
    brio_release(k->ctx, items);
    brio_release(k->ctx, spare);
    return status;
}

/* Cuts the curve where it divides the records to insert into about equal parts, never between equal ranks. */
static void cut_curve(brio_team *team, worker *workers, int zones, const uint32_t *rank) {
    for (int z = 0; z < zones; z++) {
        worker *w = &workers[z];
        size_t at = team->count * (size_t)z / (size_t)zones;
        if (z && at < workers[z - 1].begin) at = workers[z - 1].begin;
        while (z && at > workers[z - 1].begin && rank[record_of(team, at)] == rank[record_of(team, at - 1)]) at--;
        w->begin = at;
        w->end = team->count;
        w->zone = (brio_zone){rank, z ? rank[record_of(team, at)] : 0, UINT32_MAX};
        w->zone.size -= w->zone.low;
        if (!z) continue;
        workers[z - 1].end = at;
        workers[z - 1].zone.size = w->zone.low - workers[z - 1].zone.low;
    }
}

static brio_status start_pass(brio_team *team, worker *workers, int zones, const uint32_t *rank) {
    brio_status status = BRIO_OK;
    cut_curve(team, workers, zones, rank);
    for (int z = 0; z < zones; z++) {
        BRIO_TRY(join_team(&workers[z], team));
        workers[z].kernel.t.zone = &workers[z].zone;
        if (workers[z].begin < workers[z].end) place_hints(&workers[z], team);
    }
done:
    return status;
}

/* Slots for a pass: as many a point as up to now, and some more. */
static brio_status reserve_slots(brio_team *team, size_t begin, int zones) {
    brio_kernel *main = team->main;
    double each = (double)(main->t.count - main->num_unused) / (double)begin;
    size_t more = (size_t)(1.04 * each * (double)team->count) + (size_t)zones * 2 * STRETCH, room;
    room = main->max_tetrahedra - main->t.count;
    brio_status status = brio_kernel_reserve(main, more < room ? more : room);
    team->next_slot = main->t.count;
    team->last_slot = main->capacity;
    return status;
}

/* One pass over the team's records; afterwards the deferred ones are in *left. */
static brio_status run_pass(brio_team *team, worker *workers, int zones, uint32_t **left, size_t *num_left) {
    brio_status status = BRIO_OK;
    BRIO_OMP(parallel for schedule(dynamic, 1) num_threads(zones))
    for (int z = 0; z < zones; z++) workers[z].status = work(&workers[z], brio_thread() == 0);
    size_t total = 0;
    for (int z = 0; z < zones; z++) {
        BRIO_TRY(workers[z].status);
        BRIO_TRY(leave_team(&workers[z], team));
        total += workers[z].num_deferred;
    }
    team->main->t.count = team->next_slot;
    team->main->cavity.num_created = 0; /* its last star may be gone */
    BRIO_TRY(BRIO_ALLOC(team->main->ctx, *left, total));
    *num_left = 0;
    for (int z = 0; z < zones; z++) {
        if (!workers[z].num_deferred) continue;
        memcpy(*left + *num_left, workers[z].deferred, workers[z].num_deferred * sizeof **left);
        *num_left += workers[z].num_deferred;
    }
done:
    return status;
}

/* Whether to insert that many points by threads saves more time than the keys of all points along another curve take.
 */
static bool pays(size_t count, size_t points, int threads) {
    enum { KEYS_AN_INSERTION = 60 };
    return count * KEYS_AN_INSERTION * (size_t)(threads - 1) > points;
}

static int useful_zones(size_t count, size_t points, int most) {
    size_t zones = count / LEAST < points / CROWD ? count / LEAST : points / CROWD;
    return zones < (size_t)most ? (int)zones : most;
}

brio_status brio_kernel_insert_parallel(brio_kernel *k, size_t begin, size_t end) {
    brio_status status = BRIO_OK;
    brio_team team = {.main = k, .first = (uint32_t)begin, .count = end - begin};
    int most = brio_context_threads(k->ctx);
    worker *workers = NULL;
    uint32_t *key = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, workers, (size_t)most));
    for (int w = 0; w < most; w++) workers[w].kernel.ctx = k->ctx;
    for (int pass = 0; pass < PASSES; pass++) {
        int zones = useful_zones(team.count, end, most);
        uint32_t *left = NULL;
        size_t num_left = 0;
        if (zones < 2 || (pass > 0 && !pays(team.count, end, most))) break;
        BRIO_TRY(reserve_slots(&team, begin, zones));
        if (pass > 0) BRIO_TRY(list_along(&team, end, pass, most, &key));
        BRIO_TRY(start_pass(&team, workers, zones, key ? key : k->rank));
        BRIO_TRY(run_pass(&team, workers, zones, &left, &num_left));
        bool stuck = num_left > team.count / 2;
        brio_release(k->ctx, key);
        key = NULL;
        brio_release(k->ctx, team.list);
        team.list = left;
        team.count = num_left;
        if (stuck) break;
    }
    for (size_t i = 0; i < team.count; i++) BRIO_TRY(brio_kernel_insert(k, record_of(&team, i)));
    k->stats.serial += team.count;
done:
    for (int w = 0; workers && w < most; w++) worker_free(&workers[w]);
    brio_release(k->ctx, workers);
    brio_release(k->ctx, key);
    brio_release(k->ctx, team.list);
    return status;
}
