/* The co-cone of one set of samples: from the samples to triangles. */
#ifndef BRIO_RECONSTRUCT_COCONE_SURFACE_H
#define BRIO_RECONSTRUCT_COCONE_SURFACE_H

#include "base/experiment.h"
#include "reconstruct/cocone/sample_evidence.h"

/** Triangles of samples, and what was found out about the samples. */
typedef struct {
    uint32_t *faces; /* #F by 3, counterclockwise as seen from outside: manifold and oriented */
    size_t num_faces;
    uint8_t *boundary; /* #P: 1 for boundary samples, with options.boundaries; else NULL */
    double *size;      /* #P: estimate of the local feature size, with options.density; else NULL */
    uint8_t *distinct; /* #P: 1 for samples that represent their position */
    brio_surface_stats stats;
} brio_cocone_surface;

/** An experiment's part: faces of the candidates without labels of tetrahedra, of the co-cone in one piece. */
struct brio_extraction_part {
    void *user;
    /** cocones  loses the candidates that are pruned.   pruned  receives their number.
     *  faces    *num_faces by 3, owned by the caller (brio_release), on failure too. */
    brio_status (*extract)(void *user, brio_context *ctx, const brio_cocones *cocones, size_t *pruned, uint32_t **faces,
                           size_t *num_faces);
};

/** Finds the co-cone or, as options.method says, the tight co-cone.
 *  points    #P by 3, coordinates of at most 1, none -0.
 *  evidence  NULL: none.
 *  out     overwritten; freed with brio_cocone_surface_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER, and what brio_delaunay returns. */
brio_status brio_cocone_surface_find(brio_context *ctx, const double *points, size_t num_points,
                                     const brio_surface_options *options, const brio_sample_evidence *evidence,
                                     brio_cocone_surface *out);

void brio_cocone_surface_free(brio_context *ctx, brio_cocone_surface *surface);

#endif
