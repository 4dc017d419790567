/* Numbers as text, correctly rounded both ways.
 *
 * A decimal number is w * 10^e with an integer w of up to 19 digits. If w and 10^|e| are doubles, one multiplication or
 * division rounds once and is the answer. Otherwise, for |e| <= 27, 5^|e| fits in 64 bits: w * 5^e, or w / 5^-e with
 * its remainder, is computed in 128-bit integers and rounded once. All other numbers (longer mantissas, larger
 * exponents) go to strtod in the C locale.
 *
 * Printing uses the same integers. 17 digits identify a double, 9 a float; one or two digits fewer are printed if they
 * read back as the same number.
 *
 * Based on: Clinger. How to read floating point numbers accurately. PLDI 1990. */
#include "io/number.h"
#include "base/wide.h"
#include "platform/number.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* MAX_DIGITS: 10^19 < 2^64. MAX_POWER: 5^27 < 2^64. EXACT_POWER: 10^22 is a double, 10^23 is not. FAR_EXPONENT: chosen,
 * so that no int overflows; strtod decides beyond it. LONGEST_D: of a number with Fortran's exponent, if strtod has to
 * decide; chosen. */
enum { MAX_DIGITS = 19, MAX_POWER = 27, EXACT_POWER = 22, FAR_EXPONENT = 100000, LONGEST_D = 512 };

/* clang-format off */
static const uint64_t powers_of_5[MAX_POWER + 1] = {
    1, 5, 25, 125, 625, 3125, 15625, 78125, 390625, 1953125, 9765625, 48828125, 244140625, 1220703125, 6103515625,
    30517578125, 152587890625, 762939453125, 3814697265625, 19073486328125, 95367431640625, 476837158203125,
    2384185791015625, 11920928955078125, 59604644775390625, 298023223876953125, 1490116119384765625,
    7450580596923828125};
/* clang-format on */

