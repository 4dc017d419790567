/* Flips that make the boundary of labels a manifold at little cost. */
#ifndef BRIO_RECONSTRUCT_MENDING_H
#define BRIO_RECONSTRUCT_MENDING_H

#include "reconstruct/labeled_delaunay/label_flips.h"

/* Whether turns that cannot change anything are taken, too, to check that. */
#ifdef NDEBUG
enum { BRIO_CHECKED_TURNS = 0 };
#else
enum { BRIO_CHECKED_TURNS = 1 };
#endif

/** A sample is singular if the parts of its star are more than one outer and one inner part. */
typedef struct {
    brio_label_flips *flips;
    uint8_t *surplus; /* #P: brio_surplus of each star, at most 255; 0 of stars with over BRIO_STAR_ROOM tetrahedra */
    uint8_t *fans;    /* #P: parts of each star less one, at most 255 */
    uint8_t *queued;  /* #P: 1 if the sample is in the queue */
    uint8_t *sleeps;  /* #P: of queued samples, within brio_mend: the first price at which a move there helps, unless
                         labels that it depends on change before */
    uint32_t *looked; /* #P: the last call of brio_mending_look that came by, counted by `looks` */
    uint32_t looks;
    uint32_t *queue; /* singular samples, and samples that were singular when they were queued */
    size_t size, capacity;
    size_t singular;  /* samples */
    int64_t all_fans; /* the sum */
} brio_mending;

/** Looks at all samples.   flips  kept.   out  freed with brio_mending_free, on failure too. */
brio_status brio_mending_new(brio_label_flips *flips, brio_mending *out);
void brio_mending_free(brio_mending *m);

/** Looks at the samples of the tetrahedra flips->flipped[from .. to) again, and queues those that are singular. */
brio_status brio_mending_look(brio_mending *m, size_t from, size_t to);

/** Empties the queue. */
void brio_mending_forget(brio_mending *m);

/** Flips tetrahedra at queued samples until none of these is singular or nothing helps.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_mend(brio_mending *m);

#endif
