/* A piece of surface fitted to the neighbourhood of a point.
 *
 * The normal of the plane is the direction in which the weighted points spread least, an eigenvector of their
 * covariance. A quadratic polynomial fits the heights over the plane, by the normal equations, in units of the
 * neighbourhood. Where the points do not determine its six coefficients, the polynomial is a constant. The weight of a
 * point at distance d is (1 - (d/h)^2)^2, where h is the distance of the farthest point. Because the weight is 0 at h,
 * the fit does not depend on which of several points at distance h are in the neighbourhood.
 *
 * Several surfaces are fitted side by side: the eigenvectors and the normal equations of one are chains of divisions.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: each point has one plane and one polynomial, without a search for the best place of the
 *                         plane. A neighbourhood is a number of points, not a radius. */
#include "reconstruct/noise/local_surface.h"
#include "base/instruction_set.h"
#include "base/vector.h"
#include "reconstruct/noise/local_sums.h"
#include <math.h>
#include <string.h>

/* LANES_MOST: neighbours that an instruction set takes side by side. */
enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, BATCH = BRIO_SURFACE_BATCH, LANES_MOST = 4 };

static const brio_local_sums *sums(void) {
#if defined(__x86_64__)
    if (brio_instructions() >= BRIO_AVX2) return &brio_local_sums_avx2;
#endif
    return &brio_local_sums_plain;
}

/* --- planes --- */

/* Takes the axes of plane i. frame[0] and frame[1] span the plane, frame[2] is its normal. Returns false if the points
 * are on a line. */
static bool take_frame(const brio_eigen_batch *e, size_t i, double frame[3][3]) {
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (e->matrix[k][k][i] < e->matrix[least][least][i]) least = k;
    int a = (least + 1) % 3, b = (least + 2) % 3;
    for (int k = 0; k < 3; k++) {
        frame[0][k] = e->vector[k][a][i];
        frame[1][k] = e->vector[k][b][i];
        frame[2][k] = e->vector[k][least][i];
    }
    return fmin(e->matrix[a][a][i], e->matrix[b][b][i]) > 1e-10 * fmax(e->matrix[a][a][i], e->matrix[b][b][i]);
}

/* Fits planes to the neighbourhoods that are `fit`, and takes this back where the neighbours are on a line. Places
 * without a neighbourhood keep the zero matrix. */
static void fit_planes(const brio_neighbourhood *n, size_t count, brio_local_surface *s, bool *fit) {
    brio_eigen_batch e = {{{{0}}}, {{{0}}}};
    for (size_t i = 0; i < count; i++)
        if (fit[i]) sums()->covariance(&n[i], &e, i);
    sums()->find_vectors(&e);
    for (size_t i = 0; i < count; i++) fit[i] = fit[i] && take_frame(&e, i, s[i].frame);
}

/* --- polynomials --- */

static void take_polynomial(const brio_normal_equations *e, size_t i, brio_local_surface *s) {
    for (int c = 0; c < COEFFICIENTS; c++) s->coefficient[c] = e->b[c][i];
}

static void fit_polynomials(const brio_neighbourhood *n, size_t count, brio_local_surface *s, const bool *fit) {
    brio_normal_equations e = {{{{0}}}, {{0}}};
    double mean[BATCH] = {0};
    bool solved[BATCH];
    for (size_t i = 0; i < count; i++) {
        if (!fit[i]) continue;
        sums()->equations(&n[i], &s[i], &e, i);
        mean[i] = e.b[0][i] / e.a[0][0][i];
    }
    sums()->solve(&e, solved);
    for (size_t i = 0; i < count; i++) {
        memset(s[i].coefficient, 0, sizeof s[i].coefficient);
        s[i].coefficient[0] = mean[i];
        if (solved[i]) take_polynomial(&e, i, &s[i]);
    }
}

/* --- surfaces --- */

/* Sets what follows the last neighbour, which sums run over as well, to a neighbour without weight. */
static void pad(brio_neighbourhood *n) {
    for (size_t i = n->count; i < BRIO_MOST_NEAR && i % LANES_MOST; i++) {
        n->offset[0][i] = n->offset[1][i] = n->offset[2][i] = 0;
        n->weight[i] = 0;
    }
}

/* Measures and weighs the neighbours. Returns whether they may have a surface. */
static bool prepare(brio_neighbourhood *n, brio_local_surface *s) {
    pad(n);
    double square = sums()->measure(n);
    s->unit = sqrt(square);
    if (n->count <= COEFFICIENTS || !(s->unit > 0) || isinf(s->unit)) return false;
    sums()->weigh(n, square);
    pad(n);
    return true;
}

void brio_fit_local_surfaces(brio_neighbourhood *n, size_t count, brio_local_surface *s, bool *fitted) {
    for (size_t i = 0; i < count; i++) fitted[i] = prepare(&n[i], &s[i]);
    fit_planes(n, count, s, fitted);
    fit_polynomials(n, count, s, fitted);
    for (size_t i = 0; i < count; i++) s[i].height = s[i].unit * s[i].coefficient[0];
}

void brio_move_onto(const brio_local_surface *s, double *point) {
    if (fabs(s->height) > s->unit) return;
    for (int k = 0; k < 3; k++) point[k] += s->height * s->frame[2][k];
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

bool brio_plane_heights(brio_neighbourhood *n, double *height) {
    double mean = 0;
    brio_local_surface s;
    bool fitted = true;
    for (size_t i = 0; i < n->count; i++) n->weight[i] = 1;
    pad(n);
    fit_planes(n, 1, &s, &fitted);
    if (!fitted) return false;
    for (size_t i = 0; i < n->count; i++) {
        double d[3] = {n->offset[0][i], n->offset[1][i], n->offset[2][i]};
        height[i] = brio_dot(d, s.frame[2]);
        mean += height[i] / (double)n->count;
    }
    for (size_t i = 0; i < n->count; i++) height[i] -= mean;
    return true;
}

double brio_plane_spread(brio_neighbourhood *n) {
    double height[BRIO_MOST_NEAR], squares = 0;
    if (!brio_plane_heights(n, height)) return INFINITY;
    for (size_t i = 0; i < n->count; i++) squares += height[i] * height[i];
    return sqrt(squares / (double)n->count);
}
