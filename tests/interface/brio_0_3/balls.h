/* brio/balls.h: unions of balls: their volume, their surface, and which balls reach it. */
#ifndef BRIO_BALLS_H
#define BRIO_BALLS_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_ball_union_options {
    size_t size;
    double error;  /* of the mesh: most distance of a triangle from the sphere of its ball, and of an edge on an arc
                      from the arc; 0: a thousandth of the diagonal of the box of the balls */
    uint64_t seed; /* every random choice follows from it */
} brio_ball_union_options;

typedef struct brio_ball_union_stats {
    size_t size;
    size_t balls;                  /* with a positive weight */
    size_t exposed;                /* balls whose spheres are partly on the boundary */
    size_t patches, arcs, corners; /* of the boundary: on one, two and three spheres */
    size_t components;             /* of the union */
    size_t tunnels, voids;         /* the other Betti numbers: handles, and hollows that the union encloses */
    double volume, area;           /* of the union and of its boundary, by formulas */
    double error;                  /* of the mesh, as it was given or chosen */
    double delaunay_seconds, measure_seconds, mesh_seconds;
} brio_ball_union_stats;

/** Computes the union of balls: its volume, its area, and its boundary as a mesh.
 *  The volume is that of the dual complex, whose simplices are those of the regular triangulation whose power faces
 *  meet the union, and of what lies beyond: cones of patches less the lenses of arcs. No term is larger than the balls,
 *  and only balls on the boundary have terms, so it is right to a few units in the last place times their number.
 *  The mesh is closed, manifold and oriented for any balls; voids have surfaces, too. Its vertices are on the spheres,
 *  and each triangle is within options.error of its ball's sphere. Where spheres meet in one point within rounding, as
 *  polar balls do at each sample, the mesh has triangles and edges of length about 0.
 *  centres  #P by 3.   weights  #P: squared radii; where they are 0 or less there is no ball.
 *  options  NULL for the defaults.
 *  areas    #P, or NULL: receives the area of each ball on the boundary.
 *  out      NULL: no mesh; or receives it, owned by the caller. The faces have the property "ball" (uint32), the index
 *           of their ball.
 *  stats    NULL, or receives what was found.
 *  Does not guarantee: that no triangles of the mesh cross, where arcs are nearer to each other than options.error.
 *  Cost: a regular triangulation of the balls and its alpha filtration; then linear in the boundary, except for the
 *  square of the points of one patch. Memory: as these two, and 100 bytes a tetrahedron.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the error is negative), BRIO_ERR_NO_ANSWER (there is no ball), and what
 *  brio_delaunay and brio_alpha_values return.
 *  Based on: [Edelsbrunner 1995]. */
BRIO_API brio_status brio_ball_union(brio_context *ctx, const double *centres, const double *weights, size_t num_points,
                                     const brio_ball_union_options *options, double *areas, brio_mesh **out,
                                     brio_ball_union_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
