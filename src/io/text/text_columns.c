/* Names of columns. What the programs of surveyors and modellers call the coordinates is in one table. */
#include "io/text/text_columns.h"
#include "base/memory.h"
#include <ctype.h>
#include <limits.h>
#include <string.h>

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
    brio_status status = BRIO_OK;
    while (length && isspace((unsigned char)*word)) word++, length--;
    while (length && isspace((unsigned char)word[length - 1])) length--;
    BRIO_REQUIRE(ctx, length > 0 && length < 64, BRIO_ERR_ARGUMENT,
                 "columns \"%s\": a name of %zu characters, expected 1 to 63, or - for a column to leave out", columns,
                 length);
    bool skipped = length == 1 && (*word == '-' || *word == '_');
    memset(name, 0, 64);
    if (!skipped) memcpy(name, word, length);
    if (length == 1 && strchr("XYZ", *word)) name[0] = (char)tolower((unsigned char)*word);
done:
    return status;
}

static brio_status check_names(brio_context *ctx, const char *columns, bool flat, const char (*names)[64],
                               size_t count) {
    brio_status status = BRIO_OK;
    unsigned axes = flat ? 4 : 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < i && names[i][0]; k++)
            BRIO_REQUIRE(ctx, strcmp(names[i], names[k]) != 0, BRIO_ERR_ARGUMENT, "columns \"%s\": %s is there twice",
                         columns, names[i]);
        if (names[i][0] >= 'x' && names[i][0] <= 'z' && !names[i][1]) axes |= 1u << (names[i][0] - 'x');
    }
    BRIO_REQUIRE(ctx, axes == 7, BRIO_ERR_ARGUMENT, "columns \"%s\": %c is missing; x, y and z have to be there",
                 columns, "xyxzxyx"[axes]);
done:
    return status;
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
