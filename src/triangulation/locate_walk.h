/* The walk. */
#ifndef BRIO_TRIANGULATION_LOCATE_WALK_H
#define BRIO_TRIANGULATION_LOCATE_WALK_H

#include "triangulation/zone.h"
#include <assert.h>

/** What an experiment (insertion_part.h) is told: each tetrahedron that the search for a point comes to. */
typedef struct brio_watch {
    void (*came_to)(const struct brio_watch *watch, const brio_tetrahedra *t, uint32_t tet);
} brio_watch;

/** State of a sequence of walks: the start of the next walk, random bits, and the number of steps of all walks. */
typedef struct {
    uint32_t start;
    uint32_t random;
    uint64_t steps;
    bool blocked;    /* the last walk left the thread's zone */
    unsigned unsure; /* bit i is 0: the last walk found the point strictly inside facet i of the finite tetrahedron */
    const brio_watch *watch; /* told by brio_locate_walk; NULL: nobody watches */
} brio_walk;

enum { BRIO_NO_TET = UINT32_MAX };

/** Walks that may be abreast: their steps take turns, so that each one's memory is fetched during the others' steps. */
enum { BRIO_ABREAST = 8 };

/** Returns the tetrahedron whose closure holds p. For p strictly outside the hull, returns an infinite tetrahedron
 *  whose facet has p strictly outside. Exact. Returns BRIO_NO_TET when the walk takes more than most_steps or leaves
 *  the zone.
 *  zone  the thread's zone; the thread then owns the tetrahedra that it walks through. NULL: no bound. */
uint32_t brio_locate_walk(const brio_tetrahedra *t, brio_zone *zone, brio_filter *f, brio_walk *walk, const double *p,
                          uint64_t most_steps);

/** Sets found[i] to what brio_locate_walk finds for points[i], without zone and bound, from walks[i].start, for the
 *  bits i of `which`. */
void brio_locate_abreast(const brio_tetrahedra *t, brio_filter *f, brio_walk walks[BRIO_ABREAST],
                         const double (*points)[4], unsigned which, uint32_t *found);

/** Returns the tetrahedron where a walk starts: walk->start, or the finite tetrahedron next to it. */
static inline uint32_t brio_walk_begin(const brio_tetrahedra *t, const brio_walk *walk) {
    assert(!brio_is_infinite(t, walk->start) ||
           !brio_is_infinite(t, brio_tet_of(t->tet[walk->start].mate[3]))); /* I2 */
    return brio_is_infinite(t, walk->start) ? brio_tet_of(t->tet[walk->start].mate[3]) : walk->start;
}

static inline uint32_t brio_walk_random(uint32_t x) {
    return x * 1664525u + 1013904223u;
}

#endif
