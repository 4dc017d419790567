/* Triangulations and orders with the options of the library and of an experiment in one struct. */
#ifndef BRIO_TESTS_TRIAL_H
#define BRIO_TESTS_TRIAL_H

#include "brio/laboratory.h"
#include "order/order.h"
#include <stdbool.h>

/* The orders of experiments after those of the library. */
enum {
    TRIAL_BRIO_OCTREE = BRIO_ORDER_END,
    TRIAL_BRIO_KDTREE = TRIAL_BRIO_OCTREE + 1,
    TRIAL_OCTREE = TRIAL_BRIO_OCTREE + 2,
    TRIAL_ORDERS = TRIAL_BRIO_OCTREE + 3
};

typedef struct {
    int order;
    brio_location locate;
    int leave_hidden, all_conflicts, first_conflict;
    double round_ratio;
    uint64_t seed, record_every, page_bytes, cache_bytes;
    uint32_t max_tetrahedra;
    size_t block_size, num_edges;
    const uint32_t *edges;
} trial_options;

static inline brio_delaunay_options trial_library(const trial_options *o) {
    return (brio_delaunay_options){.order =
                                       o->order < BRIO_ORDER_END || o->order >= TRIAL_ORDERS ? (brio_order)o->order : 0,
                                   .leave_hidden = o->leave_hidden,
                                   .round_ratio = o->round_ratio,
                                   .seed = o->seed,
                                   .max_tetrahedra = o->max_tetrahedra};
}

static inline brio_laboratory_options trial_experiment(const trial_options *o) {
    bool blocks = o->order >= BRIO_ORDER_END && o->order < TRIAL_ORDERS;
    return (brio_laboratory_options){
        .locate = o->locate,
        .all_conflicts = o->all_conflicts,
        .first_conflict = o->first_conflict,
        .edges = o->edges,
        .num_edges = o->num_edges,
        .record_every = o->record_every,
        .page_bytes = o->page_bytes,
        .cache_bytes = o->cache_bytes,
        .order =
            blocks ? (brio_laboratory_order)(o->order - BRIO_ORDER_END + BRIO_BLOCKS_BRIO_OCTREE) : BRIO_BLOCKS_NONE,
        .block_size = o->block_size};
}

/* Does what brio_delaunay does, as an experiment.   o  NULL: the defaults.
 * lab  NULL, or receives the experiment, ended, to be freed by the caller; NULL on failure. */
static inline brio_status trial_delaunay(brio_context *ctx, const double *points, const double *weights, size_t n,
                                         const trial_options *o, brio_triangulation **t, brio_laboratory **lab) {
    const trial_options none = {0};
    brio_delaunay_options library = trial_library(o ? o : &none);
    brio_laboratory_options experiment = trial_experiment(o ? o : &none);
    brio_laboratory *made = NULL;
    *t = NULL;
    if (lab) *lab = NULL;
    brio_status status = brio_laboratory_new(ctx, &experiment, &made);
    if (status != BRIO_OK) return status;
    status = brio_delaunay(ctx, points, weights, n, &library, t);
    brio_laboratory_end(made);
    if (lab && status == BRIO_OK)
        *lab = made;
    else
        brio_laboratory_free(made);
    return status;
}

/* Does what brio_order_points does, as an experiment. */
static inline brio_status trial_order(brio_context *ctx, const brio_input *input, const trial_options *o,
                                      uint32_t *order, uint32_t *rank, uint32_t *sequence, brio_round_ends *rounds) {
    brio_delaunay_options library = trial_library(o);
    brio_laboratory_options experiment = trial_experiment(o);
    brio_laboratory *lab = NULL;
    brio_status status = brio_laboratory_new(ctx, &experiment, &lab);
    if (status == BRIO_OK) status = brio_order_points(ctx, input, &library, order, rank, sequence, rounds);
    brio_laboratory_free(lab);
    return status;
}

/* The labelings of poles of experiments after those of the library. */
enum { TRIAL_NAIVE = BRIO_LABELING_END, TRIAL_THEORETICAL = TRIAL_NAIVE + 1, TRIAL_LABELINGS = TRIAL_NAIVE + 2 };

/* Chooses a labeling, for which an experiment begins that is to be freed. */
static inline brio_status trial_labeling(brio_context *ctx, int labeling, brio_pole_options *poles,
                                         brio_laboratory **lab) {
    brio_laboratory_options o = {0};
    bool library = labeling < BRIO_LABELING_END;
    poles->labeling = library ? (brio_labeling)labeling : BRIO_LABELING_GLOBAL;
    if (!library) o.labeling = (brio_laboratory_labeling)(labeling - TRIAL_NAIVE + BRIO_LABELS_NAIVE);
    return brio_laboratory_new(ctx, &o, lab);
}

#endif
