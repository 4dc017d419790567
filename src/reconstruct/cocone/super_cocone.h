/* The co-cone of a large set of samples, in pieces. */
#ifndef BRIO_RECONSTRUCT_SUPER_COCONE_H
#define BRIO_RECONSTRUCT_SUPER_COCONE_H

#include "reconstruct/cocone/cocone_surface.h"

/** As brio_cocone_surface_find of the points times 2^-exponent, which have coordinates of at most 1; in about
 *  options.pieces pieces, which is over 1. Without a copy of the points. */
brio_status brio_super_cocone(brio_context *ctx, const double *points, size_t num_points, int exponent,
                              const brio_cocone_options *options, brio_cocone_surface *out);

#endif
