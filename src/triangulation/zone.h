/* What a thread may change while others work on the same store: its zone.
 *
 * A space-filling curve through the points is divided into segments. A thread holds segments, each held by one thread
 * at most; it takes one when it meets a vertex there and gives it back some insertions later. A segment that another
 * thread holds is never waited for. docs/decisions/006-segments-held-by-threads.md proves that nothing else needs a
 * lock. */
#ifndef BRIO_TRIANGULATION_ZONE_H
#define BRIO_TRIANGULATION_ZONE_H

#include "triangulation/tetrahedra.h"
#include <assert.h>

/** All fields belong to one thread, except what `taken` points to. */
typedef struct {
    const uint32_t *rank; /* of each vertex along the curve; constant in a pass */
    int shift;            /* of a rank, to its segment */
    uint8_t *taken;       /* of each segment: whether a thread holds it; all threads write and read it atomically */
    uint8_t *held;        /* of each segment: when this thread last met it; 0: this thread does not hold it */
    uint32_t *segment;    /* the segments that this thread holds, count of them */
    size_t count;
    uint8_t now; /* number of the insertion, never 0 */
} brio_zone;

/** Makes a zone without segments. taken  of `segments` bytes, the caller's. */
brio_status brio_zone_new(brio_context *ctx, const uint32_t *rank, int shift, size_t segments, uint8_t *taken,
                          brio_zone *out);
void brio_zone_free(brio_context *ctx, brio_zone *zone);

/** Takes a segment that this thread does not hold. Returns false when another thread holds it. */
bool brio_zone_take(brio_zone *zone, uint32_t segment);

/** Ends an insertion. Where many segments are held, gives back those that the insertion did not meet. Returns whether
 *  there were any. */
bool brio_zone_tidy(brio_zone *zone);

/** Gives back all segments. */
void brio_zone_leave(brio_zone *zone);

/** Returns whether a vertex is in the zone. Adds its segment to the zone first, if no thread holds that. */
static inline bool brio_zone_has(brio_zone *zone, uint32_t vertex) {
    assert(zone->now != 0);
    uint32_t segment = zone->rank[vertex] >> zone->shift;
    if (!zone->held[segment] && !brio_zone_take(zone, segment)) return false;
    zone->held[segment] = zone->now;
    return true;
}

/** Returns whether this thread holds a vertex. Changes nothing. */
static inline bool brio_zone_holds(const brio_zone *zone, uint32_t vertex) {
    return zone->held[zone->rank[vertex] >> zone->shift] != 0;
}

/** Returns whether this thread holds all finite vertices of a tetrahedron (P1 of store.h); always without a zone.
 *  Changes nothing. */
static inline bool brio_zone_holds_tet(const brio_tetrahedra *t, const brio_zone *zone, uint32_t tet) {
    const uint32_t *v = t->tet[tet].vertex;
    return !zone || (brio_zone_holds(zone, v[0]) && brio_zone_holds(zone, v[1]) && brio_zone_holds(zone, v[2]) &&
                     (v[3] == t->infinite || brio_zone_holds(zone, v[3])));
}

/** Returns whether this thread may destroy a tetrahedron: all its finite vertices are in the zone, which grows where it
 *  can. No other thread then destroys the tetrahedron or one that shares a facet with it (decision 006). Without a
 *  zone, which is NULL, always. */
static inline bool brio_owns(const brio_tetrahedra *t, brio_zone *zone, uint32_t tet) {
    const uint32_t *v = t->tet[tet].vertex;
    if (!zone) return true;
    return brio_zone_has(zone, v[0]) && brio_zone_has(zone, v[1]) && brio_zone_has(zone, v[2]) &&
           (v[3] == t->infinite || brio_zone_has(zone, v[3]));
}

/** Returns what brio_owns returns for the tetrahedron of a facet whose mate's tetrahedron the thread owns: one vertex
 *  is new. */
static inline bool brio_owns_beyond(const brio_tetrahedra *t, brio_zone *zone, uint32_t facet) {
    uint32_t apex;
    if (!zone) return true;
    apex = brio_apex(t, facet);
    return apex == t->infinite || brio_zone_has(zone, apex);
}

#endif
