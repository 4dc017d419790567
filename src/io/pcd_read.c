/* Reads PCD files: text, binary and compressed.
 *
 * A point of any form becomes a row of doubles, which hold every number of the format except integers of 64 bits beyond
 * 2^53. Points whose coordinates are not finite are places of the scan without a return, and are left out. The field
 * rgb or rgba packs bytes into one number, which become properties.
 *
 * Based on: Rusu Cousins. 3D is here: Point Cloud Library. ICRA 2011. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/little_endian.h"
#include "io/pcd_header.h"
#include "io/builder.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What becomes of a number: AXIS + k is a coordinate, PROPERTY + i property i. */
enum { SKIP = 0, COLOUR = 1, AXIS = 2, PROPERTY = 5 };

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    const brio_pcd_header *header;
    size_t *roles;       /* of each number of a point */
    double *values;      /* of one point */
    size_t first_colour; /* the property red, behind which are green, blue and alpha */
    bool has_colour, has_alpha;
    bool rounded; /* whether an integer of 64 bits is beyond 2^53 */
} pcd_reader;

static bool starts(const char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "# .PCD", 6);
}

static brio_scalar type_of(const brio_pcd_field *f) {
    if (f->type == 'F') return f->size == 4 ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_FLOAT64;
    if (f->size == 8) return BRIO_SCALAR_FLOAT64;
    static const brio_scalar types[] = {[1] = BRIO_SCALAR_INT8, [2] = BRIO_SCALAR_INT16, [4] = BRIO_SCALAR_INT32};
    return (brio_scalar)(types[f->size] + (f->type == 'U'));
}

/* --- roles --- */

static bool is_colour(const brio_pcd_field *f) {
    return f->size == 4 && f->count == 1 && (!strcmp(f->name, "rgb") || !strcmp(f->name, "rgba"));
}

static brio_status plan_colour(pcd_reader *r, const brio_pcd_field *f, size_t *role) {
    static const char *const names[] = {"red", "green", "blue", "alpha"};
    r->first_colour = r->builder->mesh->num_properties;
    r->has_alpha = f->name[3] == 'a';
    r->has_colour = true;
    *role = COLOUR;
    for (int i = 0; i < 3 + r->has_alpha; i++)
        BRIO_FORWARD(brio_builder_property(r->builder, names[i], BRIO_SCALAR_UINT8));
    return BRIO_OK;
}

/* Returns the axis of a field whose name is one of three letters, "xyz" or "XYZ", or -1. */
static int axis_of(const brio_pcd_field *f, const char *letters) {
    const char *at = f->name[0] && !f->name[1] && f->count == 1 ? strchr(letters, f->name[0]) : NULL;
    return at ? (int)(at - letters) : -1;
}

/* Returns the letters of the axes: capitals where no field has a small one. */
static const char *letters_of(const brio_pcd_header *h) {
    for (size_t i = 0; i < h->num_fields; i++)
        if (axis_of(&h->fields[i], "xyz") >= 0) return "xyz";
    return "XYZ";
}

static brio_status plan_field(pcd_reader *r, const brio_pcd_field *f, size_t *roles, unsigned *axes) {
    int axis = axis_of(f, letters_of(r->header));
    if (axis >= 0 && !(*axes & 1u << axis)) {
        *axes |= 1u << axis;
        roles[0] = AXIS + (size_t)axis;
        return BRIO_OK;
    }
    if (is_colour(f) && !r->has_colour) return plan_colour(r, f, roles);
    for (unsigned i = 0; i < f->count && strcmp(f->name, "_") != 0; i++) {
        char name[64];
        brio_builder_component_name(r->builder, f->name, i, f->count, name);
        roles[i] = PROPERTY + r->builder->mesh->num_properties;
        BRIO_FORWARD(brio_builder_property(r->builder, name, type_of(f)));
    }
    return BRIO_OK;
}

static brio_status plan(pcd_reader *r) {
    unsigned axes = 0;
    size_t number = 0;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->stream->ctx, r->roles, r->header->numbers));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->stream->ctx, r->values, r->header->numbers));
    for (size_t i = 0; i < r->header->num_fields; number += r->header->fields[i++].count)
        BRIO_FORWARD(plan_field(r, &r->header->fields[i], r->roles + number, &axes));
    BRIO_EXPECT(r->stream->ctx, axes == 7, BRIO_ERR_FORMAT, "%s: the points have no field %c", r->stream->name,
                "xyxzxyx"[axes]);
    if (r->header->has_place) BRIO_FORWARD(brio_plan_origins(r->builder));
    return BRIO_OK;
}

