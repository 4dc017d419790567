/* Minimum cuts of graphs of tetrahedra, part by part. */
#ifndef BRIO_RECONSTRUCT_CUT_IN_PARTS_H
#define BRIO_RECONSTRUCT_CUT_IN_PARTS_H

#include "base/team.h"
#include "reconstruct/labels/label.h"

/* --- a part, closed: it needs nothing of the rest (part_cut.c) --- */

/** A mate that is none: the facet leads out of the part. */
#define BRIO_NO_MATE UINT32_MAX

/** The problem of a part, in a flat form: the number and the arrays are all that another thread or process needs to
 *  decide it. Arc 4 v + k is facet k of node v. */
typedef struct {
    size_t num_nodes;  /* below 2^30 */
    uint32_t *mate;    /* 4 #nodes: the same facet seen from the node on its other side, or BRIO_NO_MATE */
    int32_t *capacity; /* 4 #nodes: of the arc, not negative; not read where it leads out */
    int32_t *terminal; /* #nodes: a positive entry is a capacity from the source, a negative one to the sink */
    int32_t *outside;  /* #nodes: the sum of the capacities of the arcs that lead out of the part; twice this, the
                          terminal's magnitude and the other capacities together are less than 2^31 */
} brio_part_cut;

/** Makes room.   in_memory  whether the arrays are in memory where others would be in scratch files.
 *  out  freed with brio_part_cut_free, on failure too. */
brio_status brio_part_cut_new(brio_context *ctx, size_t num_nodes, bool in_memory, brio_part_cut *out);
void brio_part_cut_free(brio_context *ctx, brio_part_cut *c);

/** Finds the labels that the nodes of the part have in the minimum cut of the whole graph with the least sink's side,
 *  whatever the rest of the graph is: BRIO_LABEL_INNER on the sink's side, BRIO_LABEL_OUTER on the source's side,
 *  BRIO_LABEL_NONE where the rest decides. If no facet leads out, no node is left.
 *  c          capacities and terminals become those that the flow has left.
 *  in_memory  as above, of the workspace: 21 bytes a node.
 *  label      #nodes, written.
 *  Members of a run may call this together. Returns BRIO_OK, BRIO_ERR_NO_MEMORY.
 *  Based on: [Boykov Kolmogorov 2004]; [Kohli Torr 2007]; [Kovtun 2003]. */
brio_status brio_part_cut_decide(brio_context *ctx, brio_part_cut *c, bool in_memory, uint8_t *label);

/* --- a graph, part by part --- */

/** A graph that is read node by node. Nodes that are near each other in their order should be near in space. */
typedef struct {
    brio_context *ctx;
    size_t num_nodes; /* below 2^30 */
    /** Reads nodes [begin, end): writes the mates of their facets, or BRIO_NO_MATE, and their capacities, 0 where there
     *  is no mate, and their terminals, all as in brio_part_cut; those of `begin` come first. Threads call this
     *  together. */
    void (*read)(const void *user, size_t begin, size_t end, uint32_t *mate, int32_t *capacity, int32_t *terminal);
    const void *user;
    brio_swept along[4]; /* the arrays that `read` goes along; one with size 0 ends them */
    int32_t *residual;   /* 4 #nodes, or NULL: what the flow leaves of the capacities */
    bool has_flow;       /* whether `residual` is from an earlier cut with the same mates and capacities: then this one
                            begins from its flow, and both terminals of a node are meant where one is bounded */
} brio_cut_graph;

/** A node that a part left undecided, as brio_cut_graph.read gives it. */
typedef struct {
    uint32_t node, mate[4];
    int32_t capacity[4], terminal;
} brio_undecided;

/** The parts of a cut. Part i has the nodes i * size to (i + 1) * size - 1. */
typedef struct {
    const brio_cut_graph *g;
    size_t size, num_parts;
    uint8_t *label;        /* #nodes */
    brio_undecided **left; /* #parts: the undecided nodes of each, ascending */
    size_t *num_left;      /* #parts */
} brio_parts;

/** Sees that each part is decided: calls brio_parts_collect, has brio_part_cut_decide called, here or in another
 *  process, and calls brio_parts_keep. Parts are in any order, and several may be on their way at once. */
typedef struct brio_part_decider {
    brio_status (*decide)(void *user, brio_parts *p);
    void *user;
    size_t workers; /* that decide parts at once; 0: as many as the context has threads */
} brio_part_decider;

/** Return the first node and the number of nodes of a part. */
static inline size_t brio_part_first(const brio_parts *p, size_t i) {
    return i * p->size;
}
static inline size_t brio_part_nodes(const brio_parts *p, size_t i) {
    size_t left = p->g->num_nodes - brio_part_first(p, i);
    return left < p->size ? left : p->size;
}

/** Reads the problem of a part from the graph.   out  freed with brio_part_cut_free, on failure too. */
brio_status brio_parts_collect(const brio_parts *p, size_t i, brio_part_cut *out);

/** Keeps what brio_part_cut_decide finds out about a part. For different parts threads may call this together.
 *  cut  as it was left; may be NULL if the graph has no `residual`. */
brio_status brio_parts_keep(brio_parts *p, size_t i, const brio_part_cut *cut, const uint8_t *label);

/** Finds the minimum cut with the least sink's side. It does not depend on the parts.
 *  size     nodes of a part; 0: as many as suit the memory and the threads.
 *  decider  NULL: that of the context (context.h); without one, or where there is one part, the threads of the context.
 *  label    #nodes, written: BRIO_LABEL_INNER on the sink's side, else BRIO_LABEL_OUTER. On failure undefined.
 *  Cost: each part is collected once. Memory: 62 bytes a node of the parts in work, 81 a node that they left
 *  undecided, and 62 more where what they left is cut as a whole.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, or what the decider returns.
 *  Based on: [Kovtun 2003]; Liu, Sun. Parallel graph-cuts by adaptive bottom-up merging. CVPR 2010. */
brio_status brio_cut_in_parts(const brio_cut_graph *g, size_t size, const brio_part_decider *decider, uint8_t *label);

#endif
