/* Writes cells: checks that the format's arrays are there, and calls the format's writer. CSV and NPY are here.
 *
 * Based on: NumPy enhancement proposal 1, the .npy format. */
#include "base/float_state.h"
#include "base/memory.h"
#include "io/formats.h"
#include "io/scalar.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

brio_cells_format brio_cells_format_of(const char *path) {
    static const char *const EXTENSION[BRIO_CELLS_FORMAT_END] = {
        [BRIO_CELLS_FORMAT_VTU] = "vtu", [BRIO_CELLS_FORMAT_NPY] = "npy", [BRIO_CELLS_FORMAT_CSV] = "csv"};
    const char *dot = strrchr(path, '.'), *extension = dot ? dot + 1 : path;
    for (int f = BRIO_CELLS_FORMAT_AUTO + 1; f <= BRIO_CELLS_FORMAT_CSV; f++)
        if (!strcasecmp(extension, EXTENSION[f])) return (brio_cells_format)f;
    return BRIO_CELLS_FORMAT_AUTO;
}

/* --- CSV --- */

/* Returns the site of a cell.   site  NULL, or what stands in place of the cells' own. */
static int64_t site_of(const brio_cells *cells, const uint64_t *site, size_t c) {
    return site ? (int64_t)site[c] : cells->site[c];
}

static brio_status write_csv_rows(brio_output *out, const brio_cells *cells, const uint64_t *site) {
    for (size_t c = 0; c < cells->num_cells; c++) {
        BRIO_FORWARD(brio_output_integer(out, 0, site_of(cells, site, c)));
        BRIO_FORWARD(brio_output_double(out, ',', cells->volume[c]));
        BRIO_FORWARD(brio_output_double(out, ',', cells->area[c]));
        BRIO_FORWARD(brio_output_integer(out, ',', (int64_t)brio_cells_num_faces(cells, c)));
        BRIO_FORWARD(brio_output_integer(out, ',', cells->bounded[c]));
        for (size_t k = 0; k < 3; k++) BRIO_FORWARD(brio_output_double(out, ',', cells->centroid[3 * c + k]));
        BRIO_FORWARD(brio_output_bytes(out, "\n", 1));
    }
    return BRIO_OK;
}

static brio_status write_face_rows(brio_output *out, const brio_cells *cells, const uint64_t *site) {
    for (size_t c = 0; c < cells->num_cells; c++)
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1]; f++) {
            BRIO_FORWARD(brio_output_integer(out, 0, site_of(cells, site, c)));
            BRIO_FORWARD(brio_output_integer(out, ',', cells->face_neighbours[f]));
            BRIO_FORWARD(brio_output_double(out, ',', cells->face_areas[f]));
            for (size_t k = 0; k < 3; k++) BRIO_FORWARD(brio_output_double(out, ',', cells->face_normals[3 * f + k]));
            for (size_t k = 0; k < 3 && cells->face_shifts; k++)
                BRIO_FORWARD(brio_output_integer(out, ',', cells->face_shifts[3 * f + k]));
            BRIO_FORWARD(brio_output_bytes(out, "\n", 1));
        }
    return BRIO_OK;
}

/* --- NPY --- */

/* Writes the header: magic, version 1.0, the length of the description in 2 bytes, the description, blanks up to a
 * multiple of 64 bytes, and a line end. */
static brio_status write_npy_header(brio_output *out, uint64_t rows) {
    enum { BEFORE = 10, UNIT = 64 };
    char text[512], order = brio_host_is_little() ? '<' : '>';
    int used = snprintf(text, sizeof text,
                        "{'descr': [('site', '%ci8'), ('volume', '%cf8'), ('area', '%cf8'), ('faces', '%ci8'), "
                        "('bounded', '|b1'), ('cx', '%cf8'), ('cy', '%cf8'), ('cz', '%cf8')], "
                        "'fortran_order': False, 'shape': (%llu,), }",
                        order, order, order, order, order, order, order, (unsigned long long)rows);
    size_t length = (size_t)used, whole = (BEFORE + length + 1 + UNIT - 1) / UNIT * UNIT - BEFORE;
    const unsigned char before[BEFORE] = {0x93, 'N', 'U', 'M',         'P',
                                          'Y',  1,   0,   whole & 255, (unsigned char)(whole >> 8)};
    memset(text + length, ' ', whole - length);
    text[whole - 1] = '\n';
    brio_status status = brio_output_bytes(out, before, sizeof before);
    return status == BRIO_OK ? brio_output_bytes(out, text, whole) : status;
}

