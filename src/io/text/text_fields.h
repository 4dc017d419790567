/* A line of a text of points, split into fields.
 *
 * Fields are separated by blanks, or by a comma or semicolon with blanks around it. Between two commas is an empty
 * field. Words between which there is only a blank are one field in a line with commas or semicolons. Comments begin
 * with #, % or // and end with the line.
 *
 * A comma between two digits may be a decimal comma. What it is shows in the first row of numbers that has one:
 *   - Nothing but commas separates its numbers (1,5,2): commas separate.
 *   - Its numbers are three or more words between blanks, tabs or semicolons, each of which is a number with at most
 *     one comma and no point (1,5;2,5;3): commas are decimal, and separate nothing from then on.
 *   - A word has commas and cannot be one number (1.5,2.5,3.5 255): commas separate.
 *   - Anything else (1,5 2; 1,234.5 6 7; 1,5 2.5 3) is an error.
 * A point in the first row of numbers decides that commas separate, too. A later row that says the opposite is an
 * error. */
#ifndef BRIO_IO_TEXT_FIELDS_H
#define BRIO_IO_TEXT_FIELDS_H

#include "base/context.h"
#include "io/stream.h"

/* --- which columns are which --- */

/* Which columns of a text are x, y and z, by their names. */

typedef enum {
    BRIO_AXES_FOUND,
    BRIO_AXES_UNKNOWN, /* a name is missing */
    BRIO_AXES_SEVERAL, /* several columns have names of one axis */
    BRIO_AXES_ANGLES   /* there are latitudes and longitudes only */
} brio_axes_result;

/** Finds x, y and z. Names count without capitals, signs, and units in brackets, so "//X", "x [m]" and "X_coord" are
 *  known. Columns x, y and z win over all others. Otherwise one pair of names is looked for (easting and northing, east
 *  and north, e and n, ...; the east is x) and one name of a height (z, elevation, height, altitude, ...).
 *  axes  receives the columns; set only with BRIO_AXES_FOUND. */
brio_axes_result brio_axes_of_names(const char (*names)[64], size_t count, size_t axes[3]);

/** Finds x and y among names that have no height, for BRIO_AXES_UNKNOWN of brio_axes_of_names.   axes  2. */
brio_axes_result brio_pair_of_names(const char (*names)[64], size_t count, size_t axes[2]);

/** Reads the names that the caller gives to the columns: "x,y,z,-,nx"; - and _ become empty names.
 *  flat   z need not be there.   names  owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (x, y or z is missing; a name is there twice, or longer than 63 characters),
 *  BRIO_ERR_NO_MEMORY. */
brio_status brio_columns_parse(brio_context *ctx, const char *columns, bool flat, char (**names)[64], size_t *count);

typedef enum { BRIO_FIELD_NUMBER, BRIO_FIELD_EMPTY, BRIO_FIELD_WORD } brio_field_kind;

typedef struct brio_field {
    brio_field_kind kind;
    double value;     /* NaN if the field is no number */
    const char *word; /* its place in the line */
    size_t length;    /* of the field's characters */
} brio_field;

typedef enum { BRIO_COMMA_UNKNOWN, BRIO_COMMA_SEPARATES, BRIO_COMMA_DECIMAL } brio_comma;

typedef struct brio_fields {
    brio_stream *stream;
    brio_field *at; /* the fields of the last line */
    size_t count, capacity;
    brio_comma comma;
    size_t comma_line; /* the line that decided what a comma is */
    bool seen_numbers; /* whether a line with numbers has been read */
} brio_fields;

/** Splits a line of words: a comma separates, and nothing is decided. The fields point into the line. Words after
 *  BRIO_MOST_NUMBERS are left out.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_fields_of_words(brio_fields *f, const char *line);

/** Splits a line. A comma at its end is followed by an empty field if the line would have fewer than `columns` fields
 *  without it; otherwise it means nothing.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (with the line: what a comma is cannot be told; more fields than
 *  BRIO_MOST_NUMBERS), BRIO_ERR_NO_MEMORY. */
brio_status brio_fields_of_line(brio_fields *f, const char *line, size_t columns);

/** Returns whether a field is a word that stands for a number that is not there, as programs of statistics write it:
 *  NA, N/A, null, None. Its value is NaN. */
bool brio_field_is_missing(const brio_field *f);

#endif
