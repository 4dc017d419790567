/* brio/plane.h: triangulations of points in the plane, their queries and Voronoi diagrams.
 *
 * The words and promises above hold here, with triangles instead of tetrahedra, edges instead of facets and circles
 * instead of spheres. Constrained edges and refinement are not offered.
 */
#ifndef BRIO_PLANE_H
#define BRIO_PLANE_H

#include "queries.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A triangle: its three vertices as indices of points, and three mates. The handle 4*t + i names the edge of triangle
 *  t opposite to vertex i: triangle handle / 4, slot handle % 4 (0 to 2). mate[i] is the handle of the edge opposite to
 *  vertex[i], seen from the triangle on its other side. As an array of numbers: six to a triangle. */
typedef struct {
    uint32_t vertex[3], mate[3];
} brio_triangle;

typedef struct brio_delaunay2_options {
    size_t size;
    double round_ratio; /* share of the points left for the rounds before the last one, below 1; 0: 1/8 */
    uint64_t seed;      /* every random choice follows from it */
    brio_order order;   /* came later. Insertion order, of which the triangles do not depend. Orders but BRIO_ORDER_BRIO
                           take 24 bytes a point more */
    int reserved_int;
} brio_delaunay2_options;

/** Facts of a triangulation of the plane. Counters are totals over the construction and include infinite triangles. */
typedef struct brio_delaunay2_stats {
    size_t size;
    size_t points, vertices, duplicates, hidden;
    int dimension;     /* of the affine hull of the points: -1 (no points) to 2 */
    int coordinates;   /* of a point: 2 from brio_delaunay2, 3 from brio_delaunay2_flat */
    size_t triangles;  /* finite ones of the result */
    size_t hull_edges; /* = infinite triangles of the result */
    uint64_t created, destroyed, walk_steps, incircle_calls;
    uint64_t exact_calls; /* calls of predicates that the floating-point filter did not settle */
    double order_seconds, insert_seconds;
} brio_delaunay2_stats;

typedef struct brio_triangulation2 brio_triangulation2;

/** Builds the Delaunay triangulation of points in the plane or, with weights, the regular triangulation. Every finite
 *  input has a result. Points on a line have no triangles, but brio_triangulation2_line; ties are broken as in three
 *  dimensions. One thread works.
 *  points   #P by 2, row after row.   weights  #P, or NULL.   num_points  less than 2^29 - 16.
 *  options  NULL for the defaults.    out      owned by the caller, freed with brio_triangulation2_free; NULL on error.
 *  Cost: expected O(n log n) time for points of realistic inputs. Memory: 88 bytes a point, with weights at most
 *  98; of the result 52 a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Bowyer 1981], [Watson 1981]; [Amenta Choi Rote 2003] for the order, [Devillers Teillaud 2011] for
 *  ties. */
BRIO_API brio_status brio_delaunay2(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                    const brio_delaunay2_options *options, brio_triangulation2 **out);

/** Builds the same for points in space that lie in one plane, exactly: inputs for which brio_delaunay returns dimension
 *  2 or less and no tetrahedra. Circles and weights are those of the plane in space, and representatives are those of
 *  brio_delaunay. Triangles are counterclockwise as seen from the side to which the plane's normal points; of the two
 *  normals the one whose last coordinate that is not 0 is positive. So a plane of constant z is seen as its x and y are
 *  by brio_delaunay2.
 *  points   #P by 3.
 *  Returns what brio_delaunay2 returns, and BRIO_ERR_NO_ANSWER when the points are not in one plane (the message names
 *  one that is off it). */
BRIO_API brio_status brio_delaunay2_flat(brio_context *ctx, const double *points, const double *weights,
                                         size_t num_points, const brio_delaunay2_options *options,
                                         brio_triangulation2 **out);

/** A plane of space with two coordinates: those of p are the products of p - origin with the axes. */
typedef struct brio_plane_frame {
    size_t size;
    int dimension; /* of the points it was made of: -1 (none), 0, 1 (axis[1] is 0), 2, or 3 for points off the plane */
    double origin[3];  /* 0 where two coordinates of space are taken as they are */
    double axis[2][3]; /* unit vectors, orthogonal */
    double thickness;  /* the greatest distance of a point from the plane, or from the line */
} brio_plane_frame;

