/* Voronoi vertices, the direction of each sample's pole, and what lies which way as seen from there. */
#ifndef BRIO_DUAL_POLE_VECTORS_H
#define BRIO_DUAL_POLE_VECTORS_H

#include "base/context.h"
#include "triangulation/tetrahedra.h"

/** Where a Voronoi vertex lies as seen from a sample: in the cone about the direction to its pole, in the opposite one,
 *  or in the co-cone between them. A place too close to the border to tell counts as in the co-cone. */
typedef enum { BRIO_SIDE_COCONE = 0, BRIO_SIDE_POLE = 1, BRIO_SIDE_ANTIPOLE = 2 } brio_side;

/** The dual of a Delaunay triangulation, as far as a sample sees its surface by it. A Voronoi vertex is named by its
 *  tetrahedron; that of an infinite tetrahedron lies infinitely far along the outward normal of the hull facet. */
typedef struct {
    brio_tetrahedra t; /* caller's indices; without records */
    size_t num_finite, num_points, num_vertices;
    const double *points;
    double theta;    /* half the opening of the co-cones */
    double *centre;  /* #T by 4: the place and its squared distance from its samples, or the unit direction and 1; NaN
                       where doubles cannot hold it */
    double *plane;   /* #P by 4: the axis and minus its product with the sample. The axis is a unit vector from the
                       sample to the farther pole or, on the hull, the sum of the unit outward normals of its hull
                       facets; zero for points that are no vertices */
    uint32_t *pole;  /* #P by 2: the farther pole (on the hull an infinite tetrahedron) and the farthest Voronoi vertex
                       on its other side; BRIO_INFINITE where there is none */
    uint16_t *sides; /* #T: what the samples in the slots see of the Voronoi vertex. Bit i: the sample in slot i sees it
                        in its cone to the pole. Bit 4 + i: in its opposite cone. Bits 8 + i, 12 + i: the lower and the
                        upper bit of brio_depth_class. */
} brio_pole_vectors;

/** Finds them.   theta  in (0, pi/2).   t and points must outlive the result; what it holds is to be freed on failure
 *  too. Ties go by the positions of centres, then of vertices. Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 */
brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, double theta, brio_pole_vectors *out);

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v);

/** What points from p to the Voronoi vertex of a tetrahedron: their difference, or the direction of a ray. */
static inline void brio_towards_centre(const brio_pole_vectors *v, size_t tet, size_t p, double to[3]) {
    const double *c = v->centre + 4 * tet, *from = v->points + 3 * p;
    bool ray = tet >= v->num_finite;
    for (int k = 0; k < 3; k++) to[k] = ray ? c[k] : c[k] - from[k];
}

/** Decode `sides`: bit i of the result belongs to slot i. The samples that see the Voronoi vertex in their cone to the
 *  pole, those that see it in their opposite cone, and those whose depth class is the worst, BRIO_DEPTHS - 1. */
static inline unsigned brio_pole_slots(unsigned sides) {
    return sides & 15;
}
static inline unsigned brio_antipole_slots(unsigned sides) {
    return sides >> 4 & 15;
}
static inline unsigned brio_shallow_slots(unsigned sides) {
    return sides >> 8 & sides >> 12 & 15;
}

/** Returns the two side bits of a slot: bit 0 for the cone to the pole, bit 4 for the opposite cone, at most one of them
 *  set. */
static inline unsigned brio_slot_sides(unsigned sides, int slot) {
    return sides >> slot & 0x11;
}

static inline int brio_side_of(const brio_pole_vectors *v, size_t tet, int slot) {
    int bits = v->sides[tet] >> slot;
    return (bits & 1) | (bits >> 3 & 2);
}

enum { BRIO_DEPTHS = 4 };

/** Whether the sine of the angle between the direction to a Voronoi vertex and the axis of the sample in a slot is over
 *  1/16, 1/8, 1/4: how many of these. */
static inline int brio_depth_class(const brio_pole_vectors *v, size_t tet, int slot) {
    int bits = v->sides[tet] >> (8 + slot);
    return (bits & 1) | (bits >> 3 & 2);
}

#endif
