/* The history DAG: every tetrahedron that ever existed, and the insertion that destroyed it.
 *
 * A destroyed tetrahedron links to all tetrahedra that the destroying insertion created. The nodes of one insertion
 * are consecutive. So a node stores its vertices and the number of the destroying insertion, and an insertion stores
 * its first node. Insertion 0 is the start. */
#ifndef BRIO_LABORATORY_HISTORY_H
#define BRIO_LABORATORY_HISTORY_H

#include "laboratory/location/trial.h"

typedef struct {
    uint32_t vertex[4];
    uint32_t next; /* number of the insertion that destroyed it, or BRIO_HISTORY_LIVE + its slot */
} brio_history_node;

#define BRIO_HISTORY_LIVE (UINT32_C(1) << 31)

/** Stands for a node: search from the first tetrahedra on. */
#define BRIO_HISTORY_ROOT UINT32_MAX

/** How a search goes through the history: along one path, or through conflicts to the first live one, or to all. */
typedef enum { BRIO_SEARCH_PATH, BRIO_SEARCH_FIRST_CONFLICT, BRIO_SEARCH_ALL_CONFLICTS } brio_history_search;

/** Nodes of one insertion that a search has still to test: [node, end). */
typedef struct {
    uint32_t node, end;
} brio_history_span;

typedef struct {
    brio_laboratory_stats *stats; /* of the trial, where it counts */
    brio_history_node *node;
    size_t num_nodes, node_capacity;
    uint32_t *first; /* first node of each insertion; then the end of the last */
    size_t num_insertions, first_capacity;
    uint32_t *node_of; /* node of each slot */
    size_t slot_capacity;
    brio_history_search search;
    /* state of the search for conflicts */
    uint32_t *seen;          /* of each insertion, the last search that reached it */
    brio_history_span *open; /* the insertions on the way from the root, the deepest one last */
    uint32_t *conflict;      /* live tetrahedra found in conflict */
    size_t seen_capacity, open_capacity, conflict_capacity, num_conflicts;
    uint32_t searches;
} brio_history;

/** Makes a history of the first tetrahedra. The caller frees the history, also after a failure. */
brio_status brio_history_new(brio_inserter *ins, brio_history *out);
void brio_history_free(brio_context *ctx, brio_history *h);

/** Adds the insertion whose cavity was filled last. Returns BRIO_ERR_TOO_LARGE beyond 2^32 - 2 nodes. */
brio_status brio_history_add(brio_inserter *ins, brio_history *h);

/** Returns the live tetrahedron whose closure holds p. For p strictly outside the hull, returns an infinite
 *  tetrahedron whose facet has p strictly outside.   from  a node with this property, or BRIO_HISTORY_ROOT. */
uint32_t brio_history_path(brio_inserter *ins, brio_history *h, uint32_t from, const double *p);

/** Lists in h->conflict the first `most` live tetrahedra in conflict with p that a search meets which goes depth first
 *  from node `from` through nodes in conflict with p. A tetrahedron with a vertex at p's position counts as in
 *  conflict. Lists none when p is hidden. */
brio_status brio_history_conflicts(brio_inserter *ins, brio_history *h, uint32_t from, const double *p, size_t most);

/** Does what a strategy's `locate` does, by the search that the options choose. */
brio_status brio_history_locate(brio_inserter *ins, brio_history *h, uint32_t from, const double *p, uint32_t *tet);

#endif
