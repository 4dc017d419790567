/* The boundary of a union of balls, taken apart: patches of spheres, arcs of the circles where two spheres meet, and
 * corners where three do. */
#ifndef BRIO_BALLS_UNION_BOUNDARY_H
#define BRIO_BALLS_UNION_BOUNDARY_H

#include "base/context.h"
#include "triangulation/tetrahedra.h"

enum { BRIO_NO_CORNER = UINT32_MAX };

/** A point of the boundary on three spheres. */
typedef struct {
    double place[3];
    uint32_t ball[3]; /* turning counterclockwise seen from outside the union */
    uint32_t arc[3];  /* arc[k] ends here; it is on the spheres of the two balls other than ball[k] */
} brio_corner;

/** A part of the circle on two spheres. It turns counterclockwise about the axis from ball[0] to ball[1]. */
typedef struct {
    uint32_t ball[2], patch[2]; /* patch[s]: the patch of ball[s] that the arc bounds */
    uint32_t corner[2];         /* where it begins and ends; BRIO_NO_CORNER both: a whole circle */
    double angle;               /* from 0 to 2 pi */
} brio_arc;

/** A boundary, and the dual complex that it was read from: the simplices of the regular triangulation whose power faces
 *  meet the union. Lengths are the caller's times 2^-exponent.
 *  I1  The complex has with a simplex all its faces. So the boundary of its regular neighbourhood is a closed manifold
 *      for whatever values rounding leaves, and patches, arcs and corners are a cell decomposition of that manifold.
 *  I2  All centres are inside the hull of the helpers, which are points of negative weight: so no tetrahedron of a ball
 *      is infinite, and none of a helper is in the complex. */
typedef struct {
    brio_context *ctx;
    size_t num_balls;  /* those with a positive weight */
    uint32_t *of_ball; /* #balls: the caller's index */
    double *centre;    /* #balls + helpers, by 3 */
    double *weight;    /* #balls + helpers: squared radii, negative for helpers */
    int exponent;
    brio_triangulation *triangulation;
    brio_tetrahedra t;
    size_t num_finite;
    uint8_t *tet_in;     /* #finite: 1 for the tetrahedra of the complex */
    uint8_t *facet_in;   /* 4 #finite, by facet handle */
    uint8_t *ball_in;    /* #balls: 1 for vertices of the complex */
    uint32_t *corner_at; /* 4 #finite: the corner of a facet of the complex on the side of a tetrahedron outside */
    brio_corner *corner;
    brio_arc *arc;
    uint32_t *patch; /* #patches: the ball of each */
    size_t num_corners, num_arcs, arc_capacity, num_patches;
    size_t components, voids; /* of the union; of its complement, the outside not counted */
    int64_t euler;            /* the Euler characteristic of the union */
} brio_union_boundary;

/** Finds the boundary of the union of balls.   weights  #P squared radii; where they are 0 or less there is no ball.
 *  b  freed with brio_union_boundary_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (there is no ball), and as brio_delaunay and brio_alpha_values. */
brio_status brio_union_boundary_find(brio_context *ctx, const double *centres, const double *weights, size_t num_points,
                                     uint64_t seed, brio_union_boundary *b);

void brio_union_boundary_free(brio_union_boundary *b);

/** Returns how far the plane of the circle of balls i and j is from the centre of i towards that of j.
 *  axis  receives the unit vector from i to j.   distance  receives that of the centres. */
double brio_circle_plane(const brio_union_boundary *b, uint32_t i, uint32_t j, double axis[3], double *distance);

/** Makes the mesh of the boundary in an empty mesh, in the caller's unit: see brio_ball_union. */
brio_status brio_union_mesh(const brio_union_boundary *b, double error, brio_mesh *mesh);

/* --- one patch --- */

/** A mesh of triangles that grows. */
typedef struct {
    brio_context *ctx;
    double *place;     /* #vertices by 3 */
    uint32_t (*on)[3]; /* #vertices: the balls on whose spheres it is, BRIO_NO_CORNER for none */
    uint32_t *corners; /* three for each triangle */
    uint32_t *of_ball; /* one for each triangle */
    size_t num_vertices, place_capacity, on_capacity, num_corners, corner_capacity, num_triangles, ball_capacity;
} brio_growing_mesh;

/** Where a patch lies. Its cycles have it on their left, seen from outside the ball. */
typedef struct {
    uint32_t ball;
    const double *centre;
    double radius;
    double covered[3];       /* the direction from the centre to a place of the sphere outside the patch */
    double longest;          /* triangles have no longer edges inside the patch */
    const uint32_t *vertex;  /* the cycles, one after the other; none: the patch is the whole sphere */
    const size_t *cycle_end; /* #cycles */
    size_t num_cycles;
} brio_patch_outline;

/** Adds a vertex to a mesh. */
brio_status brio_grow_vertex(brio_growing_mesh *m, const double place[3], const uint32_t on[3], uint32_t *number);

/** Finds the edges of cycles that cross another one, in the plane in which the patch is cut into triangles.
 *  crossing  for each vertex of the cycles: set to 1 if the edge from it to the next one crosses, else to 0. */
brio_status brio_patch_crossings(brio_growing_mesh *m, const brio_patch_outline *outline, uint8_t *crossing);

/** Adds the triangles of a patch to a mesh, and the vertices inside the patch. The triangles have each edge of the
 *  cycles once and other edges twice; no other edge has two ends on the circle of one other ball. */
brio_status brio_patch_triangles(brio_growing_mesh *m, const brio_patch_outline *outline);

#endif
