/* Weighted means of rows of values. */
#ifndef BRIO_BASE_WEIGHTED_MEAN_H
#define BRIO_BASE_WEIGHTED_MEAN_H

#include <stddef.h>
#include <stdint.h>

/** What a mean is made of: shares that are at least 0 and whose sum is 1 up to rounding. */
typedef struct brio_weighted_mean {
    const double *values;  /* #rows by components */
    size_t components;     /* numbers of a row */
    const uint32_t *place; /* #count: a row; with `name`, a place in it */
    const uint32_t *name;  /* of each place, its row; NULL: a place is a row */
    const double *share;   /* #count */
    size_t count;
} brio_weighted_mean;

/** Writes the mean of the rows. Each number is between the least and the greatest of those with a share; it is NaN if
 *  one of them is, or if they are infinite with both signs.   mean  receives `components` numbers. */
void brio_weighted_means(const brio_weighted_mean *m, double *mean);

#endif
