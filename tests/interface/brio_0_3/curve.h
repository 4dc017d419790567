/* brio/curve.h: meshes of edges: curves of points in a plane, minimum spanning trees. */
#ifndef BRIO_CURVE_H
#define BRIO_CURVE_H

#include "mesh.h"
#include "plane.h"
#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_curve_options {
    size_t size;
    double
        open;   /* a curve ends where the next point is over that many times as far as the longest of the eight links on
                    either side; 1 or more. 0: over 2.25 times where these are all alike, more where they vary */
    int closed; /* 1: curves end nowhere if they can be closed; `open` does not count */
    int reserved_int;
} brio_curve_options;

typedef struct brio_curve_stats {
    size_t size;
    size_t points, samples;      /* the points; their distinct positions */
    size_t edges, gaps;          /* links; those that were taken out since they span gaps */
    size_t curves, closed, ends; /* curves; those of them that are closed; ends of the others */
    size_t corners, isolated;    /* corners; samples that are on no curve */
    size_t fat;                  /* edges whose Voronoi edge is less than 1.25 times as long */
    double thickness;            /* the greatest distance of a point from the plane */
    double delaunay_seconds, curve_seconds;
} brio_curve_stats;

/** Finds curves through points of a plane: polylines, with corners and ends, some closed, any number of them. The plane
 *  may lie in space as it likes (brio_plane_fit); points are in it if they are off by 2^-20 of their extent at most.
 *  Each sample has two edges at most, and edges are edges of the Delaunay triangulation of the plane: so curves do not
 *  branch, and no two edges cross, up to the rounding of coordinates in a slanting plane. The result is the same for
 *  every order of the points.
 *  Does not guarantee: that the curves are those that were sampled. In tests 99 of 100 scenes came out right, link by
 *  link, and each in counts, where these held. Links of one curve that follow each other differ in length by at most
 *  1.5 times. A curve turns by at most 20 degrees at a sample, except at corners; these turn by 45 to 155 degrees and
 *  are three links apart; a sample on a corner may be missing. Other curves, and other parts of the same one, are
 *  farther than twice the links there, except at corners. An end is farther than three times the longest of the eight
 *  links beside it from samples that it is not to be linked with. Points at random along a curve are denser than that
 *  at some places and thinner at others: few gaps come out wrong.
 *  points   #P by 3.   options  NULL for the defaults.   stats  may be NULL.
 *  out      owned by the caller, NULL on error. Its vertices are the samples in the order of the points, with the
 *           properties "sample" (uint32, the index of the point, of coincident ones the lowest), "curve" (int32,
 *           counted from 0; -1 on none) and "corner" (uint8; 1 at a corner, and at both ends of an edge that spans
 *           one). Its edges go along one curve after the other, each from where the last one ended.
 *  Cost: one triangulation of the plane, and linear time. Memory: 250 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER (no points; points off a plane; points
 *  all over an area), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Dey Wenger 2002], [Dey Kumar 1999], [Amenta Bern Eppstein 1998]. */
BRIO_API brio_status brio_curve(brio_context *ctx, const double *points, size_t num_points,
                                const brio_curve_options *options, brio_mesh **out, brio_curve_stats *stats);

/** What the edges of a mesh alone say about the curves that they form. Vertices at the same position count as
 *  distinct. */
typedef struct brio_curve_certificate {
    size_t size;
    int closed;               /* there are edges, and every vertex with an edge has two */
    int manifold;             /* no vertex has more than two edges */
    size_t components, loops; /* sets of edges joined at vertices; those without ends and branches */
    size_t ends, branches;    /* vertices of one edge, and of more than two */
    size_t isolated;          /* vertices without edges */
    double length;
} brio_curve_certificate;

