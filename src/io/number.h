/* Numbers as text. Reading rounds correctly, as strtod does. Printed numbers read back bit for bit. Neither depends on
 * the locale of the process. */
#ifndef BRIO_IO_NUMBER_H
#define BRIO_IO_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_NUMBER_LENGTH = 32 }; /* no printed number is longer */

/** Reads the decimal number, with an exponent as of C or Fortran (1e3, 1D+3), "nan" or "inf" at *text and moves *text
 *  behind it. Returns false, and moves nothing, if there is none.   text  ends with a 0. */
bool brio_parse_number(const char **text, double *value);

/** Reads the digits at *text and moves *text behind them. Returns false, and moves nothing, if there are none or they
 *  exceed 2^64 - 1. */
bool brio_parse_count(const char **text, uint64_t *value);

/** Returns whether a number's text, of digits alone behind a sign, is a whole number that `value`, which was read from
 *  it, does not hold. */
bool brio_is_rounded(const char *text, size_t length, double value);

/** Print a number without a 0 at its end, and return its length.   text  room for BRIO_NUMBER_LENGTH bytes. */
size_t brio_print_double(char *text, double x);
size_t brio_print_float(char *text, float x);
size_t brio_print_integer(char *text, int64_t x);

#endif
