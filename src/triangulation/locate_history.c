/* Point location in the history DAG, as in the program hull: see history.c. */
#include "base/memory.h"
#include "triangulation/history.h"

static brio_status start_history(brio_kernel *k, const brio_delaunay_options *options) {
    brio_history *h = NULL;
    brio_status status = BRIO_ALLOC_ZERO(k->ctx, h, 1);
    if (status != BRIO_OK) return status;
    k->location = h;
    return brio_history_new(k, options, h);
}

static brio_status locate(brio_kernel *k, uint32_t p, uint32_t *tet) {
    return brio_history_locate(k, k->location, BRIO_HISTORY_ROOT, k->record[p], tet);
}

static brio_status filled(brio_kernel *k, uint32_t p) {
    (void)p;
    return brio_history_add(k, k->location);
}

static void free_history(brio_kernel *k) {
    if (k->location) brio_history_free(k->ctx, k->location);
    brio_release(k->ctx, k->location);
    k->location = NULL;
}

const brio_locator brio_locator_history = {start_history, locate, filled, free_history};
