/* The graph of poles that labels travel along: neighbours in the power diagram, and the two poles of each sample. */
#ifndef BRIO_RECONSTRUCT_POLE_GRAPH_H
#define BRIO_RECONSTRUCT_POLE_GRAPH_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/label.h"
#include "triangulation/star.h"

/** An edge as its one end sees it. */
typedef struct {
    uint32_t pole; /* the other end */
    float weight;  /* at least 0: the same label is wanted; negative: the other one; at most 1 in magnitude */
} brio_pole_edge;

/** Two poles are neighbours when their power cells share a face, that is an edge of the regular triangulation of the
 *  polar balls; a hidden pole has one neighbour, its representative. Two poles are opposite when they are the poles of
 *  one sample. */
typedef struct {
    brio_context *ctx;
    const brio_power_diagram *diagram;
    size_t *first;        /* #poles + 1: the edges of each pole, by the numbers of their other ends */
    brio_pole_edge *edge; /* between two poles there may be several */
} brio_pole_graph;

/** Cells of this shape and better are trusted in the balanced graph. */
#define BRIO_TRUSTED_SHAPE 1.3

/** What edges say of labels. */
typedef struct {
    double least;  /* neighbours have an edge when the weight of their balls is over this ... */
    bool balanced; /* ... or as the surest evidence has it on samples of any density; needs the shapes of cells */
} brio_pole_evidence;

/** Prepares the graph; what it holds is to be freed on failure too. Keeps the pointer to the diagram. The
 *  weight of two balls is -cos of the angle at which they intersect: -1 where they touch, 0 at a right angle, 1 for a
 *  ball inside the other. An edge between neighbours has this weight, or 0 where it is negative; one between opposite
 *  poles the cosine of their angle at the sample, and at less than a right angle there is none. In the balanced graph deep
 *  edges have the square, shallow ones, which want different labels, a small weight, and opposite poles are the less sure
 *  of each other the worse the cell of their sample is shaped. */
brio_status brio_pole_graph_new(brio_context *ctx, const brio_power_diagram *diagram, brio_pole_evidence evidence,
                                brio_pole_graph *out);
void brio_pole_graph_free(brio_pole_graph *g);

#endif
