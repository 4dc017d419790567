/* Splits a line into fields, and finds out whether its commas are decimal. */
#include "io/text/text_fields.h"
#include "base/memory.h"
#include "io/limits.h"
#include "io/number.h"
#include "io/textrow.h"
#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* --- which columns are which --- */

/* Names of columns. What the programs of surveyors and modellers call the coordinates is in one table. */

enum { NONE = -1, SEVERAL = -2 };
enum {
    PAIRS = 14,
    HEIGHTS = 19,
    ANGLES = 6,
    LATITUDES = 2,
    FIRST_HEIGHT = 2 * PAIRS,
    NAMES = FIRST_HEIGHT + HEIGHTS + ANGLES
};

/* Pairs of x and y: the east is x and the north is y, whichever column comes first (Points:0 is what ParaView writes).
 * Then heights, latitudes and longitudes. */
static const char *const known[NAMES] = {
    /* pairs */
    "x", "y", "xcoord", "ycoord", "xcoordinate", "ycoordinate", "coordx", "coordy", "coordinatex", "coordinatey",
    "posx", "posy", "positionx", "positiony", "pointx", "pointy", "points0", "points1", "easting", "northing",
    "eastings", "northings", "east", "north", "e", "n", "rechtswert", "hochwert",
    /* heights; z, the first of them, wins over the others */
    "z", "zcoord", "zcoordinate", "coordz", "coordinatez", "posz", "positionz", "pointz", "points2", "elevation",
    "elev", "height", "altitude", "alt", "h", "up", "hoehe", "h\xc3\xb6he", "h\xf6he",
    /* angles */
    "lat", "latitude", "lon", "long", "longitude", "lng"};

/* Copies what counts of a name: letters and digits before the unit, in small letters. */
static void normalise(const char *name, char plain[64]) {
    size_t n = 0;
    for (; *name && ((*name != '(' && *name != '[') || n == 0) && n < 63; name++)
        if (isalnum((unsigned char)*name) || (unsigned char)*name >= 0x80)
            plain[n++] = (char)((unsigned char)*name < 0x80 ? tolower((unsigned char)*name) : *name);
    plain[n] = 0;
}

static int either(int a, int b) {
    if (a == NONE || b == NONE) return a == NONE ? b : a;
    return SEVERAL;
}

/* Finds the column that bears each known name as it stands, or as what counts of it: NONE, SEVERAL, or the column. */
static void find_named(const char (*names)[64], size_t count, bool as_it_stands, int columns[NAMES]) {
    char plain[64];
    for (int k = 0; k < NAMES; k++) columns[k] = NONE;
    for (size_t i = 0; i < count && i < INT_MAX; i++) {
        normalise(names[i], plain);
        if (as_it_stands && strlen(plain) != strlen(names[i])) continue;
        for (int k = 0; k < NAMES; k++)
            if (!strcmp(plain, known[k])) columns[k] = either(columns[k], (int)i);
    }
}

/* Finds the column of each known name; beside an x, an "x [m]" is another property. */
static void find_known(const char (*names)[64], size_t count, int columns[NAMES]) {
    int looser[NAMES];
    find_named(names, count, true, columns);
    find_named(names, count, false, looser);
    for (int k = 0; k < NAMES; k++)
        if (columns[k] == NONE) columns[k] = looser[k];
}

static int any_of(const int *columns, int count) {
    int found = NONE;
    for (int i = 0; i < count; i++) found = either(found, columns[i]);
    return found;
}

brio_axes_result brio_axes_of_names(const char (*names)[64], size_t count, size_t axes[3]) {
    int columns[NAMES];
    find_known(names, count, columns);
    const int *latitudes = columns + FIRST_HEIGHT + HEIGHTS, *longitudes = latitudes + LATITUDES;
    int found[3] = {columns[0], columns[1], columns[FIRST_HEIGHT]};
    if (found[0] == NONE || found[1] == NONE || found[2] == NONE) {
        found[0] = found[1] = NONE;
        for (int i = 0; i < PAIRS; i++) {
            if (columns[2 * i] == NONE || columns[2 * i + 1] == NONE) continue;
            found[0] = either(found[0], columns[2 * i]);
            found[1] = either(found[1], columns[2 * i + 1]);
        }
        if (found[2] == NONE) found[2] = any_of(columns + FIRST_HEIGHT, HEIGHTS);
    }
    bool angles = any_of(latitudes, LATITUDES) != NONE && any_of(longitudes, ANGLES - LATITUDES) != NONE;
    if (found[0] == NONE && angles) return BRIO_AXES_ANGLES;
    for (int k = 0; k < 3; k++)
        if (found[k] == NONE) return BRIO_AXES_UNKNOWN;
    for (int k = 0; k < 3; k++) {
        if (found[k] == SEVERAL) return BRIO_AXES_SEVERAL;
        axes[k] = (size_t)found[k];
    }
    return BRIO_AXES_FOUND;
}

