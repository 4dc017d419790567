/* A point is taken out.
 *
 * The star of a vertex becomes a hole. The triangulation without the vertex has only tetrahedra of the link's
 * vertices there, since the perturbation makes it unique, and each of them is one of the triangulation of the link's
 * vertices alone. So these are triangulated (link.c for few, brio_delaunay for many), and what lies inside the link
 * is glued in: facets that are facets of the link bound a flood. Where the finite vertices of the link lie in a
 * plane, the hole has infinite tetrahedra only, one over each finite facet of the link. A vertex whose star has all
 * finite tetrahedra is left to building anew.
 *
 * Hidden rows of the star are placed again: only they can come back.
 *
 * Based on: Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011.
 *           Buchin, Devillers, Mulzer, Schrijvers, Shewchuk. Vertex deletion for 3D Delaunay triangulations. ESA
 *           2013. */
#include "base/memory.h"
#include "dynamic/live.h"
#include "triangulation/triangulation.h"
#include <string.h>

/** The tetrahedra of the link's vertices, by numbers. */
typedef struct {
    brio_tetrahedron *tet;
    uint32_t *slot; /* of each: where it goes; BRIO_NONE: it is not in the hole */
    size_t count;
    bool owned;
} filling;

enum { LAST_SHIFT = 6, LAST_BITS = (1 << LAST_SHIFT) - 1 };
static const uint32_t ON_BORDER = UINT32_C(1) << 31; /* of a mate: what follows is a facet of the border */

/* Calls for what a change of a tetrahedron will read. */
static inline void expect_change(const brio_dynamic *d, uint32_t slot) {
    const uint32_t *v = d->t.tet[slot].vertex;
    for (int k = 0; k < 4; k++) {
        __builtin_prefetch(d->record[v[k]]);
        __builtin_prefetch(&d->number[v[k]], 1);
        __builtin_prefetch(&d->home[v[k]], 1);
    }
}

brio_status brio_live_star(brio_dynamic *d, uint32_t row) {
    brio_hole *h = &d->hole;
    assert(!d->zone || brio_zone_holds(d->zone, row)); /* L7 */
    h->tet[0] = d->home[row];
    h->num_tets = 1;
    h->num_border = 0;
    if (!brio_owns(&d->t, d->zone, h->tet[0])) {
        h->num_tets = 0;
        return brio_give_up(d, BRIO_TRY_LATER);
    }
    d->state[h->tet[0]] |= SLOT_HOLE;
    for (size_t n = 0; n < h->num_tets; n++) {
        const brio_tetrahedron *t = &d->t.tet[h->tet[n]];
        int slot = brio_slot_of_vertex(t->vertex, row);
        assert(slot < 4); /* L1 */
        expect_change(d, h->tet[n]);
        for (int i = 0; i < 4; i++) {
            uint32_t mate = t->mate[i], tet = brio_tet_of(mate);
            if (i == slot) {
                h->border[h->num_border++] = mate;
                __builtin_prefetch(&d->t.tet[tet]);
            } else if (!brio_in_hole(d, tet)) {
                if (!brio_owns_beyond(&d->t, d->zone, mate)) return brio_give_up(d, BRIO_TRY_LATER);
                h->tet[h->num_tets++] = tet;
                d->state[tet] |= SLOT_HOLE;
            }
        }
        if (h->num_tets + 4 <= h->capacity) continue;
        BRIO_FORWARD(brio_hole_reserve(d, h->num_tets + 4));
        BRIO_FORWARD(brio_live_look(d, h->num_tets));
    }
    return BRIO_OK;
}

/* --- the tetrahedra of many vertices --- */

/* Copies the result of brio_delaunay, whose points have the numbers from 1 on. */
static brio_status copy_result(brio_dynamic *d, const brio_triangulation *t, filling *f) {
    f->count = t->stats.tetrahedra + t->stats.hull_facets;
    BRIO_EXPECT(d->ctx, f->count < ON_BORDER / 4, BRIO_ERR_TOO_LARGE, "a link of %zu tetrahedra", f->count);
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, f->tet, f->count));
    f->owned = true;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, f->slot, f->count));
    for (size_t i = 0; i < f->count; i++) {
        f->tet[i] = t->tet[i];
        for (int k = 0; k < 4; k++) f->tet[i].vertex[k]++; /* BRIO_INFINITE becomes 0 */
    }
    return BRIO_OK;
}

