/* The arithmetic of a fit, WIDE numbers side by side. One source file for each instruction set includes this file.
 *
 * In sums over one neighbourhood, neighbour i is in lane i mod WIDE; at the end the lanes are added. Past the last
 * neighbour weights are 0. Eigenvectors and solutions of equations are found for WIDE neighbourhoods, one in each lane;
 * a lane that is done keeps its numbers while the others go on. */
#include "reconstruct/noise/local_sums.h"
#include <math.h>

/* SWEEPS: most sweeps of rotations. Chosen. */
enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, WIDE = BRIO_SURFACE_BATCH, SWEEPS = 12 };
typedef double lanes __attribute__((vector_size(8 * WIDE), aligned(8)));
typedef int64_t lane_bits __attribute__((vector_size(8 * WIDE), aligned(8)));

_Static_assert(BRIO_MOST_NEAR % WIDE == 0, "the arrays of a neighbourhood have room for whole lanes");
_Static_assert(WIDE == 4, "sum_of adds four lanes");

#define LANES_AT(array, i)       (*(lanes *)&(array)[i])
#define CONST_LANES_AT(array, i) (*(const lanes *)&(array)[i])

static inline double sum_of(const lanes *x) {
    return ((*x)[0] + (*x)[1]) + ((*x)[2] + (*x)[3]);
}

/* Sets *x to a in the lanes of a mask. */
static inline void set_where(const lane_bits *mask, const lanes *a, lanes *x) {
    *x = (lanes)(((lane_bits)*a & *mask) | ((lane_bits)*x & ~*mask));
}

static inline void magnitude(const lanes *x, lanes *out) {
    *out = (lanes)((lane_bits)*x & INT64_MAX);
}

static inline void root(const lanes *x, lanes *out) {
    for (int l = 0; l < WIDE; l++) (*out)[l] = sqrt((*x)[l]);
}

/* --- one neighbourhood --- */

static double measure(brio_neighbourhood *n) {
    lanes most = {0};
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes x = CONST_LANES_AT(n->offset[0], i), y = CONST_LANES_AT(n->offset[1], i),
              z = CONST_LANES_AT(n->offset[2], i), square = x * x + y * y + z * z;
        lane_bits more = (lane_bits)(square > most);
        LANES_AT(n->square, i) = square;
        set_where(&more, &square, &most);
    }
    double low = most[0] > most[1] ? most[0] : most[1], high = most[2] > most[3] ? most[2] : most[3];
    return low > high ? low : high;
}

static void weigh(brio_neighbourhood *n, double most) {
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes rest = 1 - CONST_LANES_AT(n->square, i) / most;
        LANES_AT(n->weight, i) = rest * rest;
    }
}

static void covariance(const brio_neighbourhood *n, brio_eigen_batch *out, size_t place) {
    lanes all = {0}, mean[3] = {{0}, {0}, {0}}, sums[3][3] = {{{0}}};
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes w = CONST_LANES_AT(n->weight, i);
        all += w;
        for (int k = 0; k < 3; k++) mean[k] += w * CONST_LANES_AT(n->offset[k], i);
    }
    for (int k = 0; k < 3; k++) mean[k] = sum_of(&mean[k]) / sum_of(&all) + (lanes){0};
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes w = CONST_LANES_AT(n->weight, i), d[3];
        for (int k = 0; k < 3; k++) d[k] = CONST_LANES_AT(n->offset[k], i) - mean[k];
        for (int k = 0; k < 3; k++)
            for (int l = 0; l <= k; l++) sums[k][l] += w * d[k] * d[l];
    }
    for (int k = 0; k < 3; k++)
        for (int l = 0; l <= k; l++) out->matrix[k][l][place] = out->matrix[l][k][place] = sum_of(&sums[k][l]);
}

static void equations(const brio_neighbourhood *n, const brio_local_surface *s, brio_normal_equations *out,
                      size_t place) {
    lanes sums[COEFFICIENTS][COEFFICIENTS + 1] = {{{0}}};
    double scale = 1 / s->unit;
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes d[3], along[3], one = {1, 1, 1, 1};
        for (int k = 0; k < 3; k++) d[k] = CONST_LANES_AT(n->offset[k], i);
        for (int k = 0; k < 3; k++)
            along[k] = (d[0] * s->frame[k][0] + d[1] * s->frame[k][1] + d[2] * s->frame[k][2]) * scale;
        lanes u = along[0], v = along[1], monomial[COEFFICIENTS] = {one, u, v, u * u, u * v, v * v};
        for (int c = 0; c < COEFFICIENTS; c++) {
            lanes weighted = CONST_LANES_AT(n->weight, i) * monomial[c];
            for (int e = 0; e <= c; e++) sums[c][e] += weighted * monomial[e];
            sums[c][COEFFICIENTS] += weighted * along[2];
        }
    }
    for (int c = 0; c < COEFFICIENTS; c++) {
        for (int e = 0; e <= c; e++) out->a[c][e][place] = sum_of(&sums[c][e]);
        out->b[c][place] = sum_of(&sums[c][COEFFICIENTS]);
    }
}

