/* Numbers as text: the same bits as strtod, and back. */
#include "io/number.h"
#include "io_files.h"
#include <locale.h>

static void expect_as_strtod(const char *text) {
    const char *p = text;
    double value = 0, expected = strtod(text, NULL);
    EXPECT(brio_parse_number(&p, &value), "\"%s\"", text);
    EXPECT(!memcmp(&value, &expected, sizeof value), "\"%s\": %a, expected %a", text, value, expected);
    EXPECT(!*p, "\"%s\" leaves \"%s\"", text, p);
}

static void parse_known_numbers(void) {
    static const char *const texts[] = {"0",
                                        "-0",
                                        "+1",
                                        "1.",
                                        ".5",
                                        "-.5e1",
                                        "1e22",
                                        "1e23",
                                        "123456789012345678",
                                        "9007199254740993",
                                        "9007199254740992.5",
                                        "18446744073709551615",
                                        "0.1",
                                        "1e-27",
                                        "9999999999999999999e27",
                                        "9999999999999999999e-27",
                                        "2.2250738585072011e-308",
                                        "4.9e-324",
                                        "2e-324",
                                        "1.7976931348623158e308",
                                        "1e400",
                                        "-1e400",
                                        "0e99999999999",
                                        "1e-99999999999",
                                        "00000000000000000000001.5",
                                        "0.00000000000000000000000000000000000000000015e40",
                                        "179769313486231580793728971405301e276",
                                        "1.00000000000000011102230246251565",
                                        "1.000000000000000111022302462515654042363166809082031249",
                                        "8.5e0",
                                        "7E+2",
                                        "7E-2"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) expect_as_strtod(texts[i]);
}

static void parse_random_decimals(void) {
    uint64_t state = 1;
    for (int i = 0; i < 100000; i++) {
        char text[80], *p = text;
        int digits = 1 + (int)(io_random(&state) % 21), point = (int)(io_random(&state) % 24);
        for (int k = 0; k < digits; k++) {
            if (k == point) *p++ = '.';
            *p++ = (char)('0' + io_random(&state) % 10);
        }
        *p = 0;
        if (io_random(&state) % 2) sprintf(p, "e%d", (int)(io_random(&state) % 80) - 40);
        expect_as_strtod(text);
    }
}

/* Decimals of the midpoints between doubles: one unit in their last place decides. */
static void parse_midpoints(void) {
    uint64_t state = 2;
    for (int i = 0; i < 20000; i++) {
        uint64_t mantissa = (UINT64_C(1) << 53) | io_random(&state) % (UINT64_C(1) << 53);
        char text[80];
        snprintf(text, sizeof text, "%llu", (unsigned long long)(mantissa * 2 + 1));
        expect_as_strtod(text);
        snprintf(text, sizeof text, "%llu.0001", (unsigned long long)(mantissa * 2 + 1));
        expect_as_strtod(text);
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)(mantissa * 2 + 1), (int)(i % 60) - 30);
        expect_as_strtod(text);
    }
}

static void parse_words(void) {
    static const char *const nans[] = {"nan", "NaN", "-NAN"}, *const others[] = {"",  "-",   ".",   "e5",
                                                                                 "x", "+-1", "--1", "in"};
    double value;
    for (size_t i = 0; i < 3; i++) {
        const char *p = nans[i];
        EXPECT(brio_parse_number(&p, &value) && isnan(value) && !*p, "%s", nans[i]);
    }
    const char *p = "-Infinity";
    EXPECT(brio_parse_number(&p, &value) && value == -HUGE_VAL && !*p);
    p = "inf,";
    EXPECT(brio_parse_number(&p, &value) && value == HUGE_VAL && *p == ',');
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        p = others[i];
        EXPECT(!brio_parse_number(&p, &value) && p == others[i], "\"%s\"", others[i]);
    }
}

/* What follows a number stays: hexadecimal numbers and half exponents are none. */
static void parse_stops_where_the_number_ends(void) {
    static const char *const texts[][2] = {
        {"0x10", "x10"}, {"1e", "e"}, {"1e+", "e+"}, {"1.5.5", ".5"}, {"12abc", "abc"}};
    double value;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const char *p = texts[i][0];
        EXPECT(brio_parse_number(&p, &value) && !strcmp(p, texts[i][1]), "%s leaves %s", texts[i][0], p);
    }
}

