/* The cavity of a point: its lists, and how it is filled. */
#ifndef BRIO_TRIANGULATION_CAVITY_H
#define BRIO_TRIANGULATION_CAVITY_H

#include "base/context.h"

typedef struct brio_inserter brio_inserter;

/** An edge of the border that was met from one of its two facets. */
typedef struct {
    uint32_t tag;   /* bits of the edge's hash that do not choose its place */
    uint32_t facet; /* of the new tetrahedron that it was met from; 0, a facet of none: no edge */
} brio_border_edge;

/** Workspace of one insertion, kept from one to the next. All of it belongs to one thread. */
typedef struct {
    uint32_t *entry;   /* of each tetrahedron in conflict, the facet through which it was found */
    uint32_t *created; /* a tetrahedron for each border facet: the star of the last point that was inserted */
    uint32_t *facet;   /* outer sides of the facets that left the cavity; then codes of the border's vertices */
    uint32_t *border;  /* those of them that lead to no conflict */
    size_t num_tets, num_border, num_created;
    size_t capacity;         /* of entry, a quarter of that of the other lists */
    size_t pause;            /* number of tets, at most the capacity, at which the dig looks up: brio_cavity_pause */
    uint32_t *cavity_vertex; /* the vertices of all tets, with repetitions; weighted only */
    size_t cavity_vertex_capacity;
    uint8_t infinite_local; /* the store's `local` of the infinite vertex, which all threads meet */
    uint32_t *table;        /* facet handle of each directed edge of the border, BRIO_TABLE of them */
    brio_border_edge *edge; /* hash table of edges, for large borders */
    size_t edge_capacity;
} brio_cavity;

enum { BRIO_TABLE = 1 << 16 };

/** Makes an empty cavity. The caller frees it, also after a failure. */
brio_status brio_cavity_new(brio_context *ctx, brio_cavity *out);
void brio_cavity_free(brio_context *ctx, brio_cavity *c);

/** Makes room for a cavity that grows, and reports progress from a large one. */
brio_status brio_cavity_pause(brio_inserter *ins);

/** Gives a dig up: the tetrahedra of the cavity are plain again. */
void brio_cavity_undo(brio_inserter *ins);

/** Replaces the cavity by the star of record p; vertices that lose their last tetrahedron become hidden. *deferred
 *  becomes true, and everything is as before the dig, when a parallel pass has no more slots. */
brio_status brio_cavity_fill(brio_inserter *ins, uint32_t p, bool *deferred);

#endif
