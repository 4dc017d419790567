/* The store of a living triangulation: rows, slots, the filter's box, hints, and what the changes share. */
#include "base/memory.h"
#include "dynamic/live.h"
#include "predicates/span.h"
#include <string.h>

enum { DIRECT = 64 }; /* numbers of vertices that the direct table of edges takes */

/* --- room --- */

static size_t more_room(size_t need) {
    return need + need / 4 + 64;
}

brio_status brio_live_reserve_rows(brio_dynamic *d, size_t more) {
    size_t need = d->num_rows + more, capacity = more_room(need);
    if (need <= d->row_capacity) return BRIO_OK;
    BRIO_EXPECT(d->ctx, need < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^32 - 17", need);
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->record, capacity));
    d->t.record = d->record;
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->row, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->home, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->number, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->rank, capacity));
    for (size_t r = d->row_capacity; r < capacity; r++) d->rank[r] = (uint32_t)r;
    memset(d->number + d->row_capacity, 0, (capacity - d->row_capacity) * sizeof *d->number);
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->kind, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->free_row, capacity));
    d->row_capacity = capacity;
    return BRIO_OK;
}

brio_status brio_live_reserve_names(brio_dynamic *d, size_t more) {
    BRIO_EXPECT(d->ctx, d->num_names + more < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE,
                "%zu indices given out; at most 2^32 - 17", d->num_names + more);
    return BRIO_RESERVE(d->ctx, d->row_of, d->name_capacity, d->num_names + more);
}

brio_status brio_live_reserve_slots(brio_dynamic *d, size_t more) {
    static const size_t MOST = (size_t)1 << 30; /* facet handles have 32 bits */
    size_t need = d->t.count + more, capacity = more_room(need);
    if (need <= d->capacity) return BRIO_OK;
    BRIO_EXPECT(d->ctx, need <= MOST, BRIO_ERR_TOO_LARGE, "more than %zu tetrahedra", MOST);
    if (capacity > MOST) capacity = MOST;
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->t.tet, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->state, capacity));
    if (d->weighted) BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->hidden, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->until, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, d->unused, capacity));
    d->capacity = d->unused_capacity = capacity;
    return BRIO_OK;
}

brio_status brio_hole_reserve(brio_dynamic *d, size_t tets) {
    enum { BATCH = BRIO_BATCH };
    brio_hole *h = &d->hole;
    if (tets <= h->capacity) return BRIO_OK;
    size_t capacity = 2 * tets, facets = 4 * capacity + 2 * BATCH;
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, h->tet, capacity));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, h->border, facets));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, h->outer, facets));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, h->corner, 3 * facets));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, h->vertex, facets));
    h->capacity = capacity;
    return BRIO_OK;
}

brio_status brio_hole_reserve_fresh(brio_dynamic *d, size_t count) {
    return BRIO_RESERVE(d->ctx, d->hole.fresh, d->hole.fresh_capacity, count);
}

brio_status brio_live_reserve_loose(brio_dynamic *d, size_t more) {
    assert(!d->zone); /* L8 */
    return BRIO_RESERVE(d->ctx, d->loose, d->loose_capacity, d->num_loose + more);
}

brio_status brio_live_new(brio_context *ctx, bool weighted, brio_dynamic **out) {
    enum { FIRST_ROWS = 64 };
    brio_dynamic *d = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d, 1));
    d->ctx = ctx;
    d->weighted = weighted;
    d->dimension = -1;
    d->engine = brio_engine_choose(weighted);
    d->num_rows = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d->journal.time, 1));
    BRIO_TRY(brio_live_reserve_rows(d, FIRST_ROWS));
    d->num_rows = 1;
    d->record[0][0] = d->record[0][1] = d->record[0][2] = 0;
    d->record[0][3] = INFINITY; /* as conflict_lanes.h knows the infinite vertex */
    d->row[0] = (brio_live_row){BRIO_NONE, BRIO_NONE, BRIO_NONE, BRIO_NONE};
    d->kind[0] = ROW_VERTEX;
    d->home[0] = 0;
    BRIO_TRY(brio_live_equip(d));
    *out = d;
    d = NULL;
done:
    brio_dynamic_free(d);
    return status;
}

brio_status brio_live_equip(brio_dynamic *d) {
    enum { FIRST_TETS = 64 };
    BRIO_FORWARD(brio_hole_reserve(d, FIRST_TETS));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, d->edges.direct, DIRECT * DIRECT));
    return brio_link_new(d->ctx, &d->link);
}

static void release_all(brio_context *ctx, void *const *blocks, size_t count) {
    for (size_t i = 0; i < count; i++) brio_release(ctx, blocks[i]);
}