static void parse_counts(void) {
    uint64_t count = 0;
    const char *p = "18446744073709551615 ";
    EXPECT(brio_parse_count(&p, &count) && count == UINT64_MAX && *p == ' ');
    p = "18446744073709551616";
    EXPECT(!brio_parse_count(&p, &count));
    p = "-1";
    EXPECT(!brio_parse_count(&p, &count));
}

static void expect_prints_back(double x) {
    char text[BRIO_NUMBER_LENGTH + 1];
    size_t length = brio_print_double(text, x);
    EXPECT(length <= BRIO_NUMBER_LENGTH, "%zu characters", length);
    text[length] = 0;
    double back = strtod(text, NULL);
    EXPECT(!memcmp(&back, &x, sizeof x), "%a printed as %s", x, text);
}

static void print_any_double(void) {
    uint64_t state = 3;
    static const double special[] = {0.0,
                                     -0.0,
                                     1,
                                     0.1,
                                     1e16,
                                     1e17,
                                     1e-5,
                                     1e-6,
                                     123456789,
                                     0x1p-1074,
                                     0x1.fffffffffffffp1023,
                                     9007199254740993.0,
                                     99999999999999990.0,
                                     9.9999999999999995e22,
                                     1.0 / 3,
                                     1e23};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++) expect_prints_back(special[i]);
    for (int i = 0; i < 50000; i++) {
        expect_prints_back(io_random_double(&state));
        double x = ldexp((double)io_random(&state), -(int)(io_random(&state) % 90));
        expect_prints_back(-x);
        expect_prints_back(nextafter(1 + (double)(i % 1000) / 1000, 9));
    }
}

static void print_any_float(void) {
    uint64_t state = 4;
    for (int i = 0; i < 50000; i++) {
        uint32_t bits = (uint32_t)io_random(&state);
        float x, back;
        memcpy(&x, &bits, sizeof x);
        if (!isfinite(x)) continue;
        char text[BRIO_NUMBER_LENGTH + 1];
        text[brio_print_float(text, x)] = 0;
        back = strtof(text, NULL);
        EXPECT(!memcmp(&back, &x, sizeof x), "%a printed as %s", (double)x, text);
    }
}

static void print_short_where_it_is_enough(void) {
    static const struct {
        double x;
        const char *text;
    } cases[] = {{0.1, "0.1"},   {-2.5, "-2.5"},       {1e16, "10000000000000000"},
                 {1e17, "1e17"}, {0.00001, "0.00001"}, {1.5e-7, "1.5e-7"},
                 {100, "100"},   {1e300, "1e300"},     {-0.0, "-0"},
                 {0.3, "0.3"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[BRIO_NUMBER_LENGTH + 1];
        text[brio_print_double(text, cases[i].x)] = 0;
        EXPECT(!strcmp(text, cases[i].text), "%s, expected %s", text, cases[i].text);
    }
}

static void print_integers(void) {
    char text[BRIO_NUMBER_LENGTH + 1];
    text[brio_print_integer(text, INT64_MIN)] = 0;
    EXPECT(!strcmp(text, "-9223372036854775808"), "%s", text);
    text[brio_print_integer(text, 0)] = 0;
    EXPECT(!strcmp(text, "0"), "%s", text);
}

/* The decimal point is a point, whatever the locale of the process says. */
static void ignore_the_locale(void) {
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    bool found = false;
    for (size_t i = 0; i < 4 && !found; i++) found = setlocale(LC_ALL, names[i]) != NULL;
    double value = 0;
    const char *p = "1.00000000000000011102230246251566";
    EXPECT(brio_parse_number(&p, &value) && value > 1 && !*p);
    char text[BRIO_NUMBER_LENGTH + 1];
    text[brio_print_double(text, 1.5e-300)] = 0;
    EXPECT(!strcmp(text, "1.5e-300"), "%s", text);
    setlocale(LC_ALL, "C");
    if (!found) fprintf(stderr, "       (no locale with a decimal comma here)\n");
}

SUITE(test_io_number) {
    io_begin();
    RUN(parse_known_numbers);
    RUN(parse_random_decimals);
    RUN(parse_midpoints);
    RUN(parse_words);
    RUN(parse_stops_where_the_number_ends);
    RUN(parse_counts);
    RUN(print_any_double);
    RUN(print_any_float);
    RUN(print_short_where_it_is_enough);
    RUN(print_integers);
    RUN(ignore_the_locale);
    return io_end();
}
