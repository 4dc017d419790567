/* brio/offset.h: what else poles give: offset surfaces and medial axes; and offsets of meshes. */
#ifndef BRIO_OFFSET_H
#define BRIO_OFFSET_H

#include "surface.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_offset_surface_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    int triangulate;         /* as in brio_power_crust_options */
    int simplify;            /* as in brio_power_crust_options */
} brio_offset_surface_options;

BRIO_API void brio_offset_surface_options_init(brio_offset_surface_options *options, size_t size);
static inline brio_offset_surface_options brio_offset_surface_options_default(void) {
    brio_offset_surface_options options;
    brio_offset_surface_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_offset_surface_stats {
    size_t size;
    brio_pole_stats poles; /* of the balls that are left after the offset */
    double crust_seconds, simplify_seconds;
} brio_offset_surface_stats;

/** Computes the offset of the power crust of the samples: the surface at `distance` outside it or, for a negative
 *  distance, inside it. Parts of an offset that meet are merged, and parts of the object that are too thin vanish.
 *  Guarantees: as the power crust, closed, manifold and oriented for every distance. The error of the offset is that of the
 *  polar balls as an approximation of the maximal balls.
 *  Points of a surface only: of a mesh with faces, brio_mesh_offset computes the offset.
 *  distance  in the unit of the points, at most 2^60 times their greatest coordinate.   options  NULL for the defaults.
 *  out       owned by the caller.   stats  NULL, or its `size` set.
 *  Cost: as brio_power_crust, and one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no inside found, doubles cannot hold a vertex, or an inward offset leaves
 *  nothing), and as brio_delaunay.
 *  Based on: [Choi 2003] section 3.3.4. */
BRIO_API brio_status brio_offset_surface(brio_context *ctx, const double *points, size_t num_points, double distance,
                                         const brio_offset_surface_options *options, brio_mesh **out,
                                         brio_offset_surface_stats *stats);

typedef struct brio_mesh_offset_options {
    size_t size;
    double
        error; /* most distance of the result from the exact offset, in the unit of the mesh, above 0 and less than the
                        offset's distance; default 0: a hundredth of that */
} brio_mesh_offset_options;

BRIO_API void brio_mesh_offset_options_init(brio_mesh_offset_options *options, size_t size);
static inline brio_mesh_offset_options brio_mesh_offset_options_default(void) {
    brio_mesh_offset_options options;
    brio_mesh_offset_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_mesh_offset_stats {
    size_t size;
    size_t samples; /* points of the exact offset that were found */
    size_t rounds;  /* in which they were triangulated */
    double
        error; /* as it is proven: no place of the result is nearer to the mesh, or farther from it, than the distance by
                          more than this. At most the error asked for, but where the surface could not be mended. */
} brio_mesh_offset_stats;

/** Computes the offset of the solid that a closed mesh bounds: for a positive distance the boundary of all points that are at
 *  most so far from the solid, round about its convex edges and corners and sharp over concave ones; for a negative distance
 *  the boundary of the points of the solid that are at least so far from its surface, sharp at convex edges and round about
 *  concave ones. The faces count, not the vertices: the mesh may be as coarse as it likes. Parts of an offset that meet are
 *  merged; parts of the solid that are too thin vanish, and so do small ones of the offset thinner than twice the error.
 *  Guarantees: closed, manifold, oriented, and free of self-intersections; the vertices are on the exact offset, up to a
 *  fiftieth of the error; the whole surface is within stats.error of it, which is proven for every triangle. The other way
 *  round, no point of a net on the exact offset, half a distance wide, is farther than twice the error from the result. The
 *  net is wider where it would have more than eight million points; what is smaller than the net may be missing. Flat parts
 *  have few triangles.
 *  mesh      closed: each edge, with vertices at one position taken as one, has as many half-edges in one direction as in the
 *            other. Several components, pinched edges and overlapping pieces are allowed.
 *  distance  not 0, in the unit of the mesh.   options  NULL for the defaults.   out  owned by the caller, triangles.
 *  stats     NULL, or its `size` set.
 *  Cost: some ten triangulations of the samples; about 1,100 bytes a sample. There are as many samples as corners of faces
 *  at least, and about 4 pi D / E more for each ball's worth of round parts, for the distance D and the error E.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (an index out of range, a distance that is 0, not finite or more than 2^30 times the
 *  size of the mesh, an error that is not below the distance or too small for doubles); BRIO_ERR_NO_ANSWER (the mesh is not
 *  closed, or an inward offset leaves nothing); BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Boissonnat Oudot 2005]; docs/algorithms.md. */
BRIO_API brio_status brio_mesh_offset(brio_context *ctx, const brio_mesh *mesh, double distance,
                                      const brio_mesh_offset_options *options, brio_mesh **out,
                                      brio_mesh_offset_stats *stats);

/** Sides of a surface. */
typedef enum brio_sides { BRIO_SIDES_INNER = 0, BRIO_SIDES_OUTER = 1, BRIO_SIDES_BOTH = 2, BRIO_SIDES_END } brio_sides;

typedef struct brio_power_shape_options {
    size_t size;
    uint64_t seed;           /* default 1 */
    brio_pole_options poles; /* how the poles are found and labeled */
    brio_sides sides;        /* whose poles make the shape; default BRIO_SIDES_INNER */
    /* Simplification leaves out a ball if a larger ball of the same side */
    double scale;      /* S > 1: contains it after the radii of both are multiplied by S, for noise; default 1: none */
    double redundancy; /* E > 0: contains it after the larger radius grows by E times itself; default 0: none */
} brio_power_shape_options;

BRIO_API void brio_power_shape_options_init(brio_power_shape_options *options, size_t size);
static inline brio_power_shape_options brio_power_shape_options_default(void) {
    brio_power_shape_options options;
    brio_power_shape_options_init(&options, sizeof options);
    return options;
}

typedef struct brio_power_shape_stats {
    size_t size;
    brio_pole_stats poles;               /* before simplification */
    size_t unlabeled;                    /* poles without a label; 0 with every labeling there is */
    size_t left_out;                     /* poles that simplification left out */
    size_t edges, triangles, tetrahedra; /* of the shape */
    double simplify_seconds, shape_seconds;
} brio_power_shape_stats;

/** Computes the power shape of samples of a surface, an approximation of its medial axis. Its vertices are the poles on
 *  the chosen sides that have a power cell; its edges, triangles and tetrahedra are those of the regular triangulation of
 *  the poles whose vertices are all on one side. The inner shape is homotopy equivalent to the union of the inner cells:
 *  unless an inner pole is on the hull of the poles, its Euler characteristic (vertices - edges + triangles - tetrahedra)
 *  is that of the solid inside the power crust. As samples of a smooth surface get denser, their poles converge to the
 *  medial axis. Poles of the bounding points around the samples are not part of the shape.
 *  points   #P by 3.   options  NULL for the defaults.   stats  NULL, or its `size` set.
 *  shape    owned by the caller: vertices with the properties "radius" (float64) and "side" (int8: -1 inner, 1 outer),
 *           edges, triangles as faces, positive tetrahedra.
 *  crust    NULL, or receives the power crust of the balls that simplification left: closed, manifold, oriented; owned by
 *           the caller.
 *  Simplification leaves a larger ball within max((S - 1) (R - r), E R) of every ball that it leaves out, r being the
 *  radius of the smaller and R of the larger ball. It leaves out balls without a power cell first; these lie within the
 *  union of the others.
 *  Cost: as brio_power_crust; with simplification, one more triangulation of the poles.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid, no pole is on a chosen side, doubles cannot hold a vertex, or
 *  the mesh `solid` is not closed), and as brio_delaunay.
 *  Based on: [Amenta Choi Kolluri 2001], [Choi 2003] section 3.3.2, [Miklos Giesen Pauly 2010]. */
BRIO_API brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                                      brio_power_shape_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
