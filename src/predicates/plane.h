/* Exact predicates of the plane, on records of four doubles: u, v, rest, weight.
 *
 * u and v are the coordinates in the plane. `rest` is 0 for points in two dimensions. For points of a plane in space,
 * u, v and rest are the three coordinates in some order, and (u, v) names a point of the plane. The lift of a point is
 * u^2 + v^2 + rest^2 - weight. The in-circle test asks on which side of the plane through three lifted points a fourth
 * lifted point lies. That is an affine property of (u, v). So with `rest` in the lift the circles are those of the
 * plane in space, although (u, v) is only its projection.
 *
 * A predicate runs in the stages of predicates.h. Here stage 4 has integers of up to 61 bits, because the determinants
 * have degrees 2 and 4.
 *
 * Sign conventions: orient2d(a, b, c) > 0 for a counterclockwise triangle; incircle > 0 for e inside the circle of a
 * counterclockwise triangle (a, b, c), with weights: inside its orthocircle. */
#ifndef BRIO_PREDICATES_PLANE_H
#define BRIO_PREDICATES_PLANE_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The error bounds of the inexact stages for one point set, and a count of calls. */
typedef struct {
    double orient_static, incircle_static; /* an estimate of greater magnitude has the right sign */
    double orient_floor, incircle_floor;   /* bounds of the error by underflow in stages 2 and 3 */
    bool general;                          /* records have `rest` or weights that are not 0 */
    bool lattice;                          /* stage 1 has no rounding errors: an estimate of 0 is exact */
    uint8_t key[3];                        /* the numbers of a record in their lexicographic order */
    uint64_t unsettled;                    /* number of calls that went beyond stage 2 */
    uint64_t exact;                        /* number of these that reached stages 4 and 5 */
} brio_plane_filter;

/** Sets the bounds for records whose numbers differ by at most extent[0..3] in u, v, rest and weight. general = false
 *  ignores rest and weight. The lexicographic order is u, v, rest. */
void brio_plane_filter_set(brio_plane_filter *f, const double extent[4], bool general);

/** Sets the bounds for these records, and finds whether they are on a lattice. Leaves f->key as it was. */
void brio_plane_filter_for(brio_plane_filter *f, const double (*record)[4], size_t num_records, bool general);

/** Return the sign by stages 2 to 5. */
int brio_orient2d_unsettled(brio_plane_filter *f, const double *a, const double *b, const double *c);
int brio_incircle_unsettled(brio_plane_filter *f, const double *a, const double *b, const double *c, const double *e);

/** Return the sign by stage 3, or 2 if double-doubles do not decide it.   permanent, floor  as in predicates.h. */
int brio_orient2d_double_double(const double *a, const double *b, const double *c, double permanent, double floor);
int brio_incircle_double_double(const double *const row[4], double permanent, double floor);

/** Return the sign by stages 2 and 3 on scaled records, or 2, as in predicates.h. */
int brio_orient2d_rescaled(const brio_plane_filter *f, const double *a, const double *b, const double *c);
int brio_incircle_rescaled(const brio_plane_filter *f, const double *const row[4]);

/** Return the sign by stage 4, or 2 when the points are on no grid that is coarse enough. */
int brio_orient2d_integer(const double *a, const double *b, const double *c);
int brio_incircle_integer(const double *a, const double *b, const double *c, const double *e);

/** Return the sign by stage 5. */
int brio_orient2d_dyadic(const double *a, const double *b, const double *c);
int brio_incircle_dyadic(const double *a, const double *b, const double *c, const double *e);

/** Return the sign by stages 4 and 5. */
int brio_orient2d_exact(const double *a, const double *b, const double *c);
int brio_incircle_exact(const double *a, const double *b, const double *c, const double *e);

/** Returns the sign, 1 or -1, that the symbolic perturbation gives to incircle where it is 0. (a, b, c) is
 *  counterclockwise, and e is none of its vertices. */
int brio_incircle_tie(brio_plane_filter *f, const double *a, const double *b, const double *c, const double *e);

/** Returns -1, 0 or 1: compares positions by the filter's lexicographic order. */
static inline int brio_plane_lexicographic(const brio_plane_filter *f, const double *p, const double *q) {
    for (int i = 0; i < 3; i++) {
        int k = f->key[i];
        assert(k < 3);
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    }
    return 0;
}

static inline bool brio_same_place(const double *p, const double *q) {
    return (p[0] == q[0]) & (p[1] == q[1]);
}

static inline int brio_orient2d_sign(brio_plane_filter *f, const double *a, const double *b, const double *c) {
    double det = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (det > f->orient_static) return 1;
    if (det < -f->orient_static) return -1;
    return brio_orient2d_unsettled(f, a, b, c);
}

/* Returns the in-circle determinant in doubles, with each row relative to e. */
static inline double brio_incircle_estimate(const double *a, const double *b, const double *c, const double *e,
                                            const bool general) {
    double ax = a[0] - e[0], ay = a[1] - e[1], bx = b[0] - e[0], by = b[1] - e[1], cx = c[0] - e[0], cy = c[1] - e[1];
    double al = ax * ax + ay * ay, bl = bx * bx + by * by, cl = cx * cx + cy * cy;
    if (general) {
        double az = a[2] - e[2], bz = b[2] - e[2], cz = c[2] - e[2];
        al = al + az * az - (a[3] - e[3]), bl = bl + bz * bz - (b[3] - e[3]), cl = cl + cz * cz - (c[3] - e[3]);
    }
    return al * (bx * cy - cx * by) + bl * (cx * ay - ax * cy) + cl * (ax * by - bx * ay);
}

/* Returns the sign of incircle, which may be 0. */
static inline int brio_incircle_sign(brio_plane_filter *f, const double *a, const double *b, const double *c,
                                     const double *e, const bool general) {
    double det = brio_incircle_estimate(a, b, c, e, general);
    if (det > f->incircle_static) return 1;
    if (det < -f->incircle_static) return -1;
    return brio_incircle_unsettled(f, a, b, c, e);
}

/* Returns whether e conflicts with the counterclockwise triangle (a, b, c): whether e is inside the circle, with ties
 * broken by the perturbation. e is none of the vertices. */
static inline bool brio_circle_conflict(brio_plane_filter *f, const double *a, const double *b, const double *c,
                                        const double *e, const bool general) {
    int sign = brio_incircle_sign(f, a, b, c, e, general);
    return (sign ? sign : brio_incircle_tie(f, a, b, c, e)) > 0;
}

#endif
