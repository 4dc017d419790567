/* A piece of surface fitted to the neighbourhood of a point.
 *
 * The normal of the plane is the direction in which the weighted points spread least, an eigenvector of their
 * covariance. A quadratic polynomial fits the heights over the plane, by the normal equations, in units of the
 * neighbourhood. Where the points do not determine its six coefficients, the polynomial is a constant. The weight of a
 * point at distance d is (1 - (d/h)^2)^2, where h is the distance of the farthest point. Because the weight is 0 at h,
 * the fit does not depend on which of several points at distance h are in the neighbourhood.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: each point has one plane and one polynomial, without a search for the best place of the
 *                         plane. A neighbourhood is a number of points, not a radius. */
#include "reconstruct/noise/local_surface.h"
#include "base/instruction_set.h"
#include "base/rotate.h"
#include "base/vector.h"
#include "reconstruct/noise/local_sums.h"
#include <math.h>

/* SWEEPS: most sweeps of rotations. Chosen. LANES_MOST: neighbours that an instruction set takes side by side. */
enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, SWEEPS = 12, LANES_MOST = 4 };

static const brio_local_sums *sums(void) {
#if defined(__x86_64__)
    if (brio_instructions() >= BRIO_AVX2) return &brio_local_sums_avx2;
#endif
    return &brio_local_sums_plain;
}

/* --- the plane --- */

static bool is_diagonal(double m[3][3]) {
    return fabs(m[0][1]) + fabs(m[0][2]) + fabs(m[1][2]) <= 1e-16 * (m[0][0] + m[1][1] + m[2][2]);
}

/* Finds the eigenvectors of m. frame[0] and frame[1] span the plane, frame[2] is its normal. Returns false if the
 * points are on a line. */
static bool find_frame(double m[3][3], double frame[3][3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < SWEEPS && !is_diagonal(m); sweep++) {
        brio_rotate(m, v, 0, 1);
        brio_rotate(m, v, 0, 2);
        brio_rotate(m, v, 1, 2);
    }
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (m[k][k] < m[least][least]) least = k;
    int a = (least + 1) % 3, b = (least + 2) % 3;
    for (int k = 0; k < 3; k++) {
        frame[0][k] = v[k][a];
        frame[1][k] = v[k][b];
        frame[2][k] = v[k][least];
    }
    return fmin(m[a][a], m[b][b]) > 1e-10 * fmax(m[a][a], m[b][b]);
}

static bool fit_plane(const brio_neighbourhood *n, double frame[3][3]) {
    double m[3][3];
    sums()->covariance(n, m);
    return find_frame(m, frame);
}

/* --- the polynomial --- */

/* Solves a x = b in place by Cholesky's method; a is symmetric and given below its diagonal. Returns false unless a is
 * clearly positive definite. */
static bool solve(double a[COEFFICIENTS][COEFFICIENTS], double *b) {
    for (int i = 0; i < COEFFICIENTS; i++) {
        double diagonal = a[i][i];
        for (int j = 0; j < i; j++) {
            for (int k = 0; k < j; k++) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
            a[i][i] -= a[i][j] * a[i][j];
            b[i] -= a[i][j] * b[j];
        }
        if (!(a[i][i] > 1e-8 * diagonal)) return false;
        a[i][i] = sqrt(a[i][i]);
        b[i] /= a[i][i];
    }
    for (int i = COEFFICIENTS; i-- > 0;) {
        for (int j = i + 1; j < COEFFICIENTS; j++) b[i] -= a[j][i] * b[j];
        b[i] /= a[i][i];
    }
    return true;
}

static void fit_polynomial(const brio_neighbourhood *n, brio_local_surface *s) {
    brio_normal_equations e;
    sums()->equations(n, s, &e);
    double mean = e.b[0] / e.a[0][0];
    bool solved = solve(e.a, e.b);
    for (int c = 0; c < COEFFICIENTS; c++) s->coefficient[c] = solved ? e.b[c] : 0;
    if (!solved) s->coefficient[0] = mean;
}

/* --- the surface --- */

/* Sets what follows the last neighbour, which sums run over as well, to a neighbour without weight. */
static void pad(brio_neighbourhood *n) {
    for (size_t i = n->count; i < BRIO_MOST_NEAR && i % LANES_MOST; i++) {
        n->offset[0][i] = n->offset[1][i] = n->offset[2][i] = 0;
        n->weight[i] = 0;
    }
}

bool brio_fit_local_surface(brio_neighbourhood *n, brio_local_surface *s) {
    double square = 0;
    for (size_t i = 0; i < n->count; i++) square = n->square[i] > square ? n->square[i] : square;
    s->unit = sqrt(square);
    if (n->count <= COEFFICIENTS || !(s->unit > 0) || isinf(s->unit)) return false;
    for (size_t i = 0; i < n->count; i++) {
        double rest = 1 - n->square[i] / square;
        n->weight[i] = rest * rest;
    }
    pad(n);
    if (!fit_plane(n, s->frame)) return false;
    fit_polynomial(n, s);
    s->height = s->unit * s->coefficient[0];
    return true;
}

/* Returns the height of neighbour i over the surface, in its unit. */
static double height_over(const brio_neighbourhood *n, const brio_local_surface *s, size_t i) {
    double d[3] = {n->offset[0][i], n->offset[1][i], n->offset[2][i]};
    double u = brio_dot(d, s->frame[0]) / s->unit, v = brio_dot(d, s->frame[1]) / s->unit;
    const double *c = s->coefficient;
    return brio_dot(d, s->frame[2]) / s->unit - (c[0] + u * (c[1] + u * c[3] + v * c[4]) + v * (c[2] + v * c[5]));
}

double brio_local_spread(const brio_neighbourhood *n, const brio_local_surface *s) {
    double squares = 0, all = 0, sum_squares = 0;
    for (size_t i = 0; i < n->count; i++) {
        double weight = n->weight[i], height = height_over(n, s, i);
        squares += weight * height * height;
        all += weight;
        sum_squares += weight * weight;
    }
    double freedom = all - COEFFICIENTS * sum_squares / all;
    return s->unit * sqrt(squares / fmax(freedom, 0.1 * all));
}

double brio_plane_spread(brio_neighbourhood *n) {
    double frame[3][3], sum = 0, squares = 0;
    for (size_t i = 0; i < n->count; i++) n->weight[i] = 1;
    pad(n);
    if (!fit_plane(n, frame)) return INFINITY;
    for (size_t i = 0; i < n->count; i++) {
        double d[3] = {n->offset[0][i], n->offset[1][i], n->offset[2][i]}, height = brio_dot(d, frame[2]);
        sum += height, squares += height * height;
    }
    double mean = sum / (double)n->count;
    return sqrt(fmax(squares / (double)n->count - mean * mean, 0));
}
