/* Point location in a finished triangulation of the plane: a walk from a triangle near the query. It ends in some triangle
 * that holds the query; the edges whose lines hold the query lead to the others.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "plane/plane_holder.h"
#include <assert.h>

static unsigned zero_sides(brio_plane_querent *q, uint32_t t, const double *x) {
    const brio_locator2 *l = q->l;
    assert(t < l->num_finite);
    const uint32_t *v = l->triangle[t].vertex;
    unsigned zeros = 0;
    for (uint32_t i = 0; i < 3; i++) {
        const double *from = l->record[v[brio_slot_after(i)]], *to = l->record[v[brio_slot_before(i)]];
        zeros |= (unsigned)(brio_orient2d_sign(&q->filter, from, to, x) == 0) << i;
    }
    return zeros;
}

/* Walks to a finite triangle whose closure holds x, or returns BRIO_INFINITE. Keeps which lines of its edges hold x: not
 * that of the edge by which the walk came in, because x was strictly beyond it. */
static uint32_t walk(brio_plane_querent *q, const double *x, unsigned *zeros) {
    const brio_locator2 *l = q->l;
    uint32_t t = *brio_locator2_square(l, x), entered = 3;
    for (;;) {
        const uint32_t *v = l->triangle[t].vertex;
        uint32_t out = 3;
        *zeros = 0;
        for (uint32_t i = 0; i < 3 && out == 3; i++) {
            if (i == entered) continue;
            int sign =
                brio_orient2d_sign(&q->filter, l->record[v[brio_slot_after(i)]], l->record[v[brio_slot_before(i)]], x);
            if (sign < 0) out = i;
            *zeros |= (unsigned)(sign == 0) << i;
        }
        if (out == 3) return t;
        uint32_t mate = l->triangle[t].mate[out];
        t = brio_triangle_of(mate), entered = brio_edge_slot(mate);
        if (t >= l->num_finite) return BRIO_INFINITE;
    }
}

/* Returns the lowest index of the triangles that hold a query which is in triangle t. */
static uint32_t lowest_holder(const brio_locator2 *l, uint32_t t, unsigned zeros) {
    assert(t < l->num_finite && zeros < 7);
    const brio_triangle *own = &l->triangle[t];
    if (!zeros) return t;
    if (zeros & (zeros - 1)) return l->corner[own->vertex[__builtin_ctz(~zeros)]];
    uint32_t other = brio_triangle_of(own->mate[__builtin_ctz(zeros)]);
    return other < l->num_finite && other < t ? other : t;
}

brio_plane_holder brio_plane_find_holder(brio_plane_querent *q, const double *x) {
    const brio_locator2 *l = q->l;
    if (!l->num_finite || !brio_locator2_boxes(l, x)) return (brio_plane_holder){BRIO_INFINITE, 0};
    unsigned zeros;
    uint32_t t = walk(q, x, &zeros);
    if (t == BRIO_INFINITE) return (brio_plane_holder){BRIO_INFINITE, 0};
    uint32_t lowest = lowest_holder(l, t, zeros);
    return (brio_plane_holder){lowest, lowest == t ? zeros : zero_sides(q, lowest, x)};
}

bool brio_plane_holder_on_hull(const brio_locator2 *l, const brio_plane_holder *h) {
    assert(h->triangle < l->num_finite && __builtin_popcount(h->zeros) < 2);
    return h->zeros && brio_triangle_of(l->triangle[h->triangle].mate[__builtin_ctz(h->zeros)]) >= l->num_finite;
}