/** Finds the plane of points in space: the one that they are in, up to 2^-49 of the greatest coordinate, or that of
 *  least squares of their distances. Points on a line and at one position, up to the same rounding, are of dimension 1
 *  and 0. Does not depend on the order of the points. In a plane of constant z the coordinates are x and y, of constant
 *  x or y the two after it, cyclically, exactly.
 *  points  #P by 3.   frame  zeros at first.
 *  Cost: O(n), for points off a plane O(n log n). Memory: 24 bytes a point, for points off a plane 44.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an impossible size), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY. Based on: [Pearson 1901]. */
BRIO_API brio_status brio_plane_fit(brio_context *ctx, const double *points, size_t num_points,
                                    brio_plane_frame *frame);

/** Writes the coordinates of points in the plane, or of their projections to it.   points  #P by 3.   out  #P by 2. */
BRIO_API void brio_plane_project(const brio_plane_frame *frame, const double *points, size_t num_points, double *out);

/** Frees a triangulation of the plane; NULL is accepted. */
BRIO_API void brio_triangulation2_free(brio_triangulation2 *t);

/** Returns the facts of a triangulation. The view is valid until the triangulation is freed. */
BRIO_API const brio_delaunay2_stats *brio_triangulation2_stats(const brio_triangulation2 *t);

/** Returns the triangles + hull_edges triangles, finite ones first. A finite triangle is counterclockwise. An infinite
 *  triangle (a, b, BRIO_INFINITE) has the hull edge ab, and (a, b, x) is counterclockwise for x outside the hull. The
 *  view is valid until the triangulation is freed. */
BRIO_API const brio_triangle *brio_triangulation2_triangles(const brio_triangulation2 *t);

/** Returns #P indices: for each point the vertex that represents it, which is the point itself if it is a vertex. The
 *  view is valid until the triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation2_representatives(const brio_triangulation2 *t);

/** Returns the hash of the points and weights that the triangulation was made of, as brio_points_hash has it. */
BRIO_API uint64_t brio_triangulation2_points_hash(const brio_triangulation2 *t);

/** Returns the vertices of points on a line, in lexicographic order, each joined to the next by an edge of the
 *  triangulation; NULL and 0 for other dimensions than 1. The view is valid until the triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation2_line(const brio_triangulation2 *t, size_t *count);

/** Checks a triangulation of the plane exactly and completely against its points. It passes if and only if it is the
 *  result of brio_delaunay2 (brio_delaunay2_flat), up to the order of the finite triangles, the order of the infinite
 *  ones, and rotations of the vertices of a triangle. What is checked is what brio_triangulation_check checks, one
 *  dimension lower.
 *  points, weights, num_points  as they were given.
 *  Cost: O(t) for t triangles, and one walk for each point that is no vertex; points on a line are triangulated again.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (the triangulation has
 *  another number of points), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation2_check(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                               const double *weights, size_t num_points);

/** Computes a hash of the set of triangles in terms of the lexicographic ranks of their vertices; of points on a line,
 *  a hash of their number of vertices. It does not depend on the order of points or triangles, and stays the same when
 *  all points are scaled by a power of two.
 *  points  as they were given.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation2_checksum(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                                  uint64_t *checksum);

/* Queries of a triangulation of the plane. What is said of brio_locator and of its queries holds here, with `queries`
 * #Q by 2, but queries are not sorted. Only NATURAL takes workspace: for each thread, lists as long as its largest
 * cavity. */

typedef struct brio_locator2 brio_locator2;

/** Makes a locator of a triangulation of the plane. It needs neither the triangulation nor the points afterwards.
 *  points, weights, num_points  as they were given to brio_delaunay2; triangulations by brio_delaunay2_flat are
 *                               refused.
 *  out  owned by the caller, freed with brio_locator2_free; NULL on error. Several threads, each with a context of its
 *       own, may query one locator.
 *  Memory: 25 bytes a triangle and 36 a point, for points on a line 36 a point.   Cost: O(n).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation, or they are points in space),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_locator2_new(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                       const double *weights, size_t num_points, brio_locator2 **out);

/** Frees a locator; NULL is accepted. */
BRIO_API void brio_locator2_free(brio_locator2 *locator);