brio_axes_result brio_pair_of_names(const char (*names)[64], size_t count, size_t axes[2]) {
    int columns[NAMES], found[2] = {NONE, NONE};
    find_known(names, count, columns);
    for (int i = 0; i < PAIRS && found[0] == NONE; i++) {
        if (columns[2 * i] == NONE || columns[2 * i + 1] == NONE) continue;
        found[0] = columns[2 * i], found[1] = columns[2 * i + 1];
    }
    if (found[0] == NONE) return BRIO_AXES_UNKNOWN;
    for (int k = 0; k < 2; k++) {
        if (found[k] == SEVERAL) return BRIO_AXES_SEVERAL;
        axes[k] = (size_t)found[k];
    }
    return BRIO_AXES_FOUND;
}

/* --- names that the caller gives --- */

static brio_status take_name(brio_context *ctx, const char *columns, const char *word, size_t length, char name[64]) {
    while (length && isspace((unsigned char)*word)) word++, length--;
    while (length && isspace((unsigned char)word[length - 1])) length--;
    BRIO_EXPECT(ctx, length > 0 && length < 64, BRIO_ERR_ARGUMENT,
                "columns \"%s\": a name of %zu characters, expected 1 to 63, or - for a column to leave out", columns,
                length);
    bool skipped = length == 1 && (*word == '-' || *word == '_');
    memset(name, 0, 64);
    if (!skipped) memcpy(name, word, length);
    if (length == 1 && strchr("XYZ", *word)) name[0] = (char)tolower((unsigned char)*word);
    return BRIO_OK;
}

static brio_status check_names(brio_context *ctx, const char *columns, bool flat, const char (*names)[64],
                               size_t count) {
    unsigned axes = flat ? 4 : 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i && names[i][0]; k++)
            BRIO_EXPECT(ctx, strcmp(names[i], names[k]) != 0, BRIO_ERR_ARGUMENT, "columns \"%s\": %s is there twice",
                        columns, names[i]);
        if (names[i][0] >= 'x' && names[i][0] <= 'z' && !names[i][1]) axes |= 1u << (names[i][0] - 'x');
    }
    BRIO_EXPECT(ctx, axes == 7, BRIO_ERR_ARGUMENT, "columns \"%s\": %c is missing; x, y and z have to be there",
                columns, "xyxzxyx"[axes]);
    return BRIO_OK;
}

brio_status brio_columns_parse(brio_context *ctx, const char *columns, bool flat, char (**names)[64], size_t *count) {
    brio_status status = BRIO_OK;
    char(*list)[64] = NULL;
    size_t n = 1;
    for (const char *p = columns; *p; p++) n += *p == ',';
    BRIO_TRY(BRIO_ALLOC(ctx, list, n));
    const char *word = columns;
    for (size_t i = 0; i < n; i++) {
        size_t length = strcspn(word, ",");
        BRIO_TRY(take_name(ctx, columns, word, length, list[i]));
        word += length + 1;
    }
    BRIO_TRY(check_names(ctx, columns, flat, (const char(*)[64])list, n));
    *names = list;
    *count = n;
    list = NULL;
done:
    brio_release(ctx, list);
    return status;
}

/* --- fields of a row --- */

enum { LONGEST = 64 /* characters of a number with a decimal comma; chosen */ };

/* What stands between the numbers of a line. */
typedef struct {
    bool tight; /* a comma stands between a number and a digit */
    bool other; /* blanks or a semicolon alone stand between two numbers */
    bool comma; /* a comma follows a number */
    bool words; /* a blank alone follows a word */
} gaps;

