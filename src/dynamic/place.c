/* A point finds its place: located, it becomes a vertex, a hidden point, or the twin of a vertex.
 *
 * A vertex digs a hole, all tetrahedra in conflict with it, and fills it with its star, as triangulation/cavity.c
 * does for points that are inserted once. Weights may take all tetrahedra of other vertices away; these become
 * hidden, or twins where they are at the same position.
 *
 * Based on: Bowyer. Computing Dirichlet tessellations. Comput. J. 1981.
 *           Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "base/memory.h"
#include "dynamic/live.h"

/* --- lists --- */

static brio_status push(brio_dynamic *d, uint32_t row, uint32_t home, int kind, uint32_t *head) {
    uint32_t next = *head;
    BRIO_FORWARD(brio_journal_reserve(d, 0, 2));
    brio_note_row(d, row);
    if (next != BRIO_NONE) {
        brio_note_row(d, next);
        d->row[next].prev = row;
    }
    d->row[row].next = next;
    d->row[row].prev = BRIO_NONE;
    d->home[row] = home;
    brio_set_kind(d, row, kind);
    *head = row;
    return BRIO_OK;
}

brio_status brio_live_hide(brio_dynamic *d, uint32_t row, uint32_t slot) {
    assert(!brio_is_infinite(&d->t, slot));
    BRIO_FORWARD(brio_journal_reserve(d, 1, 0));
    brio_note_slot(d, slot);
    return push(d, row, slot, ROW_HIDDEN, &d->hidden[slot]);
}

brio_status brio_live_join(brio_dynamic *d, uint32_t row, uint32_t vertex) {
    assert(brio_row_kind(d, vertex) == ROW_VERTEX && row != vertex);
    BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
    brio_note_row(d, vertex);
    return push(d, row, vertex, ROW_TWIN, &d->row[vertex].twins);
}

brio_status brio_live_unlink(brio_dynamic *d, uint32_t row) {
    brio_live_row *r = &d->row[row];
    bool twin = brio_row_kind(d, row) == ROW_TWIN;
    assert(twin || brio_row_kind(d, row) == ROW_HIDDEN);
    BRIO_FORWARD(brio_journal_reserve(d, 1, 4));
    brio_note_row(d, row);
    if (r->next != BRIO_NONE) {
        brio_note_row(d, r->next);
        d->row[r->next].prev = r->prev;
    }
    if (r->prev != BRIO_NONE) {
        brio_note_row(d, r->prev);
        d->row[r->prev].next = r->next;
    } else if (twin) {
        brio_note_row(d, d->home[row]);
        d->row[d->home[row]].twins = r->next;
    } else {
        brio_note_slot(d, d->home[row]);
        d->hidden[d->home[row]] = r->next;
    }
    r->next = r->prev = BRIO_NONE;
    brio_set_kind(d, row, ROW_LOOSE);
    return BRIO_OK;
}

/* --- the hole --- */

/* Adds the facets of a tetrahedron that leave the hole found so far to those that are to be tested. */
static inline size_t leave(brio_dynamic *d, uint32_t tet, size_t n) {
    uint32_t *outer = d->hole.outer;
    for (int i = 0; i < 4; i++) {
        uint32_t mate = d->t.tet[tet].mate[i];
        __builtin_prefetch(&d->t.tet[brio_tet_of(mate)]);
        outer[n] = mate;
        n += !brio_in_hole(d, brio_tet_of(mate));
    }
    return n;
}

/* Adds the tetrahedra of those facets that are in conflict to the hole, each once, and the other facets to the border.
 * Returns false where the hand does not hold one of them. */
static inline bool divide(brio_dynamic *d, const uint32_t *facet, size_t count, unsigned conflicts) {
    brio_hole *h = &d->hole;
    uint8_t *state = d->state;
    for (size_t i = 0; i < count; i++) {
        h->border[h->num_border] = facet[i];
        h->num_border += !(conflicts >> i & 1);
    }
    for (; conflicts; conflicts &= conflicts - 1) {
        uint32_t in = facet[__builtin_ctz(conflicts)], tet = brio_tet_of(in);
        if (!brio_owns_beyond(&d->t, d->zone, in)) return false;
        h->tet[h->num_tets] = tet;
        h->num_tets += !(state[tet] & SLOT_HOLE);
        state[tet] |= SLOT_HOLE;
    }
    return true;
}

