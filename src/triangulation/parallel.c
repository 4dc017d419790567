/* Parallel insertion, in passes (passes.h): each thread has an inserter with a zone.
 *
 * Threads share the store by P1 to P4 (store.h), and the count of slots, taken in large stretches. The result is the
 * one triangulation that exact predicates and the symbolic perturbation determine, whatever was deferred. */
#include "base/memory.h"
#include "base/team.h"
#include "triangulation/insert.h"
#include "triangulation/passes.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    LEAST = 512, /* points to insert that are worth a thread */
    STARTS = 32  /* places along a thread's part where it may begin */
};

/* Insertion in passes. */
typedef struct {
    brio_inserter *main; /* the one that works alone between passes, and rests in them */
    brio_store *store;
    uint32_t first; /* the records to insert, along the curve: those of the turns from `first` on */
    size_t count;   /* of the records that are not in when the pass begins */
    brio_passes passes;
} insertion;

/* A thread's hand. */
typedef struct {
    const insertion *own;
    brio_inserter *inserter;
    bool placed; /* it has a tetrahedron to start from */
} hand;

static uint32_t record_of(const void *user, size_t i) {
    const insertion *own = user;
    return brio_record_at(own->store, own->first + i);
}

/* --- one thread --- */

/* Tries to insert a record. Where the next walk starts stays in the zone (N1). */
static brio_status try_point(void *user, uint32_t p, brio_attempt *tried) {
    hand *h = user;
    brio_inserter *ins = h->inserter;
    brio_insertion outcome = BRIO_DEFERRED;
    *tried = BRIO_TRY_LATER;
    if (!h->placed || !brio_zone_has(ins->zone, p)) return BRIO_OK;
    assert(brio_zone_holds(ins->zone, p)); /* P4 */
    brio_status status = brio_insert(ins, p, &outcome);
    if (status != BRIO_OK) return status; /* the store is good for nothing but to be freed */
    brio_owns(&ins->store->t, ins->zone, ins->walk.start);
    if (brio_zone_tidy(ins->zone) && outcome != BRIO_INSERTED)
        ins->cavity.num_created = 0; /* the last star is no longer held (N2) */
    if (outcome != BRIO_DEFERRED) *tried = BRIO_TRIED;
    return BRIO_OK;
}

static brio_status report(void *user, double share) {
    const hand *h = user;
    const insertion *own = h->own;
    double done = (double)own->first + share * (double)own->count;
    return brio_inserter_report(h->inserter, done / (double)own->store->num_points);
}

static bool is_report_due(const brio_inserter *ins) {
    return brio_inserter_work(ins) >= ins->report_at;
}

static bool is_due(const void *user) {
    return is_report_due(((const hand *)user)->inserter);
}

/* --- hands --- */

/* Finds a tetrahedron along the part that the hand can hold. Returns whether there is one. */
static bool place_hand(hand *h, const brio_pass_part *part) {
    brio_inserter *ins = h->inserter, *main = h->own->main;
    const brio_store *store = h->own->store;
    size_t n = part->end - part->begin;
    for (size_t i = 0; i < STARTS && n; i++) {
        const double *p = store->record[brio_pass_item(part->passes, part->begin + i * n / STARTS)];
        ins->walk.start = main->walk.start = brio_inserter_walk(main, p, UINT64_MAX);
        if (brio_owns(&store->t, ins->zone, ins->walk.start)) return true;
        brio_zone_leave(ins->zone);
    }
    return false;
}

static brio_status hand_new(void *user, brio_zone *zone, const brio_pass_part *part, void **out) {
    const insertion *own = user;
    const brio_inserter *main = own->main;
    hand *h;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(own->store->ctx, h, 1));
    *out = h;
    h->own = own;
    BRIO_FORWARD(brio_inserter_new(own->store, &h->inserter));
    h->inserter->zone = zone;
    h->inserter->long_walks = main->long_walks;
    h->inserter->done = main->done;
    h->inserter->reports = part->thread == 0;
    h->placed = place_hand(h, part);
    return BRIO_OK;
}

static void hand_free(void *user) {
    hand *h = user;
    brio_context *ctx = h->own->store->ctx;
    brio_inserter_free(h->inserter);
    brio_release(ctx, h);
}

