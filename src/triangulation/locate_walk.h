/* The walk. */
#ifndef BRIO_TRIANGULATION_LOCATE_WALK_H
#define BRIO_TRIANGULATION_LOCATE_WALK_H

#include "triangulation/zone.h"

/** State of a line of walks: where the next one starts, its random bits, and the steps of all of them. */
typedef struct {
    uint32_t start;
    uint32_t random;
    uint64_t steps;
    bool blocked; /* the last walk led out of the thread's zone */
} brio_walk;

enum { BRIO_NO_TET = UINT32_MAX };

/** The tetrahedron whose closure holds p, or, for p strictly outside the hull, an infinite one whose facet p is
 *  strictly outside of. Exact. BRIO_NO_TET when that takes more than most_steps, or leads out of the zone.
 *  zone  of the thread, which then owns what it walks through; NULL for no bound. */
uint32_t brio_locate_walk(const brio_tetrahedra *t, brio_zone *zone, brio_filter *f, brio_walk *walk, const double *p,
                          uint64_t most_steps);

/** The tetrahedron where a walk starts: the given one, or the finite one next to it. */
static inline uint32_t brio_walk_begin(const brio_tetrahedra *t, const brio_walk *walk) {
    return brio_is_infinite(t, walk->start) ? brio_tet_of(t->tet[walk->start].mate[3]) : walk->start;
}

static inline uint32_t brio_walk_random(uint32_t x) {
    return x * 1664525u + 1013904223u;
}

#endif
