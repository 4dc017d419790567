/* Numbers as text: read with the correctly rounded result of strtod, printed so that they read back bit for bit, both
 * without regard to the process' locale. */
#ifndef BRIO_IO_NUMBER_H
#define BRIO_IO_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_NUMBER_LENGTH = 32 }; /* no printed number is longer */

/** Reads the decimal number, "nan" or "inf" at *text and moves *text behind it; false, and nothing moved, when there is
 *  none. The text ends with a 0. */
bool brio_parse_number(const char **text, double *value);

/** Reads the digits at *text; false when there are none or they exceed 2^64 - 1. */
bool brio_parse_count(const char **text, uint64_t *value);

/** Print a number without a closing 0 and return its length. */
size_t brio_print_double(char *text, double x);
size_t brio_print_float(char *text, float x);
size_t brio_print_integer(char *text, int64_t x);

#endif
