/* brio/medial.h: the medial axis of points on a surface: by the power shape of its poles, or by facets of their Voronoi
 * diagram. */
#ifndef BRIO_MEDIAL_H
#define BRIO_MEDIAL_H

#include "surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Sides of a surface. */
typedef enum brio_sides { BRIO_SIDES_INNER = 0, BRIO_SIDES_OUTER = 1, BRIO_SIDES_BOTH = 2, BRIO_SIDES_END } brio_sides;

typedef struct brio_power_shape_options {
    size_t size;
    brio_noise noise;        /* what to do about noisy points */
    brio_sides sides;        /* whose poles make the shape */
    uint64_t seed;           /* every random choice follows from it */
    brio_pole_options poles; /* how the poles are found and labeled */
    /* Simplification leaves out a ball if a larger ball of the same side */
    double scale;      /* S > 1: contains it after the radii of both are multiplied by S, for noise; 0: none */
    double redundancy; /* E > 0: contains it after the larger radius grows by E times itself; 0: none */
    /* S > 1: leaves out, before these two, balls that lie in the union of the other balls of their side after all radii
     * are multiplied by S: the scale axis; 0: none. This came later. */
    double scale_axis;
} brio_power_shape_options;

typedef struct brio_power_shape_stats {
    size_t size;
    brio_pole_stats poles;               /* before simplification */
    size_t unlabeled;                    /* poles without a label; 0 with every labeling there is */
    size_t left_out;                     /* poles that simplification left out */
    size_t edges, triangles, tetrahedra; /* of the shape */
    size_t samples;                      /* distinct positions */
    double noise;                        /* AUTO: the standard deviation of the noise found, in spacings; 0: none */
    size_t smoothed;                     /* 1: the points were smoothed */
    double noise_seconds, delaunay_seconds, poles_seconds, simplify_seconds, shape_seconds;
} brio_power_shape_stats;

/** Computes the power shape of samples of a surface, an approximation of its medial axis. Its vertices are the poles on
 *  the chosen sides that have a power cell; its edges, triangles and tetrahedra are those of the regular triangulation
 *  of the poles whose vertices are all on one side. The inner shape is homotopy equivalent to the union of the inner
 *  cells: unless an inner pole is on the hull of the poles, its Euler characteristic (vertices - edges + triangles -
 *  tetrahedra) is that of the solid inside the power crust. As samples of a smooth surface get denser, their poles
 *  converge to the medial axis. Poles of the bounding points around the samples are not part of the shape.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or receives what was found.
 *  shape    owned by the caller: vertices with the properties "radius" (float64) and "side" (int8: -1 inner, 1 outer),
 *           edges, triangles as faces, positive tetrahedra.
 *  crust    NULL, or receives the power crust of the balls that simplification left: closed, manifold, oriented; owned
 *           by the caller.
 *  Simplification leaves a larger ball within max((S - 1) (R - r), E R) of every ball that it leaves out, r being the
 *  radius of the smaller and R of the larger ball. It leaves out balls without a power cell first; these lie within the
 *  union of the others. The scale axis leaves out the balls that reach no place of the boundary of the union of the
 *  scaled balls, except what is needed so that this union has no voids without them; those that stay keep their radii.
 *  Cost: as BRIO_SURFACE_POWER_CRUST; with simplification, one more triangulation of the poles; with the
 *  scale axis, three more.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid, no pole is on a chosen side, doubles cannot hold a
 *  vertex, or the mesh `solid` is not closed), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] section 3.3.2, [Miklos Giesen Pauly 2010]. */
BRIO_API brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                                      brio_power_shape_stats *stats);

typedef struct brio_voronoi_axis_options {
    size_t size;
    brio_noise noise;       /* what to do about noisy points */
    brio_sides sides;       /* of the surface: where the axis is wanted */
    const brio_mesh *solid; /* a closed mesh that says what is inside, or NULL: the surface of the points does */
    double theta;           /* of the angle condition, in radians, below pi / 2; 0: pi / 8 */
    double rho;             /* of the ratio condition; 0: 8 */
    uint64_t seed;          /* every random choice follows from it */
} brio_voronoi_axis_options;

typedef struct brio_voronoi_axis_stats {
    size_t size;
    size_t samples;            /* distinct positions */
    size_t edges;              /* Delaunay edges that are on no umbrella of their ends */
    size_t by_angle, by_ratio; /* of these, edges that fulfil the condition at one of their ends */
    size_t facets;             /* of the Voronoi diagram: faces of the result */
    size_t across, unbounded;  /* chosen facets with vertices on both sides, and that are not bounded: left out */
    double noise;              /* AUTO: the standard deviation of the noise found, in spacings; 0: none */
    size_t smoothed;           /* 1: the points were smoothed */
    double surface_seconds, delaunay_seconds, choose_seconds, label_seconds;
} brio_voronoi_axis_stats;

/** Approximates the medial axis of a sampled surface by a part of the Voronoi diagram of the samples, without a power
 *  diagram. The umbrella of a sample is its Delaunay triangles whose Voronoi edges cross the plane through the sample
 *  that is normal to the direction to its pole. A Voronoi facet, whose Delaunay edge is pq, is taken if pq is on no
 *  umbrella and, at p or at q, either
 *    the angle condition holds: pq makes less than pi / 2 - theta with the normal of each triangle of the umbrella, or
 *    the ratio condition holds: pq is longer than rho circumradii of each triangle of the umbrella.
 *  As samples of a smooth surface get denser, the facets converge to its medial axis, for theta and rho that do not
 *  change: no value has to be chosen for the model.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or receives what was found.
 *  out      owned by the caller: Voronoi vertices with the properties "radius" (float64: the distance to the samples)
 *           and "side" (int8: -1 inner, 1 outer), and the facets as faces, convex polygons in no common orientation.
 *           Facets with vertices on both sides of the surface, and facets without end, are not part of it.
 *  Cost: without `solid`, the surface of the points with BRIO_SURFACE_LABELED first; a triangulation, and about 600
 *  bytes a sample beside it; one winding number a vertex of the result.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (options out of range), BRIO_ERR_NO_ANSWER (the samples span no solid, no facet
 *  is taken, or the mesh `solid` is not closed), and as brio_delaunay.
 *  Based on: [Dey Zhao 2004]. */
BRIO_API brio_status brio_voronoi_axis(brio_context *ctx, const double *points, size_t num_points,
                                       const brio_voronoi_axis_options *options, brio_mesh **out,
                                       brio_voronoi_axis_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
