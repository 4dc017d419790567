/* The Voronoi (power) diagram as the cells are read from it: see diagram.h. */
#include "cells/diagram.h"
#include "base/memory.h"

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