static brio_status link_many(brio_dynamic *d, filling *f, bool *flat) {
    const brio_hole *h = &d->hole;
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    double *points = NULL, *weights = NULL;
    size_t n = h->num_vertices - 1;
    BRIO_TRY(BRIO_ALLOC(d->ctx, points, 3 * n));
    if (d->weighted) BRIO_TRY(BRIO_ALLOC(d->ctx, weights, n));
    for (size_t i = 0; i < n; i++) {
        const double *r = d->record[h->vertex[i + 1]];
        memcpy(points + 3 * i, r, 3 * sizeof *r);
        if (weights) weights[i] = r[3];
    }
    BRIO_TRY(brio_delaunay(d->ctx, points, weights, n, NULL, &t));
    *flat = t->stats.dimension < 3;
    if (!*flat) status = copy_result(d, t, f);
done:
    brio_triangulation_free(t);
    brio_release(d->ctx, points);
    brio_release(d->ctx, weights);
    return status;
}

/* --- a link in a plane --- */

/* Makes the infinite tetrahedra over the finite facets of the link. */
static brio_status link_flat(brio_dynamic *d, filling *f) {
    const brio_hole *h = &d->hole;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, f->tet, h->num_border));
    f->owned = true;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, f->slot, h->num_border));
    f->count = 0;
    for (size_t b = 0; b < h->num_border; b++) {
        const uint32_t *c = h->corner + 3 * b;
        if (c[2] == 0) continue;
        uint32_t tet = (uint32_t)f->count++, *v = f->tet[tet].vertex;
        v[0] = c[0], v[1] = c[2], v[2] = c[1], v[3] = 0;
        for (int k = 0; k < 4; k++) f->tet[tet].mate[k] = BRIO_NONE;
        for (int k = 0; k < 3; k++) brio_edges_enter(d, v[(k + 1) % 3], v[(k + 2) % 3], brio_facet_of(tet, k));
    }
    for (uint32_t tet = 0; tet < f->count; tet++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *v = f->tet[tet].vertex;
            uint32_t x = v[(k + 1) % 3], y = v[(k + 2) % 3], other = brio_edges_find(d, y, x);
            if (other == BRIO_NONE || brio_tet_of(other) >= f->count || brio_slot_of(other) > 2) continue;
            const uint32_t *w = f->tet[brio_tet_of(other)].vertex;
            int j = brio_slot_of(other);
            if (w[(j + 1) % 3] == y && w[(j + 2) % 3] == x) f->tet[tet].mate[k] = other;
        }
    return BRIO_OK;
}

/* --- glue --- */

/* Returns the facet of the border with the corners x, y, z in this sequence, or BRIO_NONE. What the table has under
 * (x, y) ends with bits of z, so that most facets that are none take one comparison. */
static inline uint32_t border_at(const brio_dynamic *d, uint32_t x, uint32_t y, uint32_t z) {
    const brio_hole *h = &d->hole;
    uint32_t found = brio_edges_find(d, x, y);
    if ((found & LAST_BITS) != (z & LAST_BITS)) return BRIO_NONE;
    size_t b = found >> LAST_SHIFT;
    if (b >= h->num_border) return BRIO_NONE;
    const uint32_t *c = h->corner + 3 * b;
    int k = c[0] == x ? 0 : c[1] == x ? 1 : 2;
    return c[k] == x && c[(k + 1) % 3] == y && c[(k + 2) % 3] == z ? (uint32_t)b : BRIO_NONE;
}

/* Lists the tetrahedra inside the link in hole.outer: those at the border, and a flood from there. Mates that are
 * facets of the border are marked. *num_met is the number of facets of the border that were met; where it is not all of
 * them, those have a mark in hole.fresh, and no tetrahedra are listed. It is 0 where the flood comes to a facet of the
 * border from outside: then the hole covers some place twice, which moved points may do (move_many.c). */
