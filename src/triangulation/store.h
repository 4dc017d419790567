/* The store: the triangulation that is being built, as all threads share it.
 *
 *   records         0 ........... n - 1 | n, n + 1                 | n + 2                n = num_points
 *   record[p]       points, in the      | apexes of flat inputs    | the infinite
 *                   order of insertion  | (start.c)                | vertex
 *   caller, rank, representative, local: one entry for each record
 *
 *   slots           0 ........... t.count - 1 | t.count ... capacity - 1
 *   t.tet, state    handed out                | room
 *
 * A thread works on a store through an inserter (inserter.h). There are two regimes. Alone: one inserter exists, or all
 * others rest; that inserter may read and write everything. In a pass (parallel.c): each inserter has a zone (zone.h),
 * the set of segments of the curve whose vertices that thread holds.
 *
 * I1 to I4 stand in tetrahedra.h. While no insertion is under way:
 * I5  state[s] is TET_PLAIN for a slot s that holds a tetrahedron.
 * I6  A slot that is handed out and holds no tetrahedron belongs to one inserter: to its unused slots, with state
 *     TET_UNUSED, or to its stretch of fresh slots, without a state.
 * I7  representative[p] = p for each vertex and each record that is not yet inserted. From any other record the
 *     representatives lead to a vertex.
 * I8  caller permutes 0 .. n - 1. Insertion swaps two entries only, and only of coincident points of one weight.
 *
 * Who writes in a pass, and who may read meanwhile; the proof is in docs/decisions/006-segments-held-by-threads.md:
 * P1  The thread that holds all finite vertices of a tetrahedron writes its vertices and its state.
 * P2  The mate at a facet is written by the thread that destroys the tetrahedron on one of the facet's sides.
 * P3  A thread reads tetrahedra that it holds, and their neighbours: their vertices and states, and their mates at the
 *     common facet.
 * P4  The thread that holds the segment of record v writes and reads representative[v], caller[v] and local[v].
 *     Every inserter keeps a number of its own for the infinite vertex.
 *
 * Not stored: a tetrahedron of each vertex (vertex_tets.h), what was inserted so far. */
#ifndef BRIO_TRIANGULATION_STORE_H
#define BRIO_TRIANGULATION_STORE_H

#include "order/rounds.h"
#include "triangulation/tetrahedra.h"

typedef enum {
    TET_PLAIN = 0,  /* a tetrahedron */
    TET_CAVITY = 1, /* a tetrahedron in conflict with the point of the insertion under way */
    TET_UNUSED = 2  /* nothing */
} brio_tet_state;

/** "Alone" below: written by the one inserter that works, or by the step named; in a pass all threads read. */
typedef struct {
    brio_context *ctx;        /* constant */
    brio_tetrahedra t;        /* t.tet: moved alone by brio_store_reserve; what it holds: I1 to I4, P1 to P3.
                                 t.count: raised alone, or in a pass by any thread through brio_store_take, atomically;
                                 lowered by the canonical order. t.infinite, t.record: constant */
    uint8_t *state;           /* of each slot: brio_tet_state; moved alone by brio_store_reserve; I5, I6, P1, P3.
                                 The canonical order takes it over and frees it */
    size_t capacity;          /* slots there is room for; written alone */
    size_t max_tetrahedra;    /* constant: the most slots */
    brio_record *record;      /* written before the first insertion; freed before the canonical order */
    uint32_t *rank;           /* of each record along the curve, or NULL: never parallel; constant after brio_start */
    uint32_t *caller;         /* of each record: its index in the caller's arrays; I8, P4 */
    uint32_t *representative; /* of each record: itself, or a record that took its place; I7, P4 */
    uint8_t *local;           /* of each vertex: its number in the cavity where it was last; P4 */
    size_t num_points;        /* constant */
    bool weighted;            /* constant */
    bool follows;             /* a record is often close to the one before it; constant */
    int dimension;            /* of the points' affine hull, -1 without points; written by brio_start */
    brio_filter filter;       /* bounds for all records, which each inserter copies; written by brio_start */
} brio_store;

/** Orders the points and makes a store of their records, without tetrahedra.
 *  weights  NULL for none.
 *  rounds   NULL, or receives where the rounds of the order end. */
brio_status brio_store_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                           const brio_delaunay_options *options, brio_round_ends *rounds, brio_store **out);

/** Makes a store for a sample of another store's records: n records, which the caller of this function writes, with
 *  their entries of `caller`. */
brio_status brio_store_sample(const brio_store *from, size_t n, brio_store **out);

/** NULL is accepted. */
void brio_store_free(brio_store *store);

/** Makes room for at least `more` further slots. Alone only. BRIO_ERR_TOO_LARGE beyond max_tetrahedra. */
brio_status brio_store_reserve(brio_store *store, size_t more);

/** Hands out the slots [*begin, *begin + size) of the room there is; false, and no slot, where the room is less. By any
 *  thread at any time. */
bool brio_store_take(brio_store *store, size_t size, size_t *begin);

/** Frees the records, once only their indices matter. */
void brio_store_drop_records(brio_store *store);

/** The vertex that took the place of record p; p itself for a vertex. Shortens the way there. Alone only. */
static inline uint32_t brio_alive(const brio_store *store, uint32_t p) {
    uint32_t *representative = store->representative;
    while (representative[p] != p) p = representative[p] = representative[representative[p]];
    return p;
}

#endif
