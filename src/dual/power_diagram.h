/* The power diagram of polar balls, represented by its dual. */
#ifndef BRIO_DUAL_POWER_DIAGRAM_H
#define BRIO_DUAL_POWER_DIAGRAM_H

#include "dual/poles.h"
#include "triangulation/tetrahedra.h"

/** A view of the power diagram. Its dual is the regular triangulation of the poles: a vertex is a pole with a cell, an
 *  edge is a face between two cells, a tetrahedron is a vertex of the diagram. The view owns nothing: the poles, the
 *  samples and the triangulation must outlive the view, and must not change meanwhile. */
typedef struct {
    const brio_poles *poles;
    const double *samples; /* #samples by 3: the samples of the poles */
    size_t num_samples;
    brio_tetrahedra power; /* the regular triangulation; vertices are numbers of poles; finite tetrahedra come first */
    size_t num_finite;
    const uint32_t *representative; /* #poles: the pole itself if it has a cell, else the pole whose cell replaces it */
} brio_power_diagram;

/** Returns -cos of the angle at which two polar balls intersect: -1 when the balls touch from outside, 0 at a right
 *  angle, 1 or more when one ball is inside the other ball. */
double brio_ball_weight(const brio_poles *poles, uint32_t p, uint32_t q);

/** The weight of balls that intersect at pi / 4: in dense samples an inner and an outer ball have a lesser one [Choi
 *  2003, lemma 38]. */
#define BRIO_DEEP_WEIGHT (-0.70710678118654752)

/** Returns the view.   samples  #samples by 3.   power  the regular triangulation of the poles. */
brio_power_diagram brio_power_diagram_of(const brio_poles *poles, const double *samples, size_t num_samples,
                                         const brio_triangulation *power);

#endif