static brio_status write_npy_rows(brio_output *out, const brio_cells *cells, const uint64_t *sites) {
    for (size_t c = 0; c < cells->num_cells; c++) {
        int64_t site = site_of(cells, sites, c), faces = (int64_t)brio_cells_num_faces(cells, c);
        BRIO_FORWARD(brio_output_bytes(out, &site, sizeof site));
        BRIO_FORWARD(brio_output_bytes(out, &cells->volume[c], sizeof(double)));
        BRIO_FORWARD(brio_output_bytes(out, &cells->area[c], sizeof(double)));
        BRIO_FORWARD(brio_output_bytes(out, &faces, sizeof faces));
        BRIO_FORWARD(brio_output_bytes(out, &cells->bounded[c], 1));
        BRIO_FORWARD(brio_output_bytes(out, &cells->centroid[3 * c], 3 * sizeof(double)));
    }
    return BRIO_OK;
}

/* --- any format --- */

static brio_status check(brio_context *ctx, const char *path, const brio_cells *cells, brio_cells_format format) {
    BRIO_EXPECT(ctx, format > BRIO_CELLS_FORMAT_AUTO && format < BRIO_CELLS_FORMAT_END,
                BRIO_BECAUSE(ctx, UNKNOWN_FORMAT, BRIO_ERR_ARGUMENT),
                "%s: unknown format of cells, expected .vtu .npy or .csv", path);
    BRIO_EXPECT(ctx, cells->area && cells->centroid && cells->face_offsets, BRIO_ERR_ARGUMENT,
                "%s: the cells have no areas, centroids or faces: brio_cells_options asks for them", path);
    BRIO_EXPECT(ctx, format != BRIO_CELLS_FORMAT_FACES_CSV || cells->face_neighbours || !cells->num_cells,
                BRIO_ERR_ARGUMENT, "%s: the cells have the number of their faces alone", path);
    BRIO_EXPECT(ctx, format != BRIO_CELLS_FORMAT_FACES_CSV || cells->face_areas || !cells->num_cells, BRIO_ERR_ARGUMENT,
                "%s: the cells have no sizes of faces: brio_cells_options asks for them", path);
    BRIO_EXPECT(ctx, format != BRIO_CELLS_FORMAT_VTU || cells->corner_offsets, BRIO_ERR_ARGUMENT,
                "%s: the cells have no vertices: brio_cells_options asks for them", path);
    return BRIO_OK;
}

static uint64_t expected_bytes(const brio_cells *cells, brio_cells_format format) {
    enum { NPY_ROW = 57, CSV_ROW = 110, CORNER = 6, FACE = 12 };
    uint64_t faces = cells->face_offsets[cells->num_cells];
    if (format == BRIO_CELLS_FORMAT_NPY) return NPY_ROW * (uint64_t)cells->num_cells;
    if (format == BRIO_CELLS_FORMAT_CSV) return CSV_ROW * (uint64_t)cells->num_cells;
    if (format == BRIO_CELLS_FORMAT_FACES_CSV) return CSV_ROW * faces;
    return 3 * sizeof(double) * (uint64_t)cells->num_vertices + CORNER * cells->corner_offsets[faces] + FACE * faces;
}

/* Writes what stands before the rows of a table. */
static brio_status write_head(brio_output *out, brio_cells_format format, uint64_t rows, bool shifts) {
    if (format == BRIO_CELLS_FORMAT_NPY) return write_npy_header(out, rows);
    if (format == BRIO_CELLS_FORMAT_CSV) return brio_output_string(out, "site,volume,area,faces,bounded,cx,cy,cz\n");
    BRIO_FORWARD(brio_output_string(out, "site,neighbour,area,nx,ny,nz"));
    return brio_output_string(out, shifts ? ",shift_a,shift_b,shift_c\n" : "\n");
}

static brio_status write_rows(brio_output *out, brio_cells_format format, const brio_cells *cells,
                              const uint64_t *site) {
    if (format == BRIO_CELLS_FORMAT_NPY) return write_npy_rows(out, cells, site);
    if (format == BRIO_CELLS_FORMAT_CSV) return write_csv_rows(out, cells, site);
    return write_face_rows(out, cells, site);
}

