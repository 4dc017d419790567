/* Conflict tests, four at a time.
 *
 * Four tetrahedra go through the in-sphere determinant side by side in the lanes of vector registers. An infinite
 * vertex enters as the point at infinity of the lifting: row (0, 0, 0) with lift 1, which turns the determinant into
 * the orientation of the hull facet and the query, so finite and infinite tetrahedra need no branch. Lanes whose sign
 * is not certain take the further stages: a bound from the largest difference along each axis, then double-doubles in
 * the same lanes, and only what these leave is tested one by one.
 *
 * The bounds are those of filter.c and double_double.c: a permanent is at most 24 times (6 times for an orientation)
 * the product of the largest differences and the largest lift. */
#include "triangulation/conflict.h"

bool brio_in_conflict_exact(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p, bool weighted) {
    const uint32_t *v = t->vertex + 4 * (size_t)tet;
    if (v[3] == t->infinite) {
        int side = brio_orient3d_exact(t->record[v[0]], t->record[v[1]], t->record[v[2]], p);
        if (side) return side > 0;
        return brio_in_conflict(t, f, brio_tet_of(t->mate[4 * (size_t)tet + 3]), p, weighted);
    }
    const double *a = t->record[v[0]], *b = t->record[v[1]], *c = t->record[v[2]], *d = t->record[v[3]];
    int sign = brio_insphere_exact(a, b, c, d, p, weighted);
    return (sign ? sign : brio_insphere_tie(f, a, b, c, d, p)) > 0;
}

static unsigned conflicts_plain(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                                const double *p) {
    unsigned mask = 0;
    for (int i = 0; i < BRIO_BATCH; i++) mask |= (unsigned)brio_in_conflict(t, f, tets[i], p, false) << i;
    return mask;
}

static unsigned conflicts_plain_weighted(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                                         const double *p) {
    unsigned mask = 0;
    for (int i = 0; i < BRIO_BATCH; i++) mask |= (unsigned)brio_in_conflict(t, f, tets[i], p, true) << i;
    return mask;
}

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#define AVX2        __attribute__((target("avx2,fma")))
#define AVX2_INLINE static inline __attribute__((always_inline, target("avx2,fma")))

typedef __m256d lanes; /* one number of each of the four tetrahedra; + - * act on each lane */

/* The four rows of the determinant relative to the query; infinite lanes have row d = 0 and lift 1. */
typedef struct {
    lanes x[4], y[4], z[4], lift[4];
    lanes infinite; /* mask */
} rows;

AVX2_INLINE lanes all(double x) {
    return _mm256_set1_pd(x);
}
AVX2_INLINE lanes magnitude(lanes x) {
    return _mm256_andnot_pd(all(-0.0), x);
}

/* Loads slot s of the four tetrahedra and transposes the records into lanes. */
AVX2_INLINE void load_slot(const brio_tetrahedra *t, const uint32_t tets[BRIO_BATCH], int s, lanes out[4]) {
    lanes a = _mm256_loadu_pd(t->record[t->vertex[4 * (size_t)tets[0] + (size_t)s]]);
    lanes b = _mm256_loadu_pd(t->record[t->vertex[4 * (size_t)tets[1] + (size_t)s]]);
    lanes c = _mm256_loadu_pd(t->record[t->vertex[4 * (size_t)tets[2] + (size_t)s]]);
    lanes d = _mm256_loadu_pd(t->record[t->vertex[4 * (size_t)tets[3] + (size_t)s]]);
    lanes ab0 = _mm256_unpacklo_pd(a, b), ab1 = _mm256_unpackhi_pd(a, b);
    lanes cd0 = _mm256_unpacklo_pd(c, d), cd1 = _mm256_unpackhi_pd(c, d);
    out[0] = _mm256_permute2f128_pd(ab0, cd0, 0x20);
    out[1] = _mm256_permute2f128_pd(ab1, cd1, 0x20);
    out[2] = _mm256_permute2f128_pd(ab0, cd0, 0x31);
    out[3] = _mm256_permute2f128_pd(ab1, cd1, 0x31);
}

