/* brio/shapes.h: convex hulls, restricted Delaunay triangulations, alpha complexes and alpha shapes.
 *
 * Alpha is a squared radius, as in the papers, GUDHI and CGAL. Programs that take a radius (PyVista's delaunay_3d,
 * Open3D, MeshLab) mean its square root: their alpha 0.1 is 0.01 here. Values carry the squared unit of the
 * coordinates.
 */
#ifndef BRIO_SHAPES_H
#define BRIO_SHAPES_H

#include "mesh.h"
#include "plane.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_convex_hull_options {
    size_t size;
    int polygons; /* 1: a facet is one polygon; 0: a facet is a fan of triangles from its first corner */
    int reserved_int;
    uint32_t *samples; /* room for #P indices: receives for each vertex of the mesh the index of its point */
    brio_order order;  /* this and what follows came later. Insertion order, of which the hull does not depend */
    int reserved_int2;
    double round_ratio; /* as in brio_delaunay_options; 0: the order's own */
    uint64_t seed;      /* every random choice follows from it */
} brio_convex_hull_options;

typedef struct brio_convex_hull_stats {
    size_t size;
    size_t points;
    size_t candidates; /* points that were not skipped as certainly inside; the others cost nothing more */
    size_t vertices;   /* strictly extreme positions */
    size_t facets;     /* convex polygons of which the hull consists; at most one lies in a plane */
    int dimension;     /* of the affine hull of the points: -1 (no points) to 3 */
    int reserved_int;
    double skip_seconds, hull_seconds, mesh_seconds;
    uint64_t created, destroyed; /* these and what follows came later. Triangles on the way; 0 for dimensions below 3 */
    uint64_t walk_steps;         /* from triangle to triangle, in search of one that a point is beyond */
    uint64_t beyond_calls;       /* tests of a point against the plane of a triangle */
    uint64_t exact_calls;        /* signs that floating-point arithmetic did not settle */
} brio_convex_hull_stats;

/** Computes the convex hull of a point set, exactly. Vertices are the strictly extreme points, in ascending order of
 *  their indices; points inside a facet or an edge of the hull are none, and of coincident points the one with the
 *  lowest index is the vertex. Facets are convex polygons, counterclockwise as seen from outside; the lexicographically
 *  least vertex of a facet comes first, and the facets are sorted by their first two vertices. So the hull depends on
 *  the points only, not on their order or the number of threads.
 *  Points of dimension 2 have one facet. It is seen counterclockwise from the end of the first of the axes z, x, y that
 *  is not parallel to its plane. Its boundary is open: the hull has area and no inside. Points of dimension 1 have two
 *  vertices and one edge (brio_mesh.edges), points of dimension 0 one vertex, no points none.
 *  points   #P by 3.   num_points  less than 2^32 - 16.   options  NULL for the defaults.
 *  out      owned by the caller.
 *  stats    NULL, or receives what was found.
 *  Cost: three passes over the points, in which those inside a polytope of 26 extreme points are skipped, with all
 *  threads; expected O(c log c) time for the c candidates that are left, with one thread. Memory: 4 bytes a point, and
 *  about 80 a candidate and 90 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE (2^30 triangles or more),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Akl Toussaint 1978] for the points inside, [Clarkson Shor 1989], [Amenta Choi Rote 2003]. */
BRIO_API brio_status brio_convex_hull(brio_context *ctx, const double *points, size_t num_points,
                                      const brio_convex_hull_options *options, brio_mesh **out,
                                      brio_convex_hull_stats *stats);

/** What was found of the Voronoi diagram of the samples on the surface. */
typedef struct brio_restricted_stats {
    size_t size;
    size_t cells, facets, edges;             /* of the Voronoi diagram that meet the surface */
    size_t bad_cells, bad_facets, bad_edges; /* those that meet it in no closed ball: not in one disk, arc, or point */
    size_t crossings;                        /* points where the surface meets edges of the Voronoi diagram */
    uint64_t exact_calls, ties; /* signs that floating-point arithmetic did not settle; those that were 0 */
    int closed_ball;            /* 1: all cells, facets and edges that meet the surface meet it in a closed ball */
    int reserved_int;
    double delaunay_seconds, cut_seconds;
} brio_restricted_stats;

