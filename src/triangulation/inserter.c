/* The inserter: construction, slots, progress. */
#include "triangulation/inserter.h"
#include "base/memory.h"
#include <assert.h>
#include <math.h>

/* Returns a number of steps that crosses vertices which fill space, as walks do in orders without locality. */
static uint64_t most_steps(const brio_store *store) {
    return 40 + (uint64_t)(4 * cbrt((double)store->num_points));
}

brio_status brio_inserter_new(brio_store *store, brio_inserter **out) {
    brio_inserter *ins = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(store->ctx, ins, 1));
    ins->store = store;
    ins->filter = store->filter;
    ins->filter.unsettled = 0;
    ins->engine = brio_engine_choose(store->weighted);
    ins->locator = &brio_strategy_walk;
    ins->most_steps = most_steps(store);
    brio_read_ahead_start(&ins->read_ahead, store->ctx);
    ins->goes_on = ins->read_ahead.active && store->follows;
    BRIO_TRY(brio_cavity_new(store->ctx, &ins->cavity));
    *out = ins;
    ins = NULL;
done:
    brio_inserter_free(ins);
    return status;
}

void brio_inserter_free(brio_inserter *ins) {
    if (!ins) return;
    brio_context *ctx = ins->store->ctx;
    if (ins->locator->release) ins->locator->release(ins);
    brio_cavity_free(ctx, &ins->cavity);
    brio_release(ctx, ins->star.tet);
    brio_release(ctx, ins->unused);
    brio_release(ctx, ins);
}

brio_status brio_inserter_return_stretch(brio_inserter *ins) {
    brio_store *store = ins->store;
    assert(ins->next_slot <= ins->end_slot); /* N3 */
    size_t left = ins->end_slot - ins->next_slot;
    brio_status status = BRIO_RESERVE(store->ctx, ins->unused, ins->unused_capacity, ins->num_unused + left);
    if (status != BRIO_OK) return status;
    for (; ins->next_slot < ins->end_slot; ins->next_slot++) {
        store->state[ins->next_slot] = TET_UNUSED;
        assert(ins->num_unused < ins->unused_capacity); /* N4 */
        ins->unused[ins->num_unused++] = (uint32_t)ins->next_slot;
    }
    return BRIO_OK;
}

/* Takes a new stretch, in a pass. */
static brio_status reserve_stretch(brio_inserter *ins, size_t more, bool *deferred) {
    size_t size = more > BRIO_SLOT_STRETCH ? more : BRIO_SLOT_STRETCH, begin;
    brio_status status = brio_inserter_return_stretch(ins);
    if (status != BRIO_OK) return status;
    *deferred = !brio_store_take(ins->store, size, &begin);
    if (*deferred) return BRIO_OK;
    assert(ins->next_slot == ins->end_slot); /* the old stretch was returned */
    ins->next_slot = begin;
    ins->end_slot = begin + size;
    return BRIO_OK;
}

brio_status brio_inserter_reserve(brio_inserter *ins, size_t more, bool *deferred) {
    brio_store *store = ins->store;
    assert(more > 0 && ins->next_slot <= ins->end_slot);
    if (more <= ins->end_slot - ins->next_slot) return BRIO_OK;
    if (ins->zone) return reserve_stretch(ins, more, deferred);
    assert(ins->next_slot == ins->end_slot);
    brio_status status = brio_store_reserve(store, more);
    if (status != BRIO_OK) return status;
    ins->next_slot = store->t.count;
    ins->end_slot = store->t.count += more;
    assert(ins->end_slot - ins->next_slot == more && store->t.count <= store->capacity); /* N3 */
    return BRIO_OK;
}

brio_status brio_inserter_report(brio_inserter *ins, double done) {
    ins->done = fmax(ins->done, done); /* a second try of deferred points does not step back */
    ins->report_at = brio_inserter_work(ins) + BRIO_INSERT_WORK;
    return ins->reports ? brio_progress(ins->store->ctx, "insert", ins->done) : BRIO_OK;
}
