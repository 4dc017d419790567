/* The co-cone of a large set of samples, in pieces. */
#ifndef BRIO_RECONSTRUCT_SUPER_COCONE_H
#define BRIO_RECONSTRUCT_SUPER_COCONE_H

#include "reconstruct/cocone/cocone_surface.h"

/** Finds the co-cone of points in about options.pieces pieces, with the contract of brio_cocone_surface_find. Scales
 *  each piece by 2^-exponent, which makes coordinates at most 1; makes no copy of all points.
 *  options  pieces is greater than 1. */
brio_status brio_super_cocone(brio_context *ctx, const double *points, size_t num_points, int exponent,
                              const brio_surface_options *options, brio_cocone_surface *out);

#endif
