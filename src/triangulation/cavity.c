/* The cavity of a point: dig it out, fill it with the point's star.
 *
 * Dig: breadth first from one tetrahedron in conflict across facets; each tetrahedron is tested once, several together,
 * and the facets between conflict and no conflict are the border, a sphere that the point sees from inside. Fill: each
 * border facet and the point make a tetrahedron, in the slots of the cavity. Two of these are neighbours across the
 * edge that their border facets share, which each of them sees in its own direction: entered under (u, v), found under
 * (v, u). Vertices of the border are numbered so that the edges fit a small square table; borders with too many
 * vertices use a hash table. Lists are written always and their length is advanced by a bit, since no branch could be
 * foreseen.
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
    brio_release(ctx, c->cavity_vertex);
}

/* --- dig --- */

/* Queues the neighbours of a cavity tetrahedron that were not queued before: written always, counted by a bit. */
static inline void queue_neighbours(brio_kernel *k, uint32_t tet) {
    const uint32_t *mate = k->t.mate + 4 * (size_t)tet, *vertex = k->t.vertex;
    uint32_t *queue = k->cavity.outside;
    uint8_t *state = k->state; /* stores to bytes may alias anything: what is used again stays in locals */
    size_t n = k->cavity.num_outside;
    for (int i = 0; i < 4; i++) {
        uint32_t other = brio_tet_of(mate[i]);
        uint8_t s = state[other];
        queue[n] = other;
        __builtin_prefetch(vertex + 4 * (size_t)other);
        __builtin_prefetch(k->t.mate + 4 * (size_t)other);
        n += s == TET_PLAIN;
        state[other] = s == TET_PLAIN ? TET_QUEUED : s;
    }
    k->cavity.num_outside = n;
}

/* Tests up to BRIO_BATCH queued tetrahedra from `from` on; those in conflict join the cavity. */
static inline void test_batch(brio_kernel *k, size_t from, size_t count, const double *point) {
    brio_cavity *c = &k->cavity;
    uint32_t *queued = c->outside + from;
    for (size_t i = BRIO_BATCH; from + i < c->num_outside && i < 2 * BRIO_BATCH; i++) { /* the batch after this */
        const uint32_t *v = k->t.vertex + 4 * (size_t)queued[i];
        for (int j = 0; j < 4; j++) __builtin_prefetch(k->record[v[j]]);
    }
    for (size_t i = count; i < BRIO_BATCH; i++) queued[i] = queued[0];
    unsigned conflicts = k->conflicts(&k->t, &k->filter, queued, point);
    uint32_t *tets = c->tets;
    uint8_t *state = k->state;
    size_t n = c->num_tets;
    for (size_t i = 0; i < count; i++) {
        unsigned conflict = conflicts >> i & 1;
        tets[n] = queued[i];
        n += conflict;
        state[queued[i]] = conflict ? TET_CAVITY : TET_QUEUED;
    }
    c->num_tets = n;
    k->stats.insphere_calls += count;
}

/* Grows the cavity over all tetrahedra in conflict; c->outside lists all that were tested. */
static brio_status search(brio_kernel *k, uint32_t first, const double *point) {
    brio_cavity *c = &k->cavity;
    brio_status status = BRIO_OK;
    size_t expanded = 0, tested = 0;
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->tets, c->tets_capacity, 1));
    c->tets[0] = first;
    c->num_tets = 1;
    c->num_outside = 0;
    k->state[first] = TET_CAVITY;
    while (expanded < c->num_tets || tested < c->num_outside) {
        while (expanded < c->num_tets && c->num_outside - tested < BRIO_BATCH) {
            BRIO_TRY(BRIO_RESERVE(k->ctx, c->outside, c->outside_capacity, c->num_outside + 4 + BRIO_BATCH));
            queue_neighbours(k, c->tets[expanded++]);
        }
        size_t count = c->num_outside - tested < BRIO_BATCH ? c->num_outside - tested : BRIO_BATCH;
        if (count == 0) continue;
        BRIO_TRY(BRIO_RESERVE(k->ctx, c->tets, c->tets_capacity, c->num_tets + BRIO_BATCH));
        test_batch(k, tested, count, point);
        tested += count;
    }
