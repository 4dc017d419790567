/* Circumcentres and orthocentres with an error bound. */
#ifndef BRIO_PREDICATES_CIRCUMCENTRE_H
#define BRIO_PREDICATES_CIRCUMCENTRE_H

#include <stdbool.h>

/** Centre of the sphere through four records, or of their orthosphere: the point of equal power distance to all four.
 *  The same bits for every order of the four. *error bounds the error of each coordinate (see brio_circumcentre). False
 *  for a flat tetrahedron, or a centre that doubles cannot hold. */
bool brio_centre(const double *a, const double *b, const double *c, const double *d, bool weighted, double centre[3],
                 double *error);

enum { BRIO_CENTRES = 4 };

/** Several centres without weights, each of its four records of coordinates at most 1, to 2^-30 of its distance to the lexicographically first
 *  record, plus one rounding; centre[n][0] is NaN and error[n] infinite where there is none. Sorts the p[n]. The bits of
 *  each depend on nothing else. */
void brio_rough_centres(const double *p[BRIO_CENTRES][4], double (*centre)[3], double *error);

#endif
