/* Passes: threads that change one triangulation together, each in the zone where it works.
 *
 * The items of a pass are what is to be done: vertices to be inserted, to be taken out, to be moved. Each thread gets a
 * part of them and tries one after the other. It may change tetrahedra all of whose finite vertices are in its zone,
 * and records all of whose tetrahedra are (docs/decisions/006-segments-held-by-threads.md). What meets another
 * thread's zone is deferred: tried again when the thread is through with its part, then in another pass, and at the end
 * left to one thread. */
#ifndef BRIO_TRIANGULATION_PASSES_H
#define BRIO_TRIANGULATION_PASSES_H

#include "triangulation/zone.h"

/** What became of an item: it is done; it met another thread's zone; it cannot be done in a pass. */
typedef enum { BRIO_TRIED = 0, BRIO_TRY_LATER = 1, BRIO_TRY_ALONE = 2 } brio_attempt;

/** A thread's part of the items. */
typedef struct {
    const struct brio_passes *passes;
    size_t begin, end; /* of the items, which brio_pass_item returns */
    int thread, threads;
} brio_pass_part;

/** What is done in passes. Functions marked (alone) are called while no other thread works. */
typedef struct {
    /** Makes room for a pass over `count` items (alone). */
    brio_status (*prepare)(void *user, size_t count, int threads);
    /** Makes a thread's hand, which works in its zone, and finds it a tetrahedron to start from (alone). The hand is
     *  freed after a failure, too, where it is not NULL. */
    brio_status (*enter)(void *user, brio_zone *zone, const brio_pass_part *part, void **hand);
    /** Tries an item. An item that is not done leaves all as it was. After a failure all is good for nothing but to be
     *  taken back or freed. */
    brio_status (*attempt)(void *hand, uint32_t item, brio_attempt *outcome);
    /** Returns whether the hand has done enough work since the last report. */
    bool (*due)(const void *hand);
    /** Reports that a share of the pass is done, if the hand is that of the thread that called. */
    brio_status (*report)(void *hand, double share);
    /** Takes over what a hand leaves (alone).   deferred  items that it could not do when it first tried them. */
    brio_status (*leave)(void *user, void *hand, size_t deferred);
    /** A pass is over (alone); NULL: nothing to do. */
    void (*passed)(void *user);
    void (*free)(void *hand);
    /** Returns item i of the first pass. */
    uint32_t (*item)(const void *user, size_t i);
    size_t least; /* items that are worth a thread */
} brio_pass_work;

/** Passes under way. The caller sets the first fields, the others being 0, and frees it by brio_passes_free. */
typedef struct brio_passes {
    brio_context *ctx;
    const brio_pass_work *work;
    void *user;
    const uint32_t *rank; /* of each vertex, constant in a pass: near vertices have near ranks */
    size_t ranks;         /* above all ranks */
    size_t vertices;      /* that there are when all items are done; the more, the more threads are of use */
    size_t count;         /* items; at the end, those that are left */
    uint32_t *list;       /* the items from the second pass on; at the end, those that are left */
    uint8_t *taken;       /* of each segment; see brio_zone */
    size_t segments, running;
    int shift; /* of ranks to segments */
    int stop;  /* some thread failed; only hastens the others' end */
    uint32_t *alone;
    size_t num_alone, alone_capacity;
} brio_passes;

/** Works in passes until what is left is best done by one thread, which the caller does: the first `count` items of
 *  the list, or all by brio_pass_item where there is none.
 *  most  threads; fewer where there is little to do. */
brio_status brio_passes_run(brio_passes *p, int most);
void brio_passes_free(brio_passes *p);

/** Returns item i of those that are to be done. */
static inline uint32_t brio_pass_item(const brio_passes *p, size_t i) {
    assert(i < p->count);
    return p->list ? p->list[i] : p->work->item(p->user, i);
}

#endif