done:
    return status;
}

/* STAR[i]: the slots other than i such that (i, STAR[i]) is an even permutation, slot 3 last where it is among them. */
static const uint8_t STAR[4][3] = {{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}};

/* Lists the facets between the cavity and the rest. */
static brio_status find_border(brio_kernel *k) {
    brio_cavity *c = &k->cavity;
    size_t n = 0;
    brio_status status = BRIO_RESERVE(k->ctx, c->border, c->border_capacity, 3 * c->num_tets + 4);
    if (status != BRIO_OK) return status;
    brio_border *border = c->border;
    const uint8_t *state = k->state;
    for (size_t i = 0; i < c->num_tets; i++) {
        const uint32_t *v = k->t.vertex + 4 * (size_t)c->tets[i], *mate = k->t.mate + 4 * (size_t)c->tets[i];
        for (int slot = 0; slot < 4; slot++) {
            border[n] = (brio_border){mate[slot], {v[STAR[slot][0]], v[STAR[slot][1]], v[STAR[slot][2]]}};
            n += state[brio_tet_of(mate[slot])] != TET_CAVITY;
        }
    }
    c->num_border = n;
    return BRIO_OK;
}

brio_status brio_cavity_dig(brio_kernel *k, uint32_t first, uint32_t p) {
    brio_cavity *c = &k->cavity;
    brio_status status = search(k, first, k->record[p]);
    if (status == BRIO_OK) status = find_border(k);
    for (size_t i = 0; i < c->num_outside; i++) k->state[c->outside[i]] = TET_PLAIN;
    return status;
}

/* --- fill --- */

/* The slot for one new tetrahedron: of the cavity, of an older one, or a new one (room is there). */
static inline uint32_t take_slot(brio_kernel *k, size_t n) {
    if (n < k->cavity.num_tets) return k->cavity.tets[n];
    if (k->num_unused) return k->unused[--k->num_unused];
    return (uint32_t)k->t.count++;
}

/* The number of a border vertex, a new one at its first sight: written always, counted by a bit. */
static inline uint8_t number_of(uint8_t *local, uint32_t *numbered, size_t *count, uint32_t v) {
    uint8_t known = local[v];
    bool fresh = known == BRIO_NO_LOCAL;
    uint8_t number = fresh ? (uint8_t)*count : known;
    numbered[*count] = v;
    *count += fresh;
    return local[v] = number;
}

/* The tetrahedron of border facet b: the new vertex in slot 0, the border in 1 to 3. */
static inline uint32_t create(brio_kernel *k, size_t b, uint32_t p) {
    const brio_border *border = &k->cavity.border[b];
    uint32_t tet = take_slot(k, b), *v = k->t.vertex + 4 * (size_t)tet;
    v[0] = p, v[1] = border->vertex[0], v[2] = border->vertex[1], v[3] = border->vertex[2];
    k->t.mate[4 * (size_t)tet] = border->outside;
    k->t.mate[border->outside] = 4 * tet;
    k->state[tet] = TET_PLAIN;
    return tet;
}

/* Facet i of a new tetrahedron holds p and the edge from vertex i % 3 + 1 to the one after it. */
static brio_status fill_by_table(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    unsigned shift = 4;
    while ((size_t)1 << shift < c->num_border / 2 + 2) shift++;
    brio_status status = BRIO_RESERVE(k->ctx, c->table, c->table_capacity, (size_t)1 << 2 * shift);
    if (status != BRIO_OK) return status;
    uint8_t *local = c->local;
    uint32_t *table = c->table, *numbered = c->numbered;
    brio_created *created = c->created;
    size_t count = 0, num_border = c->num_border;
    for (size_t b = 0; b < num_border; b++) {
        const uint32_t *v = c->border[b].vertex;
        unsigned x = number_of(local, numbered, &count, v[0]), y = number_of(local, numbered, &count, v[1]),
                 z = number_of(local, numbered, &count, v[2]);
        uint32_t tet = create(k, b, p);
        created[b] = (brio_created){tet, {(uint8_t)x, (uint8_t)y, (uint8_t)z}};
        table[y << shift | z] = 4 * tet + 1;
        table[z << shift | x] = 4 * tet + 2;
        table[x << shift | y] = 4 * tet + 3;
    }
    for (size_t b = 0; b < num_border; b++) {
        unsigned x = created[b].local[0], y = created[b].local[1], z = created[b].local[2];
        uint32_t *mate = k->t.mate + 4 * (size_t)created[b].tet;
        mate[1] = table[z << shift | y];
        mate[2] = table[x << shift | z];
        mate[3] = table[y << shift | x];
    }
    c->num_numbered = count;
    return BRIO_OK;
}