void brio_live_strip(brio_dynamic *d) {
    void *blocks[] = {d->hole.tet,    d->hole.border,  d->hole.outer,   d->hole.fresh,  d->hole.vertex,
                      d->hole.corner, d->edges.direct, d->edges.key,    d->edges.value, d->link,
                      d->loose,       d->unused,       d->journal.slot, d->journal.row};
    release_all(d->ctx, blocks, sizeof blocks / sizeof *blocks);
}

void brio_live_clear(brio_dynamic *d) {
    void *blocks[] = {d->record, d->row,   d->home,  d->number, d->rank,  d->kind,      d->free_row,
                      d->row_of, d->t.tet, d->state, d->hidden, d->until, d->hints.row, d->journal.time};
    brio_live_strip(d);
    release_all(d->ctx, blocks, sizeof blocks / sizeof *blocks);
}

/* --- rows --- */

uint32_t brio_live_add_row(brio_dynamic *d, const double *record, uint32_t name) {
    uint32_t row = d->num_free_rows ? d->free_row[--d->num_free_rows] : (uint32_t)d->num_rows++;
    assert(row < d->row_capacity && name < d->name_capacity);
    if (row >= d->journal.rows_before) d->kind[row] = ROW_FREE;
    if (d->in_transaction) brio_note_row(d, row);
    for (int c = 0; c < 4; c++) d->record[row][c] = record[c];
    d->row[row] = (brio_live_row){name, BRIO_NONE, BRIO_NONE, BRIO_NONE};
    brio_set_kind(d, row, ROW_LOOSE);
    d->home[row] = BRIO_NONE;
    d->row_of[name] = row;
    d->counts.alive++;
    return row;
}

brio_status brio_live_drop_row(brio_dynamic *d, uint32_t row) {
    assert(brio_row_kind(d, row) == ROW_LOOSE);
    BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
    brio_note_row(d, row);
    brio_set_kind(d, row, ROW_FREE);
    d->row_of[d->row[row].name] = BRIO_NONE;
    d->free_row[d->num_free_rows++] = row;
    d->counts.alive--;
    return BRIO_OK;
}

/* --- the filter's box --- */

static void set_filter(brio_dynamic *d) {
    double extent[4];
    uint64_t unsettled = d->filter.unsettled;
    for (int c = 0; c < 4; c++) extent[c] = d->high[c] - d->low[c];
    brio_filter_set(&d->filter, extent, extent[3], d->weighted);
    d->filter.unsettled = unsettled;
}

/* Returns whether a record is on the grid that the filter knows. */
static bool on_grid(const brio_dynamic *d, const double *record) {
    for (int c = 0; c < 3; c++)
        if (brio_span_of(record[c]).low < d->unit) return false;
    return !d->weighted || brio_span_of(record[3]).low >= d->weight_unit;
}

void brio_live_admit(brio_dynamic *d, const double *record) {
    bool inside = true;
    for (int c = 0; c < 4; c++) inside &= record[c] >= d->low[c] && record[c] <= d->high[c];
    if (inside && (!(d->filter.lattice || d->filter.coarse) || on_grid(d, record))) return;
    for (int c = 0; c < 4; c++) {
        d->low[c] = fmin(d->low[c], record[c]);
        d->high[c] = fmax(d->high[c], record[c]);
    }
    set_filter(d);
}

void brio_live_choose_filter(brio_dynamic *d) {
    size_t n = d->num_rows - 1;
    const brio_record *r = (const brio_record *)d->record + 1;
    d->unit = d->weight_unit = INT32_MAX;
    for (int c = 0; c < 4; c++) d->low[c] = d->high[c] = n ? r[0][c] : 0;
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 4; c++) {
            d->low[c] = fmin(d->low[c], r[i][c]);
            d->high[c] = fmax(d->high[c], r[i][c]);
        }
    brio_filter_for(&d->filter, r, n, d->weighted);
    if (!d->filter.lattice && !d->filter.coarse) return;
    for (size_t i = 0; i < n; i++) {
        for (int c = 0; c < 3; c++) {
            int low = brio_span_of(r[i][c]).low;
            if (low < d->unit) d->unit = low;
        }
        int low = brio_span_of(r[i][3]).low;
        if (low < d->weight_unit) d->weight_unit = low;
    }
}

/* --- hints --- */

static size_t cell_of(const brio_hints *h, const double *x) {
    size_t cell = 0;
    for (int c = 2; c >= 0; c--) {
        double place = (x[c] - h->low[c]) * h->scale[c];
        size_t at = place > 0 ? (place < (double)h->side ? (size_t)place : h->side - 1) : 0;
        cell = cell * h->side + (at < h->side ? at : h->side - 1);
    }
    return cell;
}