/** Computes the restricted Delaunay triangulation of samples on a known surface: the Delaunay triangles whose Voronoi
 *  edges meet the surface. Which cells, facets and edges of the Voronoi diagram do is decided exactly.
 *  Guarantees: if stats->closed_ball is 1, the triangles are homeomorphic to the surface [Edelsbrunner Shah 1997]. That
 *  is a proof for these samples and this mesh; it asks for no bound on the density. If it is 0, they may still be.
 *  Ties are decided as if the surface were moved by (e, e^2, e^3) for an infinitely small e > 0, and the samples by
 *  less, as brio_delaunay does. So the answer is that for a surface and samples as near as one likes to these.
 *  Does not guarantee: that the samples are an r-sample. A mesh has local feature size 0 at its edges, so no finite set
 *  is an r-sample of it. The samples need not lie on the surface.
 *  points   #P by 3: the samples.   surface  triangles that form a closed manifold; it may cross itself, and have any
 *  number of components.
 *  out      owned by the caller, NULL on error. Its vertices are the samples, with the same indices, also those that no
 *           triangle uses. Each triangle is oriented as the face that its Voronoi edge meets. The property
 *           "closed_ball" is 1 at a sample whose cell, and all whose facets and edges, meet the surface in closed balls
 *           or not at all.
 *  stats    NULL, or receives what was found.
 *  Cost: one triangulation; then, for each face of the surface and each cell that it meets, a test of the Voronoi edges
 *  of that cell, mostly in doubles. Memory: 60 bytes a face and 40 a piece of one, beside the triangulation and 60
 *  bytes a tetrahedron. Returns BRIO_OK, BRIO_ERR_ARGUMENT (the surface is not closed, no manifold, or not of
 *  triangles), BRIO_ERR_NO_ANSWER (the samples are in a plane), and as brio_delaunay.
 *  Based on: [Edelsbrunner Shah 1997], [Choi 2003] section 2.7. */
BRIO_API brio_status brio_restricted_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                              const brio_mesh *surface, brio_mesh **out, brio_restricted_stats *stats);

/** The simplices of a Delaunay or regular triangulation with their values in the alpha filtration. The alpha complex of
 *  alpha is the simplices with values of at most alpha. Index k of an array is the dimension: 0 vertices, 1 edges, 2
 *  facets, 3 tetrahedra. The arrays of the four dimensions lie one after the other in one block, so that values[0] has
 *  all values; the number of a simplex is its place there. */
typedef struct brio_alpha_complex {
    size_t size;
    brio_context *context;
    const brio_triangulation *triangulation; /* not owned; must outlive the complex; NULL in the plane */
    size_t counts[4];
    /** counts[k] by k + 1: indices of points, ascending in each simplex; tetrahedra in the triangulation's order. */
    uint32_t *simplices[4];
    /** counts[k]: the least alpha at which the simplex is in the complex. */
    double *values[4];
    /** counts[k]: the least value of a tetrahedron that contains the simplex. From its own value to this one the
     *  simplex is singular: in the complex, and a face of no tetrahedron there. */
    double *solid[4];
    /** counts[k]: 1 if no vertex is strictly inside the smallest orthosphere of the simplex. */
    uint8_t *gabriel[4];
    const brio_triangulation2 *triangulation2; /* of points in the plane; else NULL; as `triangulation` */
} brio_alpha_complex;

/** Computes the alpha filtration. A simplex that is Gabriel, which is decided exactly, has the squared radius of its
 *  smallest circumscribed sphere or, with weights, of its smallest orthosphere: the sphere of a vertex of weight w has
 *  the squared radius -w, and values may be negative. Any other simplex has the least value of the simplices that
 *  contain it. Vertices have the value 0 without weights. Values are rounded from double-doubles, to a few units in the
 *  last place except in tetrahedra too flat for those; a value that doubles cannot hold is INFINITY, and one below
 *  2^-1022, which has fewer bits, may be 0: such values may be equal where the squared radii are not, so scale points
 *  whose radii are beyond 2^511 or below 2^-511. Rounding leaves every value at most that of the simplices that contain
 *  the simplex. Duplicates and hidden points are in no simplex.
 *  t        the triangulation of these points and weights, of dimension 3.   weights  #P, or NULL.
 *  out      zeros at first; freed with brio_alpha_complex_free.
 *  Cost: a few times that of the triangulation, most of it with all threads. For the result and the work 48 bytes a
 *  tetrahedron, 45 a facet, 37 an edge and 24 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (another number of points), BRIO_ERR_NO_ANSWER (the points have dimension 2 or
 *  less), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE (2^32 - 1 simplices or more), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Edelsbrunner Muecke 1994], [Edelsbrunner 1995] for weights. */
BRIO_API brio_status brio_alpha_values(brio_context *ctx, const brio_triangulation *t, const double *points,
                                       const double *weights, size_t num_points, brio_alpha_complex *out);

/** Computes the alpha filtration of points in the plane: as brio_alpha_values, with triangles in place of tetrahedra
 *  and circles in place of spheres. counts[3] is 0, and `solid` is the least value of a triangle. brio_alpha_order and
 *  brio_alpha_auto take the complex, brio_alpha_shape does not.
 *  t        made of these points and weights by brio_delaunay2 or brio_delaunay2_flat, of dimension 2.
 *  points   #P by the coordinates of t.   weights  #P, or NULL.   out  zeros at first; freed with
 *  brio_alpha_complex_free. Cost: linear, one thread. For the result and the work 29 bytes a triangle, 25 an edge and
 *  57 a point. Returns what brio_alpha_values returns; BRIO_ERR_NO_ANSWER for points on a line.
 *  Based on: [Edelsbrunner Kirkpatrick Seidel 1983], [Edelsbrunner 1995] for weights. */
