/* The inserter: what one thread needs to insert points into a store.
 *
 * An inserter belongs to one thread at a time, which alone reads and writes its fields; the store (store.h) is shared.
 * In a parallel pass there is one inserter for each thread, each with a zone; outside of passes an inserter without a
 * zone works alone.
 *
 *   walk -> locator -> tetrahedron in conflict -> engine digs the cavity -> cavity filled with the star -> slots
 *
 * Between insertions:
 * N1  walk.start is a tetrahedron; in a pass, one that the thread holds, if it was placed.
 * N2  cavity.created[0 .. num_created) is the star of the last vertex that was inserted. 0 of them: it may be gone.
 * N3  Slots in [next_slot, end_slot) are fresh. Alone there are none: t.count counts just the slots that were written.
 * N4  unused[0 .. num_unused) are slots with state TET_UNUSED.
 * N5  From one insertion to the next only walk.start (N1), cavity.created (N2), the unused slots (N4) and the tables of
 *     a locator keep numbers of slots. N1 and N2 end when a thread leaves its zone. */
#ifndef BRIO_TRIANGULATION_INSERTER_H
#define BRIO_TRIANGULATION_INSERTER_H

#include "base/read_ahead.h"
#include "triangulation/cavity.h"
#include "triangulation/engine.h"
#include "triangulation/locator.h"
#include "triangulation/star.h"
#include "triangulation/store.h"
#include <assert.h>

struct brio_inserter {
    brio_store *store;
    brio_zone *zone; /* of the parallel pass, which the pass owns; NULL: the inserter works alone */

    brio_filter filter; /* the store's bounds, and the calls of this thread that they left open */
    const brio_engine *engine;
    brio_walk walk;

    const brio_strategy *locator; /* the strategy of point location */
    void *location;               /* what the strategy keeps; locator->release frees it */
    uint64_t most_steps;          /* after which a walk counts as long */
    unsigned long_walks;          /* how often of late a walk was given up, see locator.c */
    brio_star star;               /* workspace of locate_descent.c; its marks are the store's states */

    brio_cavity cavity;
    size_t next_slot, end_slot; /* the stretch */
    uint32_t *unused;
    size_t num_unused, unused_capacity;

    brio_read_ahead read_ahead;
    bool goes_on; /* in scratch files: the next point is often close to the last one */

    brio_delaunay_stats stats;
    uint64_t searched;  /* work of a strategy besides walks: nodes of a history, tetrahedra traced through */
    bool reports;       /* whether this thread, the caller's, reports progress */
    double done;        /* share of the points that were in at the last report */
    uint64_t report_at; /* work at which the next report is due */
};

/** Work between two reports of progress: milliseconds. Points are no measure of time, since one insertion can destroy
 *  millions of tetrahedra. */
enum { BRIO_INSERT_WORK = 1 << 18 };

/** Slots that an inserter takes at once in a parallel pass. */
enum { BRIO_SLOT_STRETCH = 4096 };

/** Makes an inserter for a store that brio_start has begun. It walks from the first tetrahedron, locates by walks
 *  (brio_strategy_start for other strategies), has no zone, and has counted nothing. */
brio_status brio_inserter_new(brio_store *store, brio_inserter **out);

/** Frees the inserter and what its strategy of location keeps, not the zone; NULL is accepted. */
void brio_inserter_free(brio_inserter *ins);

/** Makes what brio_delaunay makes of these points, with defaults, before it brings the tetrahedra into their order:
 *  those in the plain slots of a store, whose unused slots the inserter lists. The caller frees both, the inserter
 *  first; after a failure, too, where they are not NULL.   Returns what brio_delaunay returns. */
brio_status brio_delaunay_unordered(brio_context *ctx, const brio_input *input, brio_store **store,
                                    brio_inserter **ins);

/** Reserves `more` fresh slots. In a pass the rest of the stretch may become unused first, and *deferred becomes true
 *  when the store has no further stretch. Alone, exactly `more` slots are handed out, and the caller writes all of
 *  them. */
brio_status brio_inserter_reserve(brio_inserter *ins, size_t more, bool *deferred);

/** Makes what is left of the stretch unused slots. */
brio_status brio_inserter_return_stretch(brio_inserter *ins);

/** Reports the share of the points that are in, where this inserter reports. */
brio_status brio_inserter_report(brio_inserter *ins, double done);

/** Returns the work of an inserter so far: conflict tests, tetrahedra created, steps of walks and other searches; a
 *  predicate that the floating-point filter leaves open counts as 64 of these. */
static inline uint64_t brio_inserter_work(const brio_inserter *ins) {
    const brio_delaunay_stats *s = &ins->stats;
    return s->insphere_calls + s->created + ins->walk.steps + ins->searched + 64 * ins->filter.unsettled;
}

/** Walks to p from walk.start, by the engine's walk. */
static inline uint32_t brio_inserter_walk(brio_inserter *ins, const double *p, uint64_t most_steps) {
    assert(brio_has_tet(&ins->store->t, ins->walk.start)); /* N1 */
    if (__builtin_expect(ins->walk.watch != NULL, 0))
        return brio_locate_walk(&ins->store->t, ins->zone, &ins->filter, &ins->walk, p, most_steps);
    return ins->engine->walk(&ins->store->t, ins->zone, &ins->filter, &ins->walk, p, most_steps);
}

#endif