/* --- points --- */

static brio_status store(pcd_reader *r, size_t v, size_t role, double value) {
    brio_mesh *m = r->builder->mesh;
    if (role == SKIP) return BRIO_OK;
    if (role == COLOUR) {
        uint32_t packed = (uint32_t)value;
        for (size_t i = 0; i < 3u + r->has_alpha; i++)
            ((uint8_t *)m->properties[r->first_colour + i].data)[v] = (uint8_t)(packed >> (i < 3 ? 16 - 8 * i : 24));
        return BRIO_OK;
    }
    if (role < PROPERTY) {
        m->vertices[3 * v + role - AXIS] = value;
        return BRIO_OK;
    }
    brio_property *p = &m->properties[role - PROPERTY];
    if (brio_scalar_store((char *)p->data + v * brio_scalar_size(p->type), p->type, value)) return BRIO_OK;
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: point %" PRIu64 " (counted from 0): %s is %.17g, not a number of its type", r->stream->name,
                     r->stream->row, p->name, value);
}

/* Adds the point in r->values, unless it is none. */
static brio_status add_point(pcd_reader *r) {
    for (size_t i = 0; i < r->header->numbers; i++)
        if (r->roles[i] >= AXIS && r->roles[i] < PROPERTY && !isfinite(r->values[i])) return BRIO_OK;
    BRIO_FORWARD(brio_builder_add_vertices(r->builder, 1));
    size_t v = r->builder->mesh->num_vertices - 1;
    brio_set_origins(r->builder, v, r->header->viewpoint);
    for (size_t i = 0; i < r->header->numbers; i++) BRIO_FORWARD(store(r, v, r->roles[i], r->values[i]));
    return BRIO_OK;
}

/* Returns the number at an address; a packed colour as the integer that it is. */
static double load(const char *bytes, const brio_pcd_field *f, size_t role) {
    if (role == COLOUR) return brio_le32(bytes);
    if (f->type == 'U' && f->size == 8) return (double)brio_le64(bytes);
    if (f->type == 'I' && f->size == 8) return (double)(int64_t)brio_le64(bytes);
    return brio_scalar_load(bytes, type_of(f), !brio_host_is_little());
}

/* Loads a point whose field i begins at bytes + step * field.at, plus its place among `points`. In rows step is 1; in
 * columns, of which each has all points, the fields of n points begin at n times their places. */
static void load_point(pcd_reader *r, const char *bytes, size_t points, size_t place) {
    double *value = r->values;
    const size_t *role = r->roles;
    for (size_t i = 0; i < r->header->num_fields; i++) {
        const brio_pcd_field *f = &r->header->fields[i];
        const char *at = bytes + points * f->at + place * f->size * f->count;
        for (unsigned j = 0; j < f->count; j++, role++, value++) {
            *value = load(at + j * f->size, f, *role);
            if (f->size == 8 && f->type != 'F') r->rounded |= fabs(*value) >= 0x1p53;
        }
    }
}

static brio_status read_binary(pcd_reader *r) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    const char *bytes = NULL;
    for (; s->row < r->header->points; s->row++) {
        status = brio_stream_take(s, r->header->record, &bytes);
        if (brio_salvage(r->builder, s, brio_builder_count(r->builder), true, &status)) break;
        BRIO_TRY(status);
        load_point(r, bytes, 1, 0);
        BRIO_TRY(add_point(r));
    }
done:
    return status;
}

static brio_status read_compressed(pcd_reader *r) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    const char *bytes = NULL;
    uint8_t *plain = NULL;
    uint64_t need, at = brio_stream_offset(s);
    BRIO_TRY(brio_stream_take(s, 8, &bytes));
    size_t compressed = brio_le32(bytes), size = brio_le32(bytes + 4);
    bool wraps = __builtin_mul_overflow(r->header->points, (uint64_t)r->header->record, &need);
    BRIO_REQUIRE(s->ctx, !wraps && need == size, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": %zu bytes of data, the header announces %" PRIu64, s->name, at + 4, size, need);
    BRIO_TRY(brio_stream_expect(s, compressed, 1, "the size of the data"));
    BRIO_TRY(brio_stream_take(s, compressed, &bytes));
    BRIO_REQUIRE(s->ctx, size / BRIO_LZF_MOST_RATIO <= compressed, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": %zu bytes cannot hold %zu", s->name, at, compressed, size);
    BRIO_TRY(BRIO_ALLOC(s->ctx, plain, size + 1));
    /* data that compression would not make smaller are stored as they are by some writers */
    if (!brio_lzf_decompress((const uint8_t *)bytes, compressed, plain, size)) {
        BRIO_REQUIRE(s->ctx, compressed == size, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": the compressed data are damaged", s->name, at + 8);
        memcpy(plain, bytes, size);
    }
    for (; s->row < r->header->points; s->row++) {
        load_point(r, (char *)plain, (size_t)r->header->points, (size_t)s->row);
        BRIO_TRY(add_point(r));
    }
