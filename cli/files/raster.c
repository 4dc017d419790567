/* A raster of heights: Esri's ASCII grid, or GeoTIFF.
 *
 * The TIFF file is one strip of numbers in single precision, in this machine's byte order, with the tags of GeoTIFF
 * 1.1: the place of the upper left corner, the side of a cell, and the keys of the coordinate system that a LAS file
 * had. Cells without a height have NODATA, which both forms name.
 *
 * Based on: Adobe. TIFF revision 6.0. 1992. Open Geospatial Consortium. GeoTIFF standard 1.1. 2019. */
#include "cli/files/raster.h"
#include "cli/files/files.h"
#include "cli/files/new_file.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const float NODATA = -9999;

/* Types of TIFF. */
enum { ASCII = 2, SHORT = 3, LONG = 4, DOUBLE = 12 };

/* KEYS: bytes before the content of a record of LAS files in the metadata crs.geokeys. */
enum { MOST_TAGS = 20, RECORD_HEADER = 60, FIRST_KEYS = 34735, LAST_KEYS = 34737 };

static bool has_extension(const char *path, const char *extension) {
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot + 1, extension);
}

static bool is_tiff(const char *path) {
    return has_extension(path, "tif") || has_extension(path, "tiff");
}

brio_status cli_check_raster(run *r, const char *path) {
    if (!is_tiff(path) && !has_extension(path, "asc"))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a raster is .asc (Esri's ASCII grid) or .tif (GeoTIFF)", path);
    return cli_check_beside(r, "raster", path);
}

/* --- GeoTIFF --- */

typedef struct {
    uint16_t tag, type;
    uint32_t count;
    const void *values;
} tiff_tag;

typedef struct {
    tiff_tag tags[MOST_TAGS];
    size_t count;
} tiff_tags;

static size_t size_of(const tiff_tag *t) {
    static const size_t sizes[] = {[ASCII] = 1, [SHORT] = 2, [LONG] = 4, [DOUBLE] = 8};
    return t->count * sizes[t->type];
}

static void add(tiff_tags *t, uint16_t tag, uint16_t type, size_t count, const void *values) {
    t->tags[t->count++] = (tiff_tag){tag, type, (uint32_t)count, values};
}

/* Adds the keys that a LAS file had: its records are the values of the tags of their numbers. Returns whether there are
 * any. */
static bool add_keys(tiff_tags *t, const brio_mesh *points) {
    const brio_metadata *m = brio_mesh_metadata(points, "crs.geokeys");
    bool found = false;
    for (size_t at = 0; m && at + RECORD_HEADER <= m->size;) {
        uint16_t number;
        uint64_t size;
        memcpy(&number, m->bytes + at + 18, sizeof number);
        memcpy(&size, m->bytes + at + 20, sizeof size);
        at += RECORD_HEADER;
        if (size > m->size - at) break;
        uint16_t type = number == FIRST_KEYS ? SHORT : number == LAST_KEYS ? ASCII : DOUBLE;
        size_t of_each = type == SHORT ? 2 : type == ASCII ? 1 : 8;
        if (number >= FIRST_KEYS && number <= LAST_KEYS && size >= of_each) {
            add(t, number, type, (size_t)(size / of_each), m->bytes + at);
            found |= number == FIRST_KEYS;
        }
        at += (size_t)size;
    }
    return found;
}

static int compare_tags(const void *a, const void *b) {
    return (int)((const tiff_tag *)a)->tag - (int)((const tiff_tag *)b)->tag;
}

/* Writes the file up to the numbers: the tags, and the values that do not fit into them. */
static bool write_tags(FILE *file, tiff_tags *t) {
    static const uint16_t probe = 1;
    bool little = *(const uint8_t *)&probe == 1;
    uint32_t place = 8, next = 0;
    uint16_t count = (uint16_t)t->count, magic = 42;
    uint32_t beside = 8 + 2 + 12 * (uint32_t)t->count + 4;
    qsort(t->tags, t->count, sizeof *t->tags, compare_tags);
    bool ok = fwrite(little ? "II" : "MM", 1, 2, file) == 2 && fwrite(&magic, 2, 1, file) == 1 &&
              fwrite(&place, 4, 1, file) == 1 && fwrite(&count, 2, 1, file) == 1;
    for (size_t i = 0; i < t->count; i++) {
        const tiff_tag *tag = &t->tags[i];
        uint8_t value[4] = {0};
        if (size_of(tag) <= sizeof value) {
            memcpy(value, tag->values, size_of(tag));
        } else {
            memcpy(value, &beside, sizeof beside);
            beside += (uint32_t)((size_of(tag) + 1) & ~(size_t)1);
        }
        ok &= fwrite(tag, 2, 2, file) == 2 && fwrite(&tag->count, 4, 1, file) == 1 && fwrite(value, 1, 4, file) == 4;
    }
    ok &= fwrite(&next, 4, 1, file) == 1;
    for (size_t i = 0; i < t->count; i++) {
        size_t size = size_of(&t->tags[i]);
        if (size <= 4) continue;
        ok &= fwrite(t->tags[i].values, 1, size, file) == size;
        if (size % 2) ok &= fputc(0, file) != EOF;
    }
    return ok;
}

/* Returns the bytes before the numbers. */
static uint32_t size_of_tags(const tiff_tags *t) {
    size_t size = 8 + 2 + 12 * t->count + 4;
    for (size_t i = 0; i < t->count; i++)
        if (size_of(&t->tags[i]) > 4) size += (size_of(&t->tags[i]) + 1) & ~(size_t)1;
    return (uint32_t)size;
}

static bool write_tiff_header(FILE *file, const raster *g) {
    /* version 1.1.0 of the keys, one key: GTRasterTypeGeoKey, cells are areas */
    static const uint16_t no_system[] = {1, 1, 0, 1, 1025, 0, 1, 1}, bits = 32, one = 1, real = 3;
    uint32_t columns = (uint32_t)g->columns, rows = (uint32_t)g->rows, bytes = 4 * columns * rows, offset = 0;
    double scale[3] = {g->cell, g->cell, 0}, tie[6] = {0, 0, 0, g->west, g->south + (double)g->rows * g->cell, 0};
    tiff_tags t = {.count = 0};
    add(&t, 256, LONG, 1, &columns);
    add(&t, 257, LONG, 1, &rows);
    add(&t, 258, SHORT, 1, &bits);
    add(&t, 259, SHORT, 1, &one); /* not compressed */
    add(&t, 262, SHORT, 1, &one); /* black is 0 */
    add(&t, 273, LONG, 1, &offset);
    add(&t, 277, SHORT, 1, &one); /* one number a cell */
    add(&t, 278, LONG, 1, &rows);
    add(&t, 279, LONG, 1, &bytes);
    add(&t, 339, SHORT, 1, &real);
    add(&t, 33550, DOUBLE, 3, scale);
    add(&t, 33922, DOUBLE, 6, tie);
    add(&t, 42113, ASCII, 6, "-9999");
    if (!add_keys(&t, g->points)) add(&t, FIRST_KEYS, SHORT, sizeof no_system / sizeof *no_system, no_system);
    offset = size_of_tags(&t);
    return write_tags(file, &t);
}

/* --- both --- */

static bool write_text_header(FILE *file, const raster *g) {
    char west[32], south[32], cell[32];
    cli_format_real(g->west, west);
    cli_format_real(g->south, south);
    cli_format_real(g->cell, cell);
    return fprintf(file, "ncols %zu\nnrows %zu\nxllcorner %s\nyllcorner %s\ncellsize %s\nNODATA_value %g\n", g->columns,
                   g->rows, west, south, cell, (double)NODATA) > 0;
}

static bool write_row(FILE *file, const double *heights, size_t columns, bool tiff) {
    bool ok = true;
    for (size_t i = 0; i < columns; i++) {
        float height = isnan(heights[i]) ? NODATA : (float)heights[i];
        if (tiff)
            ok &= fwrite(&height, sizeof height, 1, file) == 1;
        else
            ok &= fprintf(file, "%s%.9g", i ? " " : "", isnan(heights[i]) ? (double)NODATA : heights[i]) > 0;
    }
    return ok && (tiff || fputc('\n', file) != EOF);
}

brio_status cli_write_raster(run *r, const char *path, const raster *g, raster_row fill, void *user) {
    brio_status status = BRIO_OK;
    new_file f = {.target.folder = -1};
    bool tiff = is_tiff(path), ok;
    double *heights = malloc((g->columns + 1) * sizeof *heights);
    if (!heights) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for a row of %zu cells", g->columns);
    if (tiff && (double)g->columns * (double)g->rows * sizeof(float) > 4e9)
        FAIL(r, BRIO_ERR_TOO_LARGE, "%s: %zu by %zu cells do not fit a TIFF file: a larger --cell, or .asc", path,
             g->columns, g->rows);
    TRY(cli_new_file_open(r, path, &f));
    ok = tiff ? write_tiff_header(f.file, g) : write_text_header(f.file, g);
    for (size_t row = 0; row < g->rows && ok; row++) {
        TRY(cli_check_interrupt(r));
        TRY(fill(r, user, row, heights));
        ok = write_row(f.file, heights, g->columns, tiff);
    }
    if (!ok) FAIL(r, BRIO_ERR_WRITE, "%s: cannot be written", path);
    TRY(cli_new_file_publish(r, path, &f));
    cli_lap(r, "raster");
done:
    cli_new_file_close(&f);
    free(heights);
    return status;
}
