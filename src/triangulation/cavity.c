/* The cavity of a point: dig it out, fill it with the point's star.
 *
 * Dig: breadth first from one tetrahedron in conflict. All facets through which the cavity has been left so far wait in
 * one list, as their outer sides; several of the tetrahedra there are tested together. One in conflict joins the cavity,
 * else the facet belongs to the border, a sphere that the point sees from inside. A tetrahedron seen across two facets
 * may be tested twice with the same answer, which costs less than marking it. Fill: each border facet and the point make
 * a tetrahedron, in the slots of the cavity. Two of these are neighbours across the edge that their border facets
 * share, which each of them sees in its own direction: entered under (u, v), found under (v, u). Vertices of the border
 * are numbered in bytes, so that a pair of them is a place in a small table; borders with too many vertices use a hash
 * table. Lists are written always and their length is advanced by a bit, since no branch could be foreseen.
 *
 * Based on: Bowyer. Computing Dirichlet tessellations. Comput. J. 1981.
 *           Watson. Computing the n-dimensional Delaunay tessellation ... Comput. J. 1981. */
#include "base/memory.h"
#include "base/rng.h"
#include "triangulation/kernel.h"
#include <string.h>

enum { TABLE_MOST = 240 }; /* vertices of a border whose edges go into the table */

void brio_cavity_free(brio_context *ctx, brio_cavity *c) {
    brio_release(ctx, c->tets);
    brio_release(ctx, c->facet);
    brio_release(ctx, c->border);
    brio_release(ctx, c->code);
    brio_release(ctx, c->local);
    brio_release(ctx, c->numbered);
    brio_release(ctx, c->table);
    brio_release(ctx, c->edge_key);
    brio_release(ctx, c->edge_facet);
    brio_release(ctx, c->cavity_vertex);
}

/* --- dig --- */

/* Room for the lists while the cavity has at most `tets` tetrahedra. */
static brio_status reserve_lists(brio_context *ctx, brio_cavity *c, size_t tets) {
    if (tets <= c->capacity) return BRIO_OK;
    size_t capacity = 2 * tets + 64;
    brio_status status = BRIO_RESIZE(ctx, c->tets, capacity);
    if (status == BRIO_OK) status = BRIO_RESIZE(ctx, c->facet, 4 * capacity);
    if (status == BRIO_OK) status = BRIO_RESIZE(ctx, c->border, 4 * capacity);
    if (status == BRIO_OK) c->capacity = capacity;
    return status;
}

/* Lists the facets of a cavity tetrahedron that leave the cavity as it is; their number afterwards. */
static inline size_t leave(const brio_kernel *k, uint32_t tet, uint32_t *facet, size_t n) {
    const brio_tetrahedron *tets = k->t.tet;
    const uint8_t *state = k->state;
    for (int i = 0; i < 4; i++) {
        uint32_t outer = tets[tet].mate[i], other = brio_tet_of(outer);
        __builtin_prefetch(&tets[other]);
        facet[n] = outer;
        n += state[other] != TET_CAVITY;
    }
    return n;
}

/* Adds the tetrahedra of those facets that are in conflict, each once, and the other facets to the border. */
static inline void divide(brio_kernel *k, const uint32_t *facet, size_t count, unsigned conflicts) {
    brio_cavity *c = &k->cavity;
    uint32_t *tets = c->tets, *border = c->border;
    uint8_t *state = k->state; /* stores to bytes may alias anything: what is used again stays in locals */
    size_t num_tets = c->num_tets, num_border = c->num_border;
    for (size_t i = 0; i < count; i++) {
        border[num_border] = facet[i];
        num_border += ~conflicts >> i & 1;
    }
    for (; conflicts; conflicts &= conflicts - 1) {
        uint32_t tet = brio_tet_of(facet[__builtin_ctz(conflicts)]);
        tets[num_tets] = tet;
        num_tets += state[tet] != TET_CAVITY;
        state[tet] = TET_CAVITY;
    }
    c->num_tets = num_tets;
    c->num_border = num_border;
}

