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
 *   field                          written by, when                               read in a pass by
 *   t.tet, state, capacity:        brio_store_reserve, alone; the canonical       every thread
 *   the arrays and their size      order, which frees the states
 *   t.tet[s], state[s]             the inserter alone; in a pass P1, P2           P3
 *   t.count                        brio_store_take, at any time, atomically;      brio_store_take
 *                                  alone also the inserter and the last step
 *   record, rank, sequence         before the first insertion; brio_start         every thread
 *                                  brings some records to the front
 *   caller, representative, local  the inserter alone; in a pass P4               P4
 *   dimension, filter              brio_start                                     every thread
 *   all others                     the constructor                                every thread
 *
 * In a pass; decision 006 (docs/decisions/006-segments-held-by-threads.md) is the proof that no two threads collide:
 * P1  The thread that holds all finite vertices of a tetrahedron writes its vertices and its state.
 * P2  The mate at a facet is written by the thread that destroys the tetrahedron on one of the facet's sides.
 * P3  A thread reads vertices, states and mates of the tetrahedra that it holds and of their neighbours. It reads the
 *     vertices behind a neighbour's facet, too: the conflict test of an infinite tetrahedron may need them.
 * P4  The thread that holds the segment of record v writes and reads representative[v], caller[v] and local[v].
 *     For the infinite vertex there is no local: each inserter stores that number itself.
 *
 * Not stored: a tetrahedron of each vertex (vertex_tets.h), what was inserted so far. */
#ifndef BRIO_TRIANGULATION_STORE_H
#define BRIO_TRIANGULATION_STORE_H

#include "order/rounds.h"
#include "triangulation/records.h"
#include <assert.h>

typedef enum {
    TET_PLAIN = 0,  /* a tetrahedron */
    TET_CAVITY = 1, /* a tetrahedron in conflict with the point of the insertion under way */
    TET_UNUSED = 2  /* nothing */
} brio_tet_state;

typedef struct {
    brio_context *ctx;
    brio_tetrahedra t; /* t.count: slots handed out; t.record: the records */
    uint8_t *state;    /* of each slot: brio_tet_state */
    size_t capacity;   /* slots that there is room for */
    size_t max_tetrahedra;
    uint64_t points_hash;     /* base/points_hash.h */
    brio_record *record;      /* NULL once only their indices matter */
    uint32_t *rank;           /* of each record: its place along the curve; NULL when one thread is to insert */
    uint32_t *sequence;       /* the records in the sequence of insertion; NULL when they stand in it */
    uint32_t *caller;         /* of each record: its index in the caller's arrays */
    uint32_t *representative; /* of each record: itself, or a record that took its place */
    uint8_t *local;           /* of each vertex: its number in the cavity where it was last */
    size_t num_points;
    bool weighted;
    bool adopted;       /* the tetrahedra were not inserted in any sequence of the records */
    bool follows;       /* a record is often close to the one before it */
    int dimension;      /* of the points' affine hull, -1 without points */
    brio_filter filter; /* bounds for all records, which each inserter copies */
} brio_store;

/** Orders the points and makes a store of their records, without tetrahedra.
 *  rounds NULL, or receives where the rounds of the order end. */
brio_status brio_store_new(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                           brio_round_ends *rounds, brio_store **out);

/** Makes a store for a sample of another store's records: n records, which the caller of this function writes, with
 *  their entries of `caller`. */
brio_status brio_store_sample(const brio_store *from, size_t n, brio_store **out);

/** Frees a store; NULL is accepted. */
void brio_store_free(brio_store *store);

/** Makes room for at least `more` further slots. Alone only. BRIO_ERR_TOO_LARGE beyond max_tetrahedra. */
brio_status brio_store_reserve(brio_store *store, size_t more);

/** Gives back the room beyond the slots that were taken. Alone only. */
brio_status brio_store_fit(brio_store *store);

/** Hands out the slots [*begin, *begin + size) of the room there is; returns false, and hands out no slot, where
 *  the room is less. Any thread may call this at any time. */
bool brio_store_take(brio_store *store, size_t size, size_t *begin);

/** Returns the record that is inserted after `turn` others. */
static inline uint32_t brio_record_at(const brio_store *store, size_t turn) {
    assert(turn < store->num_points);
    return store->sequence ? store->sequence[turn] : (uint32_t)turn;
}

/** Frees the records and their sequence, once only the records' indices matter. */
void brio_store_drop_records(brio_store *store);

/** Returns the vertex that took the place of record p; p itself for a vertex. Shortens the way there. Alone only. */
static inline uint32_t brio_alive(const brio_store *store, uint32_t p) {
    uint32_t *representative = store->representative;
    assert(p < store->num_points + 3);
    while (representative[p] != p) p = representative[p] = representative[representative[p]];
    return p;
}

#endif
