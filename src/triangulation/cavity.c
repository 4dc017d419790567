/* The cavity of a point: dig it out, fill it with the point's star.
 *
 * Dig: breadth first from one tetrahedron in conflict. All facets through which the cavity has been left so far wait in
 * one list, as their outer sides; several of the tetrahedra there are tested together. One in conflict joins the
 * cavity, else the facet belongs to the border, a sphere that the point sees from inside. A tetrahedron seen across two
 * facets may be tested twice with the same answer, which costs less than marking it. Fill: each border facet and the
 * point make a tetrahedron, in the slots of the cavity. Two of these are neighbours across the edge that their border
 * facets share, which each of them sees in its own direction: entered under (u, v), found under (v, u). Vertices of the
 * border are numbered in bytes, so that a pair of them is a place in a small table; borders with too many vertices use
 * a hash table. Lists are written always and their length is advanced by a bit, since no branch could be foreseen.
 *
 * Based on: Bowyer. Computing Dirichlet tessellations. Comput. J. 1981.
 *           Watson. Computing the n-dimensional Delaunay tessellation ... Comput. J. 1981. */
#include "triangulation/cavity.h"
#include "base/memory.h"
#include "base/poison.h"
#include "triangulation/inserter.h"
#include <assert.h>
#include <string.h>

enum { HASHED_BETWEEN = BRIO_INSERT_WORK / 4 }; /* border facets between two reports of progress */
enum { FIRST_TETS = 64 };                       /* of a cavity that there is room for at first */
enum { SMALL_MOST = 60, BYTES_MOST = 252 };     /* tetrahedra of a cavity whose vertices are numbered in 6 bits, in 8 */

void brio_cavity_free(brio_context *ctx, brio_cavity *c) {
    brio_release(ctx, c->entry);
    brio_release(ctx, c->created);
    brio_release(ctx, c->facet);
    brio_release(ctx, c->border);
    brio_release(ctx, c->table);
    brio_release(ctx, c->edge);
    brio_release(ctx, c->cavity_vertex);
}

/* Makes room for the lists of a cavity of at most `tets` tetrahedra. */
static brio_status reserve_lists(brio_context *ctx, brio_cavity *c, size_t tets) {
    if (tets <= c->capacity) return BRIO_OK;
    brio_status status = BRIO_RESIZE(ctx, c->entry, tets);
    if (status == BRIO_OK) status = BRIO_RESIZE(ctx, c->facet, 4 * tets);
    if (status == BRIO_OK) status = BRIO_RESIZE(ctx, c->border, 4 * tets);
    if (status == BRIO_OK) status = BRIO_RESIZE(ctx, c->created, 4 * tets);
    if (status == BRIO_OK) c->capacity = tets;
    return status;
}

brio_status brio_cavity_new(brio_context *ctx, brio_cavity *out) {
    *out = (brio_cavity){0};
    brio_status status = BRIO_ALLOC(ctx, out->table, BRIO_TABLE);
    return status == BRIO_OK ? reserve_lists(ctx, out, FIRST_TETS) : status;
}

brio_status brio_cavity_pause(brio_inserter *ins) {
    brio_cavity *c = &ins->cavity;
    assert(c->num_tets <= c->capacity && c->pause <= c->capacity);
    if (c->pause == c->capacity) BRIO_FORWARD(reserve_lists(ins->store->ctx, c, 2 * c->capacity));
    if (c->num_tets >= BRIO_INSERT_WORK / 2) BRIO_FORWARD(brio_inserter_report(ins, ins->done));
    c->pause = c->capacity - c->num_tets < BRIO_INSERT_WORK ? c->capacity : c->num_tets + BRIO_INSERT_WORK;
    assert(c->num_tets + 2 * BRIO_BATCH <= c->pause); /* else the dig would pause again at once */
    return BRIO_OK;
}

