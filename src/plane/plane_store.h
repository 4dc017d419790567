/* The triangulation of the plane that is being built.
 *
 *   triangle[t].vertex[i]   vertex i of triangle t: a record, or `infinite`
 *   triangle[t].mate[i]     edge handle 4 u + j of the same edge seen from the triangle u on its other side
 *
 *   records    0 ........... n - 1 | n                   | n + 1               n = num_points
 *   record[p]  points, in the      | apex of points on   | the infinite
 *              order of insertion  | a line              | vertex, not set
 *   caller, representative: one entry for each record
 *
 *   slots      0 ........... count - 1 | count ... capacity - 1
 *   triangle   handed out              | room
 *
 * Between insertions:
 * I1  A finite triangle is counterclockwise.
 * I2  The infinite vertex is only ever in slot 2, and (a, b, x) is counterclockwise for x strictly outside the hull
 *     edge ab of the infinite triangle (a, b, infinite).
 * I3  mate is an involution, and mates have the same two vertices.
 * I4  The triangles are those of the perturbed regular triangulation of the points inserted so far.
 * I5  A slot that is handed out and holds no triangle is listed in `unused`. Only hidden vertices leave such slots.
 * I6  representative[p] = p for each vertex and each record that is not yet inserted. From any other record the
 *     representatives lead to a vertex.
 * I7  caller permutes 0 .. n - 1. Insertion swaps two entries only, and only of coincident points of one weight.
 *
 * v vertices have 2 v - 2 triangles, infinite ones included, so the capacity is known from the start. */
#ifndef BRIO_PLANE_PLANE_STORE_H
#define BRIO_PLANE_PLANE_STORE_H

#include "plane/plane_input.h"
#include <assert.h>

/** A list that grows. */
typedef struct {
    uint32_t *item;
    size_t count, capacity;
} brio_plane_list;

typedef struct {
    brio_context *ctx;
    brio_triangle *triangle;
    size_t count, capacity;
    uint32_t infinite;
    brio_plane_record *record;
    uint32_t *caller;         /* of each record: its index in the caller's arrays */
    uint32_t *representative; /* of each record: itself, or a record that took its place */
    size_t num_points;
    bool weighted;
    int dimension;            /* of the points' affine hull, -1 without points */
    brio_plane_filter filter; /* of all records */
    uint32_t start;           /* a triangle near the record inserted last */
    brio_plane_list unused;
    /* the cavity of the insertion under way */
    brio_plane_list ahead;    /* edges of triangles in conflict, behind which the search goes on */
    brio_plane_list cavity;   /* triangles in conflict */
    brio_plane_list boundary; /* edges of triangles around the cavity, counterclockwise as the cavity sees them */
    uint8_t *dug;             /* of each slot: whether it is in the cavity; NULL without weights */
    brio_delaunay2_stats stats;
    uint64_t points_hash; /* base/points_hash.h */
} brio_plane_store;

static const uint32_t BRIO_NO_TRIANGLE = UINT32_MAX;

/* Makes an edge handle. bits 0 and 1: the slot opposite to the edge, 0 to 2; bits 2 to 31: the triangle. */
static inline uint32_t brio_edge_of(uint32_t triangle, uint32_t i) {
    assert(triangle >> 30 == 0 && i < 3);
    return 4 * triangle + i;
}
static inline uint32_t brio_triangle_of(uint32_t edge) {
    return edge >> 2;
}
static inline uint32_t brio_edge_slot(uint32_t edge) {
    assert((edge & 3) < 3);
    return edge & 3;
}
/* Return the slots after and before slot i, counterclockwise. */
static inline uint32_t brio_slot_after(uint32_t i) {
    assert(i < 3);
    return i == 2 ? 0 : i + 1;
}
static inline uint32_t brio_slot_before(uint32_t i) {
    assert(i < 3);
    return i == 0 ? 2 : i - 1;
}

/** Orders the points and makes a store of their records, without triangles. Frees what the input owns.
 *  Returns what brio_plane_records_new returns. */
brio_status brio_plane_store_new(brio_context *ctx, brio_plane_input *input, const brio_delaunay2_options *options,
                                 brio_plane_store **out);

/** Frees a store; NULL is accepted. */
void brio_plane_store_free(brio_plane_store *store);

/** Returns the vertex that took the place of record p; p itself for a vertex. Shortens the way there. */
static inline uint32_t brio_plane_alive(const brio_plane_store *s, uint32_t p) {
    assert(p < s->num_points);
    uint32_t *representative = s->representative;
    while (representative[p] != p) p = representative[p] = representative[representative[p]];
    return p;
}

#endif
