/* A piece of surface fitted to the points about one of them.
 *
 * The plane goes across the direction in which the weighted points spread least, an eigenvector of their covariance. Over
 * it a quadratic polynomial takes their heights, by the normal equations, in coordinates in units of the neighbourhood;
 * where the points do not determine all six coefficients the polynomial is a constant. A weight (1 - (d/h)^2)^2, h the
 * distance of the last point, is 0 where it stops: which of several points at that distance came last does not matter.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: one plane and one polynomial for a point, without a search for the plane's best place, and the
 * neighbourhood is a number of points. */
#include "reconstruct/local_surface.h"
#include "base/vector.h"
#include <math.h>

enum { COEFFICIENTS = 6, SWEEPS = 12 };

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

/* frame[0] and [1] span the plane, frame[2] is its normal; false where the points are on a line. */
static bool find_frame(double m[3][3], double frame[3][3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
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

static bool fit_plane(const brio_near_point *near, const double *weight, size_t count, double frame[3][3]) {
    double mean[3] = {0, 0, 0}, sum = 0, m[3][3] = {{0}};
    for (size_t i = 0; i < count; i++) {
        sum += weight[i];
        for (int k = 0; k < 3; k++) mean[k] += weight[i] * (near[i].point[k] - near[0].point[k]);
    }
    for (size_t i = 0; i < count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = near[i].point[k] - near[0].point[k] - mean[k] / sum;
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) m[k][l] += weight[i] * d[k] * d[l];
    }
    return find_frame(m, frame);
}

/* --- the polynomial --- */

/* Solves a x = b in place, a symmetric and positive; false where it is not clearly so [Cholesky]. */
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
static double place(const brio_near_point *near, size_t i, double unit, double frame[3][3], double *monomial) {
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = (near[i].point[k] - near[0].point[k]) / unit;
    double u = brio_dot(d, frame[0]), v = brio_dot(d, frame[1]);
    double all[COEFFICIENTS] = {1, u, v, u * u, u * v, v * v};
    for (int c = 0; c < COEFFICIENTS; c++) monomial[c] = all[c];
    return brio_dot(d, frame[2]);
}

static void fit_polynomial(const brio_near_point *near, const double *weight, size_t count, double unit,
                           double frame[3][3], double *coefficient) {
    double a[COEFFICIENTS][COEFFICIENTS] = {{0}}, b[COEFFICIENTS] = {0};
    for (size_t i = 0; i < count; i++) {
        double monomial[COEFFICIENTS], height = place(near, i, unit, frame, monomial);
        for (int c = 0; c < COEFFICIENTS; c++) {
            for (int d = 0; d < COEFFICIENTS; d++) a[c][d] += weight[i] * monomial[c] * monomial[d];
            b[c] += weight[i] * height * monomial[c];
        }
    }
    double mean = b[0] / a[0][0];
    bool solved = solve(a, b);
    for (int c = 0; c < COEFFICIENTS; c++) coefficient[c] = solved ? b[c] : 0;
    if (!solved) coefficient[0] = mean;
}

static double spread_about(const brio_near_point *near, const double *weight, size_t count, double unit,
                           double frame[3][3], const double *coefficient) {
    double squares = 0, sum = 0, sum_squares = 0;
    for (size_t i = 0; i < count; i++) {
        double monomial[COEFFICIENTS], height = place(near, i, unit, frame, monomial);
        for (int c = 0; c < COEFFICIENTS; c++) height -= coefficient[c] * monomial[c];
        squares += weight[i] * height * height;
        sum += weight[i];
        sum_squares += weight[i] * weight[i];
    }
    return unit * sqrt(squares / fmax(sum - COEFFICIENTS * sum_squares / sum, 0.1 * sum));
}

bool brio_fit_local_surface(const brio_near_point *near, size_t count, brio_local_surface *out) {
    double weight[BRIO_MOST_NEAR], frame[3][3], coefficient[COEFFICIENTS];
    if (count > BRIO_MOST_NEAR) count = BRIO_MOST_NEAR;
    double square = near[count - 1].square, unit = sqrt(square);
    if (count <= COEFFICIENTS || !(unit > 0) || isinf(unit)) return false;
    for (size_t i = 0; i < count; i++) {
        double rest = 1 - near[i].square / square;
        weight[i] = rest * rest;
    }
    if (!fit_plane(near, weight, count, frame)) return false;
    fit_polynomial(near, weight, count, unit, frame, coefficient);
    for (int k = 0; k < 3; k++) out->normal[k] = frame[2][k];
    out->height = unit * coefficient[0];
    out->spread = spread_about(near, weight, count, unit, frame, coefficient);
    return true;
}
