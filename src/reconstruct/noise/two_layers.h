/* Points of two sheets, one close behind the other. */
#ifndef BRIO_RECONSTRUCT_TWO_LAYERS_H
#define BRIO_RECONSTRUCT_TWO_LAYERS_H

#include "reconstruct/noise/local_surface.h"

/** The heights of points over the plane through their middle, and how they fall in two. */
typedef struct {
    double height[BRIO_MOST_NEAR];
    double spread;  /* the standard deviation of the heights */
    double share;   /* of the variance: that between the middles of the two layers; 0 if there are too few points */
    double cut;     /* the height between the layers */
    double central; /* the share of the points whose height is under 0.3 times the spread */
} brio_two_layers;

/** Splits points in two layers by their heights, so that the middles of the layers explain as much of the variance as
 *  they can. A fifth of the points or more is in each.   n  the weights are overwritten.
 *  Returns false if the points are on a line. */
bool brio_split_layers(brio_neighbourhood *n, brio_two_layers *out);

#endif
