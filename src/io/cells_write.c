/* Writes cells: checks that the format's arrays are there, and calls the format's writer. CSV and NPY are here.
 *
 * Based on: NumPy enhancement proposal 1, the .npy format. */
#include "base/float_state.h"
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

static brio_status cells_csv_write(brio_output *out, const brio_cells *cells) {
    BRIO_FORWARD(brio_output_string(out, "site,volume,area,faces,bounded,cx,cy,cz\n"));
    for (size_t c = 0; c < cells->num_cells; c++) {
        BRIO_FORWARD(brio_output_integer(out, 0, cells->site[c]));
        BRIO_FORWARD(brio_output_double(out, ',', cells->volume[c]));
        BRIO_FORWARD(brio_output_double(out, ',', cells->area[c]));
        BRIO_FORWARD(brio_output_integer(out, ',', (int64_t)brio_cells_num_faces(cells, c)));
        BRIO_FORWARD(brio_output_integer(out, ',', cells->bounded[c]));
        for (size_t k = 0; k < 3; k++) BRIO_FORWARD(brio_output_double(out, ',', cells->centroid[3 * c + k]));
        BRIO_FORWARD(brio_output_bytes(out, "\n", 1));
    }
    return BRIO_OK;
}

static brio_status cells_faces_write(brio_output *out, const brio_cells *cells) {
    BRIO_FORWARD(brio_output_string(out, "site,neighbour,area,nx,ny,nz"));
    BRIO_FORWARD(brio_output_string(out, cells->face_shifts ? ",shift_a,shift_b,shift_c\n" : "\n"));
    for (size_t c = 0; c < cells->num_cells; c++)
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1]; f++) {
            BRIO_FORWARD(brio_output_integer(out, 0, cells->site[c]));
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
static brio_status write_npy_header(brio_output *out, size_t rows) {
    enum { BEFORE = 10, UNIT = 64 };
    char text[512], order = brio_host_is_little() ? '<' : '>';
    int used = snprintf(text, sizeof text,
                        "{'descr': [('site', '%ci8'), ('volume', '%cf8'), ('area', '%cf8'), ('faces', '%ci8'), "
                        "('bounded', '|b1'), ('cx', '%cf8'), ('cy', '%cf8'), ('cz', '%cf8')], "
                        "'fortran_order': False, 'shape': (%zu,), }",
                        order, order, order, order, order, order, order, rows);
    size_t length = (size_t)used, whole = (BEFORE + length + 1 + UNIT - 1) / UNIT * UNIT - BEFORE;
    const unsigned char before[BEFORE] = {0x93, 'N', 'U', 'M',         'P',
                                          'Y',  1,   0,   whole & 255, (unsigned char)(whole >> 8)};
    memset(text + length, ' ', whole - length);
    text[whole - 1] = '\n';
    brio_status status = brio_output_bytes(out, before, sizeof before);
    return status == BRIO_OK ? brio_output_bytes(out, text, whole) : status;
}

static brio_status cells_npy_write(brio_output *out, const brio_cells *cells) {
    BRIO_FORWARD(write_npy_header(out, cells->num_cells));
    for (size_t c = 0; c < cells->num_cells; c++) {
        int64_t site = cells->site[c], faces = (int64_t)brio_cells_num_faces(cells, c);
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

static brio_status write_format(brio_output *out, const brio_cells *cells, brio_cells_format format,
                                const char *comment) {
    switch (format) {
    case BRIO_CELLS_FORMAT_VTU:
        return brio_cells_vtu_write(out, cells, comment);
    case BRIO_CELLS_FORMAT_NPY:
        return cells_npy_write(out, cells);
    case BRIO_CELLS_FORMAT_CSV:
        return cells_csv_write(out, cells);
    case BRIO_CELLS_FORMAT_FACES_CSV:
        return cells_faces_write(out, cells);
    case BRIO_CELLS_FORMAT_AUTO:
    case BRIO_CELLS_FORMAT_END:
        break;
    }
    return brio_fail(out->ctx, BRIO_ERR_ARGUMENT, "%s: no such format: %d", out->name, (int)format);
}

brio_status brio_cells_write(brio_context *ctx, const char *path, const brio_cells *cells, brio_cells_format format,
                             const char *comment) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_output out = {.ctx = ctx, .target.folder = -1, .file = -1};
    if (format == BRIO_CELLS_FORMAT_AUTO && strcmp(path, "-") != 0) format = brio_cells_format_of(path);
    BRIO_TRY(check(ctx, path, cells, format));
    BRIO_TRY(brio_output_open(&out, ctx, path, expected_bytes(cells, format)));
    BRIO_TRY(write_format(&out, cells, format, comment));
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    return status;
}
