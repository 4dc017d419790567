/* The Voronoi (power) diagram as the cells are read from it: see diagram.h. This file lists the tetrahedra and puts the
 * vertices in order.
 *
 * The tetrahedra of a triangulation are sorted by their latest vertex along the insertion order, which follows a curve
 * through space. The vertices are taken in the order in which they appear in a tetrahedron. So the points of a
 * tetrahedron, and the tetrahedra of successive vertices, are near each other in memory, in whatever order the caller
 * gave the points. */
#include "cells/diagram.h"
#include "base/memory.h"
#include "base/team.h"
#include <assert.h>
#include <string.h>

enum { VERTICES_A_THREAD = 1 << 14 };

brio_status brio_diagram_list(brio_diagram *d) {
    d->num_listed = d->t.count;
    if (!d->wanted) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->listed, d->t.count));
    d->num_listed = 0;
    for (size_t t = 0; t < d->t.count; t++) {
        d->listed[d->num_listed] = (uint32_t)t;
        d->num_listed += brio_is_listed(d, (uint32_t)t);
        BRIO_FORWARD(brio_look(d->ctx, 1));
    }
    return BRIO_OK;
}

static void copy_points(void *user, size_t from, size_t to, int thread) {
    const brio_diagram *d = user;
    (void)thread;
    for (size_t r = from; r < to; r++) {
        assert(d->rank[d->order[r]] == r); /* I4 */
        memcpy(d->ranked + 3 * r, d->at + 3 * (size_t)d->order[r], 3 * sizeof *d->ranked);
        if (d->square) d->ranked_square[r] = d->square[d->order[r]];
    }
}

static brio_status rank_vertices(brio_diagram *d, size_t rows) {
    uint32_t n = 0;
    for (size_t p = 0; p < rows; p++) d->rank[p] = UINT32_MAX;
    for (size_t i = 0; i < d->num_listed; i++) {
        uint32_t t = brio_listed(d, i);
        BRIO_FORWARD(brio_look(d->ctx, 1));
        if (t >= d->num_finite) break;
        for (int k = 0; k < 4; k++) {
            uint32_t p = d->t.tet[t].vertex[k];
            if (d->rank[p] != UINT32_MAX) continue;
            assert(p < rows && n < rows);
            d->order[n] = p;
            d->rank[p] = n++;
        }
    }
    d->num_vertices = n;
    return BRIO_OK;
}

brio_status brio_diagram_order_vertices(brio_diagram *d) {
    size_t rows = d->num_points + (d->flat ? 3 : 0);
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->order, rows));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->rank, rows));
    BRIO_FORWARD(rank_vertices(d, rows));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->ranked, 3 * d->num_vertices));
    if (d->square) BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->ranked_square, d->num_vertices));
    return brio_for(d->ctx, brio_threads(d->ctx, d->num_vertices, VERTICES_A_THREAD), d->num_vertices, copy_points, d);
}

brio_status brio_diagram_fill(brio_diagram *d, const brio_region *region) {
    BRIO_FORWARD(brio_diagram_list(d));
    BRIO_FORWARD(brio_diagram_order_vertices(d));
    BRIO_FORWARD(brio_diagram_find_centres(d));
    BRIO_FORWARD(brio_progress(d->ctx, "cells", 0.2));
    BRIO_FORWARD(brio_diagram_unite_ties(d));
    BRIO_FORWARD(brio_diagram_find_places(d, region));
    BRIO_FORWARD(brio_progress(d->ctx, "cells", 0.3));
    BRIO_FORWARD(brio_diagram_gather_stars(d));
    return brio_progress(d->ctx, "cells", 0.4);
}

void brio_diagram_free(brio_diagram *d) {
    brio_release(d->ctx, d->centre);
    brio_release(d->ctx, d->same);
    brio_release(d->ctx, d->order);
    brio_release(d->ctx, d->rank);
    brio_release(d->ctx, d->ranked);
    brio_release(d->ctx, d->ranked_square);
    brio_release(d->ctx, d->listed);
    brio_release(d->ctx, d->begin);
    brio_release(d->ctx, d->size);
    brio_release(d->ctx, d->star);
}