/* Finds all tetrahedra in conflict with a record, from one of them, and their border. */
static brio_status dig(brio_dynamic *d, uint32_t first, const double *p) {
    enum { MOST_OF_HAND = 4096 };
    brio_hole *h = &d->hole;
    size_t expanded = 0, tested = 0, listed = 0;
    h->tet[0] = first;
    h->num_tets = 1;
    h->num_border = 0;
    d->state[first] |= SLOT_HOLE;
    for (;;) {
        while (expanded < h->num_tets && listed - tested < BRIO_BATCH) listed = leave(d, h->tet[expanded++], listed);
        size_t count = listed - tested < BRIO_BATCH ? listed - tested : BRIO_BATCH;
        if (count == 0) return BRIO_OK;
        uint32_t *facet = h->outer + tested;
        for (size_t i = count; i < BRIO_BATCH; i++) facet[i] = facet[0];
        unsigned conflicts = d->engine->conflicts(&d->t, &d->filter, facet, count, p);
        if (!divide(d, facet, count, conflicts)) return brio_give_up(d, BRIO_TRY_LATER);
        tested += count;
        if (h->num_tets + 2 * BRIO_BATCH <= h->capacity) continue;
        if (d->zone && h->num_tets > MOST_OF_HAND) return brio_give_up(d, BRIO_TRY_ALONE);
        BRIO_FORWARD(brio_hole_reserve(d, h->num_tets + 2 * BRIO_BATCH + 1));
        BRIO_FORWARD(brio_live_look(d, h->num_tets));
    }
}

/* Lists the vertices of the hole that are not on its border as loose rows, where weights may leave some. A hand leaves
 * such a hole. */
static brio_status list_lost(brio_dynamic *d) {
    const brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = d->t.tet[h->tet[i]].vertex[k];
            if (v == 0 || (d->number[v] < h->num_vertices && h->vertex[d->number[v]] == v) ||
                brio_row_kind(d, v) != ROW_VERTEX)
                continue;
            if (d->zone) return brio_give_up(d, BRIO_TRY_ALONE);
            BRIO_FORWARD(brio_live_reserve_loose(d, 1));
            BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
            brio_note_row(d, v);
            brio_set_kind(d, v, ROW_LOOSE);
            d->counts.vertices--;
            d->loose[d->num_loose++] = v;
        }
    return BRIO_OK;
}

/* Writes the star of a row over the border: a tetrahedron for each facet, mates across the edges of the border. */
static void write_star(brio_dynamic *d, uint32_t row) {
    const brio_hole *h = &d->hole;
    brio_tetrahedron *tets = d->t.tet;
    size_t infinite = 0;
    for (size_t b = 0; b < h->num_border; b++) {
        uint32_t slot = h->fresh[b], facet = h->border[b];
        const uint32_t *c = h->corner + 3 * b;
        uint32_t *v = tets[slot].vertex;
        v[0] = row, v[1] = h->vertex[c[0]], v[2] = h->vertex[c[1]], v[3] = h->vertex[c[2]];
        d->home[v[1]] = d->home[v[2]] = slot;
        if (v[3]) d->home[v[3]] = slot; /* the infinite vertex is everybody's */
        infinite += v[3] == 0;
        tets[slot].mate[0] = facet;
        *brio_mate(&d->t, facet) = brio_facet_of(slot, 0);
        for (int k = 0; k < 3; k++) brio_edges_enter(d, c[(k + 1) % 3], c[(k + 2) % 3], brio_facet_of(slot, k + 1));
    }
    for (size_t b = 0; b < h->num_border; b++) {
        const uint32_t *c = h->corner + 3 * b;
        for (int k = 0; k < 3; k++) tets[h->fresh[b]].mate[k + 1] = brio_edges_find(d, c[(k + 2) % 3], c[(k + 1) % 3]);
    }
    d->home[row] = h->fresh[0];
    d->walk.start = h->fresh[0];
    d->counts.infinite += infinite;
    d->counts.finite += h->num_border - infinite;
}

/* --- one row --- */

/* Returns the vertex of a finite tetrahedron at a position, or the infinite vertex. */
static uint32_t vertex_at(const brio_dynamic *d, uint32_t tet, const double *p) {
    const uint32_t *v = d->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(d->record[v[i]], p)) return v[i];
    return 0;
}

