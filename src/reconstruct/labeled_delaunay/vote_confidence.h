/* How sure the labels make the surface. */
#ifndef BRIO_RECONSTRUCT_VOTE_CONFIDENCE_H
#define BRIO_RECONSTRUCT_VOTE_CONFIDENCE_H

#include "reconstruct/cocone/label_boundary.h"
#include "reconstruct/labeled_delaunay/vote_graph.h"

/** Finds the probability that the surface is right at each sample of it.
 *  label       #nodes of the graph.
 *  facets      the boundary of the labels.
 *  confidence  #P, written: in (0, 1); 0 for samples on no facet.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_vote_confidence(const brio_vote_graph *g, const uint8_t *label, const brio_facets *facets,
                                 float *confidence);

/** Finds the probability of the label of each tetrahedron by the votes of its samples alone: below 1/2 where they were
 *  outvoted.
 *  label       #nodes of the graph.   confidence  #T, written. */
void brio_tetrahedron_confidence(const brio_vote_graph *g, const uint8_t *label, float *confidence);

/** Finds the probability that a triangle is right.
 *  corners     the confidences of its vertices.
 *  size        the radius of its circle, by the usual one there; INFINITY if its corners are collinear. */
float brio_face_confidence(const float corners[3], float size);

#endif
