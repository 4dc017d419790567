/* Decides whether two triangles meet in more than what they share, by exact orientations only.
 *
 * Most triangles of a surface whose boxes meet are neighbours, and in the projection along an axis a line through an
 * edge of one keeps them apart. This is tried first, with bounds of errors only: neighbours in one plane would need
 * exact arithmetic.
 *
 * Triangles that share nothing meet when an edge of one meets the other triangle. With one common corner, the
 * intersection is convex and contains the corner. If it contains more, a ray from the corner runs in both triangles
 * and leaves one of them through the edge opposite to the corner. So one of the two opposite edges meets the other
 * triangle. With a common edge, the triangles overlap when they lie in one plane and on one side of the edge. With
 * three common corners they are equal.
 *
 * An edge off the triangle's plane meets the triangle when its three orientations with the triangle's sides do not
 * have opposite signs. In one plane the test uses projections along an axis that keeps the triangle's area nonzero. */
#include "mesh/triangles_cross.h"
#include "base/vector.h"
#include <math.h>

typedef const double *point;

/* Error bounds of a determinant of doubles. RELATIVE_ERROR is a share of the sum of the terms' sizes (derived
 * [Shewchuk 1997], rounded up generously). The other two cover underflow in products of two and of three factors. */
static const double RELATIVE_ERROR = 0x1p-49, UNDERFLOW_OF_TWO = 0x1p-1060, ABSOLUTE_ERROR = 0x1p-1000;

/* Returns the sign of det [b-a, c-a, d-a]. */
static int orient3d(point a, point b, point c, point d) {
    double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2], cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    double bc[6] = {by * cz, bz * cy, bz * cx, bx * cz, bx * cy, by * cx};
    double det = dx * (bc[0] - bc[1]) + dy * (bc[2] - bc[3]) + dz * (bc[4] - bc[5]);
    double size = fabs(dx) * (fabs(bc[0]) + fabs(bc[1])) + fabs(dy) * (fabs(bc[2]) + fabs(bc[3])) +
                  fabs(dz) * (fabs(bc[4]) + fabs(bc[5]));
    double error = RELATIVE_ERROR * size + UNDERFLOW_OF_TWO * (fabs(dx) + fabs(dy) + fabs(dz)) + ABSOLUTE_ERROR;
    return det > error ? 1 : det < -error ? -1 : brio_orient3d(a, b, c, d);
}

/* --- in a plane: coordinates x and y --- */

/* Returns the sign of the area of abc, or 0 if rounding may have decided it. */
static inline int sure_orient2d(const double *a, const double *b, const double *c) {
    double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
    double error = RELATIVE_ERROR * (fabs(left) + fabs(right)) + ABSOLUTE_ERROR;
    return (left - right > error) - (left - right < -error);
}

/* Returns the sign of the area of abc. The exact case is an orientation with a fourth point straight above a. */
static int orient2d(const double *a, const double *b, const double *c) {
    int sure = sure_orient2d(a, b, c);
    if (sure) return sure;
    double p[4][3] = {{a[0], a[1], 0}, {b[0], b[1], 0}, {c[0], c[1], 0}, {a[0], a[1], 1}};
    return brio_orient3d(p[0], p[1], p[2], p[3]);
}

static bool in_interval(double a, double b, double x) {
    return a <= b ? a <= x && x <= b : b <= x && x <= a;
}

static bool on_segment(const double *a, const double *b, const double *p) {
    return in_interval(a[0], b[0], p[0]) && in_interval(a[1], b[1], p[1]);
}

static bool segments_meet(const double *a, const double *b, const double *c, const double *d) {
    int abc = orient2d(a, b, c), abd = orient2d(a, b, d), cda = orient2d(c, d, a), cdb = orient2d(c, d, b);
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return (!abc && on_segment(a, b, c)) || (!abd && on_segment(a, b, d)) || (!cda && on_segment(c, d, a)) ||
           (!cdb && on_segment(c, d, b));
}

static bool in_triangle(const double t[3][2], const double *p) {
    int s[3];
    for (int i = 0; i < 3; i++) s[i] = orient2d(t[i], t[(i + 1) % 3], p);
    return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) || (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}

/* Writes the two coordinates other than `axis`. */
static void project(point p, int axis, double *out) {
    out[0] = p[(axis + 1) % 3];
    out[1] = p[(axis + 2) % 3];
}

/* Returns an axis along which the triangle projects to nonzero area, or 3 when no axis does. */
static int area_axis(const point t[3]) {
    int axis = 0;
    for (; axis < 3; axis++) {
        double q[3][2];
        for (int i = 0; i < 3; i++) project(t[i], axis, q[i]);
        if (orient2d(q[0], q[1], q[2])) break;
    }
    return axis;
}

static bool segment_meets_in_plane(point p, point q, const point t[3]) {
    double flat[3][2], a[2], b[2];
    int axis = area_axis(t);
    if (axis == 3) return false;
    for (int i = 0; i < 3; i++) project(t[i], axis, flat[i]);
    project(p, axis, a);
    project(q, axis, b);
    if (in_triangle((const double(*)[2])flat, a)) return true;
    for (int i = 0; i < 3; i++)
        if (segments_meet(a, b, flat[i], flat[(i + 1) % 3])) return true;
    return false;
}