static bool same_weight(const brio_dynamic *d, uint32_t r, uint32_t v) {
    return !d->weighted || d->record[r][3] == d->record[v][3];
}

/* Makes a row the twin of a vertex; the least name among those of the vertex' weight is the vertex'. */
static brio_status absorb(brio_dynamic *d, uint32_t row, uint32_t v) {
    BRIO_FORWARD(brio_live_join(d, row, v));
    if (!same_weight(d, row, v) || d->row[row].name > d->row[v].name) return BRIO_OK;
    uint32_t name = d->row[row].name;
    d->row[row].name = d->row[v].name, d->row[v].name = name;
    d->row_of[d->row[row].name] = row, d->row_of[name] = v;
    return BRIO_OK;
}

static uint32_t walk_to(brio_dynamic *d, const double *p) {
    return d->engine->walk(&d->t, d->zone, &d->filter, &d->walk, p, UINT64_MAX);
}

/* Finds a place for a loose row that is no vertex: what hid it still does, or the star that was written last does. */
static brio_status settle(brio_dynamic *d, uint32_t row) {
    const double *p = d->record[row];
    uint32_t tet = walk_to(d, p), v = vertex_at(d, tet, p);
    assert(!brio_is_infinite(&d->t, tet));
    return v ? absorb(d, row, v) : brio_live_hide(d, row, tet);
}

/* Settles the rows on the stack from `base` on, and the twins of those that were vertices. */
static brio_status settle_loose(brio_dynamic *d, size_t base) {
    while (d->num_loose > base) {
        uint32_t row = d->loose[--d->num_loose];
        for (uint32_t twin = d->row[row].twins, next; twin != BRIO_NONE; twin = next) {
            next = d->row[twin].next;
            BRIO_FORWARD(brio_live_unlink(d, twin));
            BRIO_FORWARD(settle(d, twin));
        }
        BRIO_FORWARD(settle(d, row));
        BRIO_FORWARD(brio_live_look(d, 16));
    }
    return BRIO_OK;
}

/* Makes a loose row a vertex, whose record is in conflict with a tetrahedron. */
static brio_status become_vertex(brio_dynamic *d, uint32_t row, uint32_t tet) {
    brio_hole *h = &d->hole;
    BRIO_FORWARD(dig(d, tet, d->record[row]));
    if (d->attempt) return BRIO_OK;
    if (d->zone && brio_hole_has_hidden(d)) return brio_give_up(d, BRIO_TRY_ALONE);
    brio_hole_number(d);
    BRIO_FORWARD(brio_edges_ready(d, h->num_vertices, 3 * h->num_border));
    BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
    if (d->weighted) BRIO_FORWARD(list_lost(d));
    if (!d->attempt) BRIO_FORWARD(brio_hole_take_slots(d, h->num_border));
    if (d->attempt) return BRIO_OK;
    brio_note_row(d, row);
    write_star(d, row);
    h->num_tets = h->num_border = 0;
    brio_set_kind(d, row, ROW_VERTEX);
    d->counts.vertices++;
    brio_live_hint(d, row);
    return BRIO_OK;
}

brio_status brio_live_place(brio_dynamic *d, uint32_t row) {
    const double *p = d->record[row];
    size_t base = d->num_loose;
    assert(brio_row_kind(d, row) == ROW_LOOSE && d->dimension == 3);
    assert(!d->zone || brio_zone_holds(d->zone, row)); /* L7 */
    brio_live_approach(d, p);
    uint32_t tet = d->attempt ? BRIO_NO_TET : walk_to(d, p);
    if (tet == BRIO_NO_TET) return brio_give_up(d, BRIO_TRY_LATER);
    if (!brio_is_infinite(&d->t, tet)) {
        uint32_t v = vertex_at(d, tet, p);
        bool hidden = !v && d->weighted && !brio_in_conflict(&d->t, &d->filter, tet, p, true);
        if (d->zone && (v || hidden)) return brio_give_up(d, BRIO_TRY_ALONE);
        d->walk.start = tet;
        if (v && !(d->weighted && p[3] > d->record[v][3])) return absorb(d, row, v);
        if (hidden) return brio_live_hide(d, row, tet);
    }
    BRIO_FORWARD(become_vertex(d, row, tet));
    if (d->attempt) brio_hole_forget(d);
    return settle_loose(d, base);
}
