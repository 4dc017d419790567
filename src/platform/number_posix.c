/* The locale of C is a constant of the C library: newlocale allocates nothing. WASI has this locale alone. */
#define _GNU_SOURCE
#include "platform/number.h"
#include <locale.h>
#include <stdlib.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

double brio_number_of_text(const char *text) {
#ifdef __wasi__
    return strtod(text, NULL);
#else
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    double value = c ? strtod_l(text, NULL, c) : strtod(text, NULL);
    if (c) freelocale(c);
    return value;
#endif
}
