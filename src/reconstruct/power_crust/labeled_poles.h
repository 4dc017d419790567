/* From samples to labeled polar balls: the part that the power crust, the power shape and offset surfaces share. */
#ifndef BRIO_RECONSTRUCT_LABELED_POLES_H
#define BRIO_RECONSTRUCT_LABELED_POLES_H

#include "reconstruct/labels/labeling.h"

enum { BRIO_BOUNDING_POINTS = 8 }; /* that bound the cells of the samples */

/** What to find. */
typedef struct {
    uint64_t seed;
    brio_pole_filter filter;
    brio_labeling labeling;
    const struct brio_label_part *experiment; /* in place of `labeling`, or NULL */
    brio_noise noise;
    const brio_mesh *solid; /* a closed mesh that gives the labels, or NULL; then `labeling` gives them */
    double margin;          /* moves the bounding points out by this, in the unit of the points */
    bool spacing;           /* whether to compute the spacing of each pole */
    bool representative;    /* whether to keep the representatives of the samples */
} brio_pole_request;

/** What was found of the samples. */
typedef struct {
    size_t samples;  /* distinct positions */
    double noise;    /* AUTO: the standard deviation of the noise found, in spacings of the samples; 0: none */
    size_t smoothed; /* 1: they were smoothed */
    double noise_seconds, delaunay_seconds, poles_seconds;
} brio_sample_stats;

/** Polar balls with labels, and their regular triangulation. All lengths are the caller's lengths
 *  times 2^-exponent, which makes coordinates of samples at most 1. */
typedef struct {
    brio_context *ctx;
    size_t num_samples;
    double *points; /* #samples + 8 by 3: the samples in canonical order, smoothed or not, and the bounding points */
    int exponent;
    uint32_t *order; /* #samples: the caller's index of each sample; NULL unless representatives were wanted */
    brio_delaunay_options triangulation;
    brio_poles poles;
    double *spacing;          /* #poles, or NULL */
    uint32_t *representative; /* #samples: the sample at the same position that has the poles; or NULL */
    brio_triangulation *power;
    brio_power_diagram diagram; /* a view of `poles` and of `power` */
    brio_pole_graph graph;      /* has no edges if a mesh gave the labels */
    uint8_t *label;
    brio_pole_stats stats;
    brio_sample_stats found;
} brio_labeled_poles;

/** Checks options and turns them into a request: margin 0, no spacing, no representatives.
 *  Returns BRIO_OK or BRIO_ERR_ARGUMENT. */
brio_status brio_pole_request_of(brio_context *ctx, const brio_pole_options *options, brio_noise noise, uint64_t seed,
                                 brio_pole_request *request);

/** Finds the poles of the points and labels them.
 *  l  freed with brio_labeled_poles_free, on failure too. It must not move in memory, because it contains pointers to
 *     its own fields.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the points or the poles span no solid), and what brio_delaunay and the
 *  labelings return. */
brio_status brio_labeled_poles_find(brio_context *ctx, const double *points, size_t num_points,
                                    const brio_pole_request *request, brio_labeled_poles *l);

/** Removes the poles p with keep[p] = 0 and triangulates the others with their present radii. The others keep their
 *  order, labels and spacings; their numbers close up. Samples lose their poles, and the graph its edges.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid), and what brio_delaunay returns. */
brio_status brio_labeled_poles_keep(brio_labeled_poles *l, const uint8_t *keep);

/** Makes the poles on the hull of the regular triangulation outer, which a closed crust requires. */
void brio_labeled_poles_close_hull(brio_labeled_poles *l);

void brio_labeled_poles_free(brio_labeled_poles *l);

#endif
