/* A piece of surface fitted to the points about one of them.
 *
 * The plane goes across the direction in which the weighted points spread least, an eigenvector of their covariance. Over
 * it a quadratic polynomial takes their heights, by the normal equations, in coordinates in units of the neighbourhood;
 * where the points do not determine all six coefficients the polynomial is a constant. A weight (1 - (d/h)^2)^2, h the
 * distance of the farthest point, is 0 where it stops: which of several points at that distance count does not matter.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: one plane and one polynomial for a point, without a search for the plane's best place, and the
 * neighbourhood is a number of points. */
#include "reconstruct/power_crust/local_surface.h"
#include "base/vector.h"
#include <math.h>

enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, SWEEPS = 12 };

/* --- the plane --- */

/* Turns the matrix m in the plane of axes i and j so that m[i][j] is 0, and the columns of v along [Jacobi 1846]. */
static void rotate(double m[3][3], double v[3][3], int i, int j) {
    if (m[i][j] == 0) return;
    double theta = (m[j][j] - m[i][i]) / (2 * m[i][j]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(1 + theta * theta)), c = 1 / sqrt(1 + t * t), s = t * c;
    for (int k = 0; k < 3; k++) {
        double a = m[k][i], b = m[k][j];
        m[k][i] = c * a - s * b;
        m[k][j] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        double a = m[i][k], b = m[j][k], p = v[k][i], q = v[k][j];
        m[i][k] = c * a - s * b;
        m[j][k] = s * a + c * b;
        v[k][i] = c * p - s * q;
        v[k][j] = s * p + c * q;
    }
}

static bool is_diagonal(double m[3][3]) {
    return fabs(m[0][1]) + fabs(m[0][2]) + fabs(m[1][2]) <= 1e-16 * (m[0][0] + m[1][1] + m[2][2]);
}

/* frame[0] and [1] span the plane, frame[2] is its normal; false where the points are on a line. */
static bool find_frame(double m[3][3], double frame[3][3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < SWEEPS && !is_diagonal(m); sweep++) {
        rotate(m, v, 0, 1);
        rotate(m, v, 0, 2);
        rotate(m, v, 1, 2);
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

/* Solves a x = b in place, a symmetric and positive, given below its diagonal; false where it is not clearly so
 * [Cholesky]. */
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

/* The monomials and the height of a point, in units of the neighbourhood. */
static inline double place(const double *offset, const brio_local_surface *s, double *monomial) {
    double u = brio_dot(offset, s->frame[0]) / s->unit, v = brio_dot(offset, s->frame[1]) / s->unit;
    double all[COEFFICIENTS] = {1, u, v, u * u, u * v, v * v};
    for (int c = 0; c < COEFFICIENTS; c++) monomial[c] = all[c];
    return brio_dot(offset, s->frame[2]) / s->unit;
}

static void fit_polynomial(const brio_neighbourhood *n, brio_local_surface *s) {
    double a[COEFFICIENTS][COEFFICIENTS] = {{0}}, b[COEFFICIENTS] = {0};
    for (size_t i = 0; i < n->count; i++) {
        double monomial[COEFFICIENTS], height = place(n->offset[i], s, monomial);
        for (int c = 0; c < COEFFICIENTS; c++) {
            double weighted = n->weight[i] * monomial[c];
            for (int d = 0; d <= c; d++) a[c][d] += weighted * monomial[d];
            b[c] += weighted * height;
        }
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
    double squares = 0, sum = 0, sum_squares = 0;
    for (size_t i = 0; i < n->count; i++) {
        double monomial[COEFFICIENTS], height = place(n->offset[i], s, monomial);
        for (int c = 0; c < COEFFICIENTS; c++) height -= s->coefficient[c] * monomial[c];
        squares += n->weight[i] * height * height;
        sum += n->weight[i];
        sum_squares += n->weight[i] * n->weight[i];
    }
    return s->unit * sqrt(squares / fmax(sum - COEFFICIENTS * sum_squares / sum, 0.1 * sum));
}
