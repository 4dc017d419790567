/* Brute force in exact integers (GMP) for at most 12 points of any finite doubles: every simplex of their perturbed Delaunay
 * (regular) triangulation, in the dimension that they have, and every plane of their hull. It shares no code with the library.
 *
 * Distinct positions, sorted lexicographically, are bits of a mask. Coordinates and weights become integers by a common
 * power of two, less the first position. det[mask] is the determinant of the rows of the mask's positions; its columns are the
 * d coordinates, then 1, then the lift |x|^2 - w. With d + 1 rows it is the signed volume of a simplex; with d + 2 rows, over
 * the volume of one facet, the height of a position above the hyperplane through the others' lifts. A simplex with volume is
 * one of the triangulation if no other position is below its hyperplane. A height of 0 is decided as if lifts were raised, the
 * lexicographically largest position's by most [Devillers Teillaud 2011]: its sign is that of the first minor that is not 0.
 *
 * Based on: Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#ifndef BRIO_TESTS_EXACT_ANSWER_H
#define BRIO_TESTS_EXACT_ANSWER_H

#include "hostile_points.h"
#include <gmp.h>

enum { MASKS = 1 << MOST_POINTS };

typedef uint32_t mask;

typedef struct {
    int dimension;
    size_t positions;
    uint32_t heaviest[MOST_POINTS], lowest[MOST_POINTS]; /* of the points at a position: greatest weight; least index */
    uint32_t position[MOST_POINTS];                      /* of each point */
    mask vertices, extreme;                              /* of the triangulation; of the hull */
    size_t count, planes, ties;                          /* ties: positions on the sphere of d + 1 others */
    mask simplex[MASKS], plane[MASKS];                   /* plane: the positions on a supporting hyperplane */
    uint32_t representative[MOST_POINTS];
} exact_answer;

static mpz_t det[MASKS], coordinate[3][MOST_POINTS], lift[MOST_POINTS], scratch[3];
static int8_t volume_sign[MASKS];                /* of masks of d + 1: of the orientation in ascending order */
static bool conflicted[MASKS], enclosing[MASKS]; /* simplices that conflict; that hold a position inside their sphere */

static inline void exact_begin(void) {
    for (size_t i = 0; i < MASKS; i++) mpz_init(det[i]);
    for (size_t i = 0; i < 3 * MOST_POINTS; i++) mpz_init(coordinate[i / MOST_POINTS][i % MOST_POINTS]);
    for (size_t i = 0; i < MOST_POINTS; i++) mpz_init(lift[i]);
    for (size_t i = 0; i < 3; i++) mpz_init(scratch[i]);
}

/* --- positions --- */

static inline double at(const point_set *s, size_t i, size_t k) {
    return k < s->coordinates ? s->x[s->coordinates * i + k] : 0;
}

static inline double weight_at(const point_set *s, size_t i) {
    return s->weighted ? s->w[i] : 0;
}

static inline int compare_points(const point_set *s, size_t i, size_t j) {
    for (size_t k = 0; k < s->coordinates; k++)
        if (at(s, i, k) < at(s, j, k) || at(s, i, k) > at(s, j, k)) return at(s, i, k) < at(s, j, k) ? -1 : 1;
    return 0;
}

static inline void find_positions(const point_set *s, exact_answer *a) {
    uint32_t order[MOST_POINTS];
    for (uint32_t i = 0; i < s->n; i++) {
        size_t j = i;
        for (; j > 0 && compare_points(s, i, order[j - 1]) < 0; j--) order[j] = order[j - 1];
        order[j] = i;
    }
    a->positions = 0;
    for (size_t i = 0; i < s->n; i++) {
        uint32_t p = order[i];
        if (i == 0 || compare_points(s, p, order[i - 1])) {
            a->lowest[a->positions] = a->heaviest[a->positions] = p;
            a->positions++;
        }
        uint32_t *heavy = &a->heaviest[a->positions - 1];
        if (weight_at(s, p) > weight_at(s, *heavy)) *heavy = p; /* rising indices: the first of equal ones stays */
        a->position[p] = (uint32_t)a->positions - 1;
    }
}

/* --- integers --- */

/* The exponent of the lowest bit of x. */
static inline int lowest_bit(double x) {
    int e;
    int64_t bits = (int64_t)ldexp(frexp(x, &e), 53);
    return bits ? e - 53 + __builtin_ctzll((uint64_t)bits) : 4000;
}

