/* brio/dynamic.h: a triangulation of points in space that lives: points are inserted, removed, moved and reweighted.
 *
 * The promise: after any sequence of changes the triangulation is the one that brio_delaunay makes of the points that
 * are left, ties included; brio_dynamic_snapshot returns it, equal in every byte. A change that fails, for want of
 * memory, by a bad argument, or since the caller cancelled, leaves everything as it was.
 */
#ifndef BRIO_DYNAMIC_H
#define BRIO_DYNAMIC_H

#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A triangulation that lives. Its points have indices: those of the first points are 0, 1, ...; each point that is
 *  inserted gets the next one. A point keeps its index; that of a removed point is not given out again. */
typedef struct brio_dynamic brio_dynamic;

/** What a triangulation has now, and what its changes were. */
typedef struct brio_dynamic_stats {
    size_t size;
    size_t indices;       /* given out so far: every index is below this */
    size_t points;        /* that are there */
    size_t vertices;      /* of them, in dimension 3; the others are duplicates or hidden. Else 0 */
    size_t tetrahedra;    /* finite ones */
    size_t hull_facets;   /* infinite ones */
    int dimension;        /* of the affine hull of the points: -1 (no points) to 3 */
    uint64_t in_place;    /* moves and new weights that changed no tetrahedron */
    uint64_t replaced;    /* moves and new weights for which a point was taken out and put in again */
    uint64_t anew;        /* how often all of it was built anew */
    uint64_t walk_steps;  /* of all searches */
    uint64_t exact_calls; /* calls of predicates that the floating-point filter did not settle */
} brio_dynamic_stats;

/** What became of a point. */
typedef enum brio_dynamic_state {
    BRIO_DYNAMIC_NONE = 0,      /* no point has this index, or it was removed */
    BRIO_DYNAMIC_VERTEX = 1,    /* a vertex */
    BRIO_DYNAMIC_DUPLICATE = 2, /* at the position of a vertex */
    BRIO_DYNAMIC_HIDDEN = 3,    /* with weights: its power cell is empty for now */
    BRIO_DYNAMIC_FLAT = 4       /* the points have dimension 2 or less, and no tetrahedra */
} brio_dynamic_state;

/** Makes a triangulation of points, by brio_delaunay with all threads.
 *  points    #P by 3; none at all are allowed.   weights  #P, or NULL.
 *  weighted  1 if points will have weights, those without one having 0; 0 with weights is BRIO_ERR_ARGUMENT.
 *  out       owned by the caller, freed with brio_dynamic_free before the context; NULL on error. All later calls work
 *            with this context.
 *  Memory: 41 bytes a tetrahedron (45 with weights) and 74 a point, and up to a quarter more for growth. A change
 *  takes 48 bytes for each tetrahedron that it takes out, until it ends.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                      int weighted, brio_dynamic **out);

/** Frees a triangulation; NULL is accepted. */
BRIO_API void brio_dynamic_free(brio_dynamic *d);

/* The functions that change a triangulation return BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE,
 * BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. On failure all is as it was before the call. Where a
 * call changes so much that building anew is faster, it builds anew. Calls that change at least 128 points use all
 * threads; what they make does not depend on the number of threads. */

/** Inserts points; they get the next indices, in their order.
 *  points  #P by 3.   weights  #P, or NULL for 0; weights other than NULL need `weighted`.
 *  first   receives the index of the first of them; may be NULL.
 *  Cost: some microseconds a point. Several points at once are inserted along a space-filling curve. */
BRIO_API brio_status brio_dynamic_insert(brio_dynamic *d, const double *points, const double *weights,
                                         size_t num_points, uint32_t *first);

/** Removes points. Points that they hid come back.   indices  #I, each of a point that is there, none twice.
 *  Cost: some microseconds a point, for a vertex of many neighbours as the triangulation of these.
 *  Based on: [Devillers Teillaud 2011], [Buchin Devillers Mulzer Schrijvers Shewchuk 2013]. */
BRIO_API brio_status brio_dynamic_remove(brio_dynamic *d, const uint32_t *indices, size_t num_indices);

/** Moves points.   indices  #I, each of a point that is there, none twice; NULL with num_indices equal to the number
 *  of points: all points, by ascending index.   points  #I by 3: the new positions.   weights  #I new weights, or
 *  NULL: they stay. Cost: where no tetrahedron changes, as the tests of the point's star; else as taking it out and
 *  putting it in.
 *  Based on: [de Castro Tournois Alliez Devillers 2009]. */
BRIO_API brio_status brio_dynamic_move(brio_dynamic *d, const uint32_t *indices, const double *points,
                                       const double *weights, size_t num_indices);

/** Gives points new weights.   indices  as of brio_dynamic_move.   weights  #I. */
BRIO_API brio_status brio_dynamic_reweight(brio_dynamic *d, const uint32_t *indices, const double *weights,
                                           size_t num_indices);

/** Writes the facts of a triangulation to a struct whose size the caller has set.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the size is impossible). */
BRIO_API brio_status brio_dynamic_facts(const brio_dynamic *d, brio_dynamic_stats *stats);

/** Returns what became of the point of an index, and its record.
 *  record  receives x, y, z and weight, where there is such a point; may be NULL. */
BRIO_API brio_dynamic_state brio_dynamic_point(const brio_dynamic *d, uint32_t index, double record[4]);

/** Writes the points that are there, by ascending index, `points` of brio_dynamic_stats in number.
 *  indices  #P, or NULL.   points  #P by 3, or NULL.   weights  #P, or NULL. */
BRIO_API void brio_dynamic_points(const brio_dynamic *d, uint32_t *indices, double *points, double *weights);

/** Lists the vertices that are joined to a vertex by an edge, in no order.
 *  neighbours  receives a view of their indices, valid until the next call with d.   count  receives their number; 0
 *  for a point that is no vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no such point), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_neighbours(brio_dynamic *d, uint32_t index, const uint32_t **neighbours,
                                             size_t *count);

/** Finds a finite tetrahedron whose closure holds a position.   vertices  receives the indices of its vertices, in
 *  positive order; BRIO_INFINITE four times where the position is strictly outside of the hull, or there are no
 *  tetrahedra.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE. */
BRIO_API brio_status brio_dynamic_locate(brio_dynamic *d, const double position[3], uint32_t vertices[4]);

/** Makes the triangulation that brio_delaunay makes of the points that are there, by ascending index: equal in every
 *  byte of its tetrahedra and representatives. Its indices are places in that sequence, which brio_dynamic_points
 *  writes.
 *  ctx  that of the triangulation, or another one, to which the snapshot belongs then.
 *  out  owned by the caller, freed with brio_triangulation_free; NULL on error.
 *  Cost: as sorting the points and the tetrahedra: a fraction of building anew. Inputs of dimension 2 or less are
 *  triangulated.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_snapshot(brio_context *ctx, const brio_dynamic *d, brio_triangulation **out);

/** Computes brio_triangulation_checksum of a snapshot.   Returns what brio_dynamic_snapshot returns. */
BRIO_API brio_status brio_dynamic_checksum(brio_context *ctx, const brio_dynamic *d, uint64_t *checksum);

/** Checks a snapshot exactly and completely, by brio_triangulation_check, and that the triangulation keeps its own
 *  invariants.   Returns what the two return, and BRIO_ERR_CHECK. */
BRIO_API brio_status brio_dynamic_check(brio_context *ctx, const brio_dynamic *d);

#ifdef __cplusplus
}
#endif
#endif
