/* Point location in a finished triangulation: a walk from the last answer, or from a vertex that the k-d tree finds near
 * the query. The walk ends in some tetrahedron that holds the query. Which one depends on its start; the facets whose
 * planes hold the query lead to all the others.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "locate/holder.h"
#include "locate/place_search.h"
#include "triangulation/ring.h"

/* Returns the sides of the query: bit i if it is in the plane of facet i. The query is beyond no facet. */
static unsigned zero_sides(brio_querent *q, uint32_t tet, const double *x) {
    const brio_locator *l = q->l;
    const uint32_t *v = l->t.tet[tet].vertex;
    unsigned zeros = 0;
    for (unsigned left = q->walk.unsure; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        const uint8_t *f = BRIO_FACET[i];
        const brio_record *r = l->t.record;
        zeros |= (unsigned)(brio_orient3d_sign(&q->filter, r[v[f[0]]], r[v[f[1]]], r[v[f[2]]], x) == 0) << i;
    }
    return zeros;
}

brio_holder brio_find_holder(brio_querent *q, const double *x) {
    const brio_locator *l = q->l;
    if (!l->num_finite || !brio_locator_boxes(l, x)) return (brio_holder){BRIO_INFINITE, 0};
    if (!q->near || q->walk.start == BRIO_NO_TET) q->walk.start = l->vertex_tet[brio_place_near(l, x)];
    uint32_t tet = l->engine->walk(&l->t, NULL, &q->filter, &q->walk, x, UINT64_MAX);
    q->walk.start = tet;
    if (brio_is_infinite(&l->t, tet)) return (brio_holder){BRIO_INFINITE, 0};
    return (brio_holder){tet, zero_sides(q, tet, x)};
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

brio_holder brio_find_lowest_holder(brio_querent *q, const double *x) {
    brio_holder h = brio_find_holder(q, x);
    uint32_t lowest = brio_lowest_holder(q->l, &h);
    if (lowest == h.tet) return h;
    q->walk.unsure = 15;
    return (brio_holder){lowest, zero_sides(q, lowest, x)};
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
