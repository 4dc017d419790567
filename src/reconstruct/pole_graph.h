/* The graph of poles that labels travel along: neighbours in the power diagram, and the two poles of each sample. */
#ifndef BRIO_RECONSTRUCT_POLE_GRAPH_H
#define BRIO_RECONSTRUCT_POLE_GRAPH_H

#include "dual/poles.h"
#include "triangulation/star.h"

typedef enum { BRIO_LABEL_NONE = 0, BRIO_LABEL_OUTER = 1, BRIO_LABEL_INNER = 2 } brio_label;

/** An edge as its one end sees it. */
typedef struct {
    uint32_t pole; /* the other end */
    float weight;  /* at least 0: a neighbour, which wants the same label; negative: an opposite pole, which wants the
                      other label; at most 1 in magnitude */
} brio_pole_edge;

/** Two poles are neighbours when their power cells share a face, that is an edge of the regular triangulation of the
 *  polar balls; a hidden pole has one neighbour, its representative. Two poles are opposite when they are the poles of
 *  one sample. */
typedef struct {
    brio_context *ctx;
    const brio_poles *poles;
    const double *samples; /* #samples by 3 */
    size_t num_samples;
    brio_tetrahedra power; /* the regular triangulation of the polar balls, caller's indices */
    size_t num_finite;
    size_t *first;        /* #poles + 1: the edges of each pole, by the numbers of their other ends */
    brio_pole_edge *edge; /* between two poles there may be several */
} brio_pole_graph;

/** Prepares the graph; what it holds is to be freed on failure too. Keeps pointers to poles, samples and power. The
 *  weight of an edge between neighbours is -cos of the angle at which their balls intersect: -1 where they touch, 0 at
 *  a right angle, 1 for a ball inside the other; edges of weight `least_weight` and less are left out, and negative
 *  weights are listed as 0. That of an edge between opposite poles is cos of the angle at the sample, and edges at less
 *  than a right angle are left out. */
brio_status brio_pole_graph_new(brio_context *ctx, const brio_poles *poles, const double *samples, size_t num_samples,
                                const brio_triangulation *power, double least_weight, brio_pole_graph *out);
void brio_pole_graph_free(brio_pole_graph *g);

/** The weight of an edge between two neighbours, deep or not; over 1 for a ball inside the other. */
double brio_pole_graph_weight(const brio_pole_graph *g, uint32_t p, uint32_t q);

#endif
