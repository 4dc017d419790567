/* Which of two segments is longer, exactly. */
#ifndef BRIO_PREDICATES_LENGTHS_H
#define BRIO_PREDICATES_LENGTHS_H

#include <stdint.h>

/** Returns the sign of |a - b| - |c - d|, for finite points of space.   exact  counts calls that doubles did not
 *  settle. */
int brio_compare_lengths(const double *a, const double *b, const double *c, const double *d, uint64_t *exact);

#endif
