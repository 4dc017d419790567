/* Strategies of point location: one behind the kernel's every insertion, each in a file of its own. */
#ifndef BRIO_TRIANGULATION_LOCATOR_H
#define BRIO_TRIANGULATION_LOCATOR_H

#include "triangulation/engine.h"

/** What a strategy does; what it keeps is k->location. All but `locate` may be NULL. */
typedef struct {
    /** Once the first tetrahedron stands. After a failure `release` is called, too. */
    brio_status (*start)(brio_kernel *k, const brio_delaunay_options *options);
    /** A tetrahedron whose closure holds record p, or that conflicts with it; at the position of a vertex that is not
     *  lighter, one of that vertex. Records come in their order. */
    brio_status (*locate)(brio_kernel *k, uint32_t p, uint32_t *tet);
    /** Record p has become a vertex: k->cavity has the slots of what was destroyed, and of what was created. */
    brio_status (*filled)(brio_kernel *k, uint32_t p);
    /** Frees k->location and makes it NULL; accepts NULL. */
    void (*release)(brio_kernel *k);
} brio_locator;

extern const brio_locator brio_locator_walk, brio_locator_jump, brio_locator_hierarchy, brio_locator_history,
    brio_locator_trace, brio_locator_neighbour;

const brio_locator *brio_locator_choose(brio_location location);

#endif
