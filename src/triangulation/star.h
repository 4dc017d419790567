/* The tetrahedra round a vertex. */
#ifndef BRIO_TRIANGULATION_STAR_H
#define BRIO_TRIANGULATION_STAR_H

#include "triangulation/zone.h"

/** Workspace of one thread's collections: the last star, and one mark a tetrahedron. */
typedef struct {
    uint32_t *tet;
    size_t size, capacity;
    uint8_t *mark;   /* 0 between calls */
    brio_zone *zone; /* of the thread, which collects only what it owns; NULL: everything */
} brio_star;

brio_status brio_star_new(brio_context *ctx, size_t num_tetrahedra, brio_star *out);
void brio_star_free(brio_context *ctx, brio_star *star);

/** Sets star->tet[0 .. size) to the tetrahedra with vertex v, infinite ones included; `first` is one of them. Stops
 *  soon after `most` tetrahedra, and at tetrahedra that the thread does not own. */
brio_status brio_star_collect(brio_context *ctx, const brio_tetrahedra *t, uint32_t v, uint32_t first, size_t most,
                              brio_star *star);

#endif