static brio_status flood(brio_dynamic *d, filling *f, size_t *num_inside, size_t *num_met) {
    brio_hole *h = &d->hole;
    size_t n = 0, met = 0;
    bool outside = false; /* whether the hole has infinite tetrahedra */
    for (size_t b = 0; b < h->num_border; b++) outside |= h->corner[3 * b + 2] == 0;
    for (size_t b = 0; b < h->num_border; b++)
        for (uint32_t k = 0; k < 3; k++)
            brio_edges_enter(d, h->corner[3 * b + k], h->corner[3 * b + (k + 1) % 3],
                             (uint32_t)b << LAST_SHIFT | (h->corner[3 * b + (k + 2) % 3] & LAST_BITS));
    for (size_t i = 0; i < f->count; i++) f->slot[i] = BRIO_NONE;
    BRIO_FORWARD(brio_hole_reserve(d, f->count));
    BRIO_FORWARD(brio_hole_reserve_fresh(d, h->num_border));
    for (size_t b = 0; b < h->num_border; b++) h->fresh[b] = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t *v = f->tet[i].vertex;
        if (v[0] == BRIO_NONE || (v[3] == 0 && !outside)) continue;
        for (int k = 0; k < 4; k++) {
            uint32_t b = border_at(d, v[BRIO_FACET[k][0]], v[BRIO_FACET[k][2]], v[BRIO_FACET[k][1]]);
            if (b == BRIO_NONE) continue;
            f->tet[i].mate[k] = ON_BORDER | b;
            met += h->fresh[b] == 0;
            h->fresh[b] = 1;
            if (f->slot[i] == BRIO_NONE) h->outer[n++] = i;
            f->slot[i] = 0;
        }
    }
    *num_met = met;
    if (met < h->num_border) return BRIO_OK;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t mate = f->tet[h->outer[i]].mate[k], tet = brio_tet_of(mate);
            if (mate & ON_BORDER) continue;
            if (f->tet[tet].mate[brio_slot_of(mate)] & ON_BORDER) {
                *num_met = 0;
                return BRIO_OK;
            }
            if (f->slot[tet] != BRIO_NONE) continue;
            f->slot[tet] = 0;
            h->outer[n++] = tet;
        }
    *num_inside = n;
    return BRIO_OK;
}

/* Writes the tetrahedra inside the link into the store. */
static void glue(brio_dynamic *d, const filling *f, size_t n) {
    const brio_hole *h = &d->hole;
    for (size_t i = 0; i < n; i++) f->slot[h->outer[i]] = h->fresh[i];
    for (size_t i = 0; i < n; i++) {
        const brio_tetrahedron *from = &f->tet[h->outer[i]];
        uint32_t slot = h->fresh[i];
        brio_tetrahedron *to = &d->t.tet[slot];
        for (int k = 0; k < 4; k++) {
            uint32_t mate = from->mate[k], row = h->vertex[from->vertex[k]];
            to->vertex[k] = row;
            if (row) d->home[row] = slot; /* the infinite vertex is everybody's */
            if (mate & ON_BORDER) {
                uint32_t facet = h->border[mate & ~ON_BORDER];
                to->mate[k] = facet;
                *brio_mate(&d->t, facet) = brio_facet_of(slot, k);
            } else {
                to->mate[k] = brio_facet_of(f->slot[brio_tet_of(mate)], brio_slot_of(mate));
            }
        }
        if (from->vertex[3] == 0)
            d->counts.infinite++;
        else
            d->counts.finite++;
    }
    d->walk.start = h->fresh[0];
}

static brio_status fill(brio_dynamic *d, filling *f) {
    brio_hole *h = &d->hole;
    size_t n, inside, met;
    bool flat = false;
    BRIO_EXPECT(d->ctx, h->num_border < (size_t)1 << (32 - LAST_SHIFT), BRIO_ERR_TOO_LARGE,
                "a vertex with %zu tetrahedra; at most 2^26 can be taken away", h->num_border);
    brio_hole_number(d);
    n = h->num_vertices - 1;
    if (d->zone && n > BRIO_LINK_MOST) return brio_give_up(d, BRIO_TRY_ALONE);
    BRIO_FORWARD(brio_edges_ready(d, h->num_vertices, 6 * h->num_border));
    if (n <= BRIO_LINK_MOST) {
        bool all = brio_link_few(d, &f->tet, &f->count, &flat);
        BRIO_EXPECT(d->ctx, all, BRIO_ERR_INTERNAL, "a vertex of a link of %zu hides another", n);
        f->slot = brio_link_slots(d);
    } else {
        BRIO_FORWARD(link_many(d, f, &flat));
    }
    if (flat) BRIO_FORWARD(link_flat(d, f));
    BRIO_FORWARD(flood(d, f, &inside, &met));
    BRIO_EXPECT(d->ctx, met == h->num_border, BRIO_ERR_INTERNAL, "a hole of %zu facets has %zu of them inside",
                h->num_border, met);
    BRIO_FORWARD(brio_hole_take_slots(d, inside));
    if (!d->attempt) glue(d, f, inside);
    return BRIO_OK;
}

