/* Labeling of poles as inner or outer. */
#ifndef BRIO_RECONSTRUCT_LABELING_H
#define BRIO_RECONSTRUCT_LABELING_H

#include "reconstruct/labels/pole_graph.h"

/** What a labeling counts; fields it does not know of stay as they were. */
typedef struct {
    size_t confused;      /* poles that had evidence for both labels when they were labeled */
    size_t unreached;     /* left to the greedy labeling by another one */
    size_t undecided;     /* not settled by the last roof duality of their blocks */
    size_t toggled;       /* that differ from the greedy labeling in the end */
    double energy_greedy; /* sum of the violated weights of the greedy labels to begin with */
} brio_labeling_stats;

/* Every labeling gives label[p] to every pole, hidden ones too; *label is BRIO_LABEL_NONE throughout to begin with.
 * Poles whose tetrahedron has a bounding point and the poles on the hull of the power diagram's dual are certain: outer
 * for good. Only then does every crust face close. */

/** The surest pole first. Poles that are labeled already keep their labels and are as sure as the certain ones. */
brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Breadth first from all certain poles. */
brio_status brio_label_naive(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Breadth first from one sample of the hull; the graph has the edges of weight over BRIO_THEORETICAL_WEIGHT. */
brio_status brio_label_theoretical(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** The greedy labels, but for poles beyond the box of the samples being outer, toggled as long as roof duality finds sets
 *  of poles in one of many blocks to lower the energy by. */
brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** -cos of pi / 4: the balls of the theoretical algorithm's neighbours intersect at a larger angle. */
#define BRIO_THEORETICAL_WEIGHT (-0.70710678118654752)

/** certain[p] = 1 for the poles that are outer for good, else 0; others are not written where they are 1. */
void brio_label_certain(const brio_pole_graph *g, uint8_t *certain);

/** Whether the labels of pole p and of the other end of its edge are not as the edge wants them. */
static inline bool brio_label_violates(const uint8_t *label, uint32_t p, brio_pole_edge edge) {
    return (label[p] == label[edge.pole]) == (edge.weight < 0);
}

/** The sum of the violated weights: neighbours of different labels, or of one where different ones are wanted, opposite
 *  poles of the same. */
double brio_label_energy(const brio_pole_graph *g, const uint8_t *label);

/** Spreads labels breadth first from the poles of a queue, that are labeled: deeply intersecting neighbours get the
 *  same label, opposite poles the opposite one, certain poles outer whatever reaches them.
 *  queue  #poles, of which `size` are filled. */
void brio_label_spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size);

/** Lets the greedy labeling label what is not yet labeled, and counts it. */
brio_status brio_label_finish(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

#endif
