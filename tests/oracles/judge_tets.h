/* Whether a set of tetrahedra is a Delaunay (regular) triangulation of points of dimension 3, however its ties are broken,
 * after exact_solve. It is right when
 *   - every position has one index, that of a point with the greatest weight there;
 *   - every tetrahedron has volume, and no position inside its (ortho)sphere;
 *   - every facet has two tetrahedra, on different sides of it, or one tetrahedron and supports the hull;
 *   - the volumes add up to that of the hull, which is the sum for the exact answer.
 * By the third, generic places in the hull are all covered equally often; by the fourth, once. So the tetrahedra fill the
 * hull and do not overlap. */
#ifndef BRIO_TESTS_JUDGE_TETS_H
#define BRIO_TESTS_JUDGE_TETS_H

#include "mutate_tets.h"

/* The positions of four points, or 0. index: receives the point that is used for each position. */
static inline mask tet_mask(const patient *p, const uint32_t *v, uint32_t *index) {
    mask m = 0;
    for (int i = 0; i < 4; i++) {
        if (v[i] >= p->s->n) return 0;
        uint32_t r = p->a->position[v[i]];
        double heaviest = weight_at(p->s, p->a->heaviest[r]);
        if (m >> r & 1 || weight_at(p->s, v[i]) < heaviest) return 0;
        if (index[r] == UINT32_MAX) index[r] = v[i];
        if (index[r] != v[i]) return 0;
        m |= 1u << r;
    }
    return m;
}

/* Counts the facets of a tetrahedron by their sides; false if one has a tetrahedron there already. */
static inline bool take_sides(mask tet, bool (*taken)[2]) {
    for (mask left = tet; left; left &= left - 1) {
        mask facet = tet & ~(left & -left);
        int side = side_of(facet, (uint32_t)__builtin_ctz(left));
        if (taken[facet][side > 0]) return false;
        taken[facet][side > 0] = true;
    }
    return true;
}

static inline bool is_closed(const exact_answer *a, bool (*taken)[2]) {
    for (mask m = 1; m < 1u << a->positions; m++) {
        mask on;
        if (__builtin_popcount(m) == 3 && taken[m][0] != taken[m][1] && !supports(m, a->positions, &on)) return false;
    }
    return true;
}

/* canonical: receives whether it is the exact answer. */
static inline bool tets_are_right(const patient *p, bool *canonical) {
    static bool taken[MASKS][2];
    uint32_t index[MOST_POINTS];
    memset(taken, 0, sizeof taken);
    memset(index, 0xff, sizeof index);
    *canonical = p->t->count == p->a->count;
    mpz_set_ui(scratch[0], 0);
    for (size_t i = 0; i < p->t->count; i++) {
        mask m = tet_mask(p, p->t->v[i], index);
        if (!m || !volume_sign[m] || enclosing[m] || !take_sides(m, taken)) return false;
        mpz_abs(scratch[1], det[m]);
        mpz_add(scratch[0], scratch[0], scratch[1]);
        if (conflicted[m]) *canonical = false;
    }
    for (size_t i = 0; i < p->a->count; i++) {
        mpz_abs(scratch[1], det[p->a->simplex[i]]);
        mpz_sub(scratch[0], scratch[0], scratch[1]);
    }
    return mpz_sgn(scratch[0]) == 0 && is_closed(p->a, taken);
}

#endif
