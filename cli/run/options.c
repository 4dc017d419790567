/* The command line's options, by tables.
 *
 * One pass over the arguments: `--name value`, `--name=value`, `-x value`, `-xvalue`. An option that needs a value
 * takes the next argument unless that looks like an option itself; negative numbers and `-` are values. An option that
 * may stand without a value takes the next argument if that is a number. The last of repeated options counts. */
#include "cli/run/options.h"
#include "brio/brio.h"
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool wrong(option_parse *parse, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool wrong(option_parse *parse, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(parse->message, sizeof parse->message, format, arguments);
    va_end(arguments);
    return false;
}

/* --- values --- */

static bool parse_int(const char *text, int *value) {
    char *end;
    if (isspace((unsigned char)*text)) return false;
    errno = 0;
    long number = strtol(text, &end, 10);
    if (end == text || *end || errno || number < INT_MIN || number > INT_MAX) return false;
    *value = (int)number;
    return true;
}

static bool parse_number(const char *text, double *value) {
    char *end;
    if (isspace((unsigned char)*text)) return false;
    *value = strtod(text, &end);
    return end != text && !*end && isfinite(*value);
}

/* Digits give all 64 bits; anything else must be a whole number that a double holds exactly. */
static bool parse_natural(const char *text, uint64_t *value) {
    if (text[0] && text[strspn(text, "0123456789")] == 0) {
        errno = 0;
        *value = strtoull(text, NULL, 10);
        return errno == 0;
    }
    double number;
    if (!parse_number(text, &number) || number < 0 || number > 0x1p53 || number != floor(number)) return false;
    *value = (uint64_t)number;
    return true;
}

bool cli_parse_size(const char *text, size_t *bytes) {
    static const char prefixes[] = "KMGTP";
    char *end;
    double number = strtod(text, &end);
    if (end == text || !(number >= 0)) return false;
    double base = 1024;
    int power = 0;
    const char *prefix = *end ? strchr(prefixes, *end & ~0x20) : NULL;
    if (prefix && *prefix) {
        power = (int)(prefix - prefixes) + 1;
        end++;
        if (!strcasecmp(end, "B")) base = 1000;
        if (!strcasecmp(end, "B") || !strcasecmp(end, "iB")) end += strlen(end);
    } else if (!strcasecmp(end, "B")) {
        end++;
    }
    number *= pow(base, power);
    if (*end || !(number < 0x1p63)) return false;
    *bytes = (size_t)number;
    return true;
}

bool cli_has_choices(const option *row) {
    return row->kind == OPTION_CHOICE || row->kind == OPTION_METHOD;
}

/* Methods come first: those whose surface is through the points. */
option_choice cli_choice(const option *row, size_t i, const char **words) {
    if (words) *words = NULL;
    for (int m = 0; row->kind == OPTION_METHOD && m < BRIO_SURFACE_END; m++) {
        const brio_surface_method_info *info = brio_surface_method_facts((brio_surface_method)m);
        if (info->traits & BRIO_METHOD_AT_DISTANCE || i-- > 0) continue;
        if (words) *words = info->words;
        return (option_choice){info->name, m};
    }
    for (const option_choice *c = row->choices; c->name; c++)
        if (i-- == 0) return *c;
    return (option_choice){NULL, 0};
}

const char *cli_choice_name(const void *row, size_t i) {
    return cli_choice(row, i, NULL).name;
}

void cli_list_words(const char *(*next)(const void *list, size_t i), const void *list, char *text, size_t size) {
    size_t used = 0;
    const char *word, *after;
    for (size_t i = 0; used < size && (word = next(list, i)); i++) {
        after = next(list, i + 1);
        int length = snprintf(text + used, size - used, "%s%s", i == 0 ? "" : after ? ", " : " or ", word);
        used += length > 0 ? (size_t)length : 0;
    }
}

static bool parse_choice(option_parse *parse, const option *row, const char *text, int *value) {
    option_choice c;
    for (size_t i = 0; (c = cli_choice(row, i, NULL)).name; i++) {
        if (strcmp(c.name, text)) continue;
        *value = c.value;
        return true;
    }
    char names[256] = "";
    cli_list_words(cli_choice_name, row, names, sizeof names);
    const char *near = cli_nearest(text, cli_choice_name, row);
    if (near)
        return wrong(parse, "--%s: unknown name '%s', expected %s; did you mean '%s'?", row->name, text, names, near);
    return wrong(parse, "--%s: unknown name '%s', expected %s", row->name, text, names);
}

static bool is_text(option_kind kind) {
    return kind == OPTION_TEXT || kind == OPTION_INPUT || kind == OPTION_OUTPUT;
}

/* Reads a number; what was expected, where the text is none. `above` is whether it is more than 0. */
static const char *parse_value(option_kind kind, const char *text, void *field, bool *above) {
    const char *expected = NULL;
    *above = false;
    switch (kind) {
    case OPTION_INT:
        expected = parse_int(text, field) ? NULL : "a whole number";
        *above = !expected && *(const int *)field > 0;
        break;
    case OPTION_NATURAL:
        expected = parse_natural(text, field) ? NULL : "a whole number, 0 or more (above 2^53: with all its digits)";
        *above = !expected && *(const uint64_t *)field > 0;
        break;
    case OPTION_NUMBER:
        expected = parse_number(text, field) ? NULL : "a finite number";
        *above = !expected && *(const double *)field > 0;
        break;
    case OPTION_SIZE:
        expected = cli_parse_size(text, field) ? NULL : "a size such as 500M or 8G";
        *above = !expected && *(const size_t *)field > 0;
        break;
    default:
        break;
    }
    return expected;
}

static bool store(option_parse *parse, const option *row, void *field, const char *text) {
    if (cli_has_choices(row)) return parse_choice(parse, row, text, field);
    if (is_text(row->kind)) {
        *(const char **)field = text;
        return true;
    }
    bool above;
    const char *expected = parse_value(row->kind & ~(OPTION_POSITIVE | OPTION_OPTIONAL), text, field, &above);
    if (expected) return wrong(parse, "--%s: '%s' is not %s", row->name, text, expected);
    if (row->kind & OPTION_POSITIVE && !above) return wrong(parse, "--%s: '%s' is not above 0", row->name, text);
    return true;
}

/* --- names --- */

bool cli_is_option(const option *row) {
    return row->kind != OPTION_TITLE && row->kind != OPTION_NOTE;
}

typedef struct found {
    const option *row;
    void *field;
} found;

static found find(const option_parse *parse, const char *name, size_t length, char letter) {
    for (size_t g = 0; g < parse->num_groups; g++)
        for (const option *row = parse->groups[g].rows; row->kind; row++) {
            if (!cli_is_option(row)) continue;
            bool is_long = name && strlen(row->name) == length && !memcmp(row->name, name, length);
            if (is_long || (letter && row->letter == letter))
                return (found){row, (char *)parse->groups[g].values + row->offset};
        }
    return (found){NULL, NULL};
}

static const char *option_name(const void *list, size_t i) {
    const option_parse *parse = list;
    for (size_t g = 0; g < parse->num_groups; g++)
        for (const option *row = parse->groups[g].rows; row->kind; row++)
            if (cli_is_option(row) && i-- == 0) return row->name;
    return i == 0 ? "help" : NULL;
}

static bool unknown(option_parse *parse, const char *argument) {
    char name[64];
    snprintf(name, sizeof name, "%s", argument + strspn(argument, "-"));
    name[strcspn(name, "=")] = 0;
    const char *near = cli_nearest(name, option_name, parse);
    if (near) return wrong(parse, "unknown option '%s'; did you mean '--%s'?", argument, near);
    return wrong(parse, "unknown option '%s'", argument);
}

static bool looks_like_option(const char *argument) {
    if (argument[0] != '-' || argument[1] == 0) return false;
    return !strchr("0123456789.,", argument[1]); /* "-,x,y,z" are names of columns */
}

/* Takes one option at argv[*i]; *i moves on over a value that stands by itself. */
static bool take(option_parse *parse, int argc, char **argv, int *i) {
    const char *argument = argv[*i], *value = NULL;
    found f;
    if (argument[1] == '-') {
        size_t length = strcspn(argument + 2, "=");
        f = find(parse, argument + 2, length, 0);
        if (argument[2 + length] == '=') value = argument + 2 + length + 1;
    } else {
        f = find(parse, NULL, 0, argument[1]);
        if (argument[2]) value = argument + 2;
    }
    if (!f.row) return unknown(parse, argument);
    if (f.row->kind == OPTION_FLAG) {
        if (value) return wrong(parse, "--%s takes no value", f.row->name);
        *(bool *)f.field = true;
        return true;
    }
    if (!value && f.row->kind & OPTION_OPTIONAL) {
        double number;
        value = *i + 1 < argc && parse_number(argv[*i + 1], &number) ? argv[++*i] : "0";
    }
    if (!value) {
        if (*i + 1 >= argc || looks_like_option(argv[*i + 1]))
            return wrong(parse, "%s needs a value (%s)", argument, f.row->value);
        value = argv[++*i];
    }
    if (!*value && is_text(f.row->kind)) return wrong(parse, "%s: the value is empty", argument);
    return store(parse, f.row, f.field, value);
}

static bool is_help(const char *argument) {
    return !strcmp(argument, "--help") || !strcmp(argument, "-h");
}

bool cli_parse(option_parse *parse, int argc, char **argv) {
    parse->operands = argv;
    parse->num_operands = 0;
    for (int i = 0; i < argc && strcmp(argv[i], "--"); i++)
        if (is_help(argv[i])) return parse->help = true;
    bool options_end = false;
    for (int i = 0; i < argc; i++) {
        char *argument = argv[i];
        if (!options_end && !strcmp(argument, "--")) {
            options_end = true;
        } else if (options_end || !looks_like_option(argument)) {
            parse->operands[parse->num_operands++] = argument;
        } else if (!take(parse, argc, argv, &i)) {
            return false;
        }
    }
    return true;
}

/* --- the nearest name --- */

/* Returns the Levenshtein distance, row by row; words over 63 letters are far from everything. */
static size_t edit_distance(const char *a, const char *b) {
    size_t row[64], m = strlen(a), n = strlen(b);
    if (m > 63 || n > 63) return SIZE_MAX;
    for (size_t j = 0; j <= n; j++) row[j] = j;
    for (size_t i = 1; i <= m; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t change = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            size_t least = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = change < least ? change : least;
        }
    }
    return row[n];
}

const char *cli_nearest(const char *word, const char *(*next)(const void *list, size_t i), const void *list) {
    const char *best = NULL, *name;
    size_t least = (strlen(word) + 2) / 3;
    for (size_t i = 0; (name = next(list, i)) != NULL; i++) {
        size_t distance = edit_distance(word, name);
        if (distance > least || distance >= strlen(name) || (best && distance == least)) continue;
        best = name;
        least = distance;
    }
    return best;
}