brio_status brio_live_refresh_hints(brio_dynamic *d) {
    enum { VERTICES_A_CELL = 2, MOST_SIDE = 512 };
    brio_hints *h = &d->hints, made = {0};
    size_t n = d->counts.vertices;
    if (d->dimension < 3 || (h->row && n < 4 * h->vertices && n > h->vertices / 16)) return BRIO_OK;
    made.side = 1 + (size_t)cbrt((double)n / VERTICES_A_CELL);
    if (made.side > MOST_SIDE) made.side = MOST_SIDE;
    made.cells = made.side * made.side * made.side;
    made.vertices = n;
    for (int c = 0; c < 3; c++) {
        double extent = d->high[c] - d->low[c];
        made.low[c] = d->low[c];
        made.scale[c] = extent > 0 && extent < INFINITY ? (double)made.side / extent : 0;
        if (!(made.scale[c] < INFINITY)) made.scale[c] = 0;
    }
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, made.row, made.cells));
    memset(made.row, 0xff, made.cells * sizeof *made.row);
    brio_release(d->ctx, h->row);
    *h = made;
    for (uint32_t r = 1; r < d->num_rows; r++)
        if (brio_row_kind(d, r) == ROW_VERTEX) brio_live_hint(d, r);
    uint32_t last = BRIO_NONE;
    for (size_t i = 0; i < h->cells; i++) {
        if (h->row[i] == BRIO_NONE) h->row[i] = last;
        last = h->row[i];
    }
    return BRIO_OK;
}

void brio_live_hint(brio_dynamic *d, uint32_t row) {
    if (d->hints.row) __atomic_store_n(&d->hints.row[cell_of(&d->hints, d->record[row])], row, __ATOMIC_RELAXED);
}

void brio_live_unhint(brio_dynamic *d, uint32_t row, uint32_t other) {
    if (!d->hints.row) return;
    uint32_t *hint = &d->hints.row[cell_of(&d->hints, d->record[row])];
    if (__atomic_load_n(hint, __ATOMIC_RELAXED) == row) __atomic_store_n(hint, other, __ATOMIC_RELAXED);
}

/* Returns a vertex near x, or BRIO_NONE. A hand then holds it. */
static uint32_t hint_near(brio_dynamic *d, const double *x) {
    if (!d->hints.row) return BRIO_NONE;
    uint32_t hint = __atomic_load_n(&d->hints.row[cell_of(&d->hints, x)], __ATOMIC_RELAXED);
    if (hint == BRIO_NONE || hint >= d->num_rows || (d->zone && !brio_zone_has(d->zone, hint))) return BRIO_NONE;
    return brio_row_kind(d, hint) == ROW_VERTEX ? hint : BRIO_NONE;
}

static double square_distance(const double *p, const double *q) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

void brio_live_approach(brio_dynamic *d, const double *x) {
    uint32_t hint = hint_near(d, x);
    if (d->walk.start != BRIO_NO_TET) {
        assert(!(d->state[d->walk.start] & SLOT_UNUSED) && brio_zone_holds_tet(&d->t, d->zone, d->walk.start));
        uint32_t start = brio_walk_begin(&d->t, &d->walk), near = d->t.tet[start].vertex[0];
        if (!d->zone) d->walk.start = start; /* a hand holds walk.start, perhaps not the tetrahedron next to it */
        if (hint == BRIO_NONE || square_distance(d->record[hint], x) >= square_distance(d->record[near], x)) return;
    }
    if (hint != BRIO_NONE && brio_owns(&d->t, d->zone, d->home[hint])) d->walk.start = d->home[hint];
    if (d->walk.start == BRIO_NO_TET) d->attempt = BRIO_TRY_LATER;
}

void brio_live_rank(brio_dynamic *d, uint32_t row) {
    uint32_t hint = hint_near(d, d->record[row]);
    assert(!d->zone);
    if (hint != BRIO_NONE) d->rank[row] = d->rank[hint];
}

void brio_live_start(brio_dynamic *d) {
    assert(!d->zone && d->dimension == 3);
    for (uint32_t r = 1; d->state[d->walk.start] & SLOT_UNUSED; r++)
        if (brio_row_kind(d, r) == ROW_VERTEX) d->walk.start = d->home[r];
}

/* --- holes --- */

void brio_hole_forget(brio_dynamic *d) {
    brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++) d->state[h->tet[i]] &= (uint8_t)~SLOT_HOLE;
    h->num_tets = h->num_border = 0;
}

void brio_hole_number(brio_dynamic *d) {
    brio_hole *h = &d->hole;
    uint32_t *number = d->number, *vertex = h->vertex, n = 1;
    vertex[0] = 0; /* and number[0] is 0 */
    for (size_t b = 0; b < h->num_border; b++) {
        const uint32_t *v = d->t.tet[brio_tet_of(h->border[b])].vertex;
        const uint8_t *out = BRIO_OUT[brio_slot_of(h->border[b])];
        for (int k = 0; k < 3; k++) {
            uint32_t row = v[out[k]], i = number[row];
            if (i >= n || vertex[i] != row) {
                i = number[row] = n;
                vertex[n++] = row;
            }
            h->corner[3 * b + (size_t)k] = i;
        }
    }
    h->num_vertices = n;
}

