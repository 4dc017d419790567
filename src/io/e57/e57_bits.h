/* Byte streams of an E57 file, decoded: numbers of 0 to 64 bits, one behind the other, least significant bit first.
 * They arrive in parts of any number of bytes, so that a number may lie in two parts or more. */
#ifndef BRIO_IO_E57_BITS_H
#define BRIO_IO_E57_BITS_H

#include "base/context.h"

/** How a number becomes a value. */
typedef enum brio_e57_kind {
    BRIO_E57_INTEGER, /* least + number */
    BRIO_E57_SCALED,  /* (least + number) * scale + offset */
    BRIO_E57_SINGLE,  /* the bits of a float */
    BRIO_E57_DOUBLE   /* the bits of a double */
} brio_e57_kind;

typedef struct brio_e57_code {
    brio_e57_kind kind;
    unsigned bits; /* of a number: 0 to 64; 32 for SINGLE, 64 for DOUBLE */
    int64_t least; /* INTEGER, SCALED */
    double scale, offset;
} brio_e57_code;

/** A byte stream and where its values go: value i to target + i * stride. */
typedef struct brio_e57_decoder {
    brio_e57_code code;
    brio_scalar type; /* of the target */
    bool tests;       /* stores 1 for each value that is not 0, in place of the value; the type is UINT8 */
    char *target;     /* NULL: values are passed over */
    size_t stride;    /* bytes */
    bool rounded;     /* whether an integer was one that no double has */
    uint64_t done, count;
    uint64_t carry; /* the first `carried` bits of a number whose rest is not there yet */
    unsigned carried;
} brio_e57_decoder;

/** Decodes the next part of a byte stream. Numbers beyond `count` are passed over.
 *  bytes  BRIO_E57_SLACK bytes behind the part may be read, too. */
void brio_e57_decode(brio_e57_decoder *d, const char *bytes, size_t size);

/** Decodes a stream of numbers of 0 bits, which has no bytes: every value is the same. */
void brio_e57_fill(brio_e57_decoder *d);

#endif
