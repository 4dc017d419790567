/* A living triangulation in space that repeats: the store behind brio_dynamic_periodic.
 *
 * A brio_dynamic holds the points and their translates in a margin about the domain, at positions on a grid on which
 * all of these are exact (periodic/lattice.h). So it is exact, too, and a change of a point is a change of several of
 * its points.
 *
 * Between changes:
 * W1  Each point that is there has one translate for each shift of brio_stars_shifts, and `inner` has these alone.
 * W2  kept[name] says of which point the inner point `name` is a translate, and by which shift in the reduced basis;
 *     `next` leads through the translates of a point, the one with shift 0 first.
 * W3  The answers of `inner` at a star, or at a tetrahedron, whose balls do not leave the margin are right for all of
 *     space (periodic/stars.c). Others come from a snapshot. */
#ifndef BRIO_LIVING_LIVING_H
#define BRIO_LIVING_LIVING_H

#include "brio/dynamic_periodic.h"
#include "dynamic/live.h"
#include "periodic/periodic.h"

typedef struct {
    double x[3], weight; /* in the domain */
    int32_t shift[3];    /* #rank: from where it was given to x, in the vectors that were given */
    uint32_t first;      /* the inner name of the translate with shift 0; BRIO_NONE: there is no such point */
} brio_wrapped;

typedef struct {
    uint32_t point, next;
    int8_t shift[3];
} brio_kept;

struct brio_dynamic_periodic {
    brio_context *ctx;
    bool weighted;
    brio_lattice lattice;
    double reach, halo, margin[3];
    size_t margin_for; /* number of points that the margin was chosen for */
    brio_wrapped *point;
    size_t num_points, point_capacity, alive; /* num_points: indices given out */
    brio_dynamic *inner;
    brio_kept *kept; /* #inner names */
    size_t kept_capacity;
    double moved;
    uint64_t in_place, replaced, anew, snapshots; /* of earlier inner ones, and of this */
    brio_periodic *snapshot;                      /* for questions; NULL where there is none */
    brio_periodic_locator *locator;
    uint32_t *place, *index; /* of the snapshot: the place of each index, and the index of each place */
    size_t *star_begin;      /* of the snapshot: where the corners of each place begin in `star` */
    uint32_t *star;          /* 4 tetrahedron + vertex */
    brio_image *list;        /* what neighbours were listed last */
    size_t list_capacity;
};

/** Forgets the snapshot, before or after a change. */
void brio_wrapped_forget(brio_dynamic_periodic *d);

/** Frees the inner triangulation, and what says of its points what they are. */
void brio_wrapped_clear(brio_dynamic_periodic *d);

/** A change of a point. */
typedef struct {
    uint32_t index;
    bool gone;       /* it is removed; else `to` is what it becomes, or what comes */
    brio_wrapped to; /* `first` is not read */
} brio_edit;

/* --- plan.c --- */

/** Makes the changes, which leave `num_points` indices given out and `alive` points there: all or none. */
brio_status brio_wrapped_apply(brio_dynamic_periodic *d, const brio_edit *edit, size_t count, size_t num_points,
                               size_t alive);

#endif
