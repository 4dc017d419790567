/* Barycentric coordinates in simplices so flat that rounding makes their volumes meaningless. */
#ifndef BRIO_BASE_FLAT_SHARES_H
#define BRIO_BASE_FLAT_SHARES_H

/** The square of what shares may miss the query by, as part of the square of the largest offset. Chosen: far above the
 *  rounding of offsets, far below what the values of a user tell apart. */
#define BRIO_SHARES_NEAR 0x1p-80

/** Returns whether sum share[i] row[i] is 0 up to 2^-40 of the largest row. False if a share is NaN.
 *  row  the offsets of `count` vertices from the query. */
int brio_shares_hold(const double (*row)[3], int count, const double *share);

/** Sets share to numbers that are at least 0 and sum to 1, such that sum share[i] row[i] is as near to 0 as it can be
 *  with the projections of the query to a triangle, an edge or a vertex of the simplex.
 *  zeros  bit i: share[i] is to be 0. Not all bits are set. */
void brio_flat_shares(const double (*row)[3], int count, unsigned zeros, double *share);

#endif
