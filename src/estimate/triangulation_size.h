/* How large the triangulation of many points will be, and what is completed of one that repeats, estimated
 * from few of them. */
#ifndef BRIO_ESTIMATE_TRIANGULATION_SIZE_H
#define BRIO_ESTIMATE_TRIANGULATION_SIZE_H

#include "base/context.h"
#include "base/rng.h"
#include <assert.h>

typedef struct {
    double tetrahedra; /* infinite ones included */
    double hidden;     /* points without a cell */
} brio_triangulation_size;

/** Estimates the size of the Delaunay triangulation of finite points or, with weights, of the regular triangulation.
 *  Triangulates up to 4,096 points, or the surroundings of twelve points if there are more tetrahedra or points.
 *  points  #P by 3.   weights  #P, or NULL.
 *  Cost: about 20,000 insertions and fifty passes over the points; one megabyte.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_estimate_size(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                               brio_triangulation_size *size);

typedef struct {
    double points; /* triangulated at most by one round of the completion (completion/completion.h) */
    bool flat;     /* all points are in a plane or on a line */
} brio_completion_size;

/** Estimates them for a call of brio_delaunay_periodic.
 *  Cost: that call without its last step, for up to 4,096 of the points and for a quarter of these.
 *  Returns as brio_delaunay_periodic. */
brio_status brio_estimate_completion(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                     const brio_periodic_options *options, brio_completion_size *size);

/* --- what estimates do with some of the points, beside the work of the caller --- */

/** One thread is enough for a few points; an experiment is about the whole; the bar stands still. */
typedef struct {
    int threads;
    const struct brio_experiment *experiment;
    brio_bar bar;
} brio_aside;

static inline brio_aside brio_aside_begin(brio_context *ctx) {
    brio_aside a = {ctx->threads, ctx->experiment, brio_progress_bar(ctx)};
    ctx->threads = 1;
    ctx->experiment = NULL;
    brio_progress_part(ctx, a.bar, 0, 0);
    return a;
}

static inline void brio_aside_end(brio_context *ctx, const brio_aside *a) {
    ctx->threads = a->threads;
    ctx->experiment = a->experiment;
    brio_progress_part(ctx, a->bar, 0, 1);
}

/** Returns point i of `count` random points, one of each of `count` equal parts of all points. */
static inline size_t brio_sample_of(size_t i, size_t count, size_t points) {
    assert(i < count && count > 0 && points > 0);
    double part = (double)points / (double)count, within = (double)(brio_mix(i + 1) >> 11) * 0x1p-53;
    size_t at = (size_t)(((double)i + within) * part);
    return at < points ? at : points - 1;
}

#endif
