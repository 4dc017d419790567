/* The history DAG: every tetrahedron that ever was, and the insertion that destroyed it.
 *
 * A destroyed tetrahedron links to all that its insertion created. Those are nodes one after the other, so a node needs
 * its vertices and the number of that insertion, and an insertion the first of its nodes. Insertion 0 is the start. */
#ifndef BRIO_TRIANGULATION_HISTORY_H
#define BRIO_TRIANGULATION_HISTORY_H

#include "triangulation/inserter.h"

typedef struct {
    uint32_t vertex[4];
    uint32_t next; /* the insertion that destroyed it, or BRIO_HISTORY_LIVE + its slot */
} brio_history_node;

#define BRIO_HISTORY_LIVE (UINT32_C(1) << 31)

/** In place of a node: search from the first tetrahedra on. */
#define BRIO_HISTORY_ROOT UINT32_MAX

typedef struct {
    brio_history_node *node;
    size_t num_nodes, node_capacity;
    uint32_t *first; /* node of each insertion, and one more at the end */
    size_t num_insertions, first_capacity;
    uint32_t *node_of; /* of each slot */
    size_t slot_capacity;
    bool all_conflicts;
    /* of the search for all conflicts */
    uint32_t *seen;                 /* of each insertion, the last search that came to it */
    uint32_t *insertion, *conflict; /* those that this search came to; the live tetrahedra in conflict that it met */
    size_t seen_capacity, insertion_capacity, conflict_capacity, num_conflicts;
    uint32_t searches;
} brio_history;

/** A history of the first tetrahedra. After a failure the history is to be freed, too. */
brio_status brio_history_new(brio_inserter *ins, const brio_delaunay_options *options, brio_history *out);
void brio_history_free(brio_context *ctx, brio_history *h);

/** Adds the insertion whose cavity was filled last. BRIO_ERR_TOO_LARGE beyond 2^32 - 2 nodes. */
brio_status brio_history_add(brio_inserter *ins, brio_history *h);

/** The live tetrahedron whose closure holds p, or, for p strictly outside the hull, an infinite one whose facet p is
 *  strictly outside of.   from  a node of which the same is true, or BRIO_HISTORY_ROOT. */
uint32_t brio_history_path(brio_inserter *ins, brio_history *h, uint32_t from, const double *p);

/** h->conflict = the live tetrahedra in conflict with p that can be reached from that node through nodes in conflict
 *  with p; or those of the vertex at p's position. None when p is hidden. */
brio_status brio_history_conflicts(brio_inserter *ins, brio_history *h, uint32_t from, const double *p);

/** What a strategy's `locate` gives, by the search of the options. */
brio_status brio_history_locate(brio_inserter *ins, brio_history *h, uint32_t from, const double *p, uint32_t *tet);

#endif
