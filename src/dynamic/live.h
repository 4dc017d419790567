/* A triangulation that lives: the store behind brio_dynamic.
 *
 *   rows     0            1 ........... num_rows - 1
 *   record   the infinite points, dead or alive; a row that is free is used again
 *            vertex
 *   names    the caller's indices: row_of[name] is the row of a point, or BRIO_NONE once it was removed
 *   slots    as in triangulation/tetrahedra.h: I1 to I4 hold between changes, with t.infinite = 0
 *
 * The infinite vertex is row 0, so rows can be added without end; the bounds of the filter are those of a box that
 * grows with the points. Slots and rows that are free wait in lists.
 *
 * Between changes:
 * L1  home[r] is a tetrahedron of vertex r; of a hidden row, the finite tetrahedron that holds it and that it does not
 *     conflict with; of a twin, the vertex at its position.
 * L2  hidden[s], with weights, is the first of the hidden rows whose home is slot s; `twins` of a vertex' row is the
 *     first of its twins; next and prev lead through such a list.
 * L3  A vertex is at least as heavy as each of its twins, and has the least name among those of its weight. So the
 *     vertices are those that brio_delaunay would choose.
 * L4  In an input of dimension 2 or less there are no tetrahedra, and every row that is alive is loose.
 *
 * L5  While `travelled` is at most until[s], the tetrahedron of slot s is finite and positive, and no vertex behind a
 *     facet that it shares with a finite tetrahedron of higher number is in conflict with it. until[s] is below 0
 *     where a test has to say so (slack.c).
 *
 * In a pass (together.c) each thread has a hand: a brio_dynamic with hole, lists, journal, filter and counts of its
 * own, which shares the arrays of rows and slots. A hand holds a zone (zone.h):
 * L6  The hand that holds all finite vertices of a tetrahedron writes its slot, state and list. The mate at a facet is
 *     written by the hand that destroys the tetrahedron on one of its sides.
 * L7  The hand that holds a vertex writes its home, number, kind and row; its record, if it also holds all finite
 *     vertices of its star. Decision 030 is the proof that no other hand reads it then.
 * L8  Hidden rows, twins, holes that are large and rows that are no vertices any more are left to one thread.
 * L9  Times (until) and hints are written by any hand, atomically: times that are over, and hints that may be stale.
 *
 * A change is a transaction: every slot is copied into the journal before its tetrahedron or its list is first changed,
 * every row before it is first written; mates across the border of a hole are not (journal.c). Where memory runs out,
 * the caller cancels, or a change needs another way, the journal is written back. So no step of a change needs to know
 * whether a later one can fail. */
#ifndef BRIO_DYNAMIC_LIVE_H
#define BRIO_DYNAMIC_LIVE_H

#include "brio/dynamic.h"
#include "triangulation/engine.h"
#include "triangulation/passes.h"
#include "triangulation/tetrahedra.h"

enum { BRIO_NONE = UINT32_MAX };

/** What a slot is: a tetrahedron, one of the hole under way, or nothing; and whether the journal has it. */
enum { SLOT_PLAIN = 0, SLOT_HOLE = 1, SLOT_UNUSED = 2, SLOT_NOTED = 128 };

/** What a row is; loose is a point that has no place yet. */
enum { ROW_FREE = 0, ROW_VERTEX = 1, ROW_HIDDEN = 2, ROW_TWIN = 3, ROW_LOOSE = 4, ROW_NOTED = 128 };

typedef struct {
    uint32_t name;       /* the caller's index */
    uint32_t twins;      /* of a vertex: its first twin, or BRIO_NONE */
    uint32_t next, prev; /* of a hidden row or a twin, in its list; BRIO_NONE at the ends */
} brio_live_row;

/** A slot and a row, as they were before the transaction. */
typedef struct {
    brio_tetrahedron tet; /* mates: as when it was copied */
    uint32_t slot, hidden;
    uint32_t stamp; /* of the hole that it was in */
    uint8_t state;
} brio_old_slot;

typedef struct {
    brio_record record;
    brio_live_row row;
    uint32_t at, home;
    uint8_t kind;
} brio_old_row;

/** What is counted; one struct, so that the journal keeps it as a whole. */
typedef struct {
    size_t alive, vertices, finite, infinite;
} brio_live_counts;

typedef struct brio_journal {
    brio_old_slot *slot;
    brio_old_row *row;
    size_t num_slots, slot_capacity, num_rows, row_capacity;
    size_t slots_before, rows_before, names_before; /* numbers of them when the transaction began */
    brio_live_counts counts;
    uint32_t stamp;            /* of the last hole */
    uint32_t *time;            /* the last stamp that was given out; of all hands */
    struct brio_journal *more; /* those of threads of a pass */
} brio_journal;