/* Gives the main inserter the slots that a hand has left, and what it counted. */
static brio_status leave_pass(void *user, void *left, size_t deferred) {
    const insertion *own = user;
    brio_inserter *ins = ((hand *)left)->inserter, *main = own->main;
    brio_store *store = own->store;
    if (!ins) return BRIO_OK; /* it could not be made */
    BRIO_FORWARD(brio_inserter_return_stretch(ins));
    BRIO_FORWARD(BRIO_RESERVE(store->ctx, main->unused, main->unused_capacity, main->num_unused + ins->num_unused));
    if (ins->num_unused) memcpy(main->unused + main->num_unused, ins->unused, ins->num_unused * sizeof *ins->unused);
    assert(main->num_unused + ins->num_unused <= main->unused_capacity); /* N4 */
    main->num_unused += ins->num_unused;
    ins->num_unused = 0;
    main->stats.created += ins->stats.created;
    main->stats.destroyed += ins->stats.destroyed;
    main->stats.insphere_calls += ins->stats.insphere_calls;
    main->stats.deferred += deferred;
    main->stats.locate_seconds += ins->stats.locate_seconds;
    main->walk.steps += ins->walk.steps;
    main->filter.unsettled += ins->filter.unsettled;
    /* once a thread has left its zone, others may destroy the tetrahedron where it stopped; that of the last is left */
    if (ins->stats.created && store->state[ins->walk.start] == TET_PLAIN) main->walk.start = ins->walk.start;
    main->done = fmax(main->done, ins->done);
    return BRIO_OK;
}

/* --- passes --- */

/* Makes room for the slots of a pass: as many a point as up to now, and some more. */
static brio_status reserve_slots(void *user, size_t count, int threads) {
    insertion *own = user;
    brio_store *store = own->store;
    size_t inserted = own->passes.vertices - count;
    own->count = count;
    assert(inserted > 0 && store->t.count <= store->max_tetrahedra && own->main->num_unused <= store->t.count);
    double each = (double)(store->t.count - own->main->num_unused) / (double)inserted;
    size_t more = (size_t)(1.04 * each * (double)count) + (size_t)threads * 2 * BRIO_SLOT_STRETCH;
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

static void end_pass(void *user) {
    const insertion *own = user;
    own->main->cavity.num_created = 0; /* its last star may be gone (N2) */
    assert(slots_are_accounted_for(own->main));
}

/* Inserts what the passes have left, by the main inserter alone. */
static brio_status insert_rest(const insertion *own, double done) {
    brio_inserter *ins = own->main;
    size_t count = own->passes.count;
    for (size_t i = 0; i < count; i++) {
        brio_insertion outcome;
        BRIO_FORWARD(brio_insert(ins, brio_pass_item(&own->passes, i), &outcome));
        assert(outcome != BRIO_DEFERRED);
        if (is_report_due(ins)) BRIO_FORWARD(brio_inserter_report(ins, done));
    }
    ins->stats.serial += count;
    return BRIO_OK;
}

static const brio_pass_work INSERTION = {.prepare = reserve_slots,
                                         .enter = hand_new,
                                         .attempt = try_point,
                                         .due = is_due,
                                         .report = report,
                                         .leave = leave_pass,
                                         .passed = end_pass,
                                         .free = hand_free,
                                         .item = record_of,
                                         .least = LEAST};

brio_status brio_insert_parallel(brio_inserter *ins, size_t begin, size_t end) {
    brio_store *store = ins->store;
    brio_status status = BRIO_OK;
    insertion own = {.main = ins, .store = store, .first = (uint32_t)begin, .count = end - begin};
    own.passes = (brio_passes){.ctx = store->ctx,
                               .work = &INSERTION,
                               .user = &own,
                               .rank = store->rank,
                               .ranks = store->num_points,
                               .vertices = end,
                               .count = end - begin};
    assert(ins->locator == &brio_strategy_walk); /* hands walk, and keep no tables of other strategies up to date */
    assert(store->rank && !ins->zone && begin <= end && end <= store->num_points);
    BRIO_TRY(brio_passes_run(&own.passes, brio_threads(store->ctx, end - begin, LEAST)));
    BRIO_TRY(insert_rest(&own, (double)end / (double)store->num_points));
done:
    brio_passes_free(&own.passes);
    return status;
}
