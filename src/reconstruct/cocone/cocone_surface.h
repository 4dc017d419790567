/* The co-cone of one set of samples, from their triangulation to triangles. */
#ifndef BRIO_RECONSTRUCT_COCONE_SURFACE_H
#define BRIO_RECONSTRUCT_COCONE_SURFACE_H

#include "base/context.h"

/** Triangles of samples, and what was learnt of the samples on the way. */
typedef struct {
    uint32_t *faces; /* #F by 3, counterclockwise as seen from outside: manifold and oriented */
    size_t num_faces;
    uint8_t *boundary; /* #P: 1 for boundary samples, with options.boundaries; else NULL */
    double *size;      /* #P: estimate of the local feature size, with options.density; else NULL */
    uint8_t *distinct; /* #P: 1 for samples that stand for their position */
    brio_cocone_stats stats;
} brio_cocone_surface;

/** Finds it.   points  #P by 3, of coordinates at most 1 and no -0.   What the result holds is to be freed
 *  (brio_cocone_surface_free) on failure too. Times are added to those in the stats.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER, and as brio_delaunay. */
brio_status brio_cocone_surface_find(brio_context *ctx, const double *points, size_t num_points,
                                     const brio_cocone_options *options, brio_cocone_surface *out);

void brio_cocone_surface_free(brio_context *ctx, brio_cocone_surface *surface);

#endif