/** Finds the triangle that holds each query: the finite one of lowest index whose closure holds it.
 *  triangles  #Q: indices of brio_triangulation2_triangles; BRIO_INFINITE for a query strictly outside the convex hull,
 *             and for every query if the points have dimension 1 or less. Queries on the hull's boundary are inside.
 *  Cost: one walk; a few steps where points are spread evenly. For a query at a vertex, O(triangles at that vertex).
 *  Based on: [Devillers Pion Teillaud 2002]. */
BRIO_API brio_status brio_locator2_triangles(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                             size_t num_queries, uint32_t *triangles);

/** Finds the vertex of least power distance |x - p|^2 - w from each query x; without weights, the nearest vertex. Ties
 *  are lexicographic. Works in every dimension.
 *  vertices  #Q: indices of points that are vertices; BRIO_INFINITE if there are no points.
 *  Cost: one walk, and a descent along edges from there. */
BRIO_API brio_status brio_locator2_least_power(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                               size_t num_queries, uint32_t *vertices);

/** Interpolates values at the vertices, at each query, as brio_locator_interpolate does: NATURAL weighs the natural
 *  neighbours of the query x by the areas that the Voronoi cell of x would take from their cells.
 *  Points on a line, up to the rounding of their coordinates, are interpolated linearly along the line: queries are
 *  projected to it.
 *  results  #Q by components: NaN for queries outside the hull, and for every query if there are no points.
 *  Returns also BRIO_ERR_ARGUMENT (options out of range, no values, NATURAL of a triangulation with weights), and
 *  BRIO_ERR_NO_ANSWER if all points are at one position.
 *  Based on: [Sibson 1980], [Sibson 1981]. */
BRIO_API brio_status brio_locator2_interpolate(brio_context *ctx, const brio_locator2 *locator, const double *queries,
                                               size_t num_queries, const brio_interpolation *options, double *results);

/** The Voronoi diagram of points in the plane or, with weights, their power diagram. Triangles with one circle, decided
 *  exactly, have one vertex. */
typedef struct brio_diagram2 {
    size_t size;
    size_t num_vertices, num_triangles, num_points;
    double *vertices;          /* #V by 2: the centres of the circles, in the order of their first triangles */
    uint32_t *triangle_vertex; /* #T: of each finite triangle, the vertex at the centre of its circle */
    uint64_t *offsets;         /* #P + 1: the region of point p is items[offsets[p]] to items[offsets[p + 1] - 1] */
    uint32_t *items; /* vertices, counterclockwise, each once; BRIO_INFINITE first in an unbounded region. Points
                                  that are no vertices of the triangulation have no items. */
    brio_context *context;
} brio_diagram2;

/** Computes the Voronoi diagram from a triangulation. Points of dimension 1 or less have no vertices and empty regions.
 *  points, weights, num_points  as they were given to brio_delaunay2; triangulations by brio_delaunay2_flat are
 *                               refused.
 *  out  owned by the caller, freed with brio_diagram2_free; NULL on error.
 *  A vertex is wrong by at most 2^-44 times its distance from the points, plus one rounding; NaN where doubles cannot
 *  hold it. The bits of a vertex of three points depend on their positions alone.
 *  Cost: O(n). Memory: 4 bytes a triangle, 16 a vertex, 8 a point and 4 an item; meanwhile 36 a point more.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the points are not those of the triangulation, or they are points in space),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Aurenhammer 1987]. */
BRIO_API brio_status brio_voronoi2(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                   const double *weights, size_t num_points, brio_diagram2 **out);

/** Frees a diagram with all its arrays; NULL is accepted. */
BRIO_API void brio_diagram2_free(brio_diagram2 *diagram);

#ifdef __cplusplus
}
#endif
#endif
