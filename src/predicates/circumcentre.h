/* Circumcentres and orthocentres with an error bound. */
#ifndef BRIO_PREDICATES_CIRCUMCENTRE_H
#define BRIO_PREDICATES_CIRCUMCENTRE_H

#include <stdbool.h>

/** Centre of the sphere through four records, or of their orthosphere: the point of equal power distance to all four.
 *  The same bits for every order of the four. *error bounds the error of each coordinate (see brio_circumcentre). False
 *  for a flat tetrahedron, or a centre that doubles cannot hold. */
bool brio_centre(const double *a, const double *b, const double *c, const double *d, bool weighted, double centre[3],
                 double *error);

#endif