done:
    brio_release(s->ctx, plain);
    return status;
}

/* Turns a packed colour that was printed as a floating-point number into the integer that it is. */
static double unpacked(double value) {
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return bits;
}

static brio_status read_text_row(pcd_reader *r, brio_text *text) {
    double *value = r->values;
    for (size_t i = 0; i < r->header->num_fields; i++) {
        const brio_pcd_field *f = &r->header->fields[i];
        for (unsigned j = 0; j < f->count; j++, value++) {
            BRIO_FORWARD(brio_text_number(text, value));
            bool colour = r->roles[value - r->values] == COLOUR;
            if (colour && f->type == 'F') *value = unpacked(*value);
            if (colour && !(*value >= 0 && *value <= UINT32_MAX))
                return brio_text_expected(text, "a packed colour before this place");
            if (f->size == 8 && f->type != 'F') r->rounded |= fabs(*value) >= 0x1p53;
        }
    }
    BRIO_FORWARD(brio_text_row_end(text));
    return add_point(r);
}

static brio_status read_text(pcd_reader *r) {
    brio_status status = BRIO_OK;
    brio_stream *s = r->stream;
    brio_text text = {s, 0, NULL};
    for (; s->row < r->header->points; s->row++) {
        uint64_t before = brio_builder_count(r->builder);
        status = read_text_row(r, &text);
        if (brio_salvage(r->builder, s, before, true, &status)) break;
        BRIO_TRY(status);
    }
    if (!s->salvaged) BRIO_TRY(brio_text_end(&text));
done:
    return status;
}

/* Checks the header's number of points against the bytes that are there. Each number of a text has another character
 * behind it, except the last one. Compressed data tell their size themselves, in 32 bits. */
static brio_status check_points(brio_stream *s, const brio_pcd_header *h, bool streams, bool salvages) {
    bool compressed = h->data == BRIO_PCD_COMPRESSED;
    uint64_t least = h->data == BRIO_PCD_ASCII ? 2 * h->numbers - 1 : h->record;
    if (!compressed && !salvages) BRIO_FORWARD(brio_stream_expect(s, h->points, least, "the header"));
    BRIO_EXPECT(s->ctx, !compressed || h->points <= UINT32_MAX / least, BRIO_ERR_FORMAT,
                "%s: the header announces %" PRIu64 " points of %" PRIu64 " bytes, compressed data hold 4 GiB at most",
                s->name, h->points, least);
    BRIO_EXPECT(s->ctx, streams || h->points <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                "%s: %" PRIu64 " points, the most are %" PRIu64, s->name, h->points, BRIO_MAX_VERTICES);
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_pcd_header header;
    pcd_reader r = {.stream = s, .builder = b, .header = &header};
    BRIO_TRY(brio_pcd_header_read(s, &header));
    brio_builder_stream(b, BRIO_COUNT_UNKNOWN);
    BRIO_TRY(check_points(s, &header, b->streams, b->salvage));
    BRIO_TRY(plan(&r));
    brio_stream_element(s, "point", header.points);
    if (header.data == BRIO_PCD_ASCII)
        BRIO_TRY(read_text(&r));
    else
        BRIO_TRY(header.data == BRIO_PCD_BINARY ? read_binary(&r) : read_compressed(&r));
    if (r.rounded) BRIO_TRY(brio_builder_leave_out(b, "integers beyond 2^53"));
    const double *turn = header.viewpoint + 3;
    bool turns = turn[0] != 1 || turn[1] != 0 || turn[2] != 0 || turn[3] != 0;
    if (header.placed && !b->has_origins) BRIO_TRY(brio_builder_leave_out(b, "viewpoint"));
    if (header.placed && b->has_origins && turns) BRIO_TRY(brio_builder_leave_out(b, "turns of scanners"));
    if (header.height > 1) BRIO_TRY(brio_builder_leave_out(b, "order in rows"));
done:
    brio_release(s->ctx, r.roles);
    brio_release(s->ctx, r.values);
    brio_pcd_header_free(s->ctx, &header);
    return status;
}

const brio_codec brio_pcd_codec = {.starts = starts, .read = read_file, .rows = &brio_pcd_rows};
