/* Points on a common grid as integers. */
#ifndef BRIO_PREDICATES_GRID_H
#define BRIO_PREDICATES_GRID_H

#include <stdbool.h>
#include <stdint.h>

typedef __int128 brio_wide;

enum { BRIO_GRID_BITS = 41 };

/** Writes the rows p[i] - origin as integers of at most BRIO_GRID_BITS bits and, if weighted, the differences of weights
 *  in units of the grid's square, of at most twice as many bits. count is at most 4.
 *  Returns false when the points are on no such grid. */
bool brio_grid_rows(const double *const *p, int count, const double *origin, bool weighted, int64_t (*row)[3],
                    brio_wide *weight);

/** Returns the number of bits of the greatest magnitude in the rows. */
int brio_grid_bits(const int64_t (*row)[3], int count);

#endif