static const double powers_of_10[EXACT_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                     1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                     1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static bool is_digit(char c) {
    return (unsigned)(c - '0') < 10;
}

/* --- reading --- */

/* Returns w * 10^power for 0 <= power <= MAX_POWER. The product is exact in 128 bits; of its lower half only matters
 * whether it is 0. */
static double rounded_product(uint64_t w, int power) {
    uint64_t high, low = brio_multiply_add(w, powers_of_5[power], 0, 0, &high);
    if (high == 0) return ldexp((double)low, power);
    int lift = __builtin_clzll(high);
    uint64_t lifted = lift ? high << lift | low >> (64 - lift) : high, sticky = low << lift != 0;
    return ldexp((double)(lifted | sticky), 64 - lift + power);
}

/* Returns w / 10^power for 0 < power <= MAX_POWER. The quotient has 63 or 64 bits; its last bit also records a
 * remainder. */
static double rounded_quotient(uint64_t w, int power) {
    uint64_t divisor = powers_of_5[power];
    int lift_w = __builtin_clzll(w), lift_d = __builtin_clzll(divisor);
    divisor <<= lift_d;
    uint64_t dividend = w << lift_w, remainder;
    uint64_t quotient = brio_divide_wide(dividend >> 1, dividend << 63, divisor, &remainder), sticky = remainder != 0;
    return ldexp((double)(quotient | sticky), lift_d - lift_w - 63 - power);
}

/* Computes w * 10^power, correctly rounded. Returns false where the integers do not suffice. */
static bool compose(uint64_t w, int power, double *value) {
    if (w == 0) {
        *value = 0;
    } else if (w >> 53 == 0 && power >= -EXACT_POWER && power <= EXACT_POWER) {
        *value = power < 0 ? (double)w / powers_of_10[-power] : (double)w * powers_of_10[power];
    } else if (power >= 0 && power <= MAX_POWER) {
        *value = rounded_product(w, power);
    } else if (power < 0 && power >= -MAX_POWER) {
        *value = rounded_quotient(w, -power);
    } else {
        return false;
    }
    return true;
}

typedef struct {
    uint64_t mantissa; /* the first MAX_DIGITS significant digits */
    int digits;        /* number of significant digits, at most MAX_DIGITS + 1 */
    int power;         /* the number is mantissa * 10^power */
} decimal;

static const char *scan_digits(const char *p, decimal *d, bool fraction) {
    for (; is_digit(*p); p++) {
        if (d->digits || *p != '0') {
            if (d->digits < MAX_DIGITS) d->mantissa = d->mantissa * 10 + (uint64_t)(*p - '0');
            if (d->digits <= MAX_DIGITS) d->digits++;
        }
        if (fraction && d->power > -FAR_EXPONENT) d->power--;
    }
    return p;
}

static const char *scan_exponent(const char *p, decimal *d) {
    const char *q = p + 1;
    bool negative = *q == '-';
    q += *q == '-' || *q == '+';
    if (!is_digit(*q)) return p;
    int exponent = 0;
    for (; is_digit(*q); q++)
        if (exponent < FAR_EXPONENT) exponent = exponent * 10 + (*q - '0');
    d->power += negative ? -exponent : exponent;
    return q;
}

/* Returns the place behind the number at p, or NULL if there is none. */
static const char *scan_decimal(const char *p, decimal *d) {
    const char *start = p;
    p = scan_digits(p, d, false);
    size_t seen = (size_t)(p - start);
    if (*p == '.') {
        const char *point = p;
        p = scan_digits(p + 1, d, true);
        seen += (size_t)(p - point) - 1;
    }
    if (!seen) return NULL;
    return *p == 'e' || *p == 'E' || *p == 'd' || *p == 'D' ? scan_exponent(p, d) : p;
}

static const char *scan_word(const char *p, double *value) {
    if (!strncasecmp(p, "nan", 3)) {
        *value = (double)NAN;
        return p + 3;
    }
    if (strncasecmp(p, "inf", 3) != 0) return NULL;
    *value = (double)INFINITY;
    return p + (strncasecmp(p, "infinity", 8) ? 3 : 8);
}

/* Copies a number with the E of C in the place of Fortran's D. Returns false if the number is too long for that. */
static bool copy_with_e(const char *text, const char *end, char copy[LONGEST_D]) {
    size_t length = (size_t)(end - text);
    if (length >= LONGEST_D) return false;
    for (size_t i = 0; i < length; i++) copy[i] = text[i] == 'd' || text[i] == 'D' ? 'e' : text[i];
    copy[length] = 0;
    return true;
}

bool brio_parse_number(const char **text, double *value) {
    const char *p = *text;
    bool negative = *p == '-';
    p += *p == '-' || *p == '+';
    decimal d = {0, 0, 0};
    const char *end = scan_decimal(p, &d);
    if (!end) {
        end = scan_word(p, value);
        if (!end) return false;
    } else if (d.digits > MAX_DIGITS || !compose(d.mantissa, d.power, value)) {
        char copy[LONGEST_D];
        bool fortran = memchr(p, 'd', (size_t)(end - p)) || memchr(p, 'D', (size_t)(end - p));
        if (fortran && !copy_with_e(p, end, copy)) return false;
        *value = brio_number_of_text(fortran ? copy : p);
    }
    if (negative) *value = -*value;
    *text = end;
    return true;
}

bool brio_parse_count(const char **text, uint64_t *value) {
    const char *p = *text;
    uint64_t sum = 0;
    if (!is_digit(*p)) return false;
    for (; is_digit(*p); p++)
        if (__builtin_mul_overflow(sum, 10, &sum) || __builtin_add_overflow(sum, (uint64_t)(*p - '0'), &sum))
            return false;
    *value = sum;
    *text = p;
    return true;
}

bool brio_is_rounded(const char *text, size_t length, double value) {
    const char *p = text + (*text == '-' || *text == '+'), *end = text + length;
    uint64_t digits;
    if (!(fabs(value) >= 0x1p53) || !is_digit(*p)) return false;
    bool held = brio_parse_count(&p, &digits);
    if (held) return p == end && !(fabs(value) < 0x1p64 && (uint64_t)fabs(value) == digits);
    while (is_digit(*p)) p++;
    return p == end;
}

/* --- printing --- */

static uint64_t power_of_10(int n) {
    return powers_of_5[n] << n;
}

/* Returns high 2^64 + low divided by 2^shift, rounded half to even; 0 < shift < 128, and the result is below 2^63. */
static uint64_t rounded_shift(uint64_t high, uint64_t low, int shift) {
    if (shift > 64) { /* what is below only matters as being 0 or not */
        low = high << (128 - shift) | (low != 0);
        high >>= shift - 64;
        shift = 64;
    }
    uint64_t whole = shift < 64 ? high << (64 - shift) | low >> shift : high, rest = low << (64 - shift) % 64;
    uint64_t half = UINT64_C(1) << 63;
    return whole + (rest > half || (rest == half && (whole & 1)));
}

/* Returns x * 10^power, rounded half to even, for x > 0 and a result below 2^62. */
static uint64_t scaled(double x, int power) {
    int exponent;
    uint64_t mantissa = (uint64_t)ldexp(frexp(x, &exponent), 53);
    int shift = exponent - 53 + power;
    uint64_t high, low = brio_multiply_add(mantissa, powers_of_5[power], 0, 0, &high);
    return shift >= 0 ? low << shift : rounded_shift(high, low, -shift);
}

/* Returns what digits_of does, from text that the C library prints. Takes the text apart because its decimal point
 * depends on the locale. */
static uint64_t digits_far(double x, int count, int *exponent) {
    char text[64];
    uint64_t digits = 0;
    snprintf(text, sizeof text, "%.*e", count - 1, x);
    const char *p = text;
    for (; *p && *p != 'e'; p++)
        if (is_digit(*p)) digits = digits * 10 + (uint64_t)(*p - '0');
    *exponent = *p ? atoi(p + 1) : 0;
    return digits;
}

/* Returns the first `count` digits of x > 0, rounded. The first digit is worth 10^*exponent. */
static uint64_t digits_of(double x, int count, int *exponent) {
    int binary;
    frexp(x, &binary);
    int guess = (int)floor((binary - 1) * 0.30102999566398120); /* log10(2): the guess is right or one too low */
    for (int e = guess; e <= guess + 2; e++) {
        int power = count - 1 - e;
        if (power < 0 || power > MAX_POWER) break;
        uint64_t digits = scaled(x, power);
        if (digits < power_of_10(count)) {
            *exponent = e;
            return digits;
        }
    }
    return digits_far(x, count, exponent);
}

/* Writes n digits, the first worth 10^exponent, as text. Returns the length. */
static size_t layout(char *text, const char *digits, int n, int exponent) {
    char *p = text;
    if (exponent < -5 || exponent > 16) {
        *p++ = digits[0];
        if (n > 1) {
            *p++ = '.';
            memcpy(p, digits + 1, (size_t)n - 1);
            p += n - 1;
        }
        *p++ = 'e';
        return (size_t)(p - text) + brio_print_integer(p, exponent);
    }
    if (exponent < 0) {
        *p++ = '0';
        *p++ = '.';
        for (int i = -1; i > exponent; i--) *p++ = '0';
    }
    for (int i = 0; i < n || i <= exponent; i++) {
        *p++ = i < n ? digits[i] : '0';
        if (i == exponent && i + 1 < n) *p++ = '.';
    }
    return (size_t)(p - text);
}

static bool reads_back(uint64_t digits, int power, double x, bool single) {
    double back;
    if (!compose(digits, power, &back)) {
        char text[64];
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)digits, power);
        back = brio_number_of_text(text);
    }
    return single ? (float)back == (float)x : back == x;
}

