/* Which columns of a text are x, y and z, by their names. */
#ifndef BRIO_IO_TEXT_TEXT_COLUMNS_H
#define BRIO_IO_TEXT_TEXT_COLUMNS_H

#include "base/context.h"

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

#endif