/** The tetrahedra that a change takes out, the outer sides of their border, and the rows of the border's vertices by
 *  number: number[row] = i where vertex[i] = row. Number 0 is the infinite vertex, whether it is there or not. */
typedef struct {
    uint32_t *tet, *border, *outer; /* outer: sides to be tested, while the hole is dug */
    uint32_t *fresh;                /* slots of the new tetrahedra */
    uint32_t *vertex;
    uint32_t *corner; /* 3 numbers of each facet of the border, in the order of OUT */
    size_t num_tets, num_border, num_vertices, capacity, fresh_capacity;
} brio_hole;

/** A table of directed edges of a border, by numbers of vertices: direct for few, else hashed. Entries are told from
 *  what was left by earlier uses by looking at what they name. */
typedef struct {
    uint32_t *direct;
    uint64_t *key;
    uint32_t *value;
    size_t places; /* of the hashed table, a power of two */
} brio_edge_table;

/** Vertices that walks start from: one for each cell of a grid over the box that the points had. */
typedef struct {
    uint32_t *row;
    size_t side, cells, vertices; /* vertices: when the grid was made */
    double low[3], scale[3];
} brio_hints;

typedef struct brio_link brio_link; /* link.c */

struct brio_dynamic {
    brio_context *ctx;
    bool weighted;
    int dimension;

    brio_record *record;
    brio_live_row *row;
    uint32_t *home, *number;
    uint32_t *rank; /* of each row: near vertices have near ranks, whose segments threads hold */
    uint8_t *kind;
    size_t num_rows, row_capacity; /* row_capacity: what each of these has room for, at least */
    uint32_t *free_row;
    size_t num_free_rows, free_row_capacity;
    uint32_t *row_of;
    size_t num_names, name_capacity;

    brio_tetrahedra t;
    uint8_t *state;
    uint32_t *hidden;
    float *until; /* of each slot: L5 */
    bool timed;   /* some may be 0 or above */
    double travelled;
    size_t capacity;
    uint32_t *unused;
    size_t num_unused, unused_capacity;
    brio_live_counts counts;

    brio_filter filter;
    double low[4], high[4]; /* of coordinates and weights: the filter holds in here */
    int unit, weight_unit;  /* on a coarse grid: all coordinates are multiples of 2^unit */
    const brio_engine *engine;
    brio_walk walk;
    brio_hints hints;

    brio_hole hole;
    brio_edge_table edges;
    brio_link *link;
    uint32_t *loose; /* rows that a change has set free, a stack */
    size_t num_loose, loose_capacity;
    brio_journal journal;
    bool in_transaction, needs_anew; /* needs_anew: the change can only be made by building anew */
    uint64_t in_place, replaced, anew;

    brio_zone *zone;      /* of a hand (together.c); NULL: alone */
    brio_attempt attempt; /* what a hand cannot do, and nothing has changed; BRIO_TRIED: it can, or it is alone */
};

/* OUT[s]: the slots other than s, so that (x, OUT[s]) is positive for x on the other side of facet s; slot 3, which
 * may hold the infinite vertex, last. */
static const uint8_t BRIO_OUT[4][3] = {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}};

/* --- journal.c --- */

/** Begins a transaction. */
void brio_live_begin(brio_dynamic *d);
/** Ends it: keeps the changes if the status is BRIO_OK, else takes all of them back. Returns the status. After another
 *  failure than BRIO_ERR_INTERNAL needs_anew is false: a call that was cancelled, say, has failed. */
brio_status brio_live_end(brio_dynamic *d, brio_status status);
/** Makes room in the journal for a number of slots and rows. */
brio_status brio_journal_reserve(brio_dynamic *d, size_t slots, size_t rows);
/** Begins a hole: what is noted from now on has a later stamp than what other hands noted in holes that this one
 *  meets. */
void brio_journal_stamp(brio_dynamic *d);
/** Gives the journal of a hand to d, whose change it is part of. `node` is empty, and d's then. What d notes from now
 *  on has a later stamp than what the hand noted. */
void brio_journal_give(brio_dynamic *d, brio_journal *hand, brio_journal *node);

/** Ends the time (L5) of a tetrahedron. In a pass several threads may do that at once. */
static inline void brio_end_time(brio_dynamic *d, uint32_t slot) {
    static const float OVER = -1;
    if (!d->timed) return;
    __atomic_store(&d->until[slot], &OVER, __ATOMIC_RELAXED);
}