AVX2_INLINE lanes infinite_lanes(const brio_tetrahedra *t, const uint32_t tets[BRIO_BATCH]) {
    __m128i last = _mm_setr_epi32((int)t->vertex[4 * (size_t)tets[0] + 3], (int)t->vertex[4 * (size_t)tets[1] + 3],
                                  (int)t->vertex[4 * (size_t)tets[2] + 3], (int)t->vertex[4 * (size_t)tets[3] + 3]);
    __m128i equal = _mm_cmpeq_epi32(last, _mm_set1_epi32((int)t->infinite));
    return _mm256_castsi256_pd(_mm256_cvtepi32_epi64(equal));
}

/* Coordinates of all vertices, for the stages that need them again. */
typedef struct {
    lanes v[4][4]; /* of slot s: x, y, z, weight */
    lanes e[4];
} corners;

AVX2_INLINE void load_corners(const brio_tetrahedra *t, const uint32_t tets[BRIO_BATCH], const double *p, corners *c) {
    for (int s = 0; s < 4; s++) load_slot(t, tets, s, c->v[s]);
    for (int k = 0; k < 4; k++) c->e[k] = all(p[k]);
}

AVX2_INLINE void rows_set(const corners *c, lanes infinite, rows *r, const bool weighted) {
    for (int s = 0; s < 4; s++) {
        r->x[s] = c->v[s][0] - c->e[0], r->y[s] = c->v[s][1] - c->e[1], r->z[s] = c->v[s][2] - c->e[2];
        r->lift[s] = r->x[s] * r->x[s] + r->y[s] * r->y[s] + r->z[s] * r->z[s];
        if (weighted) r->lift[s] -= c->v[s][3] - c->e[3];
    }
    r->infinite = infinite;
    r->x[3] = _mm256_andnot_pd(infinite, r->x[3]);
    r->y[3] = _mm256_andnot_pd(infinite, r->y[3]);
    r->z[3] = _mm256_andnot_pd(infinite, r->z[3]);
    r->lift[3] = _mm256_blendv_pd(r->lift[3], all(1), infinite);
}

/* Minors of the rows but one, with the signs that make minor[i] the orientation of the tetrahedron with vertex i
 * replaced by the query. */
AVX2_INLINE void minors(const rows *r, lanes minor[4]) {
    const lanes *x = r->x, *y = r->y, *z = r->z;
    lanes ab = x[0] * y[1] - x[1] * y[0], bc = x[1] * y[2] - x[2] * y[1], cd = x[2] * y[3] - x[3] * y[2];
    lanes da = x[3] * y[0] - x[0] * y[3], ac = x[0] * y[2] - x[2] * y[0], bd = x[1] * y[3] - x[3] * y[1];
    minor[0] = z[1] * cd - z[2] * bd + z[3] * bc;
    minor[1] = all(0) - (z[2] * da + z[3] * ac + z[0] * cd);
    minor[2] = z[3] * ab + z[0] * bd + z[1] * da;
    minor[3] = all(0) - (z[0] * bc - z[1] * ac + z[2] * ab);
}

AVX2_INLINE lanes determinant(const rows *r) {
    lanes minor[4];
    minors(r, minor);
    return (r->lift[2] * minor[2] + r->lift[3] * minor[3]) + (r->lift[0] * minor[0] + r->lift[1] * minor[1]);
}

/* Lanes where p is lexicographically larger than q. */
AVX2_INLINE lanes larger(const lanes p[3], const lanes q[3]) {
    lanes z = _mm256_cmp_pd(p[2], q[2], _CMP_GT_OQ);
    lanes y = _mm256_blendv_pd(_mm256_cmp_pd(p[1], q[1], _CMP_GT_OQ), z, _mm256_cmp_pd(p[1], q[1], _CMP_EQ_OQ));
    return _mm256_blendv_pd(_mm256_cmp_pd(p[0], q[0], _CMP_GT_OQ), y, _mm256_cmp_pd(p[0], q[0], _CMP_EQ_OQ));
}

/* The symbolic perturbation (perturb.c) where minors are exact: bits of the lanes in conflict if their determinant is
 * 0. */
