/* The power diagram of polar balls, seen through its dual. */
#ifndef BRIO_DUAL_POWER_DIAGRAM_H
#define BRIO_DUAL_POWER_DIAGRAM_H

#include "dual/poles.h"
#include "triangulation/tetrahedra.h"

/** The dual of the power diagram is the regular triangulation of the poles: a vertex is a pole with a cell, an edge a face
 *  between two cells, a tetrahedron a vertex of the diagram. A view: it owns nothing, and it is valid as long as what it
 *  points to. Nobody changes the triangulation. */
typedef struct {
    const brio_poles *poles;
    const double *samples; /* #samples by 3, that the poles belong to */
    size_t num_samples;
    brio_tetrahedra power; /* the regular triangulation; vertices are numbers of poles; finite tetrahedra come first */
    size_t num_finite;
    const uint32_t *representative; /* of each pole: itself, or the pole whose cell takes the place of its own */
} brio_power_diagram;

/** Returns -cos of the angle at which two polar balls intersect: -1 where they touch, 0 at a right angle, 1 or more for a
 *  ball inside the other. */
double brio_ball_weight(const brio_poles *poles, uint32_t p, uint32_t q);

/** Makes the view.   samples  #samples by 3.   power  the regular triangulation of the poles. */
brio_power_diagram brio_power_diagram_of(const brio_poles *poles, const double *samples, size_t num_samples,
                                         const brio_triangulation *power);

#endif
