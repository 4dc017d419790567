/* brio/medial.h: the medial axis of points on a surface, by the power shape of its poles. */
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
 *  union of the others.
 *  Cost: as BRIO_SURFACE_POWER_CRUST; with simplification, one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid, no pole is on a chosen side, doubles cannot hold a
 *  vertex, or the mesh `solid` is not closed), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] section 3.3.2, [Miklos Giesen Pauly 2010]. */
BRIO_API brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                                      brio_power_shape_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