AVX2_INLINE unsigned ties(const corners *c, const rows *r) {
    lanes minor[4], decisive[3] = {c->e[0], c->e[1], c->e[2]}, decision = all(-1);
    minors(r, minor);
    for (int s = 0; s < 4; s++) {
        lanes take = _mm256_and_pd(larger(c->v[s], decisive), _mm256_cmp_pd(minor[s], all(0), _CMP_NEQ_OQ));
        decision = _mm256_blendv_pd(decision, minor[s], take);
        for (int k = 0; k < 3; k++) decisive[k] = _mm256_blendv_pd(decisive[k], c->v[s][k], take);
    }
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(decision, all(0), _CMP_GT_OQ));
}

/* Bits of the lanes that are certainly in conflict, and of those that are certainly not, added to *known. */
AVX2_INLINE unsigned decide(lanes det, lanes bound, unsigned *known) {
    unsigned above = (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(det, bound, _CMP_GT_OQ));
    unsigned below = (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(det, all(0) - bound, _CMP_LT_OQ));
    unsigned fresh = above & ~*known;
    *known |= above | below;
    return fresh;
}

AVX2_INLINE lanes largest(const lanes v[4]) {
    return _mm256_max_pd(_mm256_max_pd(magnitude(v[0]), magnitude(v[1])),
                         _mm256_max_pd(magnitude(v[2]), magnitude(v[3])));
}

/* A bound of the permanent of each lane. */
AVX2_INLINE lanes permanent(const corners *c, const rows *r, const bool weighted) {
    lanes lift[4];
    for (int s = 0; s < 4; s++) {
        lift[s] = r->x[s] * r->x[s] + r->y[s] * r->y[s] + r->z[s] * r->z[s];
        if (weighted) lift[s] += magnitude(c->v[s][3] - c->e[3]);
    }
    lanes box = largest(r->x) * largest(r->y) * largest(r->z);
    return _mm256_blendv_pd(all(24.01) * box * largest(lift), all(6.01) * box, r->infinite);
}

/* --- double-doubles in lanes; see double_double.h for their bounds --- */

typedef struct {
    lanes hi, lo;
} dd;

AVX2_INLINE dd two_sum(lanes a, lanes b) {
    lanes s = a + b, t = s - a;
    return (dd){s, (a - (s - t)) + (b - t)};
}
AVX2_INLINE dd renormalised(lanes a, lanes b) {
    lanes s = a + b;
    return (dd){s, b - (s - a)};
}
AVX2_INLINE dd difference(lanes a, lanes b) {
    return two_sum(a, all(0) - b);
}
AVX2_INLINE dd multiply(dd x, dd y) {
    lanes p = x.hi * y.hi, e = _mm256_fmsub_pd(x.hi, y.hi, p);
    return renormalised(p, e + (x.hi * y.lo + x.lo * y.hi));
}
AVX2_INLINE dd add(dd x, dd y) {
    dd s = two_sum(x.hi, y.hi);
    return renormalised(s.hi, s.lo + (x.lo + y.lo));
}
AVX2_INLINE dd subtract(dd x, dd y) {
    return add(x, (dd){all(0) - y.hi, all(0) - y.lo});
}
AVX2_INLINE dd minor2(dd x, dd y, dd z, dd w) {
    return subtract(multiply(x, y), multiply(z, w));
}
AVX2_INLINE dd masked(dd x, lanes drop, double value) {
    return (dd){_mm256_blendv_pd(x.hi, all(value), drop), _mm256_andnot_pd(drop, x.lo)};
}

AVX2 static __attribute__((noinline)) lanes determinant_dd(const corners *c, lanes infinite, bool weighted) {
    dd x[4], y[4], z[4], l[4];
    for (int s = 0; s < 4; s++) {
        x[s] = difference(c->v[s][0], c->e[0]), y[s] = difference(c->v[s][1], c->e[1]);
        z[s] = difference(c->v[s][2], c->e[2]);
        l[s] = add(add(multiply(x[s], x[s]), multiply(y[s], y[s])), multiply(z[s], z[s]));
        if (weighted) l[s] = subtract(l[s], difference(c->v[s][3], c->e[3]));
    }
    x[3] = masked(x[3], infinite, 0), y[3] = masked(y[3], infinite, 0), z[3] = masked(z[3], infinite, 0);
    l[3] = masked(l[3], infinite, 1);
    dd ab = minor2(x[0], y[1], x[1], y[0]), bc = minor2(x[1], y[2], x[2], y[1]), cd = minor2(x[2], y[3], x[3], y[2]);
    dd da = minor2(x[3], y[0], x[0], y[3]), ac = minor2(x[0], y[2], x[2], y[0]), bd = minor2(x[1], y[3], x[3], y[1]);
    dd abc = add(minor2(z[0], bc, z[1], ac), multiply(z[2], ab));
    dd bcd = add(minor2(z[1], cd, z[2], bd), multiply(z[3], bc));
    dd cda = add(add(multiply(z[2], da), multiply(z[3], ac)), multiply(z[0], cd));
    dd dab = add(add(multiply(z[3], ab), multiply(z[0], bd)), multiply(z[1], da));
    return add(minor2(l[2], dab, l[3], abc), minor2(l[0], bcd, l[1], cda)).hi;
}

