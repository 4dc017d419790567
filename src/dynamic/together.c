/* Many changes together, by all threads.
 *
 * In a pass (triangulation/passes.h) each thread has a hand: a brio_dynamic that shares the arrays of rows and slots,
 * and nothing else. The functions that change one point alone change it by a hand, too: a hole is dug, or
 * a star listed, only as far as its vertices are in the hand's zone, and nothing is written before all of it is. What
 * meets another hand's zone is tried again. What has to do with hidden points, twins, or very many tetrahedra is left
 * to one thread, which does it after the passes: their lists reach across zones.
 *
 * Rows are added before the passes and dropped after them, names change in neither, and slots are handed out before.
 *
 * The result does not depend on the sequence of the changes, so the number of threads cannot be seen in it.
 *
 * Based on: Marot, Pellerin, Remacle. One machine, one minute, three billion tetrahedra. IJNME 2019; see passes.c. */
#include "base/memory.h"
#include "base/team.h"
#include "dynamic/live.h"
#include <string.h>

enum {
    LEAST = 64, /* changes that are worth a thread */
    TRIES = 64  /* between two looks */
};

typedef struct {
    brio_dynamic *d;
    const brio_batch *batch;
    size_t most; /* rows that a hand may take out and put in again */
} together;

typedef struct {
    brio_dynamic view;
    const together *own;
    brio_journal *node; /* for the journal that it leaves */
    size_t tries;
    bool looks; /* its thread is the one that called */
} hand;

/* --- one change --- */

static brio_status change_one(brio_dynamic *d, const brio_batch *b, size_t i) {
    uint32_t name = b->name[i], row = d->row_of[name];
    double record[4];
    if (b->kind == BRIO_BATCH_INSERT) return brio_live_place(d, row);
    if (b->kind == BRIO_BATCH_REMOVE) return brio_live_take(d, &row);
    BRIO_FORWARD(brio_new_record(d, b->moves, b->at ? b->at[i] : i, name, record));
    return brio_live_move(d, name, record);
}

static brio_status try_change(void *user, uint32_t item, brio_attempt *outcome) {
    hand *h = user;
    brio_dynamic *d = &h->view;
    const together *own = h->own;
    h->tries++;
    *outcome = BRIO_TRY_LATER;
    if (!brio_zone_has(d->zone, d->row_of[own->batch->name[item]])) return BRIO_OK;
    d->attempt = BRIO_TRIED;
    BRIO_FORWARD(change_one(d, own->batch, item));
    *outcome = d->attempt;
    if (d->replaced > own->most) { /* the caller takes the change back and builds anew */
        __atomic_store_n(&own->d->needs_anew, true, __ATOMIC_RELAXED);
        return BRIO_ERR_INTERNAL;
    }
    if (d->walk.start != BRIO_NO_TET) brio_owns(&d->t, d->zone, d->walk.start);
    brio_zone_tidy(d->zone);
    return BRIO_OK;
}

static bool is_due(const void *user) {
    return ((const hand *)user)->tries >= TRIES;
}

static brio_status look(void *user, double share) {
    hand *h = user;
    (void)share;
    h->tries = 0;
    return h->looks ? brio_ask(h->view.ctx) : BRIO_OK;
}

/* --- hands --- */

/* Makes room for the slots of a pass: as many a point as there are, and some more. */
static brio_status prepare(void *user, size_t count, int threads) {
    enum { SPARE = 1024 };
    const together *own = user;
    brio_dynamic *d = own->d;
    double each = (double)(d->counts.finite + d->counts.infinite) / (double)d->counts.vertices;
    size_t need = (size_t)threads * SPARE;
    if (own->batch->kind == BRIO_BATCH_INSERT) need += (size_t)(1.04 * each * (double)count);
    if (need <= d->num_unused) return BRIO_OK;
    need -= d->num_unused;
    BRIO_FORWARD(brio_live_reserve_slots(d, need));
    for (size_t slot = d->t.count + need; slot-- > d->t.count;) {
        d->state[slot] = SLOT_UNUSED;
        brio_set_first_hidden(d, slot, BRIO_NONE);
        d->until[slot] = -1;
        d->unused[d->num_unused++] = (uint32_t)slot;
    }
    d->t.count += need;
    return BRIO_OK;
}