/** Returns the first hidden row of a slot. Without weights there are none, and no array. */
static inline uint32_t brio_first_hidden(const brio_dynamic *d, uint32_t slot) {
    return d->hidden ? d->hidden[slot] : BRIO_NONE;
}
static inline void brio_set_first_hidden(brio_dynamic *d, uint32_t slot, uint32_t row) {
    assert(d->hidden || row == BRIO_NONE);
    if (d->hidden) d->hidden[slot] = row;
}

/** Notes a slot, or a row, before it is written; room was reserved. */
static inline void brio_note_slot(brio_dynamic *d, uint32_t slot) {
    brio_journal *j = &d->journal;
    brio_end_time(d, slot);
    if (slot >= j->slots_before || d->state[slot] & SLOT_NOTED) return;
    assert(j->num_slots < j->slot_capacity);
    j->slot[j->num_slots++] = (brio_old_slot){d->t.tet[slot], slot, brio_first_hidden(d, slot), j->stamp,
                                              d->state[slot] & (uint8_t)~SLOT_HOLE};
    d->state[slot] |= SLOT_NOTED;
}
static inline void brio_note_row(brio_dynamic *d, uint32_t row) {
    brio_journal *j = &d->journal;
    if (row >= j->rows_before || d->kind[row] & ROW_NOTED) return;
    assert(j->num_rows < j->row_capacity);
    brio_old_row *old = &j->row[j->num_rows++];
    *old = (brio_old_row){{0}, d->row[row], row, d->home[row], d->kind[row]};
    for (int c = 0; c < 4; c++) old->record[c] = d->record[row][c];
    d->kind[row] |= ROW_NOTED;
}

/** Asks whether to stop, as brio_look; a hand does not, since what it does is small. */
static inline brio_status brio_live_look(brio_dynamic *d, size_t items) {
    return d->zone ? BRIO_OK : brio_look(d->ctx, items);
}

/** Says that a hand cannot do what it is at. */
static inline brio_status brio_give_up(brio_dynamic *d, brio_attempt why) {
    assert(d->zone && why != BRIO_TRIED);
    d->attempt = why;
    return BRIO_OK;
}

static inline int brio_row_kind(const brio_dynamic *d, uint32_t row) {
    return d->kind[row] & ~ROW_NOTED;
}
static inline void brio_set_kind(brio_dynamic *d, uint32_t row, int kind) {
    d->kind[row] = (uint8_t)(kind | (d->kind[row] & ROW_NOTED));
}
static inline bool brio_in_hole(const brio_dynamic *d, uint32_t slot) {
    return d->state[slot] & SLOT_HOLE;
}

/* --- store.c --- */

/** Checks the indices of a call: each is below `num_names` and that of a point that is there, and none is twice.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY. */
brio_status brio_live_check_indices(brio_context *ctx, const uint32_t *indices, size_t n, size_t num_names,
                                    bool (*there)(const void *user, uint32_t index), const void *user);
/** Makes an empty one. */
brio_status brio_live_new(brio_context *ctx, bool weighted, brio_dynamic **out);
/** Makes room for more rows, names, slots, tetrahedra of the hole: a number of each. */
brio_status brio_live_reserve_rows(brio_dynamic *d, size_t more);
brio_status brio_live_reserve_names(brio_dynamic *d, size_t more);
brio_status brio_live_reserve_slots(brio_dynamic *d, size_t more);
brio_status brio_hole_reserve(brio_dynamic *d, size_t tets);
brio_status brio_hole_reserve_fresh(brio_dynamic *d, size_t count);
brio_status brio_live_reserve_loose(brio_dynamic *d, size_t more);

/** Returns a new loose row of a record, with a name; room was reserved. */
uint32_t brio_live_add_row(brio_dynamic *d, const double *record, uint32_t name);
/** Frees a loose row and its name. */
brio_status brio_live_drop_row(brio_dynamic *d, uint32_t row);