brio_status brio_cavity_dig(brio_kernel *k, uint32_t first, uint32_t p) {
    brio_cavity *c = &k->cavity;
    const double *point = k->record[p];
    size_t expanded = 0, tested = 0, listed = 0;
    brio_status status = reserve_lists(k->ctx, c, 2 * BRIO_BATCH);
    if (status != BRIO_OK) return status;
    c->tets[0] = first;
    c->num_tets = 1;
    c->num_border = 0;
    k->state[first] = TET_CAVITY;
    for (;;) {
        while (expanded < c->num_tets && listed - tested < BRIO_BATCH)
            listed = leave(k, c->tets[expanded++], c->facet, listed);
        size_t count = listed - tested < BRIO_BATCH ? listed - tested : BRIO_BATCH;
        if (count == 0) break;
        uint32_t *facet = c->facet + tested;
        for (size_t i = count; i < BRIO_BATCH; i++) facet[i] = facet[0];
        divide(k, facet, count, k->conflicts(&k->t, &k->filter, facet, count, point));
        tested += count;
        status = reserve_lists(k->ctx, c, c->num_tets + 2 * BRIO_BATCH);
        if (status != BRIO_OK) return status;
    }
    k->stats.insphere_calls += tested;
    return BRIO_OK;
}

/* --- fill --- */

/* OUT[s]: the slots other than s, so that (x, OUT[s]) is positive for x on the other side of facet s; slot 3, which may
 * hold the infinite vertex, last. */
static const uint8_t OUT[4][3] = {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}};

/* Slots for the new tetrahedra, in c->tets: those of the cavity, of older ones, then new ones (room is there). */
static void take_slots(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    for (size_t n = c->num_tets; n < c->num_border; n++)
        c->tets[n] = k->num_unused ? k->unused[--k->num_unused] : (uint32_t)k->t.count++;
}

/* Slots of the cavity that the star does not need. */
static brio_status give_back_slots(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    if (c->num_border >= c->num_tets) return BRIO_OK;
    brio_status status =
        BRIO_RESERVE(k->ctx, k->unused, k->unused_capacity, k->num_unused + c->num_tets - c->num_border);
    if (status != BRIO_OK) return status;
    for (size_t n = c->num_border; n < c->num_tets; n++) {
        k->unused[k->num_unused++] = c->tets[n];
        k->state[c->tets[n]] = TET_UNUSED;
    }
    return BRIO_OK;
}

/* The tetrahedron of a border facet: the new vertex in slot 0, the facet's in 1 to 3. Its vertices. */
static inline const uint32_t *create(brio_tetrahedron *tets, uint32_t tet, uint32_t outer, uint32_t p) {
    brio_tetrahedron *outside = &tets[brio_tet_of(outer)], *inside = &tets[tet];
    int slot = brio_slot_of(outer);
    inside->vertex[0] = p;
    for (int i = 0; i < 3; i++) inside->vertex[i + 1] = outside->vertex[OUT[slot][i]];
    inside->mate[0] = outer;
    outside->mate[slot] = brio_facet_of(tet, 0);
    return inside->vertex;
}

/* The number of a border vertex, a new one at its first sight: written always, counted by a bit. */
static inline uint32_t number_of(uint8_t *local, uint32_t *numbered, size_t *count, uint32_t v) {
    uint32_t known = local[v];
    bool fresh = known == BRIO_NO_LOCAL;
    uint32_t number = fresh ? (uint32_t)*count : known;
    numbered[*count] = v;
    *count += fresh;
    local[v] = (uint8_t)number;
    return number;
}

/* Facet i > 0 of a new tetrahedron holds the point and the edge from vertex i % 3 + 1 to the one after it. The numbers x,
 * y, z of the vertices 1, 2, 3 are kept as the bytes x y z x from the lowest on, so that each edge is a pair of adjacent
 * bytes, and each edge the other way round a pair when the bytes are reversed. */
static void join_by_table(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    const uint32_t *border = c->border, *slot = c->tets;
    brio_tetrahedron *tets = k->t.tet;
    uint8_t *state = k->state, *local = c->local;
    uint32_t *table = c->table, *code = c->code, *numbered = c->numbered;
    size_t count = 0, num_border = c->num_border;
    for (size_t b = 0; b < num_border; b++) {
        uint32_t tet = slot[b];
        const uint32_t *v = create(tets, tet, border[b], p);
        uint32_t x = number_of(local, numbered, &count, v[1]), y = number_of(local, numbered, &count, v[2]);
        uint32_t xyzx = x | y << 8 | number_of(local, numbered, &count, v[3]) << 16 | x << 24;
        state[tet] = TET_PLAIN;
        code[b] = xyzx;
        table[xyzx >> 8 & 0xffff] = brio_facet_of(tet, 1);
        table[xyzx >> 16] = brio_facet_of(tet, 2);
        table[xyzx & 0xffff] = brio_facet_of(tet, 3);
    }
    for (size_t b = 0; b < num_border; b++) {
        uint32_t xzyx = __builtin_bswap32(code[b]), *mate = tets[slot[b]].mate;
        mate[1] = table[xzyx >> 8 & 0xffff];
        mate[2] = table[xzyx & 0xffff];
        mate[3] = table[xzyx >> 16];
    }
    c->num_numbered = count;
}