static bool is_digit(char c) {
    return (unsigned)(c - '0') < 10;
}

static const char *skip_blanks(const char *p) {
    while (brio_is_blank(*p)) p++;
    return p;
}

static bool ends_field(const char *p) {
    return brio_is_blank(*p) || *p == ',' || !*p || *p == ';' || brio_starts_comment(p);
}

/* Returns whether a text ends here. In a word, as in z#1, a comment's mark is none. */
static bool ends_text(const char *p) {
    return brio_is_blank(*p) || *p == ',' || !*p || *p == ';';
}

static bool ends_word(const char *p) {
    return !*p || brio_is_blank(*p) || *p == ';' || brio_starts_comment(p);
}

/* Makes room for one more field of a row. */
static brio_status room(brio_fields *f) {
    if (f->count < f->capacity) return BRIO_OK;
    BRIO_FORWARD(brio_limit_numbers(f->stream->ctx, f->stream->name, f->stream->line, f->count + 1));
    BRIO_FORWARD(BRIO_RESERVE(f->stream->ctx, f->at, f->capacity, f->count + 1));
    if (f->capacity > BRIO_MOST_NUMBERS) f->capacity = BRIO_MOST_NUMBERS; /* so that the next one too many comes here */
    return BRIO_OK;
}

static brio_status add_field(brio_fields *f, brio_field field) {
    brio_status status = room(f);
    if (status == BRIO_OK) f->at[f->count++] = field;
    return status;
}

/* --- commas that separate --- */

/* Returns the place behind the word at p, which may be in quotes. */
static const char *skip_word(const char *p, bool (*ends)(const char *)) {
    if (*p == '"') {
        for (p++; *p && *p != '"'; p++) {}
        if (*p) p++;
    }
    while (!ends(p)) p++;
    return p;
}

/* Reads a number in quotes at p, or nothing in quotes. Returns the place behind the closing quote, or NULL. */
static const char *scan_quoted(const char *p, brio_field *field) {
    const char *end = skip_blanks(p + 1);
    bool number = brio_parse_number(&end, &field->value);
    end = skip_blanks(end);
    if (*end != '"' || !ends_field(end + 1)) return NULL;
    field->kind = number ? BRIO_FIELD_NUMBER : BRIO_FIELD_EMPTY;
    field->length = (size_t)(end + 1 - p);
    if (!number) field->value = (double)NAN;
    return end + 1;
}

/* Reads the field at p, which is neither a blank nor the end of the line. Returns the place behind the field. */
static const char *scan_field(const char *p, brio_field *field) {
    const char *end = p;
    field->word = p;
    if (brio_parse_number(&end, &field->value) && ends_field(end)) {
        field->kind = BRIO_FIELD_NUMBER;
        field->length = (size_t)(end - p);
        return end;
    }
    end = *p == '"' ? scan_quoted(p, field) : NULL;
    if (end) return end;
    *field = (brio_field){BRIO_FIELD_EMPTY, (double)NAN, p, 0};
    if (*p == ',' || *p == ';') return p;
    field->kind = BRIO_FIELD_WORD;
    end = skip_word(p, ends_text);
    field->length = (size_t)(end - p);
    return end;
}

/* Records what stands between a field, which ends before `end`, and the next one. */
static void record_gap(gaps *g, const brio_field *field, const char *end, const char *separator) {
    if (field->kind != BRIO_FIELD_NUMBER) {
        g->words |= field->kind == BRIO_FIELD_WORD && separator > end && *separator != ',' && *separator != ';';
    } else if (*separator == ',') {
        g->comma = true;
        g->tight |= separator == end && is_digit(end[1]);
    } else if (*separator == ';') {
        g->other = true;
    } else if (is_digit(*separator) || *separator == '"' || *separator == '-' || *separator == '+' ||
               *separator == '.') {
        g->other = true;
    }
}

static bool has_separator(const char *p, const char *end) {
    while (p < end && *p != ',' && *p != ';') p++;
    return p < end;
}

/* Joins words that neither a comma nor a semicolon separates, in a line that has some; to a word also a number, as in
 * "A 1", if there are semicolons. */
