/* Numbers of text by the C library of Windows, with a locale for the call. */
#include "platform/number.h"
#include <locale.h>
#include <stdlib.h>

double brio_number_of_text(const char *text) {
    _locale_t c = _create_locale(LC_ALL, "C");
    double value = c ? _strtod_l(text, NULL, c) : strtod(text, NULL);
    if (c) _free_locale(c);
    return value;
}