/** Certifies the edges of a mesh (brio_mesh.edges).   Cost: near-linear; 9 bytes a vertex.
 *  Returns BRIO_OK (whatever the certificate says), BRIO_ERR_ARGUMENT (an index out of range, or an edge from a vertex
 *  to itself), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_curve_certificate(brio_context *ctx, const brio_mesh *mesh, brio_curve_certificate *out);

typedef struct brio_planar_crust_stats {
    size_t size;
    size_t points, samples;     /* the points; their distinct positions */
    size_t edges;               /* of the crust */
    size_t poles, inner, outer; /* vertices of the Voronoi diagram; by label */
    size_t confused;            /* poles that had evidence for both labels when they were labeled */
    size_t fat;                 /* edges whose Voronoi edge is less than 1.25 times as long: few along curves,
                                           over a tenth where points lie on an area */
    double delaunay_seconds, crust_seconds;
} brio_planar_crust_stats;

/** Finds the power crust of points of a plane: edges that part inside from outside. Every vertex has an even number of
 *  edges, whatever the points: the curves are closed, though they may touch each other. In the plane all vertices of
 *  the Voronoi diagram are poles, and the power diagram of their balls is the Delaunay triangulation. So the crust
 *  consists of Delaunay edges: those between triangles of different labels. The labels are the greedy ones. brio_curve
 *  is right more often, and has ends.
 *  points   #P by 3, in a plane as those of brio_curve.
 *  out      owned by the caller, NULL on error. Its vertices are the distinct positions in the order of the points,
 *           with the property "sample" (uint32, the index of the point). Going along an edge, the inside is to the left
 *           as seen from the side to which axis[0] x axis[1] of brio_plane_fit points.
 *  shape    NULL, or receives the power shape, owned by the caller, NULL on error: the inner poles, with the property
 *           "radius" (double) of their circles, and edges between those whose triangles share an edge. It is homotopy
 *           equivalent to the inside.
 *  stats    NULL, or its `size` set.
 *  Cost: one triangulation of the plane; then O(n log n). Memory: 250 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_ANSWER (no points; points off a plane, or on a
 *  line; nothing is inside), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Choi 2003] figures 3.4 and 3.8, [Amenta Choi Kolluri 2001]. */
BRIO_API brio_status brio_planar_crust(brio_context *ctx, const double *points, size_t num_points, brio_mesh **out,
                                       brio_mesh **shape, brio_planar_crust_stats *stats);

typedef struct brio_spanning_tree_stats {
    size_t size;
    size_t points, vertices, edges; /* the points; their distinct positions; one edge fewer */
    double length;                  /* sum of the lengths of the edges */
    int dimension;                  /* of the affine hull of the points: -1 (no points) to 3 */
    int reserved_int;
    uint64_t exact_calls; /* comparisons of lengths that doubles did not settle */
    double delaunay_seconds, tree_seconds;
} brio_spanning_tree_stats;

/** Computes the Euclidean minimum spanning tree of points: edges that join all positions, with the least sum of
 *  lengths. Lengths are compared exactly. Among edges of one length, those are taken first whose lexicographically
 *  lesser end, then whose greater end, comes first. Only edges of the triangulation of brio_delaunay count. So the tree
 *  is the same for every order of the points.
 *  points   #P by 3. Those of a plane have their coordinates there, with a third one that is the same for all.
 *  out      owned by the caller, NULL on error. Its vertices are the distinct positions in the order of the points,
 *           with the property "sample" (uint32, the index of the point). Its edges are sorted, the shortest first; of
 *           each, the lexicographically lesser end comes first.
 *  stats    NULL, or its `size` set.
 *  Cost: one triangulation, and a sort of its edges: O(n log n). Memory: beside the triangulation 32 bytes an edge, of
 *  which a point of space has about 8 and one of a plane 3.
 *  Returns what brio_delaunay returns.
 *  Based on: [Shamos Hoey 1975], [Kruskal 1956]. */
BRIO_API brio_status brio_spanning_tree(brio_context *ctx, const double *points, size_t num_points, brio_mesh **out,
                                        brio_spanning_tree_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
