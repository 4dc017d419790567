/* Voronoi vertices, and the direction of each sample's pole. */
#ifndef BRIO_DUAL_POLE_VECTORS_H
#define BRIO_DUAL_POLE_VECTORS_H

#include "base/context.h"
#include "triangulation/tetrahedra.h"

/** The dual of a Delaunay triangulation, as far as a sample sees its surface by it. A Voronoi vertex is named by its
 *  tetrahedron; that of an infinite tetrahedron lies infinitely far along the outward normal of the hull facet. */
typedef struct {
    brio_tetrahedra t; /* caller's indices; without records */
    size_t num_finite, num_points;
    const double *points;
    double *centre; /* #T by 3; of an infinite tetrahedron the unit direction; NaN where doubles cannot hold it */
    double *error;  /* #T: bounds the error of each coordinate; of a direction too */
    double *vector; /* #P by 3, unit: from the sample to the farther pole or, on the hull, the sum of the unit outward
                       normals of its hull facets; zero for points that are no vertices */
    uint32_t *pole; /* #P by 2: the farther pole (on the hull an infinite tetrahedron) and the farthest Voronoi vertex
                       on its other side; BRIO_INFINITE where there is none */
} brio_pole_vectors;

/** Finds them. t and points must outlive the result; what it holds is to be freed on failure too. Ties go by the
 *  lexicographically largest centre. Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_pole_vectors_find(brio_context *ctx, const brio_triangulation *t, const double *points,
                                   size_t num_points, brio_pole_vectors *out);

void brio_pole_vectors_free(brio_context *ctx, brio_pole_vectors *v);

/** What points from p to the Voronoi vertex of a tetrahedron: their difference, or the direction of a ray. */
static inline void brio_towards_centre(const brio_pole_vectors *v, size_t tet, size_t p, double to[3]) {
    const double *c = v->centre + 3 * tet, *from = v->points + 3 * p;
    bool ray = tet >= v->num_finite;
    for (int k = 0; k < 3; k++) to[k] = ray ? c[k] : c[k] - from[k];
}

#endif
