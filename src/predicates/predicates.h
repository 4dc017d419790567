/* Exact predicates on points stored as records of four doubles: x, y, z, weight.
 *
 * A predicate runs in stages; a stage runs only when the stage before could not decide the sign:
 *   1. doubles, against a bound that holds for the whole point set (inline, here);
 *   2. doubles, against a bound from this call's own terms (the permanent);
 *   3. double-double, against its permanent;
 *   4. integers of fixed width, exact where the points are on a common grid;
 *   5. dyadic numbers, exact for every finite double.
 * Coarse point sets skip stage 3; on a lattice stage 1 decides (brio_filter). brio_power_compare has stages 2, 3 and 5.
 * Stages 1 to 3 assume that nothing overflows and that underflow costs less than `floor`. brio_filter_set turns these
 * stages off for point sets where this could fail. After stage 3, calls that underflow or overflow left open run stages
 * 2 and 3 once more, on their rows times a power of two: else far too large or too small a unit would make each call
 * exact.
 *
 * Sign conventions: orient3d(a,b,c,d) = sign det [b-a, c-a, d-a]; insphere > 0 for e inside the sphere of a positive
 * tetrahedron. With weights, a point is inside when its power distance to the orthosphere is less than its weight, that
 * is, when its lift is below the hyperplane of the tetrahedron.
 *
 * Based on: Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates. DCG 1997.
 *           Devillers, Pion. Efficient exact geometric predicates for Delaunay triangulations. ALENEX 2003. */
#ifndef BRIO_PREDICATES_PREDICATES_H
#define BRIO_PREDICATES_PREDICATES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The error bounds of the inexact stages for one point set, and a count of calls. Each thread has its own filter. */
typedef struct {
    double orient_static, insphere_static; /* an estimate of greater magnitude has the right sign */
    double orient_floor, insphere_floor;   /* bounds of the error by underflow in stages 2 and 3 */
    bool weighted;
    bool lattice;       /* stage 1 has no rounding errors: an estimate of 0 is exact */
    bool coarse;        /* stage 4 decides every call, faster than stage 3 */
    uint64_t unsettled; /* number of calls that went beyond stage 2 */
    uint64_t exact;     /* number of these that reached stages 4 and 5 */
} brio_filter;

/** Sets the bounds for points whose coordinates differ by at most extent[0..2] in x, y, z. The weights of the points
 *  differ by at most weight_extent; weighted = false ignores the weights. */
void brio_filter_set(brio_filter *f, const double extent[3], double weight_extent, bool weighted);

/** Sets the bounds for these records, and finds whether they are on a lattice and whether they are coarse. */
void brio_filter_for(brio_filter *f, const double (*record)[4], size_t num_records, bool weighted);

/** Return the sign by stages 2 to 5. */
int brio_orient3d_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d);
int brio_insphere_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                            const double *e);

/** Return the sign by what comes after stage 3, for calls that are counted as unsettled. */
int brio_orient3d_late(brio_filter *f, const double *a, const double *b, const double *c, const double *d);
int brio_insphere_late(brio_filter *f, const double *const row[5]);

/** Return the sign by stages 2 and 3 on the rows times the power of two that brings them near 1; 2 if these do not
 *  decide it, or where neither underflow nor overflow counts. */
int brio_orient3d_rescaled(const brio_filter *f, const double *a, const double *b, const double *c, const double *d);
int brio_insphere_rescaled(const brio_filter *f, const double *const row[5]);

