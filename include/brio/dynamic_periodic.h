/* brio/dynamic_periodic.h: a triangulation of points in space that repeats, which lives: points are inserted, removed,
 * moved and reweighted.
 *
 * The promise: after any sequence of changes the triangulation is the one that brio_delaunay_periodic makes of the
 * points that are left, on the same grid, ties included. The grid is chosen when the triangulation is made, and stays:
 * brio_dynamic_periodic_points writes positions that a fresh build puts on the same places of it, and
 * brio_dynamic_periodic_stats has the `reach` that gives one the same grid where fewer than three directions repeat.
 * Farther than 8 longest vectors of the reduced lattice from the origin of space, doubles are coarser than the grid:
 * rounding may break ties there in other ways, as brio_delaunay_periodic says of origins. A change that fails, for want
 * of memory, by a bad argument, or since the caller cancelled, leaves everything as it was.
 */
#ifndef BRIO_DYNAMIC_PERIODIC_H
#define BRIO_DYNAMIC_PERIODIC_H

#include "periodic.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A triangulation that lives in space that repeats. Indices are those of brio_dynamic: 0, 1, ... in the order in which
 *  points come; a point keeps its index, and that of a removed point is not given out again. */
typedef struct brio_dynamic_periodic brio_dynamic_periodic;

/** What a triangulation has now, and what its changes were. */
typedef struct brio_dynamic_periodic_stats {
    size_t size;
    size_t indices;     /* given out so far: every index is below this */
    size_t points;      /* that are there */
    size_t translates;  /* points, and translates near the domain: what is triangulated */
    int directions;     /* that repeat: 1 to 3 */
    int dimension;      /* of the affine hull of these points and translates: -1 (no points) to 3 */
    double cell[9];     /* the vectors a, b, c as they are used; those that do not repeat are 0 */
    double cell_volume; /* of the vectors that repeat: a volume, an area or a length */
    double cell_moved;  /* the largest move of a coordinate of a vector when the cell was put on its grid */
    double moved;       /* the same of all points so far */
    double reach;       /* of the grid, see brio_periodic_options; 0 with three directions */
    uint64_t in_place;  /* moves and new weights of points and translates that changed no tetrahedron */
    uint64_t replaced;  /* those for which one was taken out and put in again */
    uint64_t anew;      /* how often all of it was built anew */
    uint64_t snapshots; /* how often one was made to answer a question */
} brio_dynamic_periodic_stats;

/** Makes a triangulation of points.
 *  points   #P by 3; none at all are allowed.   weights  #P, or NULL. With weights, or with `weighted` of the options,
 *           points have weights, those without one 0.
 *  options  with the cell, as of brio_delaunay_periodic. With fewer than three directions points may be half of
 *           `reach`, less the vectors of the reduced cell, away from the least of these, in coordinates in which such
 *           vectors go anywhere. It is made at least eight times as far as these points reach, and as the longest
 *           vector. The grid is as much coarser.
 *  out      owned by the caller, freed with brio_dynamic_periodic_free before the context; NULL on error. All later
 *           calls work with this context.
 *  Memory: that of a brio_dynamic of the points and the translates within 2.5 spacings of the domain, and 12 bytes for
 *  each of these and 48 for each index; while a snapshot answers questions, it and 16 bytes a tetrahedron.
 *  Returns BRIO_OK, and as brio_delaunay_periodic. */
BRIO_API brio_status brio_dynamic_periodic_new(brio_context *ctx, const double *points, const double *weights,
                                               size_t num_points, const brio_periodic_options *options,
                                               brio_dynamic_periodic **out);

/** Frees a triangulation; NULL is accepted. */
BRIO_API void brio_dynamic_periodic_free(brio_dynamic_periodic *d);

/* The functions that change a triangulation return BRIO_OK, BRIO_ERR_ARGUMENT (also for a point more than 2^26 cells
 * away, or farther than the grid reaches), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE,
 * BRIO_ERR_CANCELLED. On failure all is as it was before the call. Points may be given in any cell. Each changes with
 * those of its translates that are near the domain, so a change costs what it costs a brio_dynamic, times translates /
 * points. Where a call changes so much that building anew is faster, it builds anew; so does one that doubles or halves
 * the number of points, since the margin follows their density. All threads are used as by brio_dynamic; results do not
 * depend on their number. */

