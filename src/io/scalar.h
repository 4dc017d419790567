/* Scalars of any type and byte order: single ones, and columns of them. */
#ifndef BRIO_IO_SCALAR_H
#define BRIO_IO_SCALAR_H

#include "base/context.h"

static inline bool brio_host_is_little(void) {
    return __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
}

/** Returns the scalar at an address of any alignment.   swap  the scalar is in the other byte order than this
 *  machine's. */
double brio_scalar_load(const void *bytes, brio_scalar type, bool swap);

/** Stores a value. Returns false if the type cannot hold it: a fraction in an integer type, or out of range. */
bool brio_scalar_store(void *target, brio_scalar type, double value);

/** Converts the first three scalars of each row to doubles, written one after the other. There are `rows` rows,
 *  `stride` bytes apart. */
void brio_scalar_convert_triples(double *target, const char *source, size_t rows, size_t stride, brio_scalar type,
                                 bool swap);

/** Copies `rows` scalars of `size` bytes that are `stride` bytes apart to an array, and with `swap` reverses their
 *  bytes. */
void brio_scalar_gather(void *target, const char *source, size_t rows, size_t stride, size_t size, bool swap);

#endif
