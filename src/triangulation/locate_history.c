/* Point location in the history DAG, as in the program hull: see history.c. */
#include "base/memory.h"
#include "triangulation/history.h"

static brio_status start_history(brio_inserter *ins, const brio_delaunay_options *options) {
    brio_history *h = NULL;
    brio_status status = BRIO_ALLOC_ZERO(ins->store->ctx, h, 1);
    if (status != BRIO_OK) return status;
    ins->location = h;
    return brio_history_new(ins, options, h);
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    return brio_history_locate(ins, ins->location, BRIO_HISTORY_ROOT, ins->store->record[p], tet);
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    (void)p;
    return brio_history_add(ins, ins->location);
}

static void free_history(brio_inserter *ins) {
    const brio_store *s = ins->store;
    if (ins->location) brio_history_free(s->ctx, ins->location);
    brio_release(s->ctx, ins->location);
    ins->location = NULL;
}

const brio_strategy brio_strategy_history = {start_history, locate, filled, free_history};