brio_status brio_cells_write(brio_context *ctx, const char *path, const brio_cells *cells, brio_cells_format format,
                             const char *comment) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    if (format == BRIO_CELLS_FORMAT_AUTO && strcmp(path, "-") != 0) format = brio_cells_format_of(path);
    BRIO_TRY(check(ctx, path, cells, format));
    BRIO_TRY(brio_output_open(&out, ctx, path, expected_bytes(cells, format)));
    if (format == BRIO_CELLS_FORMAT_VTU) {
        BRIO_TRY(brio_cells_vtu_write(&out, cells, comment));
    } else {
        BRIO_TRY(write_head(&out, format, cells->num_cells, cells->face_shifts != NULL));
        BRIO_TRY(write_rows(&out, format, cells, NULL));
    }
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    return status;
}

/* --- part after part --- */

struct brio_cells_table {
    brio_output out;
    char *path;
    brio_cells_format format;
    uint64_t rows, written; /* of cells */
    bool is_piece;
};

void brio_cells_table_free(brio_cells_table *table) {
    if (!table) return;
    brio_context *ctx = table->out.ctx;
    brio_output_close(&table->out);
    brio_release(ctx, table->path);
    brio_release(ctx, table);
}

static brio_status open_table(brio_context *ctx, const char *path, brio_cells_format format, uint64_t num_cells,
                              bool has_head, brio_cells_table **out) {
    brio_cells_table *table = NULL;
    brio_status status = BRIO_OK;
    size_t size = strlen(path) + 1;
    *out = NULL;
    if (format == BRIO_CELLS_FORMAT_AUTO && strcmp(path, "-") != 0) format = brio_cells_format_of(path);
    BRIO_REQUIRE(ctx, format > BRIO_CELLS_FORMAT_VTU && format < BRIO_CELLS_FORMAT_END, BRIO_ERR_ARGUMENT,
                 "%s: cells are written part after part to .npy and .csv", path);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, table, 1));
    table->out = (brio_output){.ctx = ctx, .target.folder = -1, .file = -1};
    table->format = format;
    table->rows = num_cells;
    BRIO_TRY(BRIO_ALLOC(ctx, table->path, size));
    memcpy(table->path, path, size);
    BRIO_TRY(brio_output_open(&table->out, ctx, table->path, BRIO_NO_PROGRESS));
    if (has_head) BRIO_TRY(write_head(&table->out, format, num_cells, false));
    *out = table;
    table = NULL;
done:
    brio_cells_table_free(table);
    return status;
}

brio_status brio_cells_table_new(brio_context *ctx, const char *path, brio_cells_format format, uint64_t num_cells,
                                 brio_cells_table **out) {
    BRIO_DOOR;
    return open_table(ctx, path, format, num_cells, true, out);
}

brio_status brio_cells_table_piece(brio_context *ctx, const char *path, brio_cells_format format, uint64_t num_cells,
                                   int is_first, brio_cells_table **out) {
    BRIO_DOOR;
    BRIO_FORWARD(open_table(ctx, path, format, num_cells, is_first, out));
    (*out)->is_piece = true;
    return BRIO_OK;
}

brio_status brio_cells_table_add(brio_context *ctx, brio_cells_table *table, const brio_cells *cells,
                                 const uint64_t *site) {
    BRIO_DOOR;
    BRIO_FORWARD(check(ctx, table->path, cells, table->format));
    BRIO_EXPECT(ctx, !cells->face_shifts, BRIO_ERR_ARGUMENT, "%s: cells of space that repeats are written at once",
                table->path);
    table->written += cells->num_cells;
    return write_rows(&table->out, table->format, cells, site);
}

brio_status brio_cells_table_finish(brio_context *ctx, brio_cells_table *table) {
    BRIO_DOOR;
    bool counts = table->format == BRIO_CELLS_FORMAT_NPY && !table->is_piece;
    BRIO_EXPECT(ctx, !counts || table->written == table->rows, BRIO_ERR_ARGUMENT,
                "%s: %llu cells were announced, and %llu came", table->path, (unsigned long long)table->rows,
                (unsigned long long)table->written);
    BRIO_FORWARD(brio_output_finish(&table->out));
    return brio_output_publish(&table->out);
}
