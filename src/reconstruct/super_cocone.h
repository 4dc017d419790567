/* The co-cone of a large set of samples, in pieces. */
#ifndef BRIO_RECONSTRUCT_SUPER_COCONE_H
#define BRIO_RECONSTRUCT_SUPER_COCONE_H

#include "reconstruct/cocone_surface.h"

/** As brio_cocone_surface_find, in about options.pieces pieces, which is over 1. */
brio_status brio_super_cocone(brio_context *ctx, const double *points, size_t num_points,
                              const brio_cocone_options *options, brio_cocone_surface *out);

#endif