static size_t print_positive(char *text, double x, bool single) {
    int exponent, count = single ? 9 : 17;
    uint64_t digits = digits_of(x, count, &exponent);
    uint64_t fifteen = (digits + 50) / 100, sixteen = (digits + 5) / 10; /* for a float: 7 and 8 digits */
    if (reads_back(fifteen, exponent - (count - 3), x, single))
        digits = fifteen * 100;
    else if (reads_back(sixteen, exponent - (count - 2), x, single))
        digits = sixteen * 10;
    if (digits == power_of_10(count)) {
        digits /= 10;
        exponent++;
    }
    char figures[BRIO_NUMBER_LENGTH];
    int n = count;
    while (n > 1 && digits % 10 == 0) {
        digits /= 10;
        n--;
    }
    for (int i = n; i-- > 0; digits /= 10) figures[i] = (char)('0' + digits % 10);
    return layout(text, figures, n, exponent);
}

static size_t print_number(char *text, double x, bool single) {
    size_t sign = signbit(x) && !isnan(x);
    if (sign) *text++ = '-';
    if (isnan(x) || isinf(x)) {
        memcpy(text, isnan(x) ? "nan" : "inf", 3);
        return sign + 3;
    }
    if (x == 0) {
        *text = '0';
        return sign + 1;
    }
    return sign + print_positive(text, fabs(x), single);
}

size_t brio_print_double(char *text, double x) {
    return print_number(text, x, false);
}
size_t brio_print_float(char *text, float x) {
    return print_number(text, (double)x, true);
}

size_t brio_print_integer(char *text, int64_t x) {
    char reversed[BRIO_NUMBER_LENGTH];
    size_t n = 0, sign = x < 0;
    uint64_t rest = sign ? 0 - (uint64_t)x : (uint64_t)x;
    do reversed[n++] = (char)('0' + rest % 10);
    while (rest /= 10);
    if (sign) *text++ = '-';
    for (size_t i = 0; i < n; i++) text[i] = reversed[n - 1 - i];
    return sign + n;
}
