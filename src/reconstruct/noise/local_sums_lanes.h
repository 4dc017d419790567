/* Sums over a neighbourhood, WIDE neighbours side by side. One source file for each instruction set includes this file.
 *
 * Neighbour i is in lane i mod WIDE; at the end the lanes are added. Past the last neighbour weights are 0. */
#include "reconstruct/noise/local_sums.h"

enum { COEFFICIENTS = BRIO_SURFACE_COEFFICIENTS, WIDE = 4 };
typedef double lanes __attribute__((vector_size(8 * WIDE), aligned(8)));

_Static_assert(BRIO_MOST_NEAR % WIDE == 0, "the arrays of a neighbourhood have room for whole lanes");

#define LANES_AT(array, i) (*(const lanes *)&(array)[i])

static inline double sum_of(const lanes *x) {
    return ((*x)[0] + (*x)[1]) + ((*x)[2] + (*x)[3]);
}

static void covariance(const brio_neighbourhood *n, double m[3][3]) {
    lanes all = {0}, mean[3] = {{0}, {0}, {0}}, sums[3][3] = {{{0}}};
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes w = LANES_AT(n->weight, i);
        all += w;
        for (int k = 0; k < 3; k++) mean[k] += w * LANES_AT(n->offset[k], i);
    }
    for (int k = 0; k < 3; k++) mean[k] = sum_of(&mean[k]) / sum_of(&all) + (lanes){0};
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes w = LANES_AT(n->weight, i), d[3];
        for (int k = 0; k < 3; k++) d[k] = LANES_AT(n->offset[k], i) - mean[k];
        for (int k = 0; k < 3; k++)
            for (int l = 0; l <= k; l++) sums[k][l] += w * d[k] * d[l];
    }
    for (int k = 0; k < 3; k++)
        for (int l = 0; l <= k; l++) m[k][l] = m[l][k] = sum_of(&sums[k][l]);
}

static void equations(const brio_neighbourhood *n, const brio_local_surface *s, brio_normal_equations *out) {
    lanes sums[COEFFICIENTS][COEFFICIENTS + 1] = {{{0}}};
    double scale = 1 / s->unit;
    for (size_t i = 0; i < n->count; i += WIDE) {
        lanes d[3], along[3], one = {1, 1, 1, 1};
        for (int k = 0; k < 3; k++) d[k] = LANES_AT(n->offset[k], i);
        for (int k = 0; k < 3; k++)
            along[k] = (d[0] * s->frame[k][0] + d[1] * s->frame[k][1] + d[2] * s->frame[k][2]) * scale;
        lanes u = along[0], v = along[1], monomial[COEFFICIENTS] = {one, u, v, u * u, u * v, v * v};
        for (int c = 0; c < COEFFICIENTS; c++) {
            lanes weighted = LANES_AT(n->weight, i) * monomial[c];
            for (int e = 0; e <= c; e++) sums[c][e] += weighted * monomial[e];
            sums[c][COEFFICIENTS] += weighted * along[2];
        }
    }
    for (int c = 0; c < COEFFICIENTS; c++) {
        for (int e = 0; e <= c; e++) out->a[c][e] = sum_of(&sums[c][e]);
        out->b[c] = sum_of(&sums[c][COEFFICIENTS]);
    }
}

const brio_local_sums LOCAL_SUMS = {covariance, equations};
