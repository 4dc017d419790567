/* brio/triangulation.h: Delaunay and regular triangulations of points in space, and their checks. Questions to them,
 * such as which tetrahedron holds a position, are in queries.h. */
#ifndef BRIO_TRIANGULATION_H
#define BRIO_TRIANGULATION_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

#define BRIO_INFINITE UINT32_MAX

/** A tetrahedron: its four vertices as indices of points, and four mates. mate[i] is the handle of the facet opposite
 *  to vertex[i], seen from the tetrahedron on its other side. As an array of numbers: eight to a tetrahedron. */
typedef struct {
    uint32_t vertex[4], mate[4];
} brio_tetrahedron;

/** Insertion orders. All give the same tetrahedra. BRIO_ORDER_RANDOM and BRIO_ORDER_INPUT follow no path through space
 *  and insert with one thread; the others insert with several. Workspace in bytes a point, freed before the insertion
 *  begins: 16, of INPUT 0. */
typedef enum brio_order {
    BRIO_ORDER_BRIO = 0,    /* random rounds, a Hilbert curve inside each round: the tuned one [Amenta Choi Rote 2003];
                            with weights, heavier neighbours on the curve are inserted in earlier rounds */
    BRIO_ORDER_HILBERT = 1, /* one round along a Hilbert curve */
    BRIO_ORDER_RANDOM = 2,
    BRIO_ORDER_INPUT = 3,
    BRIO_ORDER_END
} brio_order;

typedef struct brio_delaunay_options {
    size_t size;
    brio_order order;
    int leave_hidden;   /* 1 leaves hidden points without a representative: BRIO_INFINITE stands in the array. Where
                         weights hide most points, this saves up to two fifths of the time, and takes 6 to 12 bytes a
                         point when the insertion is over. Default 0 */
    double round_ratio; /* share of the points that is left for the rounds before the last one, below 1; 0: 1/8 */
    uint64_t seed;      /* every random choice follows from it */
    uint32_t max_tetrahedra; /* most tetrahedra at any time, infinite ones included; 0: 2^30, which is the most */
    int reserved_int;
} brio_delaunay_options;

/** Facts of a triangulation. Counters are totals over the construction and include infinite tetrahedra. */
typedef struct brio_delaunay_stats {
    size_t size;
    size_t points, vertices, duplicates, hidden;
    int dimension;      /* of the affine hull of the points: -1 (no points) to 3 */
    size_t tetrahedra;  /* finite ones of the result */
    size_t hull_facets; /* = infinite tetrahedra of the result */
    uint64_t created, destroyed, walk_steps, insphere_calls;
    uint64_t exact_calls;      /* calls of predicates that the floating-point filter did not settle */
    uint64_t deferred, serial; /* several threads: insertions put off to a later pass; done by one thread */
    double locate_seconds;     /* of the insertion: point location, extrapolated from every 64th one; 1 thread */
    double order_seconds, insert_seconds; /* insert_seconds includes the canonical sort of the result */
} brio_delaunay_stats;

typedef struct brio_triangulation brio_triangulation;

/** Builds the Delaunay triangulation of a point set or, with weights, the regular triangulation: its power distance is
 *  |x - p|^2 - w. Every finite input has a result; points of dimension 2 or less have vertices, duplicates and hidden
 *  points but no tetrahedra.
 *  points   #P by 3, row after row.   weights  #P, or NULL.
 *  num_points  less than 2^31 - 16, or less than 2^32 - 16 with a scratch folder.
 *  options  NULL for the defaults.    out      owned by the caller, freed with brio_triangulation_free; NULL on error.
 *  Cost: expected O(n log n) time for points of realistic inputs. Memory while points are inserted: 33 bytes a
 *  tetrahedron and 41 a point (45 with several threads; with weights 4 more); while the result is sorted: 41 a
 *  tetrahedron and 16 a point. Up to an eighth is reserved for growth.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED.
 *  Based on: [Bowyer 1981], [Watson 1981]; [Amenta Choi Rote 2003] for the order, [Devillers Teillaud 2011] for
 *  ties. */
BRIO_API brio_status brio_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_delaunay_options *options, brio_triangulation **out);

