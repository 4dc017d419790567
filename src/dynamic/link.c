/* The triangulation of few vertices, those of a link.
 *
 * One after the other is inserted. All tetrahedra, a few dozen, are tested for a conflict side by side, which takes
 * no search and has no branch that could not be foreseen; marks are bits, eight tetrahedra a byte. Nothing is
 * allocated.
 *
 * The same engine answers as for the whole triangulation, so ties are broken the same way. Its tests want the
 * infinite vertex to have a record of infinite weight: number 0. */
#include "base/memory.h"
#include "dynamic/live.h"

enum { SIDE = 64 };

struct brio_link {
    brio_tetrahedron tet[BRIO_LINK_TETS];
    uint32_t slot[BRIO_LINK_TETS], unused[BRIO_LINK_TETS];
    uint8_t alive[BRIO_LINK_TETS / 8], hit[BRIO_LINK_TETS / 8]; /* bits */
    size_t count, num_unused;
    brio_record record[SIDE];
    uint32_t table[SIDE * SIDE];
    uint32_t in[BRIO_LINK_TETS], border[4 * SIDE];
};

brio_status brio_link_new(brio_context *ctx, brio_link **out) {
    brio_status status = BRIO_ALLOC_ZERO(ctx, *out, 1);
    if (status == BRIO_OK) (*out)->record[0][3] = INFINITY;
    return status;
}

uint32_t *brio_link_slots(brio_dynamic *d) {
    return d->link->slot;
}

/* Lists four vertices in general position in `first`; returns false where all lie in a plane. */
static bool general_position(brio_dynamic *d, uint32_t n, uint32_t first[4]) {
    const brio_record *r = (const brio_record *)d->link->record;
    int count = 1, side = 0;
    first[0] = 1;
    for (uint32_t i = 2; i <= n && count < 4; i++) {
        if (count == 2 && brio_collinear(r[first[0]], r[first[1]], r[i])) continue;
        if (count == 3) {
            side = brio_orient3d_sign(&d->filter, r[first[0]], r[first[1]], r[first[2]], r[i]);
            if (side == 0) continue;
        }
        first[count++] = i;
    }
    if (count == 4 && side < 0) {
        uint32_t swap = first[0];
        first[0] = first[1], first[1] = swap;
    }
    return count == 4;
}

/* Writes the first tetrahedron and the four infinite ones round it. */
static void begin(brio_link *l, const uint32_t first[4]) {
    /* of the infinite tetrahedron behind facet i: its finite vertices, as slots of the first tetrahedron */
    for (uint32_t i = 0; i < 4; i++) {
        const uint8_t *f = BRIO_FACET[i];
        uint32_t own[3] = {f[0], f[2], f[1]};
        brio_tetrahedron *t = &l->tet[i + 1];
        l->tet[0].vertex[i] = first[i];
        l->tet[0].mate[i] = brio_facet_of(i + 1, 3);
        t->mate[3] = brio_facet_of(0, (int)i);
        t->vertex[3] = 0;
        for (int k = 0; k < 3; k++) {
            uint32_t j = own[k]; /* opposite to this vertex lies the infinite tetrahedron behind facet j */
            const uint8_t *g = BRIO_FACET[j];
            uint32_t other[3] = {g[0], g[2], g[1]};
            t->vertex[k] = first[j];
            for (int m = 0; m < 3; m++)
                if (other[m] == i) t->mate[k] = brio_facet_of(j + 1, m);
        }
    }
    l->count = 5;
    l->num_unused = 0;
    for (size_t i = 0; i < sizeof l->hit; i++) l->hit[i] = l->alive[i] = 0;
    l->alive[0] = 31;
}

static inline bool is_hit(const brio_link *l, uint32_t tet) {
    return l->hit[tet / 8] >> tet % 8 & 1;
}

/* Lists the tetrahedra in conflict with a vertex; returns their number. One that is not alive is not tested: a living
 * one stands for it, since its mates may be anything. */
static size_t find_conflicts(brio_dynamic *d, const brio_tetrahedra *t, uint32_t vertex) {
    brio_link *l = d->link;
    size_t n = 0;
    for (uint32_t base = 0; base < l->count; base += BRIO_BATCH) {
        uint32_t facet[BRIO_BATCH], alive = l->alive[base / BRIO_BATCH];
        l->hit[base / BRIO_BATCH] = 0;
        if (!alive) continue;
        uint32_t one = base + (uint32_t)__builtin_ctz(alive), count = 32 - (uint32_t)__builtin_clz(alive);
        for (uint32_t i = 0; i < BRIO_BATCH; i++) facet[i] = brio_facet_of(alive >> i & 1 ? base + i : one, 0);
        unsigned mask = d->engine->conflicts(t, &d->filter, facet, count, l->record[vertex]) & alive;
        l->hit[base / BRIO_BATCH] = (uint8_t)mask;
        for (; mask; mask &= mask - 1) l->in[n++] = base + (uint32_t)__builtin_ctz(mask);
    }
    return n;
}