BRIO_API brio_status brio_alpha_values2(brio_context *ctx, const brio_triangulation2 *t, const double *points,
                                        const double *weights, size_t num_points, brio_alpha_complex *out);

/** Frees what a complex owns and sets its fields but `size` to 0; NULL is accepted. */
BRIO_API void brio_alpha_complex_free(brio_alpha_complex *complex);

/** Sorts the simplices as they enter the complex: by value, then dimension, then lexicographically by vertices. So a
 *  simplex comes after all its faces, and the order is the same for every number of threads.
 *  order  receives the numbers of all simplices, room for the sum of the counts.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_alpha_order(brio_context *ctx, const brio_alpha_complex *complex, uint32_t *order);

/** Finds the least alpha at which the tetrahedra of the complex are one solid, joined across facets, that has all
 *  vertices of the triangulation; in the plane, at which the triangles are one region, joined across edges. There is
 *  one: the greatest value of a tetrahedron (triangle) at the latest.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (alpha is INFINITY, or alpha and the values of all vertices are closer to 0 than
 *  2^-1022: scale the points), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_alpha_auto(brio_context *ctx, const brio_alpha_complex *complex, double *alpha);

typedef struct brio_alpha_shape_stats {
    size_t size;
    double alpha;
    size_t tetrahedra; /* in the complex */
    size_t vertices;   /* points on the surface */
    size_t split;      /* vertices of the mesh beyond these: where parts of the solid touch, each sheet has its own */
    size_t uncovered;  /* vertices of the triangulation that are in no tetrahedron of the complex */
    size_t singular_vertices, singular_edges, singular_facets; /* in the complex, bounding no tetrahedron of it */
} brio_alpha_shape_stats;

/** Makes the boundary of an alpha shape: of the union of the tetrahedra with values of at most alpha. Its triangles are
 *  seen counterclockwise from outside. The mesh is closed and manifold: where parts of the solid touch in a vertex or
 *  an edge only, vertices are doubled. Singular simplices are counted, and are not in the mesh.
 *  points  as they were given to brio_alpha_values.   out  owned by the caller.   stats  NULL, or receives what was
 *  found. Returns BRIO_OK, BRIO_ERR_ARGUMENT (alpha is NaN, or the complex is of the plane), BRIO_ERR_NO_ANSWER (no
 *  tetrahedron has a value of at most alpha, or alpha is closer to 0 than brio_alpha_auto finds one),
 *  BRIO_ERR_NO_MEMORY. Based on: [Edelsbrunner Muecke 1994]. */
BRIO_API brio_status brio_alpha_shape(brio_context *ctx, const double *points, const brio_alpha_complex *complex,
                                      double alpha, brio_mesh **out, brio_alpha_shape_stats *stats);

/** Lists every facet of the filtration as a mesh: all alpha shapes at once, for a slider. Its faces have three
 * properties
 *  (float64): a facet is in the complex from `appears` on, a face of its solid from `solid` on, and inside the solid
 *  from `vanishes` on, which is INFINITY on the convex hull. So the boundary at alpha is solid <= alpha < vanishes,
 *  and the singular facets are appears <= alpha < solid. Facets are seen counterclockwise from the side that is
 *  outside between the two; they are in the order of complex->simplices[2].
 *  points   those of the complex, which is of points in space.   out  all points as vertices; owned by the caller.
 *  Cost: linear; 44 bytes a facet. Returns BRIO_OK, BRIO_ERR_ARGUMENT (the plane), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_alpha_facets(brio_context *ctx, const double *points, const brio_alpha_complex *complex,
                                       brio_mesh **out);

/** Text formats of filtrations. */
typedef enum brio_filtration_format {
    BRIO_FILTRATION_GUDHI = 0, /* a line a simplex, "dimension vertices value", as GUDHI's simplex tree reads it */
    BRIO_FILTRATION_RIPSER =
        1, /* a line an edge, "i j value", a sparse distance matrix as ripser --format sparse reads it. Ripser enters every
              vertex at 0, and every clique with its last edge: dimension 0 is that of the alpha complex without weights,
              and higher dimensions are those of the flag complex of its edges. */
    BRIO_FILTRATION_END
} brio_filtration_format;

/** Writes the simplices of a complex with their values, in an order from brio_alpha_order. Vertices are indices of
 *  points, from 0 on. Replaces the file when it is complete, as brio_write does; "-" writes to standard output.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write_filtration(brio_context *ctx, const char *path, const brio_alpha_complex *complex,
                                           const uint32_t *order, brio_filtration_format format);

#ifdef __cplusplus
}
#endif
#endif
