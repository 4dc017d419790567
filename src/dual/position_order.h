/* An order of tetrahedra by the positions of their vertices, not by their indices. It breaks ties between poles, so
 * that the poles do not depend on the order of the points. */
#ifndef BRIO_DUAL_POSITION_ORDER_H
#define BRIO_DUAL_POSITION_ORDER_H

#include "brio/brio.h"
#include "predicates/predicates.h"
#include <assert.h>

/** Writes the positions of the first `count` vertices of a tetrahedron to p, in ascending order. */
static inline void brio_sorted_positions(const double *points, const brio_tetrahedron *tet, int count,
                                         const double *p[4]) {
    assert((count == 3 || count == 4) && (count < 4 || tet->vertex[3] != BRIO_INFINITE));
    for (int i = 0; i < count; i++) p[i] = points + 3 * (size_t)tet->vertex[i];
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && brio_lexicographic(p[j - 1], p[j]) > 0; j--) {
            const double *swap = p[j];
            p[j] = p[j - 1], p[j - 1] = swap;
        }
}

/** Compares tetrahedra s and t by the positions of their first `count` vertices. */
static inline int brio_compare_vertices(const double *points, const brio_tetrahedron *s, const brio_tetrahedron *t,
                                        int count) {
    const double *p[4], *q[4];
    int sign = 0;
    brio_sorted_positions(points, s, count, p);
    brio_sorted_positions(points, t, count, q);
    for (int i = 0; i < count && !sign; i++) sign = brio_lexicographic(p[i], q[i]);
    return sign;
}

/** Compares finite tetrahedra by the positions of their vertices. */
static inline int brio_compare_corners(const double *points, const brio_tetrahedron *s, const brio_tetrahedron *t) {
    return brio_compare_vertices(points, s, t, 4);
}

/** Compares infinite tetrahedra by the positions of the vertices of their hull facets. */
static inline int brio_compare_hull_facets(const double *points, const brio_tetrahedron *s, const brio_tetrahedron *t) {
    return brio_compare_vertices(points, s, t, 3);
}

/** Compares tetrahedra s and t by their centres, then by their vertices' positions.   centre  #tet by 3. */
static inline int brio_compare_by_position(const double *points, const brio_tetrahedron *tet, const double *centre,
                                           uint32_t s, uint32_t t) {
    int sign = brio_lexicographic(centre + 3 * (size_t)s, centre + 3 * (size_t)t);
    return sign ? sign : brio_compare_corners(points, tet + s, tet + t);
}

#endif
