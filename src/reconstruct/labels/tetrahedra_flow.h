/* Maximum flow and minimum cut of finite tetrahedra, joined across their facets. The triangulation has the graph: facet
 * handles are the arcs. */
#ifndef BRIO_RECONSTRUCT_TETRAHEDRA_FLOW_H
#define BRIO_RECONSTRUCT_TETRAHEDRA_FLOW_H

#include "reconstruct/labels/max_flow.h"
#include "triangulation/tetrahedra.h"

/** The arrays that a flow reads and writes. Of tetrahedra that do not take part only `side` is read, which is
 *  BRIO_FLOW_FREE there, and `residual` of facets to tetrahedra that do. */
typedef struct {
    brio_context *ctx;
    const brio_tetrahedra *t;
    const uint32_t *open; /* num_open: the tetrahedra that take part; NULL: those below num_open do */
    size_t num_open;
    size_t part_size;       /* tetrahedra of a part: parts are pushed side by side at first */
    size_t most_together;   /* as many are merged before others are begun */
    bool started;           /* whether there was a flow */
    size_t from, to;        /* open[from] to open[to - 1] are pushed now */
    brio_flow_node *node;   /* #T */
    int32_t (*residual)[4]; /* #T by 4: of the arc across facet i */
    int32_t *terminal;      /* #T */
    uint8_t *side;          /* #T: a brio_flow_side each */
    brio_flow_trees trees;
} brio_tet_flow;

/** Makes room.   t, open  kept; open is ascending.   out  freed with brio_tet_flow_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_tet_flow_new(brio_context *ctx, const brio_tetrahedra *t, const uint32_t *open, size_t num_open,
                              brio_tet_flow *out);
void brio_tet_flow_free(brio_tet_flow *f);

/** Finds a maximum flow and the side of every tetrahedron that takes part.
 *
 *  Before the first call the caller sets `residual`, each less than 2^30: the capacity of a facet at both of its ends,
 *  0 at both ends where one of them does not take part. It also sets `terminal`: positive capacities from the source,
 *  negative ones to the sink; the sum of the magnitudes at a tetrahedron is less than 2^31.
 *  Before a further call, which begins from the flow of the last one, the caller adds the changes to `terminal`. Such a
 *  call is quick if few terminals changed. Runs in threads. The sides do not depend on the number of threads, nor on
 *  part_size and most_together.
 *  Based on: [Boykov Kolmogorov 2004]; Kohli, Torr. Dynamic graph cuts for efficient inference in Markov random fields.
 *            IEEE PAMI 2007. Liu, Sun. Parallel graph-cuts by adaptive bottom-up merging. CVPR 2010. */
brio_status brio_tet_flow_run(brio_tet_flow *f);

#endif