static inline size_t edge_place(const brio_cavity *c, uint64_t key, size_t mask) {
    size_t at = brio_mix(key) & mask;
    while (c->edge_key[at] != key && c->edge_key[at] != UINT64_MAX) at = (at + 1) & mask;
    return at;
}

/* The same with a hash table of edges; the vertices of the border are only marked. */
static brio_status join_by_hash(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    size_t size = 64;
    while (size < 6 * c->num_border) size *= 2;
    brio_status status = BRIO_RESERVE(k->ctx, c->edge_key, c->hash_capacity, size);
    if (status == BRIO_OK) status = BRIO_RESERVE(k->ctx, c->edge_facet, c->hash_facet_capacity, size);
    if (status != BRIO_OK) return status;
    memset(c->edge_key, 0xff, size * sizeof *c->edge_key);
    c->num_numbered = 0;
    for (size_t b = 0; b < c->num_border; b++) {
        const uint32_t *v = create(k->t.tet, c->tets[b], c->border[b], p);
        k->state[c->tets[b]] = TET_PLAIN;
        for (int i = 0; i < 3; i++) {
            uint64_t key = (uint64_t)v[(i + 1) % 3 + 1] << 32 | v[(i + 2) % 3 + 1];
            size_t at = edge_place(c, key, size - 1);
            c->edge_key[at] = key, c->edge_facet[at] = brio_facet_of(c->tets[b], i + 1);
            if (c->local[v[i + 1]] == BRIO_NO_LOCAL) c->local[v[i + 1]] = 0, c->numbered[c->num_numbered++] = v[i + 1];
        }
    }
    for (size_t b = 0; b < c->num_border; b++) {
        brio_tetrahedron *tet = &k->t.tet[c->tets[b]];
        for (int i = 0; i < 3; i++) {
            uint64_t key = (uint64_t)tet->vertex[(i + 2) % 3 + 1] << 32 | tet->vertex[(i + 1) % 3 + 1];
            tet->mate[i + 1] = c->edge_facet[edge_place(c, key, size - 1)];
        }
    }
    return BRIO_OK;
}

/* Lists the vertices of the cavity before it is overwritten; only needed where points can be hidden. */
static brio_status list_vertices(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    brio_status status = BRIO_RESERVE(k->ctx, c->cavity_vertex, c->cavity_vertex_capacity, 4 * c->num_tets);
    if (status != BRIO_OK) return status;
    for (size_t n = 0; n < c->num_tets; n++)
        memcpy(c->cavity_vertex + 4 * n, k->t.tet[c->tets[n]].vertex, 4 * sizeof *c->cavity_vertex);
    return BRIO_OK;
}

/* Vertices of the cavity that are not on its border are hidden by p. */
static void hide_interior(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    for (size_t i = 0; i < 4 * c->num_tets; i++)
        if (c->local[c->cavity_vertex[i]] == BRIO_NO_LOCAL) k->representative[c->cavity_vertex[i]] = p;
}

brio_status brio_cavity_fill(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    brio_status status = BRIO_OK;
    size_t vertices = c->num_border / 2 + 2; /* of a triangulated sphere */
    BRIO_TRY(brio_kernel_reserve(k, c->num_border));
    BRIO_TRY(reserve_lists(k->ctx, c, c->num_border));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->code, c->code_capacity, c->num_border));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->numbered, c->numbered_capacity, vertices + 1));
    if (k->weighted) BRIO_TRY(list_vertices(k));
    BRIO_TRY(give_back_slots(k));
    take_slots(k);
    if (vertices <= TABLE_MOST)
        join_by_table(k, p);
    else
        BRIO_TRY(join_by_hash(k, p));
    if (k->weighted) hide_interior(k, p);
    for (size_t i = 0; i < c->num_numbered; i++) c->local[c->numbered[i]] = BRIO_NO_LOCAL;
    k->stats.created += c->num_border;
    k->stats.destroyed += c->num_tets;
    k->walk.start = c->tets[0];
done:
    return status;
}
