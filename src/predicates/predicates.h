/* Exact predicates on points stored as records of four doubles: x, y, z, weight.
 *
 * Every predicate runs in stages, each only when the one before could not tell the sign:
 *   1. doubles, against a bound that holds for the whole point set (inline, here);
 *   2. doubles, against a bound from this call's own terms (the permanent);
 *   3. double-double, against its permanent;
 *   4. integers of fixed width, exact where the points are on a common grid;
 *   5. dyadic numbers, exact for every finite double.
 * Stages 1 to 3 assume that nothing overflows and that underflow costs less than `floor`; brio_filter_set switches them
 * off for point sets where that could fail.
 *
 * Sign conventions: orient3d(a,b,c,d) = sign det [b-a, c-a, d-a]; insphere > 0 for e inside the sphere of a positive
 * tetrahedron. Weighted, a point is inside when its power distance to the orthosphere is less than its weight: its
 * lift is below the hyperplane of the tetrahedron.
 *
 * Based on: Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates. DCG 1997.
 *           Devillers, Pion. Efficient exact geometric predicates for Delaunay triangulations. ALENEX 2003. */
#ifndef BRIO_PREDICATES_PREDICATES_H
#define BRIO_PREDICATES_PREDICATES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Bounds of the inexact stages for one point set, and the count of calls that stage 1 did not settle. One for each
 *  thread. */
typedef struct {
    double orient_static, insphere_static; /* an estimate beyond this has the right sign */
    double orient_floor, insphere_floor;   /* what underflow may cost stages 2 and 3 */
    bool weighted;
    bool lattice; /* stage 1 has no rounding errors at all: its zeros are zeros */
    bool coarse;  /* stage 4 decides every call, sooner than stage 3 */
    uint64_t unsettled;
} brio_filter;

/** Prepares the bounds for points whose coordinates differ by at most extent[0..2] in x, y, z and whose weights by at
 *  most weight_extent; weighted = false ignores the weights. */
void brio_filter_set(brio_filter *f, const double extent[3], double weight_extent, bool weighted);

/** The same for given records, and whether they stand on a lattice. */
void brio_filter_for(brio_filter *f, const double (*record)[4], size_t num_records, bool weighted);

/** Stages 2 to 5. */
int brio_orient3d_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d);
int brio_insphere_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                            const double *e);

/** Stages 4 and 5: the sign. */
int brio_orient3d_exact(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_exact(const double *a, const double *b, const double *c, const double *d, const double *e,
                        bool weighted);

/** Stage 4: the sign, or 2 when the points are on no grid that is coarse enough. */
int brio_orient3d_integer(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_integer(const double *a, const double *b, const double *c, const double *d, const double *e,
                          bool weighted);

/** Stage 5. */
int brio_orient3d_dyadic(const double *a, const double *b, const double *c, const double *d);
int brio_insphere_dyadic(const double *a, const double *b, const double *c, const double *d, const double *e,
                         bool weighted);

/** What bounds the rounding error of a determinant. */
typedef struct {
    double permanent; /* the determinant with every term positive */
    double floor;     /* the error by underflow */
} brio_magnitude;

/** Stage 3. Returns the sign, or 2 if double-doubles do not decide it.   row  a, b, c, d, e. */
int brio_orient3d_double_double(const double *a, const double *b, const double *c, const double *d,
                                brio_magnitude magnitude);
int brio_insphere_double_double(const double *const row[5], bool weighted, brio_magnitude magnitude);

/** What a zero of insphere stands for under the symbolic perturbation; (a, b, c, d) positive, e none of them. */
int brio_insphere_tie(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                      const double *e);

/** Sign of |x - p|^2 - w_p - (|x - q|^2 - w_q): which of p and q (records) is nearer to x in power distance; staged. */
int brio_power_compare(const double *x, const double *p, const double *q);
int brio_power_compare_double_double(const double *x, const double *p, const double *q, double magnitude);
int brio_power_compare_exact(const double *x, const double *p, const double *q);

/** Whether a, b, c (records) are collinear; exact. */
bool brio_collinear(const double *a, const double *b, const double *c);

/** Lexicographic order of positions. */
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

/* The in-sphere determinant in doubles, each row relative to e. */
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

/* The sign of insphere, 0 included. */
static inline int brio_insphere_sign(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                                     const double *e, const bool weighted) {
    double det = brio_insphere_estimate(a, b, c, d, e, weighted);
    if (det > f->insphere_static) return 1;
    if (det < -f->insphere_static) return -1;
    return brio_insphere_unsettled(f, a, b, c, d, e);
}

/* Returns whether e conflicts with the positive tetrahedron (a, b, c, d): whether it is inside the sphere, ties broken. e is
 * none of the vertices. */
static inline bool brio_conflict(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                                 const double *e, const bool weighted) {
    int sign = brio_insphere_sign(f, a, b, c, d, e, weighted);
    return (sign ? sign : brio_insphere_tie(f, a, b, c, d, e)) > 0;
}

#endif
