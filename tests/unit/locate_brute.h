/* Brute force for queries of a finished triangulation: over all tetrahedra, and over all vertices. */
#ifndef BRIO_TESTS_LOCATE_BRUTE_H
#define BRIO_TESTS_LOCATE_BRUTE_H

#include "harness.h"
#include "predicates/predicates.h"

static inline bool is_held(const double *p, const brio_tetrahedron *tet, const double *x) {
    static const int FACET[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    const double *v[4];
    for (int i = 0; i < 4; i++) v[i] = p + 3 * (size_t)tet->vertex[i];
    for (int i = 0; i < 4; i++)
        if (brio_orient3d(v[FACET[i][0]], v[FACET[i][1]], v[FACET[i][2]], x) < 0) return false;
    return true;
}

/* The first tetrahedron whose closure holds x. */
static inline uint32_t brute_tetrahedron(const double *p, const brio_triangulation *t, const double *x) {
    const brio_tetrahedron *tets = brio_triangulation_tetrahedra(t);
    for (size_t i = 0; i < brio_triangulation_stats(t)->tetrahedra; i++)
        if (is_held(p, &tets[i], x)) return (uint32_t)i;
    return BRIO_INFINITE;
}

static inline void record_of(const double *p, const double *w, size_t i, double record[4]) {
    for (size_t k = 0; k < 3; k++) record[k] = p[3 * i + k];
    record[3] = w ? w[i] : 0;
}

/* The vertices that come before v, seen from x. */
static inline size_t number_before(const double *p, const double *w, const brio_triangulation *t, const double *x,
                                   uint32_t v) {
    const uint32_t *representative = brio_triangulation_representatives(t);
    size_t before = 0;
    double a[4], b[4];
    record_of(p, w, v, b);
    for (size_t i = 0; i < brio_triangulation_stats(t)->points; i++) {
        if (representative[i] != i || i == v) continue;
        record_of(p, w, i, a);
        int sign = brio_power_compare(x, a, b);
        before += sign < 0 || (sign == 0 && brio_lexicographic(a, b) < 0);
    }
    return before;
}

#endif