/* --- in space --- */

static bool segment_meets(point p, point q, const point t[3]) {
    int at_p = orient3d(t[0], t[1], t[2], p), at_q = orient3d(t[0], t[1], t[2], q);
    if (at_p * at_q > 0) return false;
    if (!at_p && !at_q) return segment_meets_in_plane(p, q, t);
    int s[3];
    for (int i = 0; i < 3; i++) s[i] = orient3d(p, q, t[i], t[(i + 1) % 3]);
    return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) || (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}

/* Returns whether the corners of u are all strictly on one side of the plane of t. */
static bool on_one_side(const point t[3], const point u[3]) {
    int first = orient3d(t[0], t[1], t[2], u[0]);
    for (int i = 1; i < 3 && first; i++)
        if (orient3d(t[0], t[1], t[2], u[i]) != first) first = 0;
    return first != 0;
}

static bool cross_apart(const point t[3], const point u[3]) {
    if (on_one_side(t, u) || on_one_side(u, t)) return false;
    for (int i = 0; i < 3; i++)
        if (segment_meets(t[i], t[(i + 1) % 3], u) || segment_meets(u[i], u[(i + 1) % 3], t)) return true;
    return false;
}

static bool cross_at_corner(const point t[3], int i, const point u[3], int j) {
    return segment_meets(t[(i + 1) % 3], t[(i + 2) % 3], u) || segment_meets(u[(j + 1) % 3], u[(j + 2) % 3], t);
}

/* Tests t and u that share an edge; corners i and j are the ones off the edge. */
static bool cross_at_edge(const point t[3], int i, const point u[3], int j) {
    point v = t[(i + 1) % 3], w = t[(i + 2) % 3], a = t[i], b = u[j];
    double flat[4][2];
    if (orient3d(v, w, a, b)) return false;
    int axis = area_axis(t);
    if (axis == 3) return false;
    project(v, axis, flat[0]);
    project(w, axis, flat[1]);
    project(a, axis, flat[2]);
    project(b, axis, flat[3]);
    return orient2d(flat[0], flat[1], flat[2]) == orient2d(flat[0], flat[1], flat[3]);
}

static bool same(point p, point q) {
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static bool has_corner_twice(const point t[3]) {
    return same(t[0], t[1]) || same(t[1], t[2]) || same(t[2], t[0]);
}

static bool cross_unless_flat(const point t[3], const point u[3]) {
    int common = 0, i = 0, j = 0, sum_i = 0, sum_j = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (same(t[a], u[b])) common++, i = a, j = b, sum_i += a, sum_j += b;
    if (common == 0) return cross_apart(t, u);
    if (common == 1) return cross_at_corner(t, i, u, j);
    if (has_corner_twice(t) || has_corner_twice(u)) return false;
    if (common == 2) return cross_at_edge(t, 3 - sum_i, u, 3 - sum_j);
    return true;
}

/* --- apart in a projection --- */

/* Returns the axis along which a triangle shows the most area, about. */
static int broad_axis(const point t[3]) {
    double a[3], b[3], normal[3];
    for (int k = 0; k < 3; k++) a[k] = t[1][k] - t[0][k], b[k] = t[2][k] - t[0][k];
    brio_cross(a, b, normal);
    for (int k = 0; k < 3; k++) normal[k] = fabs(normal[k]);
    if (normal[0] > normal[1]) return normal[0] > normal[2] ? 0 : 2;
    return normal[1] > normal[2] ? 1 : 2;
}

/* Returns whether it is sure that a line through an edge of t has t on one side and u on the other, in the projection:
 * then t and u meet at most in corners that they share, or in that edge. */
static bool edge_parts(const point t[3], const double flat_t[3][2], const point u[3], const double flat_u[3][2]) {
    int side = sure_orient2d(flat_t[0], flat_t[1], flat_t[2]);
    for (int i = 0; i < 3 && side; i++) {
        int next = (i + 1) % 3, beyond = 0;
        for (; beyond < 3; beyond++)
            if (sure_orient2d(flat_t[i], flat_t[next], flat_u[beyond]) != -side && !same(u[beyond], t[i]) &&
                !same(u[beyond], t[next]))
                break;
        if (beyond == 3) return true;
    }
    return false;
}

/* Returns whether it is sure, and quick to see, that t and u meet at most in what they share. */
static bool apart_in_projection(const point t[3], const point u[3]) {
    double flat_t[3][2], flat_u[3][2];
    int axis = broad_axis(t);
    for (int i = 0; i < 3; i++) project(t[i], axis, flat_t[i]), project(u[i], axis, flat_u[i]);
    return edge_parts(t, (const double(*)[2])flat_t, u, (const double(*)[2])flat_u) ||
           edge_parts(u, (const double(*)[2])flat_u, t, (const double(*)[2])flat_t);
}

bool brio_triangles_cross(const double *const t[3], const double *const u[3]) {
    if (apart_in_projection(t, u)) return false;
    return cross_unless_flat(t, u) && area_axis(t) < 3 && area_axis(u) < 3;
}