static const double DOUBLE_UNIT = 18 * 0x1p-53, DD_UNIT = 0x1p-99;

/* Lanes whose determinant is exactly 0, on a lattice: a hull facet's plane is decided by its finite neighbour, else
 * ties are broken. */
AVX2 static __attribute__((noinline)) unsigned settle_lattice(const brio_tetrahedra *t, brio_filter *f,
                                                              const uint32_t tets[BRIO_BATCH], const double *p,
                                                              const corners *c, const rows *r, unsigned known) {
    unsigned zero = ~known & 15, infinite = zero & (unsigned)_mm256_movemask_pd(r->infinite);
    unsigned mask = ties(c, r) & zero & ~infinite;
    for (int i = 0; i < BRIO_BATCH; i++)
        if (infinite >> i & 1) mask |= (unsigned)brio_in_conflict(t, f, tets[i], p, f->weighted) << i;
    return mask;
}

/* Stages beyond the static bound, for the lanes not yet known. */
AVX2 static __attribute__((noinline)) unsigned settle(const brio_tetrahedra *t, brio_filter *f,
                                                      const uint32_t tets[BRIO_BATCH], const double *p,
                                                      const corners *c, const rows *r, lanes det, unsigned known,
                                                      const bool weighted) {
    lanes floor = _mm256_blendv_pd(all(f->insphere_floor), all(f->orient_floor), r->infinite);
    lanes most = permanent(c, r, weighted);
    unsigned mask = decide(det, all(DOUBLE_UNIT) * most + floor, &known);
    if (known == 15) return mask;
    f->unsettled += (uint64_t)__builtin_popcount(~known & 15);
    if (!f->coarse) mask |= decide(determinant_dd(c, r->infinite, weighted), all(DD_UNIT) * most + floor, &known);
    for (int i = 0; i < BRIO_BATCH; i++)
        if (!(known >> i & 1)) mask |= (unsigned)brio_in_conflict_exact(t, f, tets[i], p, weighted) << i;
    return mask;
}

AVX2_INLINE unsigned conflicts(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                               const double *p, const bool weighted) {
    corners c;
    rows r;
    unsigned known = 0;
    load_corners(t, tets, p, &c);
    lanes infinite = infinite_lanes(t, tets);
    rows_set(&c, infinite, &r, weighted);
    lanes bound = _mm256_blendv_pd(all(f->insphere_static), all(f->orient_static), infinite);
    lanes det = determinant(&r);
    unsigned mask = decide(det, bound, &known);
    if (__builtin_expect(known == 15, 1)) return mask;
    if (f->lattice) return mask | settle_lattice(t, f, tets, p, &c, &r, known);
    return mask | settle(t, f, tets, p, &c, &r, det, known, weighted);
}

AVX2 static unsigned conflicts_avx2(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                                    const double *p) {
    return conflicts(t, f, tets, p, false);
}

AVX2 static unsigned conflicts_avx2_weighted(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                                             const double *p) {
    return conflicts(t, f, tets, p, true);
}

brio_conflicts_fn brio_conflicts_choose(bool weighted) {
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return weighted ? conflicts_avx2_weighted : conflicts_avx2;
    return weighted ? conflicts_plain_weighted : conflicts_plain;
}

#else

brio_conflicts_fn brio_conflicts_choose(bool weighted) {
    return weighted ? conflicts_plain_weighted : conflicts_plain;
}

#endif
