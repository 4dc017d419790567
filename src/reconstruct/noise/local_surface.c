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
#include "base/rotate.h"
#include "base/vector.h"
#include <math.h>

/* SWEEPS: most sweeps of rotations. Chosen. */
enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, SWEEPS = 12 };

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
    double mean[3] = {0, 0, 0}, sum = 0, m[3][3] = {{0}};
    for (size_t i = 0; i < n->count; i++) {
        sum += n->weight[i];
        for (int k = 0; k < 3; k++) mean[k] += n->weight[i] * n->offset[i][k];
    }
    for (int k = 0; k < 3; k++) mean[k] /= sum;
    for (size_t i = 0; i < n->count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = n->offset[i][k] - mean[k];
        for (int k = 0; k < 3; k++)
            for (int l = 0; l <= k; l++) m[k][l] += n->weight[i] * d[k] * d[l];
    }
    for (int k = 0; k < 3; k++)
        for (int l = k + 1; l < 3; l++) m[k][l] = m[l][k];
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

/* WIDE points side by side: their monomials, heights and weights, in units of the neighbourhood. */
enum { WIDE = 4 };
typedef double lanes __attribute__((vector_size(8 * WIDE)));
typedef struct {
    lanes monomial[COEFFICIENTS], height, weight;
} some_points;

/* Loads WIDE points from index `first` on. Lanes past the last point have weight 0. */
static inline void place(const brio_neighbourhood *n, size_t first, const brio_local_surface *s, some_points *out) {
    lanes d[3] = {{0}, {0}, {0}}, zero = {0}, weight = {0};
    for (size_t i = 0; i < WIDE && first + i < n->count; i++) {
        for (int k = 0; k < 3; k++) d[k][i] = n->offset[first + i][k];
        weight[i] = n->weight[first + i];
    }
    lanes along[3];
    for (int k = 0; k < 3; k++)
        along[k] = (d[0] * s->frame[k][0] + d[1] * s->frame[k][1] + d[2] * s->frame[k][2]) * (1 / s->unit);
    lanes u = along[0], v = along[1], all[COEFFICIENTS] = {zero + 1, u, v, u * u, u * v, v * v};
    for (int c = 0; c < COEFFICIENTS; c++) out->monomial[c] = all[c];
    out->height = along[2];
    out->weight = weight;
}

static inline double sum_of(const lanes *x) {
    return ((*x)[0] + (*x)[1]) + ((*x)[2] + (*x)[3]);
}

static void fit_polynomial(const brio_neighbourhood *n, brio_local_surface *s) {
    lanes sums[COEFFICIENTS][COEFFICIENTS + 1] = {{{0}}};
    double a[COEFFICIENTS][COEFFICIENTS] = {{0}}, b[COEFFICIENTS];
    for (size_t i = 0; i < n->count; i += WIDE) {
        some_points p;
        place(n, i, s, &p);
        for (int c = 0; c < COEFFICIENTS; c++) {
            lanes weighted = p.weight * p.monomial[c];
            for (int d = 0; d <= c; d++) sums[c][d] += weighted * p.monomial[d];
            sums[c][COEFFICIENTS] += weighted * p.height;
        }
    }
    for (int c = 0; c < COEFFICIENTS; c++) {
        for (int d = 0; d <= c; d++) a[c][d] = sum_of(&sums[c][d]);
        b[c] = sum_of(&sums[c][COEFFICIENTS]);
    }
    double mean = b[0] / a[0][0];
    bool solved = solve(a, b);
    for (int c = 0; c < COEFFICIENTS; c++) s->coefficient[c] = solved ? b[c] : 0;
    if (!solved) s->coefficient[0] = mean;
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
    if (!fit_plane(n, s->frame)) return false;
    fit_polynomial(n, s);
    s->height = s->unit * s->coefficient[0];
    return true;
}

double brio_local_spread(const brio_neighbourhood *n, const brio_local_surface *s) {
    lanes squares = {0}, sum = {0}, sum_squares = {0};
    for (size_t i = 0; i < n->count; i += WIDE) {
        some_points p;
        place(n, i, s, &p);
        for (int c = 0; c < COEFFICIENTS; c++) p.height -= s->coefficient[c] * p.monomial[c];
        squares += p.weight * p.height * p.height;
        sum += p.weight;
        sum_squares += p.weight * p.weight;
    }
    double all = sum_of(&sum), freedom = all - COEFFICIENTS * sum_of(&sum_squares) / all;
    return s->unit * sqrt(sum_of(&squares) / fmax(freedom, 0.1 * all));
}

double brio_plane_spread(brio_neighbourhood *n) {
    double frame[3][3], sum = 0, squares = 0;
    for (size_t i = 0; i < n->count; i++) n->weight[i] = 1;
    if (!fit_plane(n, frame)) return INFINITY;
    for (size_t i = 0; i < n->count; i++) {
        double height = brio_dot(n->offset[i], frame[2]);
        sum += height, squares += height * height;
    }
    double mean = sum / (double)n->count;
    return sqrt(fmax(squares / (double)n->count - mean * mean, 0));
}
