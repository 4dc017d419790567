/* The cavity of a point: dig it out, fill it with the point's star.
 *
 * Dig: breadth first from one tetrahedron in conflict across facets; each tetrahedron is tested once, and the facets
 * between conflict and no conflict are the border, a sphere that the point sees from inside.
 * Fill: each border facet and the point make a tetrahedron, in the slots of the cavity. Two of these are neighbours across
 * the edge that their border facets share, which each of them sees in its own direction: entered under (u, v), found under
 * (v, u). Vertices of the border are numbered so that the edges fit a small square table; borders with too many vertices
 * use a hash table.
 *
 * Based on: Bowyer. Computing Dirichlet tessellations. Comput. J. 1981.
 *           Watson. Computing the n-dimensional Delaunay tessellation ... Comput. J. 1981. */
#include "base/memory.h"
#include "base/rng.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { TABLE_MOST = 240 }; /* vertices of a border whose edges go into the square table */

void brio_cavity_free(brio_context *ctx, brio_cavity *c) {
    brio_release(ctx, c->tets);
    brio_release(ctx, c->outside);
    brio_release(ctx, c->border);
    brio_release(ctx, c->local);
    brio_release(ctx, c->numbered);
    brio_release(ctx, c->table);
    brio_release(ctx, c->edge_key);
    brio_release(ctx, c->edge_facet);
    brio_release(ctx, c->created);
}

/* --- dig --- */

static brio_status reserve_step(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->tets, c->tets_capacity, c->num_tets + 4));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->outside, c->outside_capacity, c->num_outside + 4));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->border, c->border_capacity, c->num_border + 4));
done:
    return status;
}

static inline void add_border(brio_cavity *c, const uint32_t v[4], int slot, uint32_t outside, uint32_t p) {
    brio_border *b = &c->border[c->num_border++];
    b->outside = outside;
    b->slot = (uint32_t)slot;
    memcpy(b->vertex, v, sizeof b->vertex);
    b->vertex[slot] = p;
}

static inline __attribute__((always_inline)) brio_status dig(brio_kernel *k, uint32_t first, uint32_t p,
                                                             const bool weighted) {
    brio_cavity *c = &k->cavity;
    const double *point = k->record[p];
    uint8_t *state = k->state;
    c->num_tets = c->num_outside = c->num_border = 0;
    for (size_t next = 0; next == 0 || next < c->num_tets; next++) {
        brio_status status = reserve_step(k);
        if (status != BRIO_OK) return status;
        if (next == 0) {
            c->tets[c->num_tets++] = first;
            state[first] = TET_CAVITY;
        }
        uint32_t tet = c->tets[next];
        for (int i = 0; i < 4; i++) {
            uint32_t mate = k->t.mate[4 * (size_t)tet + (size_t)i], other = brio_tet_of(mate);
            if (state[other] == TET_PLAIN) {
                bool conflict = brio_in_conflict(&k->t, &k->filter, other, point, weighted);
                k->stats.insphere_calls++;
                state[other] = conflict ? TET_CAVITY : TET_OUTSIDE;
                c->tets[c->num_tets] = c->outside[c->num_outside] = other;
                c->num_tets += conflict;
                c->num_outside += !conflict;
            }
            if (state[other] == TET_OUTSIDE) add_border(c, k->t.vertex + 4 * (size_t)tet, i, mate, p);
        }
    }
    for (size_t i = 0; i < c->num_outside; i++) state[c->outside[i]] = TET_PLAIN;
    return BRIO_OK;
}

brio_status brio_cavity_dig(brio_kernel *k, uint32_t first, uint32_t p) {
    return k->weighted ? dig(k, first, p, true) : dig(k, first, p, false);
}

/* --- fill --- */

/* Numbers the vertices of the border; false when they are too many for the table. */
static brio_status number_vertices(brio_kernel *k, bool *few) {
    brio_cavity *c = &k->cavity;
    size_t vertices = c->num_border / 2 + 2; /* of a triangulated sphere */
    c->num_numbered = 0;
    *few = vertices <= TABLE_MOST;
    brio_status status = BRIO_RESERVE(k->ctx, c->numbered, c->numbered_capacity, vertices + 4);
    if (status != BRIO_OK) return status;
    for (size_t b = 0; b < c->num_border; b++)
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t v = c->border[b].vertex[i];
            if (i == c->border[b].slot || c->local[v] != BRIO_NO_LOCAL) continue;
            c->local[v] = *few ? (uint8_t)c->num_numbered : 0;
            c->numbered[c->num_numbered++] = v;
        }
    return BRIO_OK;
}

/* Vertices of the cavity that are not on its border are hidden by p. */
static brio_status hide_interior(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    for (size_t n = 0; n < c->num_tets; n++)
        for (int i = 0; i < 4; i++) {
            uint32_t v = k->t.vertex[4 * (size_t)c->tets[n] + (size_t)i];
            if (c->local[v] != BRIO_NO_LOCAL) continue;
            brio_status status = BRIO_RESERVE(k->ctx, c->numbered, c->numbered_capacity, c->num_numbered + 1);
            if (status != BRIO_OK) return status;
            c->local[v] = 0;
            c->numbered[c->num_numbered++] = v;
            k->representative[v] = p;
        }
    return BRIO_OK;
}