/** Return the sign by stages 4 and 5. */
int brio_orient3d_exact(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_exact(const double *a, const double *b, const double *c, const double *d, const double *e,
                        bool weighted);

/** Return the sign by stage 4, or 2 when the points are on no grid that is coarse enough. */
int brio_orient3d_integer(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_integer(const double *a, const double *b, const double *c, const double *d, const double *e,
                          bool weighted);

/** Return the sign by stage 5. */
int brio_orient3d_dyadic(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_dyadic(const double *a, const double *b, const double *c, const double *d, const double *e,
                         bool weighted);

/** The terms of the error bound of a determinant. */
typedef struct {
    double permanent; /* the determinant with every term positive */
    double floor;     /* a bound of the error by underflow */
} brio_magnitude;

/** Return the sign by stage 3, or 2 if double-doubles do not decide it.   row  a, b, c, d, e. */
int brio_orient3d_double_double(const double *a, const double *b, const double *c, const double *d,
                                brio_magnitude magnitude);
int brio_insphere_double_double(const double *const row[5], bool weighted, brio_magnitude magnitude);

/** Returns the sign, 1 or -1, that the symbolic perturbation gives to insphere where it is 0. (a, b, c, d) is positive,
 *  and e is none of its vertices. */
int brio_insphere_tie(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                      const double *e);

/** Returns the sign of |x - p|^2 - w_p - (|x - q|^2 - w_q) for records p and q: -1 when p is nearer to x in power
 *  distance. The double-double stage returns 2 when it does not decide the sign; magnitude is the sum of the terms'
 *  magnitudes. */
int brio_power_compare(const double *x, const double *p, const double *q);
int brio_power_compare_double_double(const double *x, const double *p, const double *q, double magnitude);
int brio_power_compare_exact(const double *x, const double *p, const double *q);

/** Returns whether a record d is strictly inside the smallest orthosphere of an edge (count 2) or a facet (count 3)
 *  that is not degenerate: whether its power distance to the centre is less than the squared radius. Exact. The edge or
 *  facet is then attached to the simplex that d spans with it; where no d is inside, it is Gabriel.
 *  p  count + 1 records, d the last of them. */
bool brio_attached(const double *const *p, int count, bool weighted);
int brio_attached_dyadic(const double *const *p, int count, bool weighted);

/** Returns whether the points a, b, c are collinear; exact. */
bool brio_collinear(const double *a, const double *b, const double *c);

/** Returns -1, 0 or 1: compares positions lexicographically. */
static inline int brio_lexicographic(const double *p, const double *q) {
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static inline bool brio_same_position(const double *p, const double *q) {
    return (p[0] == q[0]) & (p[1] == q[1]) & (p[2] == q[2]);
}

static inline int brio_orient3d_sign(brio_filter *f, const double *a, const double *b, const double *c,
                                     const double *d) {
    double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
    double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    double det = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx);
    if (det > f->orient_static) return 1;
    if (det < -f->orient_static) return -1;
    return brio_orient3d_unsettled(f, a, b, c, d);
}

/* Returns the in-sphere determinant in doubles, with each row relative to e. */
static inline double brio_insphere_estimate(const double *a, const double *b, const double *c, const double *d,
                                            const double *e, const bool weighted) {
    double ax = a[0] - e[0], ay = a[1] - e[1], az = a[2] - e[2];
    double bx = b[0] - e[0], by = b[1] - e[1], bz = b[2] - e[2];
    double cx = c[0] - e[0], cy = c[1] - e[1], cz = c[2] - e[2];
    double dx = d[0] - e[0], dy = d[1] - e[1], dz = d[2] - e[2];
    double al = ax * ax + ay * ay + az * az, bl = bx * bx + by * by + bz * bz;
    double cl = cx * cx + cy * cy + cz * cz, dl = dx * dx + dy * dy + dz * dz;
    if (weighted) al -= a[3] - e[3], bl -= b[3] - e[3], cl -= c[3] - e[3], dl -= d[3] - e[3];
    double ab = ax * by - bx * ay, bc = bx * cy - cx * by, cd = cx * dy - dx * cy;
    double da = dx * ay - ax * dy, ac = ax * cy - cx * ay, bd = bx * dy - dx * by;
    double abc = az * bc - bz * ac + cz * ab, bcd = bz * cd - cz * bd + dz * bc;
    double cda = cz * da + dz * ac + az * cd, dab = dz * ab + az * bd + bz * da;
    return (cl * dab - dl * abc) + (al * bcd - bl * cda);
}

/* Returns the sign of insphere, which may be 0. */
static inline int brio_insphere_sign(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                                     const double *e, const bool weighted) {
    double det = brio_insphere_estimate(a, b, c, d, e, weighted);
    if (det > f->insphere_static) return 1;
    if (det < -f->insphere_static) return -1;
    return brio_insphere_unsettled(f, a, b, c, d, e);
}

/* Returns whether e conflicts with the positive tetrahedron (a, b, c, d): whether e is inside the sphere, with ties
 * broken by the perturbation. e is none of the vertices. */
static inline bool brio_conflict(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                                 const double *e, const bool weighted) {
    int sign = brio_insphere_sign(f, a, b, c, d, e, weighted);
    return (sign ? sign : brio_insphere_tie(f, a, b, c, d, e)) > 0;
}

#endif
