/* Strategies of point location. An inserter uses one strategy for all points: the walk, unless an experiment has
 * another one. */
#ifndef BRIO_TRIANGULATION_LOCATOR_H
#define BRIO_TRIANGULATION_LOCATOR_H

#include "triangulation/engine.h"

/** What a strategy does; what it keeps is ins->location. All but `locate` may be NULL. */
typedef struct {
    /** Once the first tetrahedron stands. After a failure `release` is called, too. */
    brio_status (*start)(brio_inserter *ins);
    /** *tet = a tetrahedron whose closure holds record p, or that conflicts with it; at the position of a vertex that
     *  is not lighter, one of that vertex; BRIO_NO_TET when the search leads out of the zone. In a
     *  pass the thread holds *tet. Records come in their order. */
    brio_status (*locate)(brio_inserter *ins, uint32_t p, uint32_t *tet);
    /** Record p has become a vertex: ins->cavity has the slots of what was destroyed, and of what was created. */
    brio_status (*filled)(brio_inserter *ins, uint32_t p);
    /** Frees ins->location and makes it NULL; accepts NULL. */
    void (*release)(brio_inserter *ins);
} brio_strategy;

/** The default: the walk from the point inserted last. */
extern const brio_strategy brio_strategy_walk;

#endif