static void join_words(brio_fields *f) {
    size_t kept = 0;
    if (!strpbrk(f->at[0].word, ",;")) return;
    bool numbers = strchr(f->at[0].word, ';') != NULL;
    for (size_t i = 0; i < f->count; i++) {
        brio_field *here = &f->at[i], *last = kept ? &f->at[kept - 1] : NULL;
        const char *gap = last ? last->word + last->length : NULL;
        bool fits = here->kind == BRIO_FIELD_WORD || (numbers && here->kind == BRIO_FIELD_NUMBER);
        bool joined = last && last->kind == BRIO_FIELD_WORD && fits && !has_separator(gap, here->word);
        if (joined)
            last->length = (size_t)(here->word - last->word) + here->length;
        else
            f->at[kept++] = *here;
    }
    f->count = kept;
}

/* Returns whether a % is the end of a name with blanks, as in "Humidity %". */
static bool is_unit(const brio_fields *f, const char *p) {
    bool word = f->count && f->at[f->count - 1].kind == BRIO_FIELD_WORD;
    return word && *p == '%' && (p[1] == ',' || p[1] == ';' || (!p[1] && strpbrk(f->at[0].word, ",;")));
}

/* Splits a row.   prose  whether words after BRIO_MOST_NUMBERS are left out, as in a long comment; otherwise they are
 * an error. */
static brio_status split(brio_fields *f, const char *p, size_t columns, bool prose, gaps *g) {
    bool comma = false;
    f->count = 0;
    for (p = skip_blanks(p); *p && (!brio_starts_comment(p) || is_unit(f, p));) {
        if (prose && f->count == BRIO_MOST_NUMBERS) break;
        BRIO_FORWARD(room(f));
        brio_field *field = &f->at[f->count++];
        const char *end = scan_field(p, field);
        p = skip_blanks(end);
        record_gap(g, field, end, p);
        comma = *p == ',' || *p == ';';
        if (comma) p = skip_blanks(p + 1);
    }
    if (g->words) join_words(f);
    if (comma && f->count < columns) BRIO_FORWARD(add_field(f, (brio_field){BRIO_FIELD_EMPTY, (double)NAN, p, 0}));
    return BRIO_OK;
}

brio_status brio_fields_of_words(brio_fields *f, const char *line) {
    gaps g = {0};
    return split(f, line, 0, true, &g);
}

bool brio_field_is_missing(const brio_field *f) {
    static const char *const marks[] = {"NA", "N/A", "n/a", "null", "NULL", "None"};
    if (f->kind != BRIO_FIELD_WORD) return false;
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
        if (strlen(marks[i]) == f->length && !memcmp(marks[i], f->word, f->length)) return true;
    return false;
}

/* --- decimal commas --- */

/* Reads a number with one comma in the place of the point, or none of both, up to `end`. */
static bool parse_decimal_comma(const char *p, const char *end, double *value) {
    char text[LONGEST + 1];
    size_t length = (size_t)(end - p);
    if (length == 0 || length > LONGEST || memchr(p, '.', length)) return false;
    memcpy(text, p, length);
    text[length] = 0;
    char *comma = strchr(text, ',');
    if (comma) {
        if (comma == text || !is_digit(comma[-1]) || !is_digit(comma[1])) return false;
        *comma = '.';
    }
    const char *at = text;
    return brio_parse_number(&at, value) && !*at;
}

static brio_status split_decimal(brio_fields *f, const char *p, size_t columns) {
    bool separator = false, words = false;
    f->count = 0;
    for (;;) {
        p = skip_blanks(p);
        if (!*p || brio_starts_comment(p)) break;
        const char *end = skip_word(p, ends_word);
        brio_field field = {BRIO_FIELD_EMPTY, (double)NAN, p, (size_t)(end - p)};
        if (end > p) field.kind = parse_decimal_comma(p, end, &field.value) ? BRIO_FIELD_NUMBER : BRIO_FIELD_WORD;
        BRIO_FORWARD(add_field(f, field));
        p = skip_blanks(end);
        separator = *p == ';';
        words |= field.kind == BRIO_FIELD_WORD && !separator;
        p += separator;
    }
    if (words) join_words(f);
    if (separator && f->count < columns) BRIO_FORWARD(add_field(f, (brio_field){BRIO_FIELD_EMPTY, (double)NAN, p, 0}));
    return BRIO_OK;
}

