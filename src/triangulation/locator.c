/* The default strategy of point location: the walk from the point inserted last. */
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
