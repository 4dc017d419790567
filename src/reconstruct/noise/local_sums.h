/* The arithmetic of a fit of a surface, in versions for several instruction sets. All versions compute in the same
 * order, and so compute the same bits. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SUMS_H
#define BRIO_RECONSTRUCT_LOCAL_SUMS_H

#include "reconstruct/noise/local_surface.h"

/** Symmetric matrices, one a neighbourhood, and their eigenvectors in the columns of `vector`. The last index is that
 *  of the neighbourhood. */
typedef struct {
    double matrix[3][3][BRIO_SURFACE_BATCH], vector[3][3][BRIO_SURFACE_BATCH];
} brio_eigen_batch;

/** The normal equations of polynomials, one a neighbourhood: the lower half of the matrix, and the right side. The last
 *  index is that of the neighbourhood. */
typedef struct {
    double a[BRIO_SURFACE_COEFFICIENTS][BRIO_SURFACE_COEFFICIENTS][BRIO_SURFACE_BATCH];
    double b[BRIO_SURFACE_COEFFICIENTS][BRIO_SURFACE_BATCH];
} brio_normal_equations;

typedef struct {
    /** Computes the squared distances of the neighbours. Returns the largest. */
    double (*measure)(brio_neighbourhood *n);
    /** Computes the weights of the neighbours from their squared distances and the largest of these. */
    void (*weigh)(brio_neighbourhood *n, double most);
    /** Computes the weighted covariance of the neighbours about their weighted mean, and writes it to matrix `i`. */
    void (*covariance)(const brio_neighbourhood *n, brio_eigen_batch *out, size_t i);
    /** Makes the matrices diagonal and writes the eigenvectors. */
    void (*find_vectors)(brio_eigen_batch *batch);
    /** Computes the normal equations of the weighted heights over the plane of s->frame, in s->unit, and writes them to
     *  place `i`. */
    void (*equations)(const brio_neighbourhood *n, const brio_local_surface *s, brio_normal_equations *out, size_t i);
    /** Solves the equations in place by Cholesky's method: b becomes the solution. solved[i] is false unless matrix i
     *  is clearly positive definite. */
    void (*solve)(brio_normal_equations *e, bool *solved);
} brio_local_sums;

extern const brio_local_sums brio_local_sums_plain, brio_local_sums_avx2;

#endif