static inline size_t edge_place(const brio_cavity *c, uint64_t key, size_t mask) {
    size_t at = brio_mix(key) & mask;
    while (c->edge_key[at] != key && c->edge_key[at] != UINT64_MAX) at = (at + 1) & mask;
    return at;
}

/* The same with a hash table of edges; the vertices of the border are only marked. */
static brio_status fill_by_hash(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    size_t size = 64;
    while (size < 6 * c->num_border) size *= 2;
    brio_status status = BRIO_RESERVE(k->ctx, c->edge_key, c->hash_capacity, size);
    if (status == BRIO_OK) status = BRIO_RESERVE(k->ctx, c->edge_facet, c->hash_facet_capacity, size);
    if (status != BRIO_OK) return status;
    memset(c->edge_key, 0xff, size * sizeof *c->edge_key);
    for (int pass = 0; pass < 2; pass++)
        for (size_t b = 0; b < c->num_border; b++) {
            if (pass == 0) c->created[b].tet = create(k, b, p);
            for (uint32_t i = 0; i < 3; i++) {
                uint64_t u = c->border[b].vertex[(i + 1) % 3], w = c->border[b].vertex[(i + 2) % 3];
                uint32_t facet = 4 * c->created[b].tet + 1 + i;
                size_t at = edge_place(c, pass == 0 ? u << 32 | w : w << 32 | u, size - 1);
                if (pass == 0) {
                    c->edge_key[at] = u << 32 | w, c->edge_facet[at] = facet;
                    if (c->local[u] == BRIO_NO_LOCAL) c->local[u] = 0, c->numbered[c->num_numbered++] = (uint32_t)u;
                } else {
                    k->t.mate[facet] = c->edge_facet[at];
                }
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
        memcpy(c->cavity_vertex + 4 * n, k->t.vertex + 4 * (size_t)c->tets[n], 4 * sizeof *c->cavity_vertex);
    return BRIO_OK;
}

/* Vertices of the cavity that are not on its border are hidden by p. */
static void hide_interior(brio_kernel *k, uint32_t p) {
    brio_cavity *c = &k->cavity;
    for (size_t i = 0; i < 4 * c->num_tets; i++)
        if (c->local[c->cavity_vertex[i]] == BRIO_NO_LOCAL) k->representative[c->cavity_vertex[i]] = p;
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
    size_t vertices = c->num_border / 2 + 2; /* of a triangulated sphere */
    BRIO_TRY(brio_kernel_reserve(k, c->num_border));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->created, c->created_capacity, c->num_border));
    BRIO_TRY(BRIO_RESERVE(k->ctx, c->numbered, c->numbered_capacity, vertices + 1));
    if (k->weighted) BRIO_TRY(list_vertices(k));
    c->num_numbered = 0;
    BRIO_TRY(vertices <= TABLE_MOST ? fill_by_table(k, p) : fill_by_hash(k, p));
    if (k->weighted) hide_interior(k, p);
    BRIO_TRY(give_back_slots(k));
    for (size_t i = 0; i < c->num_numbered; i++) c->local[c->numbered[i]] = BRIO_NO_LOCAL;
    k->stats.created += c->num_border;
    k->stats.destroyed += c->num_tets;
    k->walk.start = c->created[0].tet;
done:
    return status;
}
