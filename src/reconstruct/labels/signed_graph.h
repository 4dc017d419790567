/* Graphs whose edges say whether their two ends should have one label or different ones, and the energy of labels. */
#ifndef BRIO_RECONSTRUCT_SIGNED_GRAPH_H
#define BRIO_RECONSTRUCT_SIGNED_GRAPH_H

#include "base/context.h"
#include "reconstruct/labels/label.h"

/** An edge, stored at both of its ends. */
typedef struct {
    uint32_t node; /* the other end */
    float weight;  /* in [-1, 1]. At least 0: the ends should have the same label. Negative: they should not. */
} brio_signed_edge;

/** The struct owns nothing. */
typedef struct {
    brio_context *ctx;
    size_t count;           /* of nodes */
    const double *position; /* #nodes by 3: nodes that an edge joins should be near each other */
    int exponent;           /* positions are below 2^exponent */
    const size_t *first;    /* #nodes + 1: the edges of node p are edge[first[p]] to edge[first[p + 1] - 1] */
    const brio_signed_edge *edge;
} brio_signed_graph;

/** Returns whether the labels of node p and of the other end of its edge contradict the edge: labels that differ
 *  although the weight is at least 0, or labels that are equal although it is negative. */
static inline bool brio_label_violates(const uint8_t *label, uint32_t p, brio_signed_edge edge) {
    return (label[p] == label[edge.node]) == (edge.weight < 0);
}

/** Returns the energy of labels: the sum of |weight| over the edges that the labels contradict, each edge counted
 *  once. Does not depend on the number of threads. */
brio_status brio_label_energy(const brio_signed_graph *g, const uint8_t *label, double *out);

/** What brio_lower_energy does, and what it counts. */
typedef struct {
    int first_bits;   /* pass i has blocks of 2^(first_bits + i) nodes */
    int passes;       /* most passes */
    double from;      /* of the progress of "label" at the start; 1 at the end */
    size_t undecided; /* written: nodes that the last roof duality of their block did not decide */
} brio_energy_descent;

/** Lowers the energy of labels by roof duality on blocks of nodes. Stops after `passes` passes, or after one that flips
 *  next to nothing. No step raises the energy. Nodes p with fixed[p] != 0 keep their labels.
 *  label  #nodes, read and written: inner or outer.
 *  The result does not depend on the number of threads.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_lower_energy(const brio_signed_graph *g, const uint8_t *fixed, brio_energy_descent *descent,
                              uint8_t *label);

#endif
