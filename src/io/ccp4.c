/* Reads maps of densities: CCP4, MRC.
 *
 * A file has a header of 256 words of four bytes, symmetry records, which are skipped, and the values: sections of rows
 * of columns. The header says which of columns, rows and sections run along x, y and z. The byte order is the one in
 * which the mode and the axes make sense, because many files lack the machine stamp. The cell's lengths and angles give
 * the axes in space: x is along the first axis of the cell, y in the plane of the first two. The place of the first
 * value is the origin in the words of MRC or, if that is 0, the start of columns, rows and sections.
 *
 * Based on: Cheng, Henderson, Mastronarde, Ludtke, Schoenmakers, Short, Marabini, Dallakyan, Agard, Winn. MRC2014:
 *           Extensions to the MRC format header for electron cryo-microscopy and tomography. Journal of Structural
 *           Biology 2015. */
#include "io/ccp4.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* 256 words of four bytes. */
enum { HEADER_BYTES = 1024 };

/* Byte offsets in the header. */
enum {
    SIZE = 0,
    MODE = 12,
    START = 16,
    INTERVALS = 28,
    CELL_LENGTHS = 40,
    CELL_ANGLES = 52,
    AXES = 64,
    SYMMETRY_BYTES = 92,
    ORIGIN = 196,
    LABEL = 208
};

typedef struct {
    const char *bytes;
    bool swap;
    int64_t size[3], start[3], intervals[3]; /* size and start: of columns, rows, sections; intervals: along x, y, z */
    int axis[3];                             /* of columns, rows, sections: 0, 1, 2 for x, y, z */
    double length[3], angle[3], origin[3];
    int64_t mode, symmetry_bytes;
    brio_scalar type;
} ccp4_header;

/* --- header --- */

static int64_t whole(const ccp4_header *h, int offset) {
    return (int64_t)brio_scalar_load(h->bytes + offset, BRIO_SCALAR_INT32, h->swap);
}

static double real(const ccp4_header *h, int offset) {
    return brio_scalar_load(h->bytes + offset, BRIO_SCALAR_FLOAT32, h->swap);
}

/* Returns whether mode and axes make sense in a byte order, and sets h->swap and h->axis. Some programs leave the axes
 * 0, which stands for 1, 2, 3; then the number of columns decides. */
static bool makes_sense(ccp4_header *h, bool swap) {
    unsigned seen = 0;
    int64_t axes[3];
    h->swap = swap;
    int64_t mode = whole(h, MODE), columns = whole(h, SIZE);
    for (int k = 0; k < 3; k++) {
        axes[k] = whole(h, AXES + 4 * k);
        if (axes[k] >= 0 && axes[k] <= 3) seen |= 1u << axes[k];
    }
    bool none = axes[0] == 0 && axes[1] == 0 && axes[2] == 0;
    for (int k = 0; k < 3; k++) h->axis[k] = none ? k : (int)axes[k] - 1;
    return (none ? columns >= 0 && columns <= UINT16_MAX : seen == 14) && mode >= 0 && mode < 256;
}