void brio_hole_number_inner(brio_dynamic *d) {
    brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t row = d->t.tet[h->tet[i]].vertex[k], n = d->number[row];
            if (row == 0 || (n < h->num_vertices && h->vertex[n] == row)) continue;
            d->number[row] = (uint32_t)h->num_vertices;
            h->vertex[h->num_vertices++] = row;
        }
}

brio_status brio_edges_ready(brio_dynamic *d, size_t num_vertices, size_t num_edges) {
    brio_edge_table *e = &d->edges;
    size_t places = 256;
    if (num_vertices <= DIRECT) {
        e->places = 0;
        return BRIO_OK;
    }
    while (places < 2 * num_edges) places *= 2;
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, e->key, places));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, e->value, places));
    memset(e->key, 0xff, places * sizeof *e->key);
    e->places = places;
    return BRIO_OK;
}

static size_t place_of(const brio_edge_table *e, uint64_t key) {
    size_t mask = e->places - 1, at = (size_t)((key * UINT64_C(0x9e3779b97f4a7c15)) >> 32) & mask;
    while (e->key[at] != UINT64_MAX && e->key[at] != key) at = (at + 1) & mask;
    return at;
}

void brio_edges_enter(brio_dynamic *d, uint32_t x, uint32_t y, uint32_t value) {
    brio_edge_table *e = &d->edges;
    if (!e->places) {
        e->direct[DIRECT * x + y] = value;
        return;
    }
    uint64_t key = (uint64_t)x << 32 | y;
    size_t at = place_of(e, key);
    e->key[at] = key;
    e->value[at] = value;
}

uint32_t brio_edges_find(const brio_dynamic *d, uint32_t x, uint32_t y) {
    const brio_edge_table *e = &d->edges;
    if (!e->places) return e->direct[DIRECT * x + y];
    uint64_t key = (uint64_t)x << 32 | y;
    size_t at = place_of(e, key);
    return e->key[at] == key ? e->value[at] : BRIO_NONE;
}

/* Makes the hidden rows of the hole loose. */
static brio_status set_loose(brio_dynamic *d) {
    const brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++)
        for (uint32_t r = brio_first_hidden(d, h->tet[i]), next; r != BRIO_NONE; r = next) {
            next = d->row[r].next;
            BRIO_FORWARD(brio_live_reserve_loose(d, 1));
            BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
            brio_note_row(d, r);
            brio_set_kind(d, r, ROW_LOOSE);
            d->row[r].next = d->row[r].prev = BRIO_NONE;
            d->loose[d->num_loose++] = r;
        }
    return BRIO_OK;
}

brio_status brio_hole_take_slots(brio_dynamic *d, size_t count) {
    brio_hole *h = &d->hole;
    size_t n = 0, have = h->num_tets + d->num_unused;
    if (count > have && d->zone) return brio_give_up(d, BRIO_TRY_ALONE);
    if (count > have) BRIO_FORWARD(brio_live_reserve_slots(d, count - have));
    if (d->zone) BRIO_FORWARD(BRIO_RESERVE(d->ctx, d->unused, d->unused_capacity, have));
    BRIO_FORWARD(brio_hole_reserve_fresh(d, count));
    BRIO_FORWARD(brio_journal_reserve(d, h->num_tets + count, 0));
    BRIO_FORWARD(set_loose(d));
    brio_journal_stamp(d);
    for (size_t b = 0; b < h->num_border; b++) brio_end_time(d, brio_tet_of(h->border[b]));
    for (size_t i = 0; i < h->num_tets; i++) {
        uint32_t slot = h->tet[i];
        size_t infinite = brio_is_infinite(&d->t, slot);
        brio_note_slot(d, slot);
        d->counts.infinite -= infinite;
        d->counts.finite -= 1 - infinite;
        brio_set_first_hidden(d, slot, BRIO_NONE);
        d->state[slot] &= SLOT_NOTED;
        if (n < count) {
            h->fresh[n++] = slot;
        } else {
            d->state[slot] |= SLOT_UNUSED;
            d->unused[d->num_unused++] = slot;
        }
    }
    while (n < count) {
        uint32_t slot = d->num_unused ? d->unused[--d->num_unused] : (uint32_t)d->t.count++;
        if (slot >= d->journal.slots_before) d->state[slot] = SLOT_UNUSED, d->until[slot] = -1;
        brio_note_slot(d, slot);
        d->state[slot] &= SLOT_NOTED;
        brio_set_first_hidden(d, slot, BRIO_NONE);
        h->fresh[n++] = slot;
    }
    return BRIO_OK;
}