/* x * 2^-unit, an integer. */
static inline void integer_of(mpz_t out, double x, int unit) {
    int e;
    mpz_set_d(out, ldexp(frexp(x, &e), 53));
    e -= 53 + unit;
    if (e >= 0)
        mpz_mul_2exp(out, out, (mp_bitcnt_t)e);
    else
        mpz_tdiv_q_2exp(out, out, (mp_bitcnt_t)-e);
}

static inline int unit_of(const point_set *s, const exact_answer *a) {
    int unit = 4000;
    for (size_t r = 0; r < a->positions; r++) {
        for (size_t k = 0; k < 3; k++) {
            int e = lowest_bit(at(s, a->heaviest[r], k));
            if (e < unit) unit = e;
        }
        int e = lowest_bit(weight_at(s, a->heaviest[r]));
        if (e < 2 * unit) unit = (e - (e & 1)) / 2;
    }
    return unit == 4000 ? 0 : unit;
}

static inline void find_integers(const point_set *s, const exact_answer *a) {
    int unit = unit_of(s, a);
    for (size_t k = 0; k < 3; k++)
        for (size_t r = a->positions; r-- > 0;) integer_of(coordinate[k][r], at(s, a->heaviest[r], k), unit);
    for (size_t k = 0; k < 3; k++)
        for (size_t r = a->positions; r-- > 0;) mpz_sub(coordinate[k][r], coordinate[k][r], coordinate[k][0]);
    for (size_t r = 0; r < a->positions; r++) {
        integer_of(lift[r], weight_at(s, a->heaviest[r]), 2 * unit);
        mpz_neg(lift[r], lift[r]);
        for (size_t k = 0; k < 3; k++) mpz_addmul(lift[r], coordinate[k][r], coordinate[k][r]);
    }
}

/* --- determinants --- */

/** Fills det of every mask of `rows` bits from those of rows - 1 bits, with one more column; NULL is a column of ones. */
static inline void expand(size_t positions, int rows, mpz_t *column) {
    for (mask m = 1; m < 1u << positions; m++) {
        if (__builtin_popcount(m) != rows) continue;
        mpz_set_ui(det[m], 0);
        bool minus = rows % 2 == 0;
        for (mask left = m; left; left &= left - 1, minus = !minus) {
            mask i = (mask)__builtin_ctz(left), minor = m & ~(1u << i);
            if (!column && minus) mpz_sub(det[m], det[m], det[minor]);
            if (!column && !minus) mpz_add(det[m], det[m], det[minor]);
            if (column && minus) mpz_submul(det[m], column[i], det[minor]);
            if (column && !minus) mpz_addmul(det[m], column[i], det[minor]);
        }
    }
}

/** Fills det of d columns and one of ones; whether one of them is not 0. */
static inline bool spans(size_t positions, int d, const int *axis) {
    bool any = false;
    mpz_set_ui(det[0], 1);
    for (int k = 0; k < d; k++) expand(positions, k + 1, coordinate[axis[k]]);
    expand(positions, d + 1, NULL);
    for (mask m = 0; m < 1u << positions; m++)
        if (__builtin_popcount(m) == d + 1) {
            volume_sign[m] = (int8_t)(mpz_sgn(det[m]) * (d % 2 ? -1 : 1));
            any |= volume_sign[m] != 0;
        }
    return any;
}

/* Axes that show the points' dimension, and planes from the side that the library promises. */
static inline int find_dimension(size_t positions) {
    static const int space[] = {0, 1, 2}, plane[][2] = {{0, 1}, {2, 0}, {1, 2}}, line[] = {0, 1, 2};
    if (positions == 0) return -1;
    if (spans(positions, 3, space)) return 3;
    for (int i = 0; i < 3; i++)
        if (spans(positions, 2, plane[i])) return 2;
    for (int i = 0; i < 3; i++)
        if (spans(positions, 1, &line[i])) return 1;
    return 0;
}

/* --- the triangulation --- */

/* The sign of a determinant of d + 2 rows, and of its perturbation if it is 0. */
static inline int perturbed_sign(mask m, int d) {
    int sign = mpz_sgn(det[m]);
    bool minus = false; /* of the last row's minor */
    for (mask left = m; left && sign == 0; minus = !minus) {
        mask i = 31u - (mask)__builtin_clz(left);
        sign = volume_sign[m & ~(1u << i)] * (d % 2 ? -1 : 1) * (minus ? -1 : 1);
        left &= ~(1u << i);
    }
    return sign;
}

