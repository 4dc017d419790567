/* Reads VTU files with arrays appended as raw bytes: points, point data, tetrahedra and polygons.
 *
 * Arrays are read in the order of the file. Points become vertices at once, and point data become properties. The three
 * arrays of the cells are stored until all have been read. Cells of other types are skipped.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#define _GNU_SOURCE
#include "base/memory.h"
#include "io/formats.h"
#include "io/scalar.h"
#include "io/vtk/vtu_header.h"
#include <inttypes.h>
#include <string.h>

enum { VTK_TRIANGLE = 5, VTK_POLYGON = 7, VTK_QUAD = 9, VTK_TETRAHEDRON = 10, FIRST_CAPACITY = 1 << 16 };

/* An array of the cells, in this machine's byte order. */
typedef struct {
    char *bytes;
    uint64_t count;
    int type;
} cell_array;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    brio_vtu_header header;
    cell_array connectivity, offsets, types;
} vtu_reader;

bool brio_vtu_starts(const char *bytes, size_t size) {
    static const char xml[] = "<?xml", file[] = "<VTKFile";
    if (size >= strlen(xml) && !memcmp(bytes, xml, strlen(xml))) return memmem(bytes, size, file, strlen(file)) != NULL;
    return size >= strlen(file) && !memcmp(bytes, file, strlen(file));
}

/* --- arrays --- */

/* Moves to an array and reads its size. The array must have *count rows; UINT64_MAX accepts any number and receives
 * it. */
static brio_status open_array(vtu_reader *r, const brio_vtu_array *a, uint64_t *count) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    uint64_t at = brio_stream_offset(s), start, bytes = 0, rows, row;
    BRIO_REQUIRE(s->ctx, !__builtin_add_overflow(r->header.base, a->offset, &start) && start >= at, BRIO_ERR_FORMAT,
                 "%s: array %s begins at byte %" PRIu64 ", where another is", s->name, a->name, start);
    brio_stream_element(s, a->name[0] ? a->name : "array", *count == UINT64_MAX ? 0 : *count);
    BRIO_TRY(brio_stream_skip(s, start - at));
    const char *word = NULL;
    BRIO_TRY(brio_stream_take(s, r->header.word, &word));
    uint32_t narrow;
    brio_scalar_gather(r->header.word == 8 ? (void *)&bytes : (void *)&narrow, word, 1, 0, r->header.word,
                       r->header.swap);
    if (r->header.word == 4) bytes = narrow;
    bool overflow = __builtin_mul_overflow(a->components, brio_vtu_type_size(a->type), &row) || row == 0;
    rows = overflow ? 0 : bytes / row;
    BRIO_REQUIRE(s->ctx, !overflow && rows * row == bytes && (*count == UINT64_MAX || rows == *count), BRIO_ERR_FORMAT,
                 "%s: array %s has %" PRIu64 " bytes, which is not %" PRIu64 " rows", s->name, a->name, bytes, *count);
    BRIO_TRY(brio_stream_expect(s, bytes, 1, a->name));
    *count = rows;
    s->rows = rows;
done:
    return status;
}

static brio_status read_points(vtu_reader *r, const brio_vtu_array *a) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    uint64_t count = r->header.num_points;
    BRIO_REQUIRE(s->ctx, a->components == 3 && a->type < BRIO_SCALAR_END && !r->builder->mesh->num_vertices,
                 BRIO_ERR_FORMAT, "%s: expected one array of points with 3 components Float32 or Float64", s->name);
    BRIO_TRY(open_array(r, a, &count));
    /* the size of the file, or properties that were read before, show that the count is true; room for properties
     * follows that for the vertices */
    bool true_count = s->size != BRIO_SIZE_UNKNOWN || r->builder->mesh->num_properties;
    if (true_count) BRIO_TRY(brio_builder_expect_vertices(r->builder, count));
    size_t row = 3 * brio_vtu_type_size(a->type);
    while (s->row < count) {
        BRIO_TRY(brio_stream_fill(s, row));
        size_t rows = brio_stream_left(s) / row;
        if (rows > count - s->row) rows = (size_t)(count - s->row);
        if (!rows) return brio_stream_truncated(s);
        BRIO_TRY(brio_builder_add_vertices(r->builder, rows));
        brio_scalar_convert_triples(r->builder->mesh->vertices + 3 * s->row, s->buffer + s->begin, rows, row,
                                    (brio_scalar)a->type, r->header.swap);
        s->begin += rows * row;
        s->row += rows;
    }
done:
    return status;
}

/* Reads an array into a new block, which grows as data are read. */
static brio_status read_block(vtu_reader *r, const brio_vtu_array *a, uint64_t count, cell_array *out) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    size_t size = brio_vtu_type_size(a->type), capacity = 0;
    *out = (cell_array){NULL, 0, a->type};
    BRIO_TRY(open_array(r, a, &count));
    if (s->size != BRIO_SIZE_UNKNOWN) capacity = (size_t)count * size;
    BRIO_TRY(BRIO_ALLOC(s->ctx, out->bytes, capacity));
    while (s->row < count) {
        BRIO_TRY(brio_stream_fill(s, size));
        size_t rows = brio_stream_left(s) / size;
        if (rows > count - s->row) rows = (size_t)(count - s->row);
        if (!rows) return brio_stream_truncated(s);
        BRIO_TRY(BRIO_RESERVE(s->ctx, out->bytes, capacity, (s->row + rows) * size));
        brio_scalar_gather(out->bytes + s->row * size, s->buffer + s->begin, rows, size, size, r->header.swap);
        s->begin += rows * size;
        s->row += rows;
    }
    out->count = count;
