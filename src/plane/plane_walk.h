/* The visibility walk: crosses any edge that separates the triangle from the point. In regular triangulations this walk
 * ends, because no cycle of triangles lies one behind the other as seen from a point.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#ifndef BRIO_PLANE_PLANE_WALK_H
#define BRIO_PLANE_PLANE_WALK_H

#include "plane/plane_store.h"
#include <assert.h>

/** The triangles that a walk goes through; `infinite` is the infinite vertex. */
typedef struct {
    const brio_triangle *triangle;
    const brio_plane_record *record;
    uint32_t infinite;
} brio_plane_view;

/** Returns the closed triangle that holds x or, for x outside the hull, an infinite triangle with x strictly outside of
 *  its hull edge.   start  any triangle.   steps  grows by the number of triangles entered. */
static inline uint32_t brio_plane_walk(const brio_plane_view *v, brio_plane_filter *filter, uint32_t start,
                                       const double *x, uint64_t *steps) {
    const brio_plane_record *r = v->record;
    uint32_t t = start, entered = 3;
    assert(v->triangle && v->record);
    if (v->triangle[t].vertex[2] == v->infinite) t = brio_triangle_of(v->triangle[t].mate[2]);
    for (;;) {
        assert(v->triangle[t].vertex[0] != v->infinite && v->triangle[t].vertex[1] != v->infinite); /* I2 */
        const uint32_t *a = v->triangle[t].vertex;
        uint32_t i = 0;
        while (i < 3 && (i == entered ||
                         brio_orient2d_sign(filter, r[a[brio_slot_after(i)]], r[a[brio_slot_before(i)]], x) >= 0))
            i++;
        if (i == 3) return t;
        uint32_t g = v->triangle[t].mate[i];
        assert(v->triangle[brio_triangle_of(g)].mate[brio_edge_slot(g)] == brio_edge_of(t, i)); /* I3 */
        t = brio_triangle_of(g), entered = brio_edge_slot(g);
        ++*steps;
        if (v->triangle[t].vertex[2] == v->infinite) return t;
    }
}

#endif