static brio_status hand_new(void *user, brio_zone *zone, const brio_pass_part *part, void **out) {
    const together *own = user;
    brio_dynamic *d = own->d, *v;
    hand *h;
    size_t share = d->num_unused / (size_t)(part->threads - part->thread);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, h, 1));
    *out = h;
    h->own = own;
    h->looks = part->thread == 0;
    v = &h->view;
    *v = *d;
    v->zone = zone;
    v->attempt = BRIO_TRIED;
    v->hole = (brio_hole){0};
    v->edges = (brio_edge_table){0};
    v->link = NULL;
    v->loose = v->unused = NULL;
    v->num_loose = v->loose_capacity = v->num_unused = v->unused_capacity = 0;
    v->journal.slot = NULL, v->journal.row = NULL, v->journal.more = NULL;
    v->journal.num_slots = v->journal.num_rows = v->journal.slot_capacity = v->journal.row_capacity = 0;
    v->counts = (brio_live_counts){0};
    v->in_place = v->replaced = 0;
    v->filter.unsettled = 0;
    v->walk.steps = 0;
    v->walk.start = BRIO_NO_TET;
    BRIO_FORWARD(brio_live_equip(v));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, h->node, 1));
    BRIO_FORWARD(BRIO_RESERVE(d->ctx, v->unused, v->unused_capacity, share));
    d->num_unused -= share;
    v->num_unused = share;
    if (share) memcpy(v->unused, d->unused + d->num_unused, share * sizeof *v->unused);
    return BRIO_OK;
}

static void hand_free(void *user) {
    hand *h = user;
    brio_context *ctx = h->view.ctx;
    brio_live_strip(&h->view);
    brio_release(ctx, h->node);
    brio_release(ctx, h);
}

/* Takes over a hand's journal, its unused slots, which there is room for, and what it counted. */
static brio_status leave(void *user, void *left, size_t deferred) {
    const together *own = user;
    brio_dynamic *d = own->d;
    hand *h = left;
    brio_dynamic *v = &h->view;
    (void)deferred;
    if (!h->node) return BRIO_OK; /* it could not be made */
    brio_hole_forget(v);
    brio_journal_give(d, &v->journal, h->node);
    h->node = NULL;
    if (v->num_unused) memcpy(d->unused + d->num_unused, v->unused, v->num_unused * sizeof *v->unused);
    d->num_unused += v->num_unused;
    d->counts.vertices += v->counts.vertices; /* differences, which wrap around */
    d->counts.finite += v->counts.finite;
    d->counts.infinite += v->counts.infinite;
    d->in_place += v->in_place;
    d->replaced += v->replaced;
    d->filter.unsettled += v->filter.unsettled;
    d->walk.steps += v->walk.steps;
    return BRIO_OK;
}

static uint32_t item(const void *user, size_t i) {
    (void)user;
    return (uint32_t)i;
}

static const brio_pass_work CHANGES = {.prepare = prepare,
                                       .enter = hand_new,
                                       .attempt = try_change,
                                       .due = is_due,
                                       .report = look,
                                       .leave = leave,
                                       .free = hand_free,
                                       .item = item,
                                       .least = LEAST};

/* Makes the changes that the passes have left. */
static brio_status change_rest(brio_dynamic *d, const brio_batch *b, const brio_passes *left, uint64_t replaced) {
    for (size_t i = 0; i < left->count; i++) {
        BRIO_FORWARD(change_one(d, b, brio_pass_item(left, i)));
        BRIO_FORWARD(brio_look(d->ctx, 4));
        if (d->replaced - replaced <= b->most) continue;
        d->needs_anew = true;
        return BRIO_ERR_INTERNAL; /* the caller takes the change back and builds anew */
    }
    return BRIO_OK;
}

brio_status brio_live_together(brio_dynamic *d, const brio_batch *b) {
    brio_status status = BRIO_OK;
    uint64_t replaced = d->replaced;
    int threads = brio_threads(d->ctx, b->count, LEAST);
    together own = {d, b, b->most / (size_t)threads};
    size_t more = b->kind == BRIO_BATCH_INSERT ? b->count : 0;
    brio_passes passes = {.ctx = d->ctx,
                          .work = &CHANGES,
                          .user = &own,
                          .rank = d->rank,
                          .ranks = d->row_capacity,
                          .vertices = d->counts.vertices + more,
                          .count = b->count};
    if (d->counts.vertices > b->count && threads > 1) {
        BRIO_TRY(brio_passes_run(&passes, threads));
        brio_live_start(d);
    }
    BRIO_TRY(change_rest(d, b, &passes, replaced));
done:
    brio_passes_free(&passes);
    return status;
}
