/* brio/predicates.h: predicates, exact for all finite doubles. Points are 3 doubles each, in the plane 2. */
#ifndef BRIO_PREDICATES_H
#define BRIO_PREDICATES_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Returns the sign (-1, 0, 1) of det [b-a, c-a, d-a]. */
BRIO_API int brio_orient3d(const double *a, const double *b, const double *c, const double *d);

/** Returns the sign of the in-sphere determinant: for a positive tetrahedron (a, b, c, d) it is 1 if e is inside the
 *  sphere through a, b, c, d, -1 if e is outside, 0 if e is on it; for a negative tetrahedron the opposite.
 *  weights  NULL, or the weights of a, b, c, d, e: then the orthosphere takes the sphere's place (power test). */
BRIO_API int brio_insphere(const double *a, const double *b, const double *c, const double *d, const double *e,
                           const double *weights);

/** Returns what brio_insphere returns, with ties broken by the symbolic perturbation: never 0. The tetrahedron must be
 *  positive and e must be none of its vertices. */
BRIO_API int brio_insphere_perturbed(const double *a, const double *b, const double *c, const double *d,
                                     const double *e, const double *weights);

/** Computes the circumcentre of a tetrahedron that is not flat or, with 4 weights, its orthocentre. The result has the
 *  same bits for every order of the four points.   weights  4, or NULL.
 *  error  NULL, or receives a bound on the error of each coordinate: at most 2^-44 times the distance from the centre
 *         to the lexicographically first of the points, plus one rounding. Where doubles do not reach that bound, the
 *         computation uses higher precision.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT for a flat tetrahedron or a centre that doubles cannot hold. */
BRIO_API brio_status brio_circumcentre(const double *a, const double *b, const double *c, const double *d,
                                       const double *weights, double *centre, double *error);

/* In the plane; points are 2 doubles each. */

/** Returns the sign of det [b-a, c-a]: 1 when the triangle (a, b, c) is counterclockwise, 0 when it is flat. */
BRIO_API int brio_orient2d(const double *a, const double *b, const double *c);

/** Returns the sign of the in-circle determinant: for a counterclockwise triangle (a, b, c) it is 1 if d is inside the
 *  circle through a, b, c, -1 if d is outside, 0 if d is on it; for a clockwise triangle the opposite.
 *  weights  NULL, or the weights of a, b, c, d: then the orthocircle takes the circle's place (power test). */
BRIO_API int brio_incircle(const double *a, const double *b, const double *c, const double *d, const double *weights);

/** Returns what brio_incircle returns, with ties broken by the symbolic perturbation: never 0. The triangle must be
 *  counterclockwise and d must be none of its vertices. */
BRIO_API int brio_incircle_perturbed(const double *a, const double *b, const double *c, const double *d,
                                     const double *weights);

#ifdef __cplusplus
}
#endif
#endif