static brio_status find_type(const brio_stream *s, ccp4_header *h) {
    static const struct {
        int64_t mode;
        brio_scalar type;
    } types[] = {{0, BRIO_SCALAR_INT8}, {1, BRIO_SCALAR_INT16}, {2, BRIO_SCALAR_FLOAT32}, {6, BRIO_SCALAR_UINT16}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (h->mode == types[i].mode) {
            h->type = types[i].type;
            return BRIO_OK;
        }
    return brio_fail(s->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %d: mode %" PRId64
                     "%s, expected 0 (8-bit), 1 (16-bit), 2 (float) or 6 (unsigned 16-bit)",
                     s->name, MODE, h->mode, h->mode == 3 || h->mode == 4 ? " (a transform, no map)" : "");
}

static brio_status parse_header(const brio_stream *s, ccp4_header *h) {
    BRIO_EXPECT(s->ctx, !memcmp(h->bytes + LABEL, "MAP", 3), BRIO_ERR_FORMAT,
                "%s: byte %d: expected the word \"MAP \" of a CCP4 or MRC map", s->name, LABEL);
    BRIO_EXPECT(s->ctx, makes_sense(h, !brio_host_is_little()) || makes_sense(h, brio_host_is_little()),
                BRIO_ERR_FORMAT, "%s: byte %d: the axes of columns, rows and sections are not 1, 2, 3 in some order",
                s->name, AXES);
    h->mode = whole(h, MODE);
    h->symmetry_bytes = whole(h, SYMMETRY_BYTES);
    for (int k = 0; k < 3; k++) {
        h->size[k] = whole(h, SIZE + 4 * k);
        h->start[k] = whole(h, START + 4 * k);
        h->intervals[k] = whole(h, INTERVALS + 4 * k);
        h->length[k] = real(h, CELL_LENGTHS + 4 * k);
        h->angle[k] = real(h, CELL_ANGLES + 4 * k);
        h->origin[k] = real(h, ORIGIN + 4 * k);
    }
    return find_type(s, h);
}

static brio_status check_header(const brio_stream *s, const ccp4_header *h) {
    static const char *const parts[3] = {"columns", "rows", "sections"};
    for (int k = 0; k < 3; k++) {
        BRIO_EXPECT(s->ctx, h->size[k] > 0, BRIO_ERR_FORMAT, "%s: byte %d: %" PRId64 " %s", s->name, SIZE + 4 * k,
                    h->size[k], parts[k]);
        BRIO_EXPECT(s->ctx, h->intervals[k] > 0, BRIO_ERR_FORMAT,
                    "%s: byte %d: %" PRId64 " intervals along the cell's %c, expected at least 1", s->name,
                    INTERVALS + 4 * k, h->intervals[k], "xyz"[k]);
        BRIO_EXPECT(s->ctx, h->length[k] > 0 && isfinite(h->length[k]), BRIO_ERR_FORMAT,
                    "%s: byte %d: the cell is %g long along %c, expected a positive number", s->name,
                    CELL_LENGTHS + 4 * k, h->length[k], "xyz"[k]);
        BRIO_EXPECT(s->ctx, isfinite(h->origin[k]), BRIO_ERR_FORMAT, "%s: byte %d: the origin is not a number", s->name,
                    ORIGIN + 4 * k);
    }
    BRIO_EXPECT(s->ctx, h->symmetry_bytes >= 0, BRIO_ERR_FORMAT, "%s: byte %d: %" PRId64 " bytes of symmetry records",
                s->name, SYMMETRY_BYTES, h->symmetry_bytes);
    return BRIO_OK;
}

/* --- axes in space --- */

/* Computes the three axes of the cell, of length 1. The angles are between y and z, x and z, x and y; if all are 0,
 * they are right angles. */
static brio_status find_axes(const brio_stream *s, const ccp4_header *h, double axes[3][3]) {
    double c[3];
    bool none = h->angle[0] == 0 && h->angle[1] == 0 && h->angle[2] == 0;
    for (int k = 0; k < 3; k++) /* a right angle must have the cosine 0 */
        c[k] = none || h->angle[k] == 90 ? 0 : cos(h->angle[k] * (3.14159265358979323846 / 180));
    double sine = sqrt(1 - c[2] * c[2]), across = (c[0] - c[1] * c[2]) / sine;
    double up = 1 - c[1] * c[1] - across * across;
    bool proper = sine > 0 && up > 0;
    for (int k = 0; k < 3; k++) proper = proper && (none || (h->angle[k] > 0 && h->angle[k] < 180));
    BRIO_EXPECT(s->ctx, proper, BRIO_ERR_FORMAT, "%s: byte %d: no cell has the angles %g, %g, %g", s->name, CELL_ANGLES,
                h->angle[0], h->angle[1], h->angle[2]);
    memcpy(axes, (const double[3][3]){{1, 0, 0}, {c[2], sine, 0}, {c[1], across, sqrt(up)}}, 9 * sizeof(double));
    return BRIO_OK;
}

static brio_status place_volume(const brio_stream *s, const ccp4_header *h, brio_volume *volume) {
    double axes[3][3];
    bool has_origin = h->origin[0] != 0 || h->origin[1] != 0 || h->origin[2] != 0;
    BRIO_FORWARD(find_axes(s, h, axes));
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) volume->step[k][i] = axes[k][i] * h->length[k] / (double)h->intervals[k];
    for (int i = 0; i < 3; i++) {
        volume->origin[i] = has_origin ? h->origin[i] : 0;
        for (int part = 0; part < 3 && !has_origin; part++)
            volume->origin[i] += (double)h->start[part] * volume->step[h->axis[part]][i];
    }
    return BRIO_OK;
}

