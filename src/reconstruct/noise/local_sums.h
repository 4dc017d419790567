/* The sums over a neighbourhood that a fit of a surface needs, in versions for several instruction sets. All versions add
 * in the same order, and so compute the same bits. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SUMS_H
#define BRIO_RECONSTRUCT_LOCAL_SUMS_H

#include "reconstruct/noise/local_surface.h"

/** The normal equations of a polynomial: the lower half of the matrix, and the right side. */
typedef struct {
    double a[BRIO_SURFACE_COEFFICIENTS][BRIO_SURFACE_COEFFICIENTS], b[BRIO_SURFACE_COEFFICIENTS];
} brio_normal_equations;

typedef struct {
    /** Computes the weighted covariance of the neighbours about their weighted mean. */
    void (*covariance)(const brio_neighbourhood *n, double m[3][3]);
    /** Computes the normal equations of the weighted heights over the plane of s->frame, in s->unit. */
    void (*equations)(const brio_neighbourhood *n, const brio_local_surface *s, brio_normal_equations *out);
} brio_local_sums;

extern const brio_local_sums brio_local_sums_plain, brio_local_sums_avx2;

#endif