/* The slot for one new tetrahedron: of the cavity, of an older one, or a new one (room is there). */
static inline uint32_t take_slot(brio_kernel *k, size_t n) {
    if (n < k->cavity.num_tets) return k->cavity.tets[n];
    if (k->num_unused) return k->unused[--k->num_unused];
    return (uint32_t)k->t.count++;
}

static void create_star(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    for (size_t b = 0; b < c->num_border; b++) {
        const brio_border *border = &c->border[b];
        uint32_t tet = take_slot(k, b), own = brio_facet_of(tet, (int)border->slot);
        memcpy(k->t.vertex + 4 * (size_t)tet, border->vertex, sizeof border->vertex);
        k->t.mate[own] = border->outside;
        k->t.mate[border->outside] = own;
        k->state[tet] = TET_PLAIN;
        c->created[b] = tet;
    }
}

static brio_status link_by_table(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    size_t n = c->num_numbered;
    brio_status status = BRIO_RESERVE(k->ctx, c->table, c->table_capacity, n * n);
    if (status != BRIO_OK) return status;
    for (int pass = 0; pass < 2; pass++)
        for (size_t b = 0; b < c->num_border; b++) {
            const uint32_t *v = c->border[b].vertex;
            uint32_t slot = c->border[b].slot;
            for (uint32_t j = 0; j < 4; j++) {
                if (j == slot) continue;
                size_t u = c->local[v[BRIO_EDGE[slot][j][0]]], w = c->local[v[BRIO_EDGE[slot][j][1]]];
                uint32_t facet = brio_facet_of(c->created[b], (int)j);
                if (pass == 0)
                    c->table[u * n + w] = facet;
                else
                    k->t.mate[facet] = c->table[w * n + u];
            }
        }
    return BRIO_OK;
}

static inline size_t edge_place(const brio_cavity *c, uint64_t key, size_t mask) {
    size_t at = brio_mix(key) & mask;
    while (c->edge_key[at] != key && c->edge_key[at] != UINT64_MAX) at = (at + 1) & mask;
    return at;
}

static brio_status link_by_hash(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    size_t size = 64;
    while (size < 6 * c->num_border) size *= 2;
    brio_status status = BRIO_RESERVE(k->ctx, c->edge_key, c->hash_capacity, size);
    if (status == BRIO_OK) status = BRIO_RESERVE(k->ctx, c->edge_facet, c->hash_facet_capacity, size);
    if (status != BRIO_OK) return status;
    memset(c->edge_key, 0xff, size * sizeof *c->edge_key);
    for (int pass = 0; pass < 2; pass++)
        for (size_t b = 0; b < c->num_border; b++) {
            const uint32_t *v = c->border[b].vertex;
            uint32_t slot = c->border[b].slot;
            for (uint32_t j = 0; j < 4; j++) {
                if (j == slot) continue;
                uint64_t u = v[BRIO_EDGE[slot][j][0]], w = v[BRIO_EDGE[slot][j][1]];
                uint32_t facet = brio_facet_of(c->created[b], (int)j);
                size_t at = edge_place(c, pass == 0 ? u << 32 | w : w << 32 | u, size - 1);
                if (pass == 0)
                    c->edge_key[at] = u << 32 | w, c->edge_facet[at] = facet;
                else
                    k->t.mate[facet] = c->edge_facet[at];
            }
        }
    return BRIO_OK;
}

/* Slots of the cavity that the star does not need. */
static brio_status give_back_slots(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    for (size_t n = c->num_border; n < c->num_tets; n++) {
        brio_status status = BRIO_RESERVE(k->ctx, k->unused, k->unused_capacity, k->num_unused + 1);
        if (status != BRIO_OK) return status;
        k->unused[k->num_unused++] = c->tets[n];
        k->state[c->tets[n]] = TET_UNUSED;
    }
    return BRIO_OK;
}

brio_status brio_cavity_fill(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    brio_status status = BRIO_OK;
    bool few;
    BRIO_TRY(brio_kernel_reserve(k, c->num_border));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->created, c->created_capacity, c->num_border));
    BRIO_TRY(number_vertices(k, &few));
    if (k->weighted) BRIO_TRY(hide_interior(k, p));
    create_star(k);
    BRIO_TRY(few ? link_by_table(k) : link_by_hash(k));
    BRIO_TRY(give_back_slots(k));
    for (size_t i = 0; i < c->num_numbered; i++) c->local[c->numbered[i]] = BRIO_NO_LOCAL;
    k->stats.created += c->num_border;
    k->stats.destroyed += c->num_tets;
    k->walk.start = c->created[0];
done:
    return status;
}