/* --- values --- */

typedef struct {
    uint64_t offset, count; /* offset of the first value that is not finite, and the number of such values */
} not_finite;

static void convert_row(const ccp4_header *h, const char *bytes, uint64_t offset, float *target, size_t stride,
                        not_finite *wrong) {
    size_t size = brio_scalar_size(h->type);
    for (int64_t i = 0; i < h->size[0]; i++) {
        double value = brio_scalar_load(bytes + (size_t)i * size, h->type, h->swap);
        if (!isfinite(value) && wrong->count++ == 0) wrong->offset = offset + (uint64_t)i * size;
        target[(size_t)i * stride] = (float)value;
    }
}

static brio_status read_values(brio_stream *s, const ccp4_header *h, brio_volume *volume) {
    size_t size = brio_scalar_size(h->type);
    const size_t of_axis[3] = {1, volume->size[0], (size_t)volume->size[0] * volume->size[1]};
    size_t column = of_axis[h->axis[0]], row = of_axis[h->axis[1]], section = of_axis[h->axis[2]];
    not_finite wrong = {0};
    brio_stream_element(s, "row", (uint64_t)(h->size[1] * h->size[2]));
    for (size_t z = 0; z < (size_t)h->size[2]; z++)
        for (size_t y = 0; y < (size_t)h->size[1]; y++, s->row++) {
            const char *bytes = NULL;
            uint64_t offset = brio_stream_offset(s);
            BRIO_FORWARD(brio_stream_take(s, (size_t)h->size[0] * size, &bytes));
            convert_row(h, bytes, offset, volume->values + z * section + y * row, column, &wrong);
        }
    BRIO_EXPECT(s->ctx, !wrong.count, BRIO_ERR_NOT_FINITE,
                "%s: byte %" PRIu64 ": the value is not finite; there are %" PRIu64 " such values", s->name,
                wrong.offset, wrong.count);
    return BRIO_OK;
}

brio_status brio_ccp4_read(brio_stream *s, brio_volume *out) {
    char bytes[HEADER_BYTES];
    const char *start = NULL;
    uint64_t count;
    ccp4_header h = {.bytes = bytes};
    *out = (brio_volume){0};
    brio_stream_element(s, "word", HEADER_BYTES / 4);
    BRIO_FORWARD(brio_stream_take(s, HEADER_BYTES, &start));
    memcpy(bytes, start, HEADER_BYTES);
    BRIO_FORWARD(parse_header(s, &h));
    BRIO_FORWARD(check_header(s, &h));
    BRIO_FORWARD(place_volume(s, &h, out));
    for (int part = 0; part < 3; part++) out->size[h.axis[part]] = (uint32_t)h.size[part];
    bool fits = !__builtin_mul_overflow((uint64_t)h.size[0] * (uint64_t)h.size[1], (uint64_t)h.size[2], &count);
    BRIO_EXPECT(s->ctx, fits && count < UINT64_MAX / 8, BRIO_ERR_TOO_LARGE,
                "%s: %" PRId64 " x %" PRId64 " x %" PRId64 " values", s->name, h.size[0], h.size[1], h.size[2]);
    brio_stream_element(s, "byte of the symmetry records", (uint64_t)h.symmetry_bytes);
    BRIO_FORWARD(brio_stream_skip(s, (uint64_t)h.symmetry_bytes));
    BRIO_FORWARD(brio_stream_expect(s, count, brio_scalar_size(h.type), "the header"));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, out->values, (size_t)count));
    return read_values(s, &h, out);
}