/** Widens the box so that the filter holds for a record, too. */
void brio_live_admit(brio_dynamic *d, const double *record);
/** Chooses the filter for all rows, which are alive. */
void brio_live_choose_filter(brio_dynamic *d);
/** Makes the grid of hints anew where there are many more vertices than when it was made. */
brio_status brio_live_refresh_hints(brio_dynamic *d);
/** Enters a vertex as the hint of its cell. */
void brio_live_hint(brio_dynamic *d, uint32_t row);
/** Makes another vertex, which is near, the hint where it is a vertex that goes. */
void brio_live_unhint(brio_dynamic *d, uint32_t row, uint32_t other);
/** Sets the start of the next walk to a tetrahedron near x. A hand may find none that it holds (attempt). */
void brio_live_approach(brio_dynamic *d, const double *x);
/** Gives a row that is loose the rank of a vertex near its record (alone). */
void brio_live_rank(brio_dynamic *d, uint32_t row);
/** Makes the start of walks a tetrahedron, where that may be gone (alone). */
void brio_live_start(brio_dynamic *d);
/** Makes the workspace of changes; frees it. */
brio_status brio_live_equip(brio_dynamic *d);
void brio_live_strip(brio_dynamic *d);

/** Numbers the vertices of the hole's border, and fills corner. */
void brio_hole_number(brio_dynamic *d);
/** Numbers the other vertices of the hole, after those. */
void brio_hole_number_inner(brio_dynamic *d);
/** Readies the table for a border with a number of edges. */
brio_status brio_edges_ready(brio_dynamic *d, size_t num_vertices, size_t num_edges);
/** Enters and finds a value under a directed edge. What is found may be left from earlier: the caller looks. */
void brio_edges_enter(brio_dynamic *d, uint32_t x, uint32_t y, uint32_t value);
uint32_t brio_edges_find(const brio_dynamic *d, uint32_t x, uint32_t y);
/** Lists `count` slots for new tetrahedra in hole.fresh, those of the hole first, and makes all that are left unused.
 *  Hidden rows of the hole become loose. The slots are in the journal afterwards, and the time of the
 *  tetrahedra behind the border is over. */
brio_status brio_hole_take_slots(brio_dynamic *d, size_t count);

/* --- place.c --- */

/** Puts a row into the list of a slot, or of a vertex; takes it out. */
brio_status brio_live_hide(brio_dynamic *d, uint32_t row, uint32_t slot);
brio_status brio_live_join(brio_dynamic *d, uint32_t row, uint32_t vertex);
brio_status brio_live_unlink(brio_dynamic *d, uint32_t row);
/** Finds its place for a loose row: it becomes a vertex, hidden, or a twin. Like the three functions that follow and
 *  brio_live_move, it may be called of a hand, which looks at `attempt` afterwards. */
brio_status brio_live_place(brio_dynamic *d, uint32_t row);

/* --- take.c --- */

/** Takes a row out: it becomes loose. *row is the row that has the name afterwards. */
brio_status brio_live_take(brio_dynamic *d, uint32_t *row);
/** Marks the star of a vertex as the hole, with its border. */
brio_status brio_live_star(brio_dynamic *d, uint32_t row);
/** Fills a hole with the triangulation of its vertices, inner ones included, where that has all facets of the border.
 *  Else *mended is false, the hole stays, and hole.fresh is 0 for each facet that it lacks; hole.fresh is as it was
 *  where the vertices lie in a plane, are too many, or hide one another. */
brio_status brio_hole_mend(brio_dynamic *d, bool *mended);
/** Forgets the hole. */
void brio_hole_forget(brio_dynamic *d);

/** Returns whether some tetrahedron of the hole has hidden rows. */
bool brio_hole_has_hidden(const brio_dynamic *d);

/* --- slack.c --- */

/** Ends the time (L5) of all tetrahedra of the hole, a star, and of those behind its border: its vertex moves. */
void brio_slack_end(brio_dynamic *d);
/** Ends that of all tetrahedra. */
void brio_slack_end_all(brio_dynamic *d);
/** Lets time go on: each vertex has moved by at most `step`, but those whose time ends. */
void brio_slack_advance(brio_dynamic *d, double step);

/** Slots in ascending order. */
typedef struct {
    uint32_t *slot;
    size_t count, capacity;
} brio_slot_list;

/** Tests the tetrahedra whose time is over, with all threads. Lists the finite ones that are not certainly sound, and
 *  all that are infinite; the caller frees the lists. */
brio_status brio_slack_test(brio_dynamic *d, brio_slot_list *open, brio_slot_list *infinite);

/* --- records.c --- */

/** A change of the records of points: where a new record comes from. */
typedef struct {
    const uint32_t *indices; /* NULL: all points, by ascending index */
    const double *points;    /* NULL: they stay */
    const double *weights;   /* NULL: they stay */
    size_t count;
} brio_moves;

/** How far the rows move. */
typedef struct {
    brio_record *record; /* of each row, the new one */
    double step;         /* no row moves by more, but the fast ones */
    uint32_t *fast;
    size_t num_fast, moved;
} brio_paths;