/** Frees a triangulation; NULL is accepted. */
BRIO_API void brio_triangulation_free(brio_triangulation *t);

/** Returns the facts of a triangulation. The view is valid until the triangulation is freed. */
BRIO_API const brio_delaunay_stats *brio_triangulation_stats(const brio_triangulation *t);

/** Returns the tetrahedra + hull_facets tetrahedra, finite ones first. A finite tetrahedron is positive. An infinite
 *  tetrahedron (a, b, c, BRIO_INFINITE) has the hull facet abc, and (a, b, c, x) is positive for x outside the hull.
 *  The array is the same for every number of threads. The view is valid until the triangulation is freed. */
BRIO_API const brio_tetrahedron *brio_triangulation_tetrahedra(const brio_triangulation *t);

/** Returns #P indices: for each point the vertex that represents it, which is the point itself if it is a vertex. With
 *  options.leave_hidden, BRIO_INFINITE stands for each hidden point and for its duplicates. The view is valid until the
 *  triangulation is freed. */
BRIO_API const uint32_t *brio_triangulation_representatives(const brio_triangulation *t);

/** Returns the hash of the points and weights that the triangulation was made of, as brio_points_hash has it. So a
 *  caller who keeps points beside a triangulation can see whether they are still its points. */
BRIO_API uint64_t brio_triangulation_points_hash(const brio_triangulation *t);

/** Returns a hash of points in their order.
 *  points  #P by `coordinates`, which is 2 or 3.   weights  #P, or NULL, which counts as weights of 0.   Cost: O(n). */
BRIO_API uint64_t brio_points_hash(const double *points, const double *weights, size_t num_points, int coordinates);

/** Checks a triangulation exactly and completely against its points. It passes if and only if it is the result of
 *  brio_delaunay, up to the order of the finite tetrahedra, the order of the infinite ones, and even permutations of
 *  the vertices of a tetrahedron. Checked are: the tetrahedra cover the convex hull once and meet in common faces; no
 *  point is inside the sphere (orthosphere) of a tetrahedron; ties are broken by the symbolic perturbation; mates,
 *  infinite tetrahedra and every representative are right; the statistics' dimension and numbers of vertices,
 *  duplicates, hidden points, tetrahedra and hull facets are right.
 *  points, weights, num_points  as they were given to brio_delaunay.
 *  Cost: O(t) for t tetrahedra, and one walk for each point that is no vertex; inputs of dimension 1 and 2 are
 *  triangulated again.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (the triangulation has
 *  another number of points), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_triangulation_check(brio_context *ctx, const brio_triangulation *t, const double *points,
                                              const double *weights, size_t num_points);

/** Checks finite tetrahedra from any source, in any order and either orientation. They pass if and only if they are a
 *  Delaunay (regular) triangulation of the points, however its ties are broken, in which every position has one index,
 *  that of a point with the greatest weight there. For points of dimension 2 or less, only no tetrahedra at all pass.
 *  tetrahedra  Tetrahedron i has four indices of points at tetrahedra + stride * i: stride 4 for a packed array, 8 for
 *              the array of a brio_triangulation.
 *  canonical   receives 1 if ties are broken as brio_delaunay breaks them, so that the tetrahedra are the same up to
 *              coincident points of equal weight, else 0. It is unchanged on failure and may be NULL.
 *  Cost: O(t log t) for t tetrahedra, and one walk for each point that is no vertex.
 *  Returns BRIO_OK, BRIO_ERR_CHECK (the message says what is wrong and where), BRIO_ERR_ARGUMENT (stride below 4),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE (2^29 tetrahedra or more), BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tetrahedra_check(brio_context *ctx, const double *points, const double *weights,
                                           size_t num_points, const uint32_t *tetrahedra, size_t stride,
                                           size_t num_tetrahedra, int *canonical);

/** Computes a hash of the set of tetrahedra in terms of the lexicographic ranks of their vertices. It does not depend
 *  on the order of points or tetrahedra, and stays the same when all points are scaled by a power of two.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_triangulation_checksum(brio_context *ctx, const brio_triangulation *t, const double *points,
                                                 uint64_t *checksum);

#ifdef __cplusplus
}
#endif
#endif
