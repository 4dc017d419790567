/* The choice of a strategy of point location, and the default one: the walk from the point inserted last. */
#include "triangulation/inserter.h"
#include "triangulation/locate_descent.h"
#include <assert.h>

/* Walks, which is best nearly always. Where walks are long again and again it descends, and tries a walk after every
 * DESCENTS descents. */
static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    const double *point = ins->store->record[p];
    enum { DESCENTS = 64 };
    if (ins->long_walks == 0) {
        *tet = brio_inserter_walk(ins, point, ins->most_steps);
        if (*tet != BRIO_NO_TET || ins->walk.blocked) return BRIO_OK;
        ins->long_walks = DESCENTS;
    }
    ins->long_walks--;
    return brio_locate_descent(ins, point, tet);
}

const brio_strategy brio_strategy_walk = {.locate = locate};

brio_status brio_strategy_start(brio_inserter *ins, const brio_delaunay_options *options) {
    static const brio_strategy *const locators[BRIO_LOCATION_END] = {
        [BRIO_LOCATION_WALK] = &brio_strategy_walk,           [BRIO_LOCATION_JUMP] = &brio_strategy_jump,
        [BRIO_LOCATION_HIERARCHY] = &brio_strategy_hierarchy, [BRIO_LOCATION_HISTORY] = &brio_strategy_history,
        [BRIO_LOCATION_TRACE] = &brio_strategy_trace,         [BRIO_LOCATION_NEIGHBOUR] = &brio_strategy_neighbour,
    };
    assert((unsigned)options->locate < BRIO_LOCATION_END && locators[options->locate]);
    ins->locator = locators[options->locate];
    return ins->locator->start ? ins->locator->start(ins, options) : BRIO_OK;
}
