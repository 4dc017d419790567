/* The choice of a strategy of point location, and the default one: the walk from the point inserted last. */
#include "triangulation/kernel.h"

/* The steps after which a walk counts as long: more than it takes to cross vertices that fill space, as the walks of
 * orders without locality do. */
static uint64_t most_steps(const brio_kernel *k) {
    return 40 + (uint64_t)(4 * cbrt((double)k->num_points));
}

/* A walk, which is best nearly always; where walks are long again and again, the descent, with a walk tried now and
 * then. */
static brio_status locate(brio_kernel *k, uint32_t p, uint32_t *tet) {
    const double *point = k->record[p];
    enum { DESCENTS = 64 };
    if (k->long_walks == 0) {
        *tet = k->engine->walk(&k->t, &k->filter, &k->walk, point, most_steps(k));
        if (*tet != BRIO_NO_TET) return BRIO_OK;
        if (k->walk.blocked) return BRIO_DEFERRED;
        k->long_walks = DESCENTS;
    }
    k->long_walks--;
    k->star.mark = k->state;
    return brio_locate_descent(k, point, tet);
}

const brio_locator brio_locator_walk = {.locate = locate};

const brio_locator *brio_locator_choose(brio_location location) {
    static const brio_locator *const locators[BRIO_LOCATION_END] = {
        [BRIO_LOCATION_WALK] = &brio_locator_walk,           [BRIO_LOCATION_JUMP] = &brio_locator_jump,
        [BRIO_LOCATION_HIERARCHY] = &brio_locator_hierarchy, [BRIO_LOCATION_HISTORY] = &brio_locator_history,
        [BRIO_LOCATION_TRACE] = &brio_locator_trace,         [BRIO_LOCATION_NEIGHBOUR] = &brio_locator_neighbour,
    };
    return locators[location];
}
