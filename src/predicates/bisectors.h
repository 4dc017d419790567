/* Where a surface meets the Voronoi diagram of samples: exact signs, ties broken by a translation of the surface.
 *
 * Let g_s(x) = |x - s|^2 - |x - a|^2, which is affine in x: positive where sample a is nearer than sample s. A point of
 * a surface is given by corners p, q, r and barycentric coordinates, so that all questions are about the values of such
 * functions at corners:
 *   - which of two samples is nearer to p: the sign of g_b(p);
 *   - which of two bisectors the line from p to q meets first: the sign of g_b(p) g_c(q) - g_b(q) g_c(p). The same
 *     three signs for the edges of a triangle are the barycentric coordinates of the point where its plane meets the
 *     Voronoi edge's line;
 *   - on which side of the bisector of a and w that point is: the sign of the determinant of g_b, g_c, g_w at p, q, r.
 *
 * Ties: the surface is moved by (e, e^2, e^3) for an infinitely small e > 0. That adds 2 (a - s) . (e, e^2, e^3) to
 * g_s, the same at each corner, so all three expressions are linear in the translation. A sign is 0 only where no
 * translation makes it another: where the line of the edge, or the Voronoi edge, is parallel to what it should meet. */
#ifndef BRIO_PREDICATES_BISECTORS_H
#define BRIO_PREDICATES_BISECTORS_H

#include <stdint.h>

/** Calls that floating-point arithmetic did not settle, and those of them that the translation decided. */
typedef struct {
    uint64_t exact, ties;
} brio_bisector_counts;

/** Returns 1 where sample a is nearer to corner p than sample b, else -1. a and b differ. */
int brio_nearer_sample(brio_bisector_counts *n, const double *a, const double *b, const double *p);

/** Returns the sign of g_b(p) g_c(q) - g_b(q) g_c(p), with g of sample a. */
int brio_bisector_order(brio_bisector_counts *n, const double *a, const double *b, const double *c, const double *p,
                        const double *q);

/** Returns the sign of the determinant whose rows are g_b, g_c, g_w at the corners of a triangle. */
int brio_bisector_side(brio_bisector_counts *n, const double *const samples[4], const double *const corners[3]);

#endif