brio_status brio_hole_mend(brio_dynamic *d, bool *mended) {
    filling f = {0};
    brio_hole *h = &d->hole;
    size_t inside, met;
    bool flat;
    *mended = false;
    brio_hole_number(d);
    brio_hole_number_inner(d);
    if (h->num_vertices > BRIO_LINK_MOST + 1) return BRIO_OK;
    BRIO_FORWARD(brio_edges_ready(d, h->num_vertices, 3 * h->num_border));
    if (!brio_link_few(d, &f.tet, &f.count, &flat) || flat) return BRIO_OK;
    f.slot = brio_link_slots(d);
    BRIO_FORWARD(flood(d, &f, &inside, &met));
    *mended = met == h->num_border;
    if (!*mended) return BRIO_OK;
    BRIO_FORWARD(brio_hole_take_slots(d, inside));
    glue(d, &f, inside);
    return BRIO_OK;
}

/* Returns whether the hole, a star, has all finite tetrahedra. */
static bool is_all(const brio_dynamic *d) {
    size_t finite = 0;
    if (d->hole.num_tets < d->counts.finite) return false;
    for (size_t i = 0; i < d->hole.num_tets; i++) finite += !brio_is_infinite(&d->t, d->hole.tet[i]);
    return finite == d->counts.finite;
}

bool brio_hole_has_hidden(const brio_dynamic *d) {
    for (size_t i = 0; i < d->hole.num_tets && d->hidden; i++)
        if (d->hidden[d->hole.tet[i]] != BRIO_NONE) return true;
    return false;
}

/* Takes a vertex out; its twins stay with its row, which is loose then. */
static brio_status take_vertex(brio_dynamic *d, uint32_t row) {
    filling f = {0};
    size_t base = d->num_loose;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_live_star(d, row));
    if (d->zone && !d->attempt && brio_hole_has_hidden(d)) brio_give_up(d, BRIO_TRY_ALONE);
    if (!d->zone && is_all(d)) {
        d->needs_anew = true;
        status = BRIO_ERR_INTERNAL; /* the caller takes the change back and builds anew */
        goto done;
    }
    if (!d->attempt) BRIO_TRY(fill(d, &f));
    if (d->attempt) {
        brio_hole_forget(d);
        goto done;
    }
    brio_live_unhint(d, row, d->hole.vertex[1]);
    d->hole.num_tets = d->hole.num_border = 0;
    BRIO_TRY(brio_journal_reserve(d, 0, 1));
    brio_note_row(d, row);
    brio_set_kind(d, row, ROW_LOOSE);
    d->counts.vertices--;
    while (d->num_loose > base && status == BRIO_OK) status = brio_live_place(d, d->loose[--d->num_loose]);
done:
    if (f.owned) {
        brio_release(d->ctx, f.tet);
        brio_release(d->ctx, f.slot);
    }
    return status;
}

/* --- twins --- */

/* Returns the twin that takes the vertex' place: the heaviest, of these that with the least name. */
static uint32_t best_twin(const brio_dynamic *d, uint32_t row) {
    uint32_t best = d->row[row].twins;
    for (uint32_t r = best; r != BRIO_NONE; r = d->row[r].next) {
        double more = d->weighted ? d->record[r][3] - d->record[best][3] : 0;
        if (more > 0 || (more == 0 && d->row[r].name < d->row[best].name)) best = r;
    }
    return best;
}

brio_status brio_live_take(brio_dynamic *d, uint32_t *row) {
    uint32_t r = *row, twin;
    if (d->zone && (brio_row_kind(d, r) != ROW_VERTEX || d->row[r].twins != BRIO_NONE))
        return brio_give_up(d, BRIO_TRY_ALONE);
    if (brio_row_kind(d, r) != ROW_VERTEX) return brio_live_unlink(d, r);
    if (d->row[r].twins == BRIO_NONE) return take_vertex(d, r);
    twin = best_twin(d, r);
    if (!d->weighted || d->record[twin][3] == d->record[r][3]) { /* they change names */
        BRIO_FORWARD(brio_live_unlink(d, twin));
        BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
        brio_note_row(d, r);
        uint32_t name = d->row[r].name;
        d->row[r].name = d->row[twin].name, d->row[twin].name = name;
        d->row_of[name] = twin, d->row_of[d->row[r].name] = r;
        *row = twin;
        return BRIO_OK;
    }
    BRIO_FORWARD(take_vertex(d, r));
    while ((twin = d->row[r].twins) != BRIO_NONE) {
        BRIO_FORWARD(brio_live_unlink(d, twin));
        BRIO_FORWARD(brio_live_place(d, twin));
    }
    return BRIO_OK;
}
