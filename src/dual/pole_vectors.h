/* Voronoi vertices, the direction from each sample to its farther pole, and the side on which each vertex lies. */
#ifndef BRIO_DUAL_POLE_VECTORS_H
#define BRIO_DUAL_POLE_VECTORS_H

#include "base/context.h"
#include "triangulation/tetrahedra.h"
#include <assert.h>

/** Where a Voronoi vertex lies relative to a sample: in the cone about the direction to the sample's farther pole, in
 *  the opposite cone, or in the co-cone between the cones. A vertex within its error bound of a cone's border counts as
 *  in the co-cone. */
typedef enum { BRIO_SIDE_COCONE = 0, BRIO_SIDE_POLE = 1, BRIO_SIDE_ANTIPOLE = 2 } brio_side;

/** The Voronoi vertices of a Delaunay triangulation relative to the samples. The index of a tetrahedron names its
 *  Voronoi vertex. The Voronoi vertex of an infinite tetrahedron is infinitely far along the outward normal of the hull
 *  facet. */
typedef struct {
    brio_tetrahedra t; /* vertices are the caller's indices; has no records */
    size_t num_finite, num_points, num_vertices;
    const double *points;
    double theta;    /* half the opening of the co-cones */
    double *centre;  /* #T by 4: for a finite tetrahedron the circumcentre and its squared distance from the vertices,
                       NaN where doubles cannot hold the centre; for an infinite one the unit direction and 1 */
    double *plane;   /* #P by 4: the axis and minus the dot product of the axis and the sample. The axis is the unit
                       vector from the sample to the farther pole. On the hull the axis is the sum of the unit outward
                       normals of the sample's hull facets, made a unit vector. Zero for points that are not vertices */
    uint32_t *pole;  /* #P by 2: the farther pole (on the hull an infinite tetrahedron) and the farthest Voronoi vertex
                       on the other side of the sample; BRIO_INFINITE where there is none */
    uint16_t *sides; /* #T: where the Voronoi vertex lies relative to the sample in each slot i.
                        bit i:             in the cone to the pole
                        bit 4 + i:         in the opposite cone
                        bits 8 + i, 12 + i: the lower and the upper bit of brio_depth_class */
} brio_pole_vectors;

/** Fills *out.   theta  in (0, pi/2).   t and points must outlive *out. The caller frees *out with
 *  brio_pole_vectors_free, on failure too. The positions of the centres break ties between equally far Voronoi
 *  vertices, then the positions of the vertices. Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, double theta, brio_pole_vectors *out);

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v);

/** Frees the centres, planes and poles: some 260 bytes a sample of a surface. The sides, 14, stay. */
void brio_pole_vectors_drop(brio_context *ctx, brio_pole_vectors *v);

/** Writes the row of `centre` of a tetrahedron; computes it, with the same bits, if the centres were freed. */
void brio_centre_row(const brio_pole_vectors *v, size_t tet, double row[4]);

/** Writes the vector from p to the Voronoi vertex of a tetrahedron; for an infinite tetrahedron, the unit direction. */
static inline void brio_towards_centre(const brio_pole_vectors *v, size_t tet, size_t p, double to[3]) {
    assert(tet < v->t.count && p < v->num_points && v->centre);
    const double *c = v->centre + 4 * tet, *from = v->points + 3 * p;
    bool ray = tet >= v->num_finite;
    for (int k = 0; k < 3; k++) to[k] = ray ? c[k] : c[k] - from[k];
}

/** Decode `sides`: bit i of the result belongs to slot i. The first returns the slots whose cone to the pole holds the
 *  Voronoi vertex, the second the slots whose opposite cone holds it. The third returns the slots whose depth class is
 *  the worst, BRIO_DEPTHS - 1. */
static inline unsigned brio_pole_slots(unsigned sides) {
    return sides & 15;
}
static inline unsigned brio_antipole_slots(unsigned sides) {
    return sides >> 4 & 15;
}
static inline unsigned brio_shallow_slots(unsigned sides) {
    return sides >> 8 & sides >> 12 & 15;
}

/** Returns the two side bits of a slot, of which at most one is set: bit 0 for the cone to the pole, bit 4 for the
 *  opposite cone. */
static inline unsigned brio_slot_sides(unsigned sides, int slot) {
    assert(0 <= slot && slot < 4);
    return sides >> slot & 0x11;
}

static inline int brio_side_of(const brio_pole_vectors *v, size_t tet, int slot) {
    assert(tet < v->t.count && 0 <= slot && slot < 4);
    int bits = v->sides[tet] >> slot;
    return (bits & 1) | (bits >> 3 & 2);
}

enum { BRIO_DEPTHS = 4 };

/** Returns how many of 1/16, 1/8 and 1/4 are below the sine of the angle between the direction to a Voronoi vertex and
 *  the axis of the sample in a slot. */
static inline int brio_depth_class(const brio_pole_vectors *v, size_t tet, int slot) {
    assert(tet < v->t.count && 0 <= slot && slot < 4);
    int bits = v->sides[tet] >> (8 + slot);
    return (bits & 1) | (bits >> 3 & 2);
}

#endif
