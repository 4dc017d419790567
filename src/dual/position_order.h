/* An order of tetrahedra that goes by where their points are, not by what they are called: ties between poles are broken
 * by it, so that the poles are the same for every order of the points. */
#ifndef BRIO_DUAL_POSITION_ORDER_H
#define BRIO_DUAL_POSITION_ORDER_H

#include "brio/brio.h"
#include "predicates/predicates.h"

/** Positions of the vertices of a finite tetrahedron, ascending. */
static inline void brio_sorted_positions(const double *points, const brio_tetrahedron *tet, const double *p[4]) {
    for (int i = 0; i < 4; i++) p[i] = points + 3 * (size_t)tet->vertex[i];
    for (int i = 1; i < 4; i++)
        for (int j = i; j > 0 && brio_lexicographic(p[j - 1], p[j]) > 0; j--) {
            const double *swap = p[j];
            p[j] = p[j - 1], p[j - 1] = swap;
        }
}

/** Compares tetrahedra s and t by their points. */
static inline int brio_compare_corners(const double *points, const brio_tetrahedron *s, const brio_tetrahedron *t) {
    const double *p[4], *q[4];
    int sign = 0;
    brio_sorted_positions(points, s, p);
    brio_sorted_positions(points, t, q);
    for (int i = 0; i < 4 && !sign; i++) sign = brio_lexicographic(p[i], q[i]);
    return sign;
}

/** Compares tetrahedra s and t by their centres, then by their points.   centre  of each of `tet`. */
static inline int brio_compare_by_position(const double *points, const brio_tetrahedron *tet, const double *centre,
                                           uint32_t s, uint32_t t) {
    int sign = brio_lexicographic(centre + 3 * (size_t)s, centre + 3 * (size_t)t);
    return sign ? sign : brio_compare_corners(points, tet + s, tet + t);
}

#endif