/* --- which of both --- */

/* Returns whether the word up to `end` is a number whose commas mark thousands, as 1,234,567.8 is. */
static bool marks_thousands(const char *p, const char *end) {
    p += *p == '-' || *p == '+';
    const char *first = p;
    while (is_digit(*p)) p++;
    if (p == first || p - first > 3 || *p != ',') return false;
    while (*p == ',' && is_digit(p[1]) && is_digit(p[2]) && is_digit(p[3]) && !is_digit(p[4])) p += 4;
    if (*p == '.')
        for (p++; is_digit(*p);) p++;
    return p == end;
}

/* Finds out what the commas of a row are that has some between digits and something else between numbers. UNKNOWN: both
 * are possible, or neither. */
static brio_comma judge(const char *p) {
    size_t words = 0, decimal = 0, points = 0, thousands = 0, others = 0;
    double value;
    for (p = skip_blanks(p); *p && !brio_starts_comment(p);) {
        const char *end = skip_word(p, ends_word);
        size_t length = (size_t)(end - p);
        bool commas = memchr(p, ',', length) != NULL, number = is_digit(p[*p == '-' || *p == '+']);
        words++;
        if (commas && parse_decimal_comma(p, end, &value))
            decimal++;
        else if (commas && marks_thousands(p, end))
            thousands++;
        else if (commas && number)
            others++;
        else if (number && memchr(p, '.', length))
            points += brio_parse_number(&p, &value) && p == end;
        p = skip_blanks(end);
        if (*p == ';') p = skip_blanks(p + 1);
    }
    if (others) return BRIO_COMMA_SEPARATES;
    return decimal && !thousands && !points && words >= 3 ? BRIO_COMMA_DECIMAL : BRIO_COMMA_UNKNOWN;
}

static brio_status unclear(const brio_fields *f, const char *line) {
    char shown[61];
    size_t length = strcspn(line, "\r\n");
    length = length < sizeof shown ? length : sizeof shown - 1;
    memcpy(shown, line, length);
    shown[length] = 0;
    return brio_fail(f->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: line %zu: its commas may be decimal, mark thousands, or separate fields: \"%s\"; write "
                     "points, or one separator that is no comma",
                     f->stream->name, f->stream->line, shown);
}

/* Records what the commas of a row are, which must be what those of earlier rows are. */
static brio_status decide(brio_fields *f, brio_comma comma) {
    if (f->comma == BRIO_COMMA_UNKNOWN) {
        f->comma = comma;
        f->comma_line = f->stream->line;
    }
    if (f->comma == comma) return BRIO_OK;
    return brio_fail(f->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: line %zu: its commas seem to be decimal, but since line %zu a comma separates fields",
                     f->stream->name, f->stream->line, f->comma_line);
}

/* Looks for a point in the numbers of the first row that has numbers. */
static bool has_point(brio_fields *f) {
    if (f->seen_numbers) return false;
    for (size_t i = 0; i < f->count; i++) {
        const brio_field *field = &f->at[i];
        if (field->kind != BRIO_FIELD_NUMBER) continue;
        f->seen_numbers = true;
        if (field->word[strcspn(field->word, ".,; \t#%/")] == '.') return true;
    }
    return false;
}

brio_status brio_fields_of_line(brio_fields *f, const char *line, size_t columns) {
    gaps g = {0};
    if (f->comma == BRIO_COMMA_DECIMAL) return split_decimal(f, line, columns);
    BRIO_FORWARD(split(f, line, columns, false, &g));
    if (g.tight && g.other) {
        brio_comma comma = judge(line);
        if (comma == BRIO_COMMA_UNKNOWN) return unclear(f, line);
        BRIO_FORWARD(decide(f, comma));
        if (comma == BRIO_COMMA_DECIMAL) BRIO_FORWARD(split_decimal(f, line, columns));
    } else if (f->comma == BRIO_COMMA_UNKNOWN && (g.comma || has_point(f))) {
        BRIO_FORWARD(decide(f, BRIO_COMMA_SEPARATES));
    }
    return BRIO_OK;
}