void brio_cavity_undo(brio_inserter *ins) {
    const brio_cavity *c = &ins->cavity;
    assert(ins->zone); /* alone nothing is deferred */
    for (size_t i = 0; i < c->num_tets; i++) ins->store->state[brio_tet_of(c->entry[i])] = TET_PLAIN;
}

/* OUT[s]: the slots other than s, so that (x, OUT[s]) is positive for x on the other side of facet s; slot 3, which may
 * hold the infinite vertex, last. */
static const uint8_t OUT[4][3] = {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}};

/* Lists slots for the new tetrahedra: those of the cavity, then unused ones, then fresh ones (room is there). Slots of
 * the cavity that the star does not need become unused. */
static brio_status take_slots(brio_inserter *ins) {
    brio_cavity *c = &ins->cavity;
    size_t n = 0;
    uint32_t *created = c->created;
    uint8_t *state = ins->store->state;
    for (; n < c->num_tets && n < c->num_border; n++) {
        created[n] = brio_tet_of(c->entry[n]);
        assert(state[created[n]] == TET_CAVITY);
        state[created[n]] = TET_PLAIN;
    }
    for (; n < c->num_border; n++) {
        assert(ins->num_unused ? state[ins->unused[ins->num_unused - 1]] == TET_UNUSED
                               : ins->next_slot < ins->end_slot);
        created[n] = ins->num_unused ? ins->unused[--ins->num_unused] : (uint32_t)ins->next_slot++;
        assert(brio_has_tet(&ins->store->t, created[n]));
        state[created[n]] = TET_PLAIN;
    }
    if (n >= c->num_tets) return BRIO_OK;
    brio_status status =
        BRIO_RESERVE(ins->store->ctx, ins->unused, ins->unused_capacity, ins->num_unused + c->num_tets - n);
    if (status != BRIO_OK) return status;
    for (; n < c->num_tets; n++) {
        uint32_t slot = brio_tet_of(c->entry[n]);
        assert(state[slot] == TET_CAVITY && ins->num_unused < ins->unused_capacity); /* N4 */
        ins->unused[ins->num_unused++] = slot;
        state[slot] = TET_UNUSED;
        brio_poison_fill(&ins->store->t.tet[slot], sizeof *ins->store->t.tet);
    }
    return BRIO_OK;
}

/* Writes four numbers in two stores. */
static inline void store_four(uint32_t *to, uint64_t a, uint64_t b, uint64_t c, uint64_t d) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    uint64_t pair[2] = {a | b << 32, c | d << 32};
#else
    uint64_t pair[2] = {a << 32 | b, c << 32 | d};
#endif
    memcpy(to, &pair[0], sizeof *pair);
    memcpy(to + 2, &pair[1], sizeof *pair);
}

/* Makes the tetrahedron of a border facet, with the new vertex in slot 0 and the facet's vertices v in slots 1 to 3.
 * The tetrahedron outside need not be the thread's own: no other thread writes its vertices, nor its mate at this facet
 * (P1, P2). */
static inline void create(brio_tetrahedron *tets, uint32_t tet, uint32_t outer, uint32_t p, uint32_t v[3]) {
    assert(brio_tet_of(outer) != tet);
    brio_tetrahedron *outside = &tets[brio_tet_of(outer)], *inside = &tets[tet];
    int slot = brio_slot_of(outer);
    for (int i = 0; i < 3; i++) v[i] = outside->vertex[OUT[slot][i]];
    outside->mate[slot] = brio_facet_of(tet, 0);
    assert(v[0] != p && v[1] != p && v[2] != p);
    store_four(inside->vertex, p, v[0], v[1], v[2]);
}

/* Where the vertices of a cavity, which the thread holds, have their numbers (P4). By value, since stores to bytes may
 * alias anything. */
typedef struct {
    uint8_t *local, *infinite_local;
    uint32_t infinite;
} numbers;

static inline numbers numbers_of(brio_inserter *ins) {
    return (numbers){ins->store->local, &ins->cavity.infinite_local, ins->store->t.infinite};
}