done:
    return status;
}

/* Reads an array as a property. Skips arrays of vectors and of 64-bit integers, which no property can hold. */
static brio_status read_property(vtu_reader *r, const brio_vtu_array *a) {
    brio_status status = BRIO_OK;
    cell_array values = {NULL, 0, 0};
    if (a->components != 1 || a->type >= BRIO_SCALAR_END || !a->name[0]) return BRIO_OK;
    BRIO_TRY(read_block(r, a, r->header.num_points, &values));
    void *data = values.bytes;
    values.bytes = NULL;
    BRIO_TRY(brio_builder_adopt_property(r->builder, a->name, (brio_scalar)a->type, data));
done:
    brio_release(r->stream->ctx, values.bytes);
    return status;
}

static brio_status read_cells(vtu_reader *r, const brio_vtu_array *a) {
    cell_array *target = !strcmp(a->name, "connectivity") ? &r->connectivity
                         : !strcmp(a->name, "offsets")    ? &r->offsets
                         : !strcmp(a->name, "types")      ? &r->types
                                                          : NULL;
    if (!target || a->components != 1) return BRIO_OK;
    if (target->bytes) return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT, "%s: two arrays %s", r->stream->name, a->name);
    return read_block(r, a, target == &r->connectivity ? UINT64_MAX : r->header.num_cells, target);
}

static brio_status read_array(vtu_reader *r, const brio_vtu_array *a) {
    switch (a->section) {
    case BRIO_VTU_POINTS:
        return read_points(r, a);
    case BRIO_VTU_POINT_DATA:
        return read_property(r, a);
    case BRIO_VTU_CELLS:
        return read_cells(r, a);
    case BRIO_VTU_OTHER:
        break;
    }
    return BRIO_OK;
}

/* --- cells --- */

static double number_at(const cell_array *a, uint64_t i) {
    const char *p = a->bytes + i * brio_vtu_type_size(a->type);
    uint64_t raw;
    if (a->type < BRIO_SCALAR_END) return brio_scalar_load(p, (brio_scalar)a->type, false);
    memcpy(&raw, p, sizeof raw);
    return a->type == BRIO_VTU_INT64 ? (double)(int64_t)raw : (double)raw;
}

static brio_status add_cell(vtu_reader *r, uint64_t from, uint64_t to, double type) {
    brio_status status = BRIO_OK;
    if (type == VTK_TETRAHEDRON) {
        double corners[4];
        BRIO_REQUIRE(r->stream->ctx, to - from == 4, BRIO_ERR_FORMAT,
                     "%s: tetrahedron %zu (counted from 0): %" PRIu64 " corners, expected 4", r->stream->name,
                     r->builder->mesh->num_tetrahedra, to - from);
        for (int i = 0; i < 4; i++) corners[i] = number_at(&r->connectivity, from + (uint64_t)i);
        return brio_builder_tetrahedron(r->builder, corners);
    }
    if (type != VTK_TRIANGLE && type != VTK_POLYGON && type != VTK_QUAD) return BRIO_OK;
    for (uint64_t i = from; i < to; i++) BRIO_TRY(brio_builder_corner(r->builder, number_at(&r->connectivity, i)));
    BRIO_TRY(brio_builder_face(r->builder));
done:
    return status;
}

static brio_status add_cells(vtu_reader *r) {
    brio_status status = BRIO_OK;
    uint64_t from = 0;
    for (uint64_t c = 0; c < r->header.num_cells; c++) {
        double to = number_at(&r->offsets, c);
        BRIO_REQUIRE(r->stream->ctx, to >= (double)from && to <= (double)r->connectivity.count, BRIO_ERR_FORMAT,
                     "%s: cell %" PRIu64 " (counted from 0): offset %.17g, expected %" PRIu64 " to %" PRIu64,
                     r->stream->name, c, to, from, r->connectivity.count);
        BRIO_TRY(add_cell(r, from, (uint64_t)to, number_at(&r->types, c)));
        from = (uint64_t)to;
    }
done:
    return status;
}

brio_status brio_vtu_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    vtu_reader r = {.stream = s, .builder = b};
    BRIO_TRY(brio_vtu_header_read(s, &r.header));
    for (size_t i = 0; i < r.header.num_arrays; i++) BRIO_TRY(read_array(&r, &r.header.arrays[i]));
    BRIO_REQUIRE(s->ctx, b->mesh->num_vertices == r.header.num_points, BRIO_ERR_FORMAT, "%s: no array of points",
                 s->name);
    BRIO_REQUIRE(s->ctx, !r.header.num_cells || (r.connectivity.bytes && r.offsets.bytes && r.types.bytes),
                 BRIO_ERR_FORMAT, "%s: expected arrays connectivity, offsets and types of the cells", s->name);
    BRIO_TRY(add_cells(&r));
done:
    brio_vtu_header_free(s->ctx, &r.header);
    brio_release(s->ctx, r.connectivity.bytes);
    brio_release(s->ctx, r.offsets.bytes);
    brio_release(s->ctx, r.types.bytes);
    return status;
}