/* --- WIDE neighbourhoods --- */

/* Writes which of the matrices are not diagonal yet. Returns whether there is one. */
static inline bool find_open(lanes m[3][3], lane_bits *open) {
    lanes a, b, c;
    magnitude(&m[0][1], &a);
    magnitude(&m[0][2], &b);
    magnitude(&m[1][2], &c);
    *open = ~(lane_bits)(a + b + c <= 1e-16 * (m[0][0] + m[1][1] + m[2][2]));
    return ((*open)[0] | (*open)[1] | (*open)[2] | (*open)[3]) != 0;
}

/* Computes the cosine and the sine of the rotation that brio_rotate describes. */
static inline void find_angle(lanes m[3][3], int i, int j, lanes *c, lanes *s) {
    lanes theta = (m[j][j] - m[i][i]) / (2 * m[i][j]), size, length, squares = 1 + theta * theta;
    lanes one = {1, 1, 1, 1}, sign = (lanes)(((lane_bits)theta & INT64_MIN) | (lane_bits)one);
    magnitude(&theta, &size);
    root(&squares, &length);
    lanes t = sign / (size + length);
    squares = 1 + t * t;
    root(&squares, &length);
    *c = 1 / length;
    *s = t * *c;
}

/* Turns two axes as brio_rotate does, in the lanes that are open. */
static inline void rotate(lanes m[3][3], lanes v[3][3], const lane_bits *open, int i, int j) {
    lane_bits turns = *open & (lane_bits)(m[i][j] != 0);
    lanes c, s;
    find_angle(m, i, j, &c, &s);
    for (int k = 0; k < 3; k++) {
        lanes a = m[k][i], b = m[k][j], x = c * a - s * b, y = s * a + c * b;
        set_where(&turns, &x, &m[k][i]);
        set_where(&turns, &y, &m[k][j]);
    }
    for (int k = 0; k < 3; k++) {
        lanes a = m[i][k], b = m[j][k], p = v[k][i], q = v[k][j];
        lanes x = c * a - s * b, y = s * a + c * b, z = c * p - s * q, w = s * p + c * q;
        set_where(&turns, &x, &m[i][k]);
        set_where(&turns, &y, &m[j][k]);
        set_where(&turns, &z, &v[k][i]);
        set_where(&turns, &w, &v[k][j]);
    }
}

static void find_vectors(brio_eigen_batch *batch) {
    lanes m[3][3], v[3][3];
    lane_bits open;
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            m[k][l] = CONST_LANES_AT(batch->matrix[k][l], 0);
            v[k][l] = (double)(k == l) + (lanes){0};
        }
    for (int sweep = 0; sweep < SWEEPS && find_open(m, &open); sweep++) {
        rotate(m, v, &open, 0, 1);
        rotate(m, v, &open, 0, 2);
        rotate(m, v, &open, 1, 2);
    }
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            LANES_AT(batch->matrix[k][l], 0) = m[k][l];
            LANES_AT(batch->vector[k][l], 0) = v[k][l];
        }
}

/* Divides row i of the matrices by the rows before it. Keeps in *good the lanes whose matrix is positive so far. */
static inline void eliminate(lanes a[COEFFICIENTS][COEFFICIENTS], lanes *b, int i, lane_bits *good) {
    lanes diagonal = a[i][i];
    for (int j = 0; j < i; j++) {
        for (int k = 0; k < j; k++) a[i][j] -= a[i][k] * a[j][k];
        a[i][j] /= a[j][j];
        a[i][i] -= a[i][j] * a[i][j];
        b[i] -= a[i][j] * b[j];
    }
    *good &= (lane_bits)(a[i][i] > 1e-8 * diagonal);
    lanes square = a[i][i];
    root(&square, &a[i][i]);
    b[i] /= a[i][i];
}

static void solve(brio_normal_equations *e, bool *solved) {
    lanes a[COEFFICIENTS][COEFFICIENTS], b[COEFFICIENTS];
    lane_bits good = {-1, -1, -1, -1};
    for (int i = 0; i < COEFFICIENTS; i++) {
        for (int j = 0; j <= i; j++) a[i][j] = CONST_LANES_AT(e->a[i][j], 0);
        b[i] = CONST_LANES_AT(e->b[i], 0);
    }
    for (int i = 0; i < COEFFICIENTS; i++) eliminate(a, b, i, &good);
    for (int i = COEFFICIENTS; i-- > 0;) {
        for (int j = i + 1; j < COEFFICIENTS; j++) b[i] -= a[j][i] * b[j];
        b[i] /= a[i][i];
        LANES_AT(e->b[i], 0) = b[i];
    }
    for (int l = 0; l < WIDE; l++) solved[l] = good[l] != 0;
}

const brio_local_sums LOCAL_SUMS = {measure, weigh, covariance, find_vectors, equations, solve};