/* Puts a vertex in the place of the tetrahedra in conflict; returns false where there are none. */
static bool insert(brio_dynamic *d, const brio_tetrahedra *t, uint32_t vertex) {
    brio_link *l = d->link;
    size_t n = find_conflicts(d, t, vertex), num_border = 0;
    uint32_t slot[4 * SIDE];
    if (n == 0) return false;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t mate = l->tet[l->in[i]].mate[k];
            l->border[num_border] = mate;
            num_border += !is_hit(l, brio_tet_of(mate));
            assert(num_border < sizeof l->border / sizeof *l->border); /* a sphere with 63 vertices has 122 facets */
        }
    for (size_t i = 0; i < n; i++) {
        l->hit[l->in[i] / 8] = 0;
        l->alive[l->in[i] / 8] &= (uint8_t) ~(1u << l->in[i] % 8);
        if (i >= num_border) l->unused[l->num_unused++] = l->in[i];
    }
    for (size_t b = 0; b < num_border; b++) {
        uint32_t tet = b < n ? l->in[b] : l->num_unused ? l->unused[--l->num_unused] : (uint32_t)l->count++;
        const uint32_t *v = l->tet[brio_tet_of(l->border[b])].vertex;
        const uint8_t *out = BRIO_OUT[brio_slot_of(l->border[b])];
        uint32_t x = v[out[0]], y = v[out[1]], z = v[out[2]];
        assert(tet < BRIO_LINK_TETS);
        slot[b] = tet;
        l->alive[tet / 8] |= (uint8_t)(1u << tet % 8);
        l->table[SIDE * y + z] = brio_facet_of(tet, 1);
        l->table[SIDE * z + x] = brio_facet_of(tet, 2);
        l->table[SIDE * x + y] = brio_facet_of(tet, 3);
    }
    for (size_t b = 0; b < num_border; b++) {
        const brio_tetrahedron *outer = &l->tet[brio_tet_of(l->border[b])];
        const uint8_t *out = BRIO_OUT[brio_slot_of(l->border[b])];
        brio_tetrahedron *own = &l->tet[slot[b]];
        uint32_t x = outer->vertex[out[0]], y = outer->vertex[out[1]], z = outer->vertex[out[2]];
        own->vertex[0] = vertex, own->vertex[1] = x, own->vertex[2] = y, own->vertex[3] = z;
        own->mate[0] = l->border[b];
        own->mate[1] = l->table[SIDE * z + y];
        own->mate[2] = l->table[SIDE * x + z];
        own->mate[3] = l->table[SIDE * y + x];
        l->tet[brio_tet_of(l->border[b])].mate[brio_slot_of(l->border[b])] = brio_facet_of(slot[b], 0);
    }
    return true;
}

/* Returns whether each of the vertices 1 to n, at most 63, is one of a tetrahedron. A heavy one may hide another. */
static bool has_all(const brio_link *l, uint32_t n) {
    uint64_t seen = 0;
    for (uint32_t t = 0; t < l->count; t++)
        for (int k = 0; k < 4 && l->alive[t / 8] >> t % 8 & 1; k++) seen |= UINT64_C(1) << l->tet[t].vertex[k];
    return seen >> 1 == (UINT64_C(1) << n) - 1;
}

bool brio_link_few(brio_dynamic *d, brio_tetrahedron **tet, size_t *count, bool *flat) {
    brio_link *l = d->link;
    const brio_hole *h = &d->hole;
    uint32_t n = (uint32_t)h->num_vertices - 1, first[4];
    assert(n <= BRIO_LINK_MOST);
    for (uint32_t i = 1; i <= n; i++)
        for (int c = 0; c < 4; c++) l->record[i][c] = d->record[h->vertex[i]][c];
    *flat = !general_position(d, n, first);
    if (*flat) return true;
    begin(l, first);
    brio_tetrahedra t = {l->tet, l->count, 0, (const brio_record *)l->record};
    for (uint32_t i = 1; i <= n; i++) {
        if (i == first[0] || i == first[1] || i == first[2] || i == first[3]) continue;
        if (!insert(d, &t, i)) return false;
        t.count = l->count;
    }
    if (d->weighted && !has_all(l, n)) return false;
    for (size_t i = 0; i < l->num_unused; i++) l->tet[l->unused[i]].vertex[0] = BRIO_NONE;
    *tet = l->tet;
    *count = l->count;
    return true;
}
