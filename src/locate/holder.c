/* Point location in a finished triangulation: a walk from the last answer, or from a vertex that the k-d tree finds near
 * the query. The walk ends in some tetrahedron that holds the query. Which one depends on its start; the facets whose
 * planes hold the query lead to all the others.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "locate/holder.h"
#include "locate/place_search.h"
#include "triangulation/ring.h"

/* Returns the sides of the query: bit i if it is in the plane of facet i. The query is beyond no facet.
 * unsure  the facets whose planes may hold it */
static unsigned zero_sides(brio_querent *q, uint32_t tet, unsigned unsure, const double *x) {
    const brio_locator *l = q->l;
    const uint32_t *v = l->t.tet[tet].vertex;
    unsigned zeros = 0;
    for (unsigned left = unsure; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        const uint8_t *f = BRIO_FACET[i];
        const brio_record *r = l->t.record;
        zeros |= (unsigned)(brio_orient3d_sign(&q->filter, r[v[f[0]]], r[v[f[1]]], r[v[f[2]]], x) == 0) << i;
    }
    return zeros;
}

/* Returns the columns whose queries can be inside, with starts for their walks. */
static unsigned start_walks(brio_querent *q, const brio_query_row *row) {
    const brio_locator *l = q->l;
    unsigned which = 0;
    for (size_t c = 0; c < row->count && l->num_finite; c++) {
        if (!brio_locator_boxes(l, row->x[c])) continue;
        which |= 1u << c;
        if (!q->near || q->walk[c].start == BRIO_NO_TET)
            q->walk[c].start = l->vertex_tet[brio_place_near(l, row->x[c])];
    }
    return which;
}

void brio_find_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]) {
    const brio_locator *l = q->l;
    uint32_t found[BRIO_ABREAST];
    unsigned which = start_walks(q, row);
    l->engine->walk_abreast(&l->t, &q->filter, q->walk, row->x, which, found);
    for (size_t c = 0; c < row->count; c++) {
        holders[c] = (brio_holder){BRIO_INFINITE, 0};
        if (!(which >> c & 1)) continue;
        q->walk[c].start = found[c];
        if (!brio_is_infinite(&l->t, found[c]))
            holders[c] = (brio_holder){found[c], zero_sides(q, found[c], q->walk[c].unsure, row->x[c])};
    }
}

/* --- the tetrahedra that share a facet, an edge or a vertex with the query on it --- */

/* The two slots whose bits are not set, in ascending order. */
static void other_slots(unsigned two, int *i, int *j) {
    unsigned rest = ~two & 15;
    *i = __builtin_ctz(rest);
    *j = __builtin_ctz(rest & (rest - 1));
}

static inline uint32_t lower(const brio_locator *l, uint32_t a, uint32_t b) {
    return b < l->num_finite && b < a ? b : a;
}

static uint32_t lowest_of_ring(const brio_locator *l, const brio_holder *h) {
    int i, j;
    uint32_t lowest = h->tet;
    other_slots(h->zeros, &i, &j);
    brio_ring ring = brio_ring_second(&l->t, h->tet, i, j);
    do lowest = lower(l, lowest, ring.tet);
    while (brio_ring_next(&ring));
    return lowest;
}

uint32_t brio_lowest_holder(const brio_locator *l, const brio_holder *h) {
    if (h->tet == BRIO_INFINITE || !h->zeros) return h->tet;
    const brio_tetrahedron *tet = &l->t.tet[h->tet];
    switch (__builtin_popcount(h->zeros)) {
    case 1:
        return lower(l, h->tet, brio_tet_of(tet->mate[__builtin_ctz(h->zeros)]));
    case 2:
        return lowest_of_ring(l, h);
    default:
        return l->vertex_tet[tet->vertex[__builtin_ctz(~h->zeros & 15)]];
    }
}

void brio_find_lowest_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]) {
    brio_find_holders(q, row, holders);
    for (size_t c = 0; c < row->count; c++) {
        uint32_t lowest = brio_lowest_holder(q->l, &holders[c]);
        if (lowest != holders[c].tet) holders[c] = (brio_holder){lowest, zero_sides(q, lowest, 15, row->x[c])};
    }
}

bool brio_holder_on_hull(const brio_locator *l, const brio_holder *h) {
    const brio_tetrahedron *tet = &l->t.tet[h->tet];
    int i, j;
    if (!h->zeros) return false;
    if (__builtin_popcount(h->zeros) == 1) return brio_tet_of(tet->mate[__builtin_ctz(h->zeros)]) >= l->num_finite;
    other_slots(h->zeros, &i, &j);
    brio_ring ring = brio_ring_second(&l->t, h->tet, i, j);
    do
        if (ring.tet >= l->num_finite) return true;
    while (brio_ring_next(&ring));
    return false;
}