static inline uint8_t *number_of(numbers n, uint32_t v) {
    return v == n.infinite ? n.infinite_local : &n.local[v];
}

/* Numbers the vertices of the cavity: those of the first tetrahedron by their slots, and what each later one added, the
 * vertex opposite to the facet it was found through, by when it was found. The last number of a vertex counts. */
static void number_vertices(brio_inserter *ins) {
    const brio_tetrahedron *tets = ins->store->t.tet;
    const numbers number = numbers_of(ins);
    const uint32_t *entry = ins->cavity.entry;
    size_t num_tets = ins->cavity.num_tets;
    assert(0 < num_tets && num_tets <= BYTES_MOST); /* numbers up to num_tets + 2 fit bytes */
    for (uint32_t i = 0; i < 4; i++) *number_of(number, tets[brio_tet_of(entry[0])].vertex[i]) = (uint8_t)i;
    for (size_t n = 1; n < num_tets; n++)
        *number_of(number, tets[brio_tet_of(entry[n])].vertex[brio_slot_of(entry[n])]) = (uint8_t)(n + 3);
}

/* Joins the star by a table of edges. Facet i > 0 of a new tetrahedron holds the point and the edge from vertex i % 3 +
 * 1 to the one after it. The numbers x, y, z of the vertices 1, 2, 3, of `bits` bits each, are packed as x y z x from
 * the lowest on, so that each edge is a pair of neighbours; packed as x z y x, each edge the other way round is one. */
static inline void join_by_table(brio_inserter *ins, uint32_t p, const int bits) {
    brio_cavity *c = &ins->cavity;
    const uint32_t *border = c->border, *created = c->created, pair = (1u << 2 * bits) - 1;
    const numbers number = numbers_of(ins);
    const uint8_t *local = number.local;
    brio_tetrahedron *tets = ins->store->t.tet;
    uint32_t *table = c->table, *code = c->facet;
    size_t num_border = c->num_border;
    assert(2 * bits <= 16 && c->num_tets + 3 <= (size_t)1 << bits); /* pairs of numbers are places of the table */
    for (size_t b = 0; b < num_border; b++) {
        uint32_t tet = created[b], v[3];
        create(tets, tet, border[b], p, v);
        uint32_t x = local[v[0]], y = local[v[1]], z = *number_of(number, v[2]), xx = x | x << 3 * bits;
        uint32_t xyzx = xx | y << bits | z << 2 * bits;
        assert((x | y | z) >> bits == 0 && x != y && y != z && z != x);
        code[b] = xx | z << bits | y << 2 * bits;
        table[xyzx >> bits & pair] = brio_facet_of(tet, 1);
        table[xyzx >> 2 * bits] = brio_facet_of(tet, 2);
        table[xyzx & pair] = brio_facet_of(tet, 3);
    }
    for (size_t b = 0; b < num_border; b++) {
        uint32_t xzyx = code[b];
        /* each edge of the border was met from its other side (I3) */
        assert(brio_has_tet(&ins->store->t, brio_tet_of(table[xzyx >> bits & pair])) &&
               tets[brio_tet_of(table[xzyx >> bits & pair])].vertex[0] == p);
        store_four(tets[created[b]].mate, border[b], table[xzyx >> bits & pair], table[xzyx & pair],
                   table[xzyx >> 2 * bits]);
    }
}

/* Reports progress after every HASHED_BETWEEN border facets. */
static brio_status report_between(brio_inserter *ins, size_t b) {
    return (b + 1) % HASHED_BETWEEN == 0 ? brio_inserter_report(ins, ins->done) : BRIO_OK;
}

/* Returns the hash of an edge, the same from either side: multilinear hashing, whose upper bits are good. [Lemire Kaser
 * 2014] */
static inline uint64_t edge_hash(uint32_t u, uint32_t v) {
    uint32_t low = u < v ? u : v, high = u ^ v ^ low;
    return low * UINT64_C(0x9e3779b97f4a7c15) + high * UINT64_C(0xd1b54a32d192ed03);
}

