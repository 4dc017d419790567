/* Strategies of point location. An inserter uses one strategy for all points. Each strategy has a file locate_*.c. */
#ifndef BRIO_TRIANGULATION_LOCATOR_H
#define BRIO_TRIANGULATION_LOCATOR_H

#include "triangulation/engine.h"

/** What a strategy does; what it keeps is ins->location. All but `locate` may be NULL. */
typedef struct {
    /** Once the first tetrahedron stands. After a failure `release` is called, too. */
    brio_status (*start)(brio_inserter *ins, const brio_delaunay_options *options);
    /** *tet = a tetrahedron whose closure holds record p, or that conflicts with it; at the position of a vertex that
     *  is not lighter, one of that vertex; BRIO_NO_TET when the search leads out of the zone. In a
     *  pass the thread holds *tet. Records come in their order. */
    brio_status (*locate)(brio_inserter *ins, uint32_t p, uint32_t *tet);
    /** Record p has become a vertex: ins->cavity has the slots of what was destroyed, and of what was created. */
    brio_status (*filled)(brio_inserter *ins, uint32_t p);
    /** Frees ins->location and makes it NULL; accepts NULL. */
    void (*release)(brio_inserter *ins);
} brio_strategy;

extern const brio_strategy brio_strategy_walk, brio_strategy_jump, brio_strategy_hierarchy, brio_strategy_history,
    brio_strategy_trace, brio_strategy_neighbour;

/** Chooses the strategy of the options and starts it. The inserter keeps it from then on, also after a failure. */
brio_status brio_strategy_start(brio_inserter *ins, const brio_delaunay_options *options);

#endif
