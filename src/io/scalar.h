/* Scalars of any type and byte order: one, or a column of many. */
#ifndef BRIO_IO_SCALAR_H
#define BRIO_IO_SCALAR_H

#include "base/context.h"

static inline bool brio_host_is_little(void) {
    return __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
}

/** The scalar at a place of any alignment.   swap  in the other byte order than this machine's. */
double brio_scalar_load(const void *bytes, brio_scalar type, bool swap);

/** Stores a value; false when the type cannot hold it (a fraction, or out of range). */
bool brio_scalar_store(void *target, brio_scalar type, double value);

/** Converts the first three scalars of each of `rows` rows that are `stride` bytes apart, to doubles without gaps. */
void brio_scalar_convert_triples(double *target, const char *source, size_t rows, size_t stride, brio_scalar type,
                                 bool swap);

/** Gathers `rows` scalars of `size` bytes that are `stride` bytes apart, and turns their bytes round if asked. */
void brio_scalar_gather(void *target, const char *source, size_t rows, size_t stride, size_t size, bool swap);

#endif
