/* The graph that labels travel along: its vertices are the poles, its edges join neighbours in the power diagram and
 * the two poles of each sample. */
#ifndef BRIO_RECONSTRUCT_POLE_GRAPH_H
#define BRIO_RECONSTRUCT_POLE_GRAPH_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/signed_graph.h"
#include "triangulation/star.h"

/** Neighbours are two poles whose power cells share a face: the ends of an edge of the regular triangulation of the
 *  polar balls. A hidden pole has one neighbour, its representative. Opposite poles are the two poles of one sample. */
typedef struct {
    brio_context *ctx;
    const brio_power_diagram *diagram;
    size_t *first;          /* #poles + 1: the edges of pole p are edge[first[p]] to edge[first[p + 1] - 1] */
    brio_signed_edge *edge; /* sorted by the number of the other end; several edges may join two poles */
} brio_pole_graph;

/** In the balanced graph, opposite poles count in full if the shape of their sample's cell is at least this. The value
 *  was chosen (docs/decisions/008-balanced-weights.md). */
#define BRIO_TRUSTED_SHAPE 1.3

/** How the weights of edges are computed. */
typedef struct {
    double least;  /* not balanced: an edge joins neighbours whose ball weight is over this */
    bool balanced; /* weights that also hold where samples are few (algorithms.md); needs poles->shape */
} brio_pole_evidence;

/** Builds the graph. The ball weight of two poles is -cos of the angle at which their balls intersect: -1 if they
 *  touch, 0 at a right angle, 1 if one ball is inside the other.
 *  - Neighbours, not balanced: the weight is the ball weight, or 0 if that is negative.
 *  - Neighbours, balanced: deep intersections weigh the square of the ball weight, shallow ones -0.1.
 *  - Opposite poles: the weight is the cosine of their angle at the sample. At an angle of less than 90 degrees there
 *    is no edge. The balanced graph lowers |weight| at badly shaped cells.
 *  diagram  kept: it must outlive the graph.
 *  out      to be freed with brio_pole_graph_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_pole_graph_new(brio_context *ctx, const brio_power_diagram *diagram, brio_pole_evidence evidence,
                                brio_pole_graph *out);
void brio_pole_graph_free(brio_pole_graph *g);

/** Returns the graph without the diagram, which must outlive the result. */
static inline brio_signed_graph brio_pole_signs(const brio_pole_graph *g) {
    return (brio_signed_graph){.ctx = g->ctx,
                               .count = g->diagram->poles->count,
                               .position = g->diagram->poles->centre,
                               .first = g->first,
                               .edge = g->edge};
}

#endif
