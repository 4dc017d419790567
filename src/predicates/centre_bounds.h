/* How certain a centre has to be, and the errors of its formula. */
#ifndef BRIO_PREDICATES_CENTRE_BOUNDS_H
#define BRIO_PREDICATES_CENTRE_BOUNDS_H

/** An error of 2^-44 of the centre's distance is what doubles reach for tetrahedra of ordinary shape. */
static const double BRIO_FINE_GOAL = 0x1p-44;

/** First-order error of each expression, relative to its permanent: at most 20 roundings along a path; double-doubles
 *  80 u^2. */
static const double BRIO_DOUBLE_BOUND = 20 * 0x1p-53, BRIO_DD_BOUND = 0x1p-99;

#endif
