/* The star of a vertex, breadth first across the facets that hold the vertex. */
#include "triangulation/star.h"
#include "base/memory.h"
#include <assert.h>

brio_status brio_star_new(brio_context *ctx, size_t num_tetrahedra, brio_star *out) {
    *out = (brio_star){0};
    return BRIO_ALLOC_ZERO(ctx, out->mark, num_tetrahedra);
}

void brio_star_free(brio_context *ctx, brio_star *star) {
    brio_release(ctx, star->tet);
    brio_release(ctx, star->mark);
    *star = (brio_star){0};
}

brio_status brio_star_collect(brio_context *ctx, const brio_tetrahedra *t, uint32_t v, uint32_t first, size_t most,
                              brio_star *star) {
    brio_status status = BRIO_OK;
    star->size = 0;
    BRIO_TRY(BRIO_RESERVE(ctx, star->tet, star->capacity, 1));
    assert(brio_has_tet(t, first) && brio_slot_of_vertex(t->tet[first].vertex, v) < 4);
    star->tet[star->size++] = first;
    star->mark[first] = 1;
    for (size_t n = 0; n < star->size && star->size < most; n++) {
        size_t tet = star->tet[n];
        BRIO_TRY(BRIO_RESERVE(ctx, star->tet, star->capacity, star->size + 4));
        for (int i = 0; i < 4; i++) {
            uint32_t mate = t->tet[tet].mate[i], other = brio_tet_of(mate);
            if (t->tet[tet].vertex[i] == v || star->mark[other] || !brio_owns_beyond(t, star->zone, mate)) continue;
            assert(brio_slot_of_vertex(t->tet[other].vertex, v) < 4); /* mates share the facet, and so v (I3) */
            star->mark[other] = 1;
            star->tet[star->size++] = other;
            __builtin_prefetch(&t->tet[other]);
        }
    }
done:
    for (size_t n = 0; n < star->size; n++) star->mark[star->tet[n]] = 0;
    return status;
}