/* Of d + 2 positions, marks the simplices below whose hyperplane the other one is, by the sign of their determinant. */
static inline void mark_below(mask m, int d, int sign, bool *table) {
    bool minus = d % 2 == 0; /* of the first row's minor in the last column */
    for (mask left = m; left; left &= left - 1, minus = !minus) {
        mask simplex = m & ~(left & -left);
        int minor = volume_sign[simplex] * (d % 2 ? -1 : 1) * (minus ? -1 : 1);
        if (minor * sign < 0) table[simplex] = true;
    }
}

static inline void find_simplices(exact_answer *a) {
    int d = a->dimension;
    mask all = (1u << a->positions) - 1;
    a->vertices = 0;
    expand(a->positions, d + 2, lift);
    memset(conflicted, 0, sizeof conflicted);
    memset(enclosing, 0, sizeof enclosing);
    for (mask m = 1; m <= all; m++) {
        if (__builtin_popcount(m) != d + 2) continue;
        a->ties += mpz_sgn(det[m]) == 0;
        mark_below(m, d, perturbed_sign(m, d), conflicted);
        mark_below(m, d, mpz_sgn(det[m]), enclosing);
    }
    for (mask m = 1; m <= all; m++)
        if (__builtin_popcount(m) == d + 1 && volume_sign[m] && !conflicted[m])
            a->simplex[a->count++] = m, a->vertices |= m;
}

/* --- the hull --- */

/** The side of the hyperplane of d positions, in ascending order, on which position r is; 0 on it. */
static inline int side_of(mask facet, uint32_t r) {
    int above = __builtin_popcount(facet >> r); /* positions of the facet after r: as many exchanges to be last */
    return volume_sign[facet | 1u << r] * (above % 2 ? -1 : 1);
}

/** Whether all positions are on one side of the facet's hyperplane: which, else 0. on: receives those on it. */
static inline int supports(mask facet, size_t positions, mask *on) {
    int side = 0;
    *on = facet;
    for (uint32_t r = 0; r < positions; r++) {
        if (facet >> r & 1) continue;
        int here = side_of(facet, r);
        if (here && here == -side) return 0;
        if (here) side = here;
        if (!here) *on |= 1u << r;
    }
    return side;
}

/* Hyperplanes that hold a facet of the hull, each once; and positions in at least d of them, which are extreme. */
static inline void find_planes(exact_answer *a) {
    uint8_t times[MOST_POINTS] = {0};
    a->planes = 0, a->extreme = 0;
    for (mask m = 1; m < 1u << a->positions; m++) {
        mask on;
        if (__builtin_popcount(m) != a->dimension || !supports(m, a->positions, &on)) continue;
        size_t i = 0;
        while (i < a->planes && a->plane[i] != on) i++;
        if (i < a->planes) continue;
        a->plane[a->planes++] = on;
        for (uint32_t r = 0; r < a->positions; r++) times[r] += on >> r & 1;
    }
    for (uint32_t r = 0; r < a->positions; r++)
        if (times[r] >= a->dimension) a->extreme |= 1u << r;
}

/* --- representatives --- */

/* scratch[0] = lift[v] - 2 x_v x_r: the power distance of r from v, but for what r alone determines. */
static inline void power_distance(uint32_t v, uint32_t r) {
    mpz_set_ui(scratch[1], 0);
    for (size_t k = 0; k < 3; k++) mpz_addmul(scratch[1], coordinate[k][v], coordinate[k][r]);
    mpz_mul_2exp(scratch[1], scratch[1], 1);
    mpz_sub(scratch[0], lift[v], scratch[1]);
}

static inline uint32_t nearest_vertex(const exact_answer *a, uint32_t r) {
    uint32_t best = MOST_POINTS;
    for (uint32_t v = 0; v < a->positions; v++) { /* rising lexicographically */
        if (!(a->vertices >> v & 1)) continue;
        power_distance(v, r);
        if (best < MOST_POINTS && mpz_cmp(scratch[0], scratch[2]) >= 0) continue;
        best = v;
        mpz_set(scratch[2], scratch[0]);
    }
    return best;
}

static inline void exact_solve(const point_set *s, exact_answer *a) {
    find_positions(s, a);
    find_integers(s, a);
    a->dimension = find_dimension(a->positions);
    a->count = a->ties = 0, a->vertices = a->positions ? 1 : 0;
    if (a->dimension > 0) find_simplices(a);
    find_planes(a);
    for (uint32_t i = 0; i < s->n; i++) {
        uint32_t r = a->position[i];
        a->representative[i] = a->heaviest[a->vertices >> r & 1 ? r : nearest_vertex(a, r)];
    }
}

#endif