/* Joins facet i > 0 of a new tetrahedron, whose edge on the border leads from u to v, with the facet that was entered
 * for this edge. Enters it if there is none. */
static inline void meet(brio_cavity *c, int bits, brio_tetrahedron *tets, uint32_t facet, uint32_t u, uint32_t v) {
    uint64_t hash = edge_hash(u, v);
    size_t at = hash >> (64 - bits), mask = ((size_t)1 << bits) - 1;
    assert(((size_t)1 << bits) <= c->edge_capacity && at <= mask && brio_slot_of(facet) > 0);
    uint32_t tag = (uint32_t)(hash >> 16);
    for (; c->edge[at].facet != 0; at = (at + 1) & mask) {
        if (c->edge[at].tag != tag) continue;
        uint32_t other = c->edge[at].facet, i = brio_slot_of(other);
        brio_tetrahedron *mate = &tets[brio_tet_of(other)];
        if (mate->vertex[i % 3 + 1] != v || mate->vertex[(i + 1) % 3 + 1] != u) continue;
        assert(i > 0); /* facet 0 is the border's */
        mate->mate[i] = facet;
        tets[brio_tet_of(facet)].mate[brio_slot_of(facet)] = other;
        return;
    }
    c->edge[at] = (brio_border_edge){tag, facet};
}

/* Joins the star by a hash table of edges, where there are too many vertices for numbers of one byte. */
static brio_status join_by_hash(brio_inserter *ins, uint32_t p) {
    brio_cavity *c = &ins->cavity;
    brio_tetrahedron *tets = ins->store->t.tet;
    int bits = 6; /* of the number of places, at least twice that of the edges */
    while ((size_t)1 << bits < 3 * c->num_border) bits++;
    BRIO_FORWARD(BRIO_RESERVE(ins->store->ctx, c->edge, c->edge_capacity, (size_t)1 << bits));
    memset(c->edge, 0, sizeof *c->edge << bits);
    for (size_t b = 0; b < c->num_border; b++) {
        uint32_t v[3];
        BRIO_FORWARD(report_between(ins, b));
        create(tets, c->created[b], c->border[b], p, v);
        tets[c->created[b]].mate[0] = c->border[b];
        for (int i = 0; i < 3; i++)
            meet(c, bits, tets, brio_facet_of(c->created[b], i + 1), v[(i + 1) % 3], v[(i + 2) % 3]);
    }
    return BRIO_OK;
}

/* Lists the vertices of the cavity before it is overwritten; only needed where points can be hidden. */
static brio_status list_vertices(brio_inserter *ins) {
    brio_cavity *c = &ins->cavity;
    const brio_tetrahedra *t = &ins->store->t;
    brio_status status = BRIO_RESERVE(ins->store->ctx, c->cavity_vertex, c->cavity_vertex_capacity, c->num_tets + 3);
    if (status != BRIO_OK) return status;
    assert(c->num_tets > 0 && brio_slot_of(c->entry[0]) == 0); /* as dig_cavity begins */
    for (uint32_t i = 0; i < 4; i++) c->cavity_vertex[i] = brio_apex(t, c->entry[0] ^ i);
    for (size_t n = 1; n < c->num_tets; n++) c->cavity_vertex[n + 3] = brio_apex(t, c->entry[n]);
    return BRIO_OK;
}

/* Returns whether some vertex of the cavity is not on its border: a sphere of b triangles has b / 2 + 2 vertices. A
 * vertex of the cavity counts where its last number stands, so the count is that of the vertices. */
static bool has_interior(brio_inserter *ins) {
    const brio_cavity *c = &ins->cavity;
    const numbers number = numbers_of(ins);
    size_t vertices = 0;
    if (c->num_tets > BYTES_MOST) return true; /* perhaps: there are no numbers */
    for (size_t i = 0; i < c->num_tets + 3; i++) vertices += *number_of(number, c->cavity_vertex[i]) == i;
    return vertices != c->num_border / 2 + 2;
}

