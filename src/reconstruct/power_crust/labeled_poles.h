/* From samples to labeled polar balls: what the power crust, the power shape and offset surfaces have in common. */
#ifndef BRIO_RECONSTRUCT_LABELED_POLES_H
#define BRIO_RECONSTRUCT_LABELED_POLES_H

#include "reconstruct/labels/labeling.h"

/** What is to be found. */
typedef struct {
    uint64_t seed;
    brio_pole_filter filter;
    brio_labeling labeling;
    brio_noise noise;
    const brio_mesh *solid; /* a closed mesh that gives the labels instead, or NULL */
    double margin;          /* by which the bounding points are moved out, in the unit of the points */
    bool spacing;           /* of the poles */
    bool representative;    /* of the samples */
} brio_pole_request;

/** Polar balls with labels, and the regular triangulation of them. */
typedef struct {
    brio_context *ctx;
    size_t num_samples;
    double *
        points; /* samples in their canonical order, smoothed or not, and bounding points; all lengths here are scaled by 2^-exponent, which makes the
                       samples and the margin at most 1 */
    int exponent;
    uint32_t *order; /* #samples: the caller's index of each, where representatives are wanted; else NULL */
    brio_delaunay_options triangulation;
    brio_poles poles;
    double *spacing;          /* of the poles, or NULL */
    uint32_t *representative; /* of the samples, or NULL */
    brio_triangulation *power;
    brio_power_diagram diagram; /* a view of the poles and of `power` */
    brio_pole_graph graph;      /* without edges where the labels came from elsewhere */
    uint8_t *label;
    brio_pole_stats stats;
} brio_labeled_poles;

/** Checks options and turns them into a request without margin, spacing or representatives. Returns BRIO_OK,
 *  or BRIO_ERR_ARGUMENT for numbers out of range. */
brio_status brio_pole_request_of(brio_context *ctx, const brio_pole_options *options, uint64_t seed,
                                 brio_pole_request *request);

/** Finds the poles of points and labels them.   l  to be freed on failure too; it does not move meanwhile.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid), and as brio_delaunay. */
brio_status brio_labeled_poles_find(brio_context *ctx, const double *points, size_t num_points,
                                    const brio_pole_request *request, brio_labeled_poles *l);

/** Takes away the poles for which keep is 0, and triangulates those that are left with their present radii; the
 *  others' numbers, labels and spacings close up in order. Samples forget their poles, and the graph has no edges.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the poles span no solid), and as brio_delaunay. */
brio_status brio_labeled_poles_keep(brio_labeled_poles *l, const uint8_t *keep);

/** Makes the poles on the hull of the triangulation outer, as a crust needs it. */
void brio_labeled_poles_close_hull(brio_labeled_poles *l);

void brio_labeled_poles_free(brio_labeled_poles *l);

#endif
