/* Brute force for queries of a triangulation of the plane: over all triangles, and over all points. */
#ifndef BRIO_TESTS_PLANE_LOCATE_BRUTE_H
#define BRIO_TESTS_PLANE_LOCATE_BRUTE_H

#include "brio/brio.h"
#include "predicates/predicates.h"

static inline bool plane_is_held(const double *p, const brio_triangle *t, const double *x) {
    for (int i = 0; i < 3; i++)
        if (brio_orient2d(p + 2 * (size_t)t->vertex[(i + 1) % 3], p + 2 * (size_t)t->vertex[(i + 2) % 3], x) < 0)
            return false;
    return true;
}

/* The first triangle whose closure holds x. */
static inline uint32_t brute_triangle(const double *p, const brio_triangulation2 *t, const double *x) {
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    for (size_t i = 0; i < brio_triangulation2_stats(t)->triangles; i++)
        if (plane_is_held(p, &triangle[i], x)) return (uint32_t)i;
    return BRIO_INFINITE;
}

/* Whether point i comes before point v, seen from x: it is nearer, or as near and lexicographically first.
 * w  weights, or NULL. */
static inline bool plane_comes_before(const double *p, const double *w, const double *x, size_t i, size_t v) {
    const double at[4] = {x[0], x[1], 0, 0};
    const double a[4] = {p[2 * i], p[2 * i + 1], 0, w ? w[i] : 0}, b[4] = {p[2 * v], p[2 * v + 1], 0, w ? w[v] : 0};
    int sign = brio_power_compare(at, a, b);
    return (sign ? sign : brio_lexicographic(a, b)) < 0;
}

#endif