/** Inserts points, as brio_dynamic_insert. */
BRIO_API brio_status brio_dynamic_periodic_insert(brio_dynamic_periodic *d, const double *points, const double *weights,
                                                  size_t num_points, uint32_t *first);

/** Removes points, as brio_dynamic_remove. Points that they hid come back. */
BRIO_API brio_status brio_dynamic_periodic_remove(brio_dynamic_periodic *d, const uint32_t *indices,
                                                  size_t num_indices);

/** Moves points, as brio_dynamic_move. A point that leaves the domain comes back on its other side by itself, with all
 *  translates near the border: what moves a little moves in place. */
BRIO_API brio_status brio_dynamic_periodic_move(brio_dynamic_periodic *d, const uint32_t *indices, const double *points,
                                                const double *weights, size_t num_indices);

/** Gives points new weights, as brio_dynamic_reweight. */
BRIO_API brio_status brio_dynamic_periodic_reweight(brio_dynamic_periodic *d, const uint32_t *indices,
                                                    const double *weights, size_t num_indices);

/** Writes the facts of a triangulation to a struct whose size the caller has set.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the size is impossible). */
BRIO_API brio_status brio_dynamic_periodic_facts(const brio_dynamic_periodic *d, brio_dynamic_periodic_stats *stats);

/** Returns 1 if there is a point of an index, and else 0.
 *  record  receives its position, as brio_dynamic_periodic_points writes it, and its weight; may be NULL. */
BRIO_API int brio_dynamic_periodic_point(const brio_dynamic_periodic *d, uint32_t index, double record[4]);

/** Writes the points that are there, by ascending index, `points` of the stats in number: in the cell in which they
 *  were given, and where they were given, up to the grid. A fresh build puts these on the same places.
 *  indices  #P, or NULL.   points  #P by 3, or NULL.   weights  #P, or NULL. */
BRIO_API void brio_dynamic_periodic_points(const brio_dynamic_periodic *d, uint32_t *indices, double *points,
                                           double *weights);

/** Lists the translates that are joined to a vertex by an edge, in no order: those of the point `point` by `shift`,
 *  where points are where they were given. A vertex can be joined to translates of itself.
 *  neighbours  receives a view, valid until the next call with d.   count  receives their number; 0 for a point that is
 *  no vertex, and where there are no tetrahedra.
 *  Cost: some microseconds. Where a ball at the vertex reaches beyond the translates that are kept, which happens in
 *  large voids and at the hull of slabs and wires, the answer comes from a snapshot, which stays until the next change.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no such point), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_periodic_neighbours(brio_dynamic_periodic *d, uint32_t index,
                                                      const brio_image **neighbours, size_t *count);

/** Finds a finite tetrahedron whose closure holds a position, in any cell; the position is put on the grid.
 *  vertices  receives its vertices, in positive order, as above; `point` is BRIO_INFINITE four times where the position
 *            is strictly outside of the hull, or there are no tetrahedra.
 *  Cost: as above.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE, BRIO_ERR_ARGUMENT (it is more than 2^26 cells away), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_periodic_locate(brio_dynamic_periodic *d, const double position[3],
                                                  brio_image vertices[4]);

/** Makes the triangulation that brio_delaunay_periodic makes of the points that are there, by ascending index: the same
 *  tetrahedra and the same checksum; their order may differ. All functions of periodic.h read it. Its points are places
 *  in that sequence, which brio_dynamic_periodic_points writes.
 *  ctx  that of the triangulation, or another one, to which the snapshot belongs then.
 *  out  owned by the caller, freed with brio_periodic_free; NULL on error.
 *  Cost: as sorting the tetrahedra of the points and translates, and a search from their hull.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_dynamic_periodic_snapshot(brio_context *ctx, const brio_dynamic_periodic *d,
                                                    brio_periodic **out);

/** Computes brio_periodic_checksum of a snapshot.   Returns what brio_dynamic_periodic_snapshot returns. */
BRIO_API brio_status brio_dynamic_periodic_checksum(brio_context *ctx, const brio_dynamic_periodic *d,
                                                    uint64_t *checksum);

/** Checks a snapshot exactly by brio_periodic_check, and that the triangulation keeps its own invariants.
 *  Returns what the two return, and BRIO_ERR_CHECK. */
BRIO_API brio_status brio_dynamic_periodic_check(brio_context *ctx, const brio_dynamic_periodic *d);

#ifdef __cplusplus
}
#endif
#endif