/** Writes the new record of the point of a name, which is number i of the moves. */
brio_status brio_new_record(const brio_dynamic *d, const brio_moves *m, size_t i, uint32_t name, double record[4]);
/** Writes those of all rows, with all threads, and widens the filter's box for them. Fast are at most a few of them, so
 *  that the step is not much longer than most paths, and those that get another weight. Freed by brio_paths_free. */
brio_status brio_paths_new(brio_dynamic *d, const brio_moves *m, brio_paths *out);
void brio_paths_free(brio_context *ctx, brio_paths *p);

/* --- link.c --- */

/** Makes the workspace. */
brio_status brio_link_new(brio_context *ctx, brio_link **out);
/** Makes the triangulation of the finite vertices of the hole's border, which are few; *flat where they lie in a
 *  plane. Returns false where weights hide one of them.   tet, count  its tetrahedra, by numbers; those that are not
 *  part of it have vertex[0] = BRIO_NONE. */
bool brio_link_few(brio_dynamic *d, brio_tetrahedron **tet, size_t *count, bool *flat);
/** Returns room for a number for each tetrahedron. */
uint32_t *brio_link_slots(brio_dynamic *d);
enum { BRIO_LINK_MOST = 62, BRIO_LINK_TETS = 2048 }; /* finite vertices; tetrahedra that there can be */

/* --- move.c --- */

/** Gives a row another record: in place where its star stays valid, else out and in. */
brio_status brio_live_move(brio_dynamic *d, uint32_t name, const double *record);

/* --- together.c --- */

/** What is done with many rows. */
typedef enum { BRIO_BATCH_INSERT, BRIO_BATCH_REMOVE, BRIO_BATCH_MOVE } brio_batch_kind;

typedef struct {
    brio_batch_kind kind;
    const uint32_t
        *name;          /* of loose rows that are to be placed, of others to be taken out or moved; near ones in turn */
    const uint32_t *at; /* of each that is to be moved: its place among the moves; NULL: the same */
    const brio_moves *moves;
    size_t count;
    size_t most; /* rows that may be taken out and put in again before building anew is faster */
} brio_batch;

/** Makes the changes of a batch, with all threads of the context. Rows that were taken out are loose afterwards; the
 *  filter's box holds the records of those that are placed or moved. Sets needs_anew, and fails, beyond `most`. */
brio_status brio_live_together(brio_dynamic *d, const brio_batch *batch);

/* --- move_many.c --- */

/** Gives all rows, which are vertices, their new records; the array is exchanged with that of the store. Sets
 *  needs_anew, and fails, where more than `most` would have to be taken out. */
brio_status brio_live_move_many(brio_dynamic *d, brio_paths *paths, size_t most);

/* --- build.c --- */

/** A list of points: what a change leaves. */
typedef struct {
    double *point, *weight; /* weight NULL without weights */
    uint32_t *name;
    size_t count;
} brio_live_points;

/** Lists the points that are alive, by ascending name, with room for `more`. */
brio_status brio_live_list(brio_context *ctx, const brio_dynamic *d, size_t more, brio_live_points *out);
void brio_live_list_free(brio_context *ctx, brio_live_points *list);
/** Builds all of it anew from these points, with num_names names given out. On failure d is as it was.
 *  sorted  near tetrahedra shall be near in memory, for many changes: a sixth more work. */
brio_status brio_live_build(brio_dynamic *d, const brio_live_points *list, size_t num_names, bool sorted);
/** Frees what a store has, not the store. */
void brio_live_clear(brio_dynamic *d);

/* --- dynamic.c --- */

/** Changes of several kinds. Indices are those of points that are there, in one of the lists and once. */
typedef struct {
    brio_moves moved; /* with a list of indices */
    const uint32_t *removed;
    const double *points, *weights; /* of those that are inserted; they get the next indices */
    size_t num_removed, num_inserted;
} brio_live_changes;

/** Makes all of them, or none: points move first, then go, then come. */
brio_status brio_live_change(brio_dynamic *d, const brio_live_changes *changes);

/** Gives the points that are there the names 0, 1, ... by their order.
 *  now  #num_names: receives the new name of each, BRIO_NONE where there is no point. */
void brio_live_renumber(brio_dynamic *d, uint32_t *now);

/* --- view.c --- */

/** Makes what brio_delaunay makes of the points of a list, which has all that are there, in any order; its names are
 *  those of the points. */
brio_status brio_live_snapshot(brio_context *ctx, const brio_dynamic *d, const brio_live_points *list,
                               brio_triangulation **out);

#endif