/* Names p as the representative of the vertices of the cavity that are not on its border: p hides them. */
static void hide_interior(brio_inserter *ins, uint32_t p) {
    const brio_cavity *c = &ins->cavity;
    const brio_store *s = ins->store;
    const numbers number = numbers_of(ins);
    if (!has_interior(ins)) return;
    for (size_t i = 0; i < c->num_tets + 3; i++) *number_of(number, c->cavity_vertex[i]) = 0;
    for (size_t b = 0; b < c->num_border; b++)
        for (int i = 1; i < 4; i++) *number_of(number, s->t.tet[c->created[b]].vertex[i]) = 1;
    for (size_t i = 0; i < c->num_tets + 3; i++)
        if (!*number_of(number, c->cavity_vertex[i])) s->representative[c->cavity_vertex[i]] = p;
}

#ifndef NDEBUG
/* Returns whether slot i keeps I2, a finite vertex in each slot except the last, and facet i keeps I3: its mate leads
 * back, and has the facet's vertices. */
static bool facet_is_mated(const brio_tetrahedra *t, uint32_t tet, int i) {
    const uint32_t *v = t->tet[tet].vertex;
    uint32_t facet = brio_facet_of(tet, i), mate = *brio_mate(t, facet);
    if (i < 3 && v[i] == t->infinite) return false;
    if (mate == facet || *brio_mate(t, mate) != facet) return false;
    for (int j = 0; j < 4; j++) {
        int slot = brio_slot_of_vertex(t->tet[brio_tet_of(mate)].vertex, v[j]);
        if (j != i && (slot == 4 || slot == brio_slot_of(mate))) return false;
    }
    return true;
}

/* Returns whether the new tetrahedra keep I1 to I3 and I5. */
static bool star_is_valid(const brio_inserter *ins, uint32_t p) {
    const brio_tetrahedra *t = &ins->store->t;
    const brio_record *r = t->record;
    brio_filter filter = ins->filter; /* a copy, which counts apart */
    for (size_t b = 0; b < ins->cavity.num_created; b++) {
        uint32_t tet = ins->cavity.created[b];
        const uint32_t *v = t->tet[tet].vertex;
        if (v[0] != p || ins->store->state[tet] != TET_PLAIN) return false;
        if (v[3] != t->infinite && brio_orient3d_sign(&filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]]) <= 0) return false;
        for (int i = 0; i < 4; i++)
            if (!facet_is_mated(t, tet, i)) return false;
    }
    return true;
}
#endif

brio_status brio_cavity_fill(brio_inserter *ins, uint32_t p, bool *deferred) {
    brio_cavity *c = &ins->cavity;
    const bool weighted = ins->store->weighted;
    size_t slots = c->num_tets + ins->num_unused;
    assert(c->num_tets > 0 && c->num_border >= 4 && c->num_border % 2 == 0); /* a sphere of triangles */
    assert(c->num_border <= 4 * c->capacity);
    if (c->num_border > slots) BRIO_FORWARD(brio_inserter_reserve(ins, c->num_border - slots, deferred));
    if (*deferred) {
        brio_cavity_undo(ins);
        return BRIO_OK;
    }
    if (weighted) BRIO_FORWARD(list_vertices(ins));
    if (c->num_tets <= BYTES_MOST) number_vertices(ins);
    BRIO_FORWARD(take_slots(ins));
    if (c->num_tets <= SMALL_MOST)
        join_by_table(ins, p, 6);
    else if (c->num_tets <= BYTES_MOST)
        join_by_table(ins, p, 8);
    else
        BRIO_FORWARD(join_by_hash(ins, p));
    if (weighted) hide_interior(ins, p);
    ins->stats.created += c->num_border;
    ins->stats.destroyed += c->num_tets;
    c->num_created = c->num_border;
    ins->walk.start = c->created[0];
    assert(star_is_valid(ins, p));
    return BRIO_OK;
}
