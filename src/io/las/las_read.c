/* Reads LAS files of versions 1.0 to 1.5 and, with laz_read.c, their compressed form LAZ.
 *
 * Records have fixed size. What the buffer has of them is divided among the threads; each thread goes through its part
 * in blocks that stay in the cache while one column after the other is taken.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "base/memory.h"
#include "base/team.h"
#include "io/formats.h"
#include "io/las/las.h"
#include "io/little_endian.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* --- fields --- */

/* The fields of LAS records. Coordinates are whole numbers times a scale plus an offset, computed as every reader of
 * LAS does, so that the doubles are the same. */

#define U8  BRIO_SCALAR_UINT8
#define I8  BRIO_SCALAR_INT8
#define U16 BRIO_SCALAR_UINT16
#define I16 BRIO_SCALAR_INT16
#define F64 BRIO_SCALAR_FLOAT64

enum { UINT64 = 7, INT64 = 8, DOUBLE = 10 /* types of extra bytes */ };

/* Formats 0 to 5, and 6 to 10. */
static const brio_las_field early[] = {
    {"intensity", U16, 12, 0, 0},           {"return_number", U8, 14, 0, 3},       {"number_of_returns", U8, 14, 3, 3},
    {"scan_direction_flag", U8, 14, 6, 1},  {"edge_of_flight_line", U8, 14, 7, 1}, {"classification", U8, 15, 0, 5},
    {"classification_flags", U8, 15, 5, 3}, {"scan_angle_rank", I8, 16, 0, 0},     {"user_data", U8, 17, 0, 0},
    {"point_source_id", U16, 18, 0, 0}};
static const brio_las_field late[] = {
    {"intensity", U16, 12, 0, 0},           {"return_number", U8, 14, 0, 4},   {"number_of_returns", U8, 14, 4, 4},
    {"classification_flags", U8, 15, 0, 4}, {"scanner_channel", U8, 15, 4, 2}, {"scan_direction_flag", U8, 15, 6, 1},
    {"edge_of_flight_line", U8, 15, 7, 1},  {"classification", U8, 16, 0, 0},  {"user_data", U8, 17, 0, 0},
    {"scan_angle", I16, 18, 0, 0},          {"point_source_id", U16, 20, 0, 0}};

/* Where time, colour and near infrared begin in each format; 0: the format has none. */
static const struct {
    uint8_t time, colour, infrared;
} places[BRIO_LAS_FORMATS] = {{0, 0, 0},  {20, 0, 0},  {0, 20, 0},   {20, 28, 0}, {20, 0, 0},  {20, 28, 0},
                              {22, 0, 0}, {22, 30, 0}, {22, 30, 36}, {22, 0, 0},  {22, 30, 36}};

size_t brio_las_fields_of(unsigned format, brio_las_field *fields) {
    static const char *const colours[] = {"red", "green", "blue"};
    size_t count = format < 6 ? sizeof early / sizeof *early : sizeof late / sizeof *late;
    memcpy(fields, format < 6 ? early : late, count * sizeof *fields);
    if (places[format].time) fields[count++] = (brio_las_field){"gps_time", F64, places[format].time, 0, 0};
    for (uint8_t i = 0; i < 3 && places[format].colour; i++)
        fields[count++] = (brio_las_field){colours[i], U16, (uint8_t)(places[format].colour + 2 * i), 0, 0};
    if (places[format].infrared) fields[count++] = (brio_las_field){"nir", U16, places[format].infrared, 0, 0};
    return count;
}

/* --- the plan --- */

/* Returns whether a format has colours. */
static bool las_has_colours(unsigned format) {
    return places[format].colour;
}

/* Adds the property of a field. Times of version 1.5 are moved to where all versions count from. */
static brio_status plan_field(brio_las_plan *plan, brio_builder *b, const brio_las_header *h, const brio_las_field *f) {
    bool moved = h->time_shift != 0 && f->type == F64;
    plan->columns[plan->num_columns++] = (brio_las_column){.property = b->mesh->num_properties,
                                                           .at = f->at,
                                                           .extra = moved ? DOUBLE : 0,
                                                           .type = f->type,
                                                           .shift = f->shift,
                                                           .bits = f->bits,
                                                           .scale = 1,
                                                           .offset = h->time_shift};
    return brio_builder_property(b, f->name, f->type);
}

/* Keeps a description that says more than a name and a type. */
static brio_status keep_description(brio_las_plan *plan, brio_las_records *kept, const brio_las_extra *e,
                                    const char *name) {
    bool more = (uint8_t)e->description[BRIO_EXTRA_OPTIONS] & BRIO_EXTRA_ALL_OPTIONS;
    if (!more && !e->description[BRIO_EXTRA_TEXT] && e->type != UINT64 && e->type != INT64) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(plan->ctx, kept->bytes, kept->capacity, kept->size + BRIO_LAS_EXTRA_ENTRY));
    memset(kept->bytes + kept->size, 0, 64);
    memcpy(kept->bytes + kept->size, name, strlen(name));
    memcpy(kept->bytes + kept->size + 64, e->description, BRIO_LAS_EXTRA);
    kept->size += BRIO_LAS_EXTRA_ENTRY;
    return BRIO_OK;
}

/* Plans an extra number. A name that the format has already, or another extra number, gets "_2", "_3", ... behind
 * it. Numbers that are scaled, or have 64 bits, become doubles. */
static brio_status plan_extra(brio_las_plan *plan, brio_builder *b, const brio_las_header *h, const brio_las_extra *e,
                              brio_las_records *kept) {
    static const brio_scalar types[] = {
        F64, U8, I8, U16, I16, BRIO_SCALAR_UINT32, BRIO_SCALAR_INT32, F64, F64, BRIO_SCALAR_FLOAT32, F64};
    bool wide = e->scaled || e->type == UINT64 || e->type == INT64;
    brio_las_column c = {.property = b->mesh->num_properties,
                         .at = brio_las_record_bytes(h->format) + e->at,
                         .extra = wide ? e->type : 0,
                         .type = wide ? F64 : types[e->type],
                         .scale = e->scale,
                         .offset = e->offset};
    char name[64];
    brio_builder_new_name(b, e->name, name);
    BRIO_FORWARD(brio_builder_property(b, name, c.type));
    plan->columns[plan->num_columns++] = c;
    return keep_description(plan, kept, e, name);
}

static brio_status begin_plan(brio_las_plan *plan, const brio_builder *b, const brio_las_header *h) {
    *plan = (brio_las_plan){.ctx = b->ctx, .record = h->record, .rounded = plan->rounded};
    memcpy(plan->scale, h->scale, sizeof plan->scale);
    memcpy(plan->offset, h->offset, sizeof plan->offset);
    return BRIO_ALLOC(b->ctx, plan->columns, BRIO_LAS_FIELDS + h->num_extras);
}

/* Adds the properties of a file to the mesh under construction, and the metadata "las.extras" if descriptions say more
 * than
 *  name and type. Call brio_las_plan_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY. */
static brio_status las_plan_make(brio_las_plan *plan, brio_builder *b, const brio_las_header *h) {
    brio_status status = BRIO_OK;
    brio_las_field fields[BRIO_LAS_FIELDS];
    brio_las_records kept = {.bytes = NULL};
    size_t count = brio_las_fields_of(h->format, fields);
    BRIO_TRY(begin_plan(plan, b, h));
    for (size_t i = 0; i < count; i++) BRIO_TRY(plan_field(plan, b, h, &fields[i]));
    for (size_t i = 0; i < h->num_extras; i++) BRIO_TRY(plan_extra(plan, b, h, &h->extras[i], &kept));
    if (kept.size) BRIO_TRY(brio_mesh_set_metadata(b->mesh, "las.extras", kept.bytes, kept.size));
done:
    brio_release(b->ctx, kept.bytes);
    return status;
}

brio_status brio_las_plan_colours(brio_las_plan *plan, brio_builder *b, const brio_las_header *h) {
    brio_las_field fields[BRIO_LAS_FIELDS];
    size_t count = brio_las_fields_of(h->format, fields);
    BRIO_FORWARD(begin_plan(plan, b, h));
    for (size_t i = 0; i < count; i++)
        if (fields[i].at >= places[h->format].colour && fields[i].at < places[h->format].colour + 6)
            BRIO_FORWARD(plan_field(plan, b, h, &fields[i]));
    return BRIO_OK;
}

void brio_las_plan_free(brio_las_plan *plan) {
    brio_release(plan->ctx, plan->columns);
    plan->columns = NULL;
}

/* --- records --- */

static void store_coordinates(const brio_las_plan *plan, double *vertices, const char *records, size_t count) {
    double scale[3], offset[3];
    memcpy(scale, plan->scale, sizeof scale);
    memcpy(offset, plan->offset, sizeof offset);
    for (size_t i = 0; i < count; i++, records += plan->record)
        for (int k = 0; k < 3; k++)
            vertices[3 * i + (size_t)k] = (double)(int32_t)brio_le32(records + 4 * k) * scale[k] + offset[k];
}

static void store_bits(uint8_t *target, const char *bytes, size_t count, size_t record, const brio_las_column *c) {
    uint8_t mask = (uint8_t)((1u << c->bits) - 1), shift = c->shift;
    for (size_t i = 0; i < count; i++, bytes += record) target[i] = (uint8_t)*bytes >> shift & mask;
}

static double extra_value(const char *bytes, unsigned type) {
    static const brio_scalar types[] = {[1] = U8,
                                        [2] = I8,
                                        [3] = U16,
                                        [4] = I16,
                                        [5] = BRIO_SCALAR_UINT32,
                                        [6] = BRIO_SCALAR_INT32,
                                        [9] = BRIO_SCALAR_FLOAT32,
                                        [DOUBLE] = F64};
    if (type == UINT64) return (double)brio_le64(bytes);
    if (type == INT64) return (double)(int64_t)brio_le64(bytes);
    return brio_scalar_load(bytes, types[type], !brio_host_is_little());
}

/* Returns whether an integer of 64 bits is no double. */
static bool is_rounded(const char *bytes, unsigned type) {
    uint64_t size = brio_le64(bytes);
    if (type == INT64 && size >> 63) size = -size;
    double x = (double)size;
    return x >= 0x1p64 || (uint64_t)x != size;
}

static void store_extra(const brio_las_plan *plan, double *target, const char *bytes, size_t count,
                        const brio_las_column *c) {
    bool whole = c->extra == UINT64 || c->extra == INT64, rounded = false;
    for (size_t i = 0; i < count; i++, bytes += plan->record) {
        target[i] = extra_value(bytes, c->extra) * c->scale + c->offset;
        rounded |= whole && is_rounded(bytes, c->extra);
    }
    if (rounded) atomic_store_explicit(plan->rounded, true, memory_order_relaxed);
}

void brio_las_store(const brio_las_plan *plan, const brio_mesh *mesh, const char *records, size_t first, size_t count) {
    store_coordinates(plan, mesh->vertices + 3 * first, records, count);
    for (size_t i = 0; i < plan->num_columns; i++) {
        const brio_las_column *c = &plan->columns[i];
        size_t size = brio_scalar_size(c->type);
        char *target = (char *)mesh->properties[c->property].data + first * size;
        if (c->bits)
            store_bits((uint8_t *)target, records + c->at, count, plan->record, c);
        else if (c->extra)
            store_extra(plan, (double *)(void *)target, records + c->at, count, c);
        else
            brio_scalar_gather(target, records + c->at, count, plan->record, size, !brio_host_is_little());
    }
}

/* --- depth of colours --- */

/* Finds out whether the colours of a LAS file have 8 bits.
 *
 * LAS has colours of 16 bits, and says that numbers of 8 bits are to be scaled; many programs write them as they are. A
 * file is of that kind if no number of its colours is over 255. All points are looked at, so that the answer does not
 * depend on which come first; the search ends at the first larger number. Black alone tells nothing. */

typedef struct brio_las_depth {
    bool coloured; /* whether a colour is not black */
    bool deep;     /* whether a number needs more than 8 bits */
} brio_las_depth;

enum { MOST_OF_8_BITS = 255 };

/* Looks at the colours of a block. */
static void las_depth_see(brio_las_depth *d, const brio_mesh *block) {
    static const char *const names[] = {"red", "green", "blue"};
    for (int k = 0; k < 3 && !d->deep; k++) {
        const brio_property *p = brio_mesh_property(block, names[k]);
        const uint16_t *values = p->data;
        uint16_t most = 0;
        for (size_t i = 0; i < block->num_vertices; i++)
            if (values[i] > most) most = values[i];
        d->coloured |= most > 0;
        d->deep |= most > MOST_OF_8_BITS;
    }
}

/* Gives the mesh the metadata "colour.depth", 8, if its file has such colours. */
static brio_status las_depth_give(const brio_las_depth *d, brio_mesh *mesh) {
    return d->coloured && !d->deep ? brio_mesh_set_metadata(mesh, "colour.depth", "8", 1) : BRIO_OK;
}

static brio_status look(void *user, const brio_mesh *block) {
    brio_las_depth *d = user;
    las_depth_see(d, block);
    return d->deep ? BRIO_ERR_CANCELLED : BRIO_OK; /* more points change nothing */
}

/* Looks at the colours of all points of a file that is no pipe, without moving the stream.
 *  s  where the points begin.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
static brio_status las_depth_find(brio_stream *s, const brio_builder *b, const brio_las_header *h, brio_las_depth *d) {
    brio_status status = BRIO_OK;
    brio_stream again = {.ctx = s->ctx, .file = -1};
    brio_builder colours = {.ctx = s->ctx};
    brio_las_plan plan = {.ctx = s->ctx};
    const brio_sink sink = {look, d};
    *d = (brio_las_depth){.deep = false};
    BRIO_TRY(brio_stream_open_again(&again, s));
    BRIO_TRY(brio_stream_skip(&again, brio_stream_offset(s)));
    BRIO_TRY(brio_builder_start(&colours, s->ctx, b->name));
    colours.sink = &sink;
    colours.drop_invalid = true; /* the reading that counts refuses */
    colours.salvage = b->salvage;
    brio_builder_stream(&colours, BRIO_COUNT_UNKNOWN);
    BRIO_TRY(brio_las_plan_colours(&plan, &colours, h));
    BRIO_TRY(brio_las_read_points(&again, &colours, h, &plan));
    BRIO_TRY(brio_builder_finish(&colours));
done:
    if (d->deep) status = BRIO_OK;
    brio_las_plan_free(&plan);
    brio_mesh_free(colours.mesh);
    brio_stream_close(&again);
    return status;
}

/* --- the file --- */

/* Both chosen: a block fits in the second-level cache, and a thread's part is worth waking it. */
enum { BLOCK_BYTES = 1 << 16, LEAST_ROWS = 1 << 12 };

static bool las_starts(const char *bytes, size_t size) {
    return size >= 4 && !memcmp(bytes, "LASF", 4);
}

static bool laz_starts(const char *bytes, size_t size) {
    enum { POINT_FORMAT = 104, COMPRESSED = 0xc0 };
    return las_starts(bytes, size) && size > POINT_FORMAT && (bytes[POINT_FORMAT] & COMPRESSED);
}

typedef struct {
    const brio_las_plan *plan;
    const brio_mesh *mesh;
    const char *records;
    size_t first;
} block_job;

static void store_part(void *user, size_t begin, size_t end, int thread) {
    const block_job *job = user;
    size_t record = job->plan->record, most = BLOCK_BYTES / record + 1;
    (void)thread;
    for (size_t i = begin; i < end; i += most)
        brio_las_store(job->plan, job->mesh, job->records + i * record, job->first + i,
                       end - i < most ? end - i : most);
}

/* Returns how many of the points that the header announces a file can have. */
static uint64_t points_that_are_there(const brio_stream *s, const brio_las_header *h) {
    uint64_t offset = brio_stream_offset(s), room = s->size > offset ? (s->size - offset) / h->record : 0;
    return room < h->num_points ? room : h->num_points;
}

static brio_status read_records(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    if (s->size != BRIO_SIZE_UNKNOWN) BRIO_FORWARD(brio_builder_expect_vertices(b, points_that_are_there(s, h)));
    while (s->row < h->num_points) {
        BRIO_FORWARD(brio_stream_fill(s, h->record));
        size_t rows = brio_stream_left(s) / h->record;
        if (rows > BRIO_BLOCK_ROWS) rows = BRIO_BLOCK_ROWS;
        if (rows > h->num_points - s->row) rows = (size_t)(h->num_points - s->row);
        if (!rows && b->salvage) break;
        if (!rows) return brio_stream_truncated(s);
        BRIO_FORWARD(brio_builder_add_vertices(b, rows));
        block_job job = {plan, b->mesh, s->buffer + s->begin, b->mesh->num_vertices - rows};
        BRIO_FORWARD(brio_for(s->ctx, brio_threads(s->ctx, rows, LEAST_ROWS), rows, store_part, &job));
        s->begin += rows * h->record;
        s->row += rows;
    }
    b->missing = h->num_points - s->row;
    return BRIO_OK;
}

brio_status brio_las_read_points(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    brio_stream_element(s, "point", h->num_points);
    return h->compressed ? brio_laz_read(s, b, h, plan) : read_records(s, b, h, plan);
}

/* Returns whether a file can be read a second time while it is read. */
static bool can_look_ahead(const brio_stream *s) {
    return s->size != BRIO_SIZE_UNKNOWN && !s->unpacker;
}

/* Takes what is known only when all points of a pipe have been read: the depth of colours, and records behind the
 * points. */
static brio_status end_pipe(brio_stream *s, brio_builder *b, brio_las_header *h, bool has_depth) {
    brio_las_depth depth = {.deep = false};
    if (!has_depth) {
        las_depth_see(&depth, b->mesh);
        BRIO_FORWARD(las_depth_give(&depth, b->mesh));
    }
    if (h->late_pending && b->streams) BRIO_FORWARD(brio_builder_leave_out(b, "records behind the points of a pipe"));
    if (!h->late_pending || b->streams) return BRIO_OK;
    BRIO_FORWARD(brio_las_late_records_read(s, b, h));
    return brio_las_records_give(b, h);
}

/* Reads a file. A pipe with colours is not handed on in blocks: what the colours are is known at its end. */
static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_las_header h;
    atomic_bool rounded = false;
    brio_las_plan plan = {.ctx = b->ctx, .rounded = &rounded};
    brio_las_depth depth = {.deep = false};
    BRIO_TRY(brio_las_header_read(s, b, &h));
    if (!h.compressed && !b->salvage) BRIO_TRY(brio_stream_expect(s, h.num_points, h.record, "the header"));
    bool has_depth = can_look_ahead(s) || !las_has_colours(h.format);
    if (has_depth) brio_builder_stream(b, b->salvage ? BRIO_COUNT_UNKNOWN : h.num_points);
    snprintf(b->version, sizeof b->version, "1.%d, point format %u", h.minor, h.format);
    BRIO_REQUIRE(b->ctx, b->streams || h.num_points <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, h.num_points, BRIO_MAX_VERTICES);
    if (has_depth && las_has_colours(h.format)) BRIO_TRY(las_depth_find(s, b, &h, &depth));
    BRIO_TRY(las_depth_give(&depth, b->mesh));
    BRIO_TRY(las_plan_make(&plan, b, &h));
    memcpy(b->mesh->coordinate_step, h.scale, sizeof h.scale);
    memcpy(b->mesh->coordinate_origin, h.offset, sizeof h.offset);
    BRIO_TRY(brio_las_read_points(s, b, &h, &plan));
    BRIO_TRY(end_pipe(s, b, &h, has_depth));
    if (rounded) BRIO_TRY(brio_builder_leave_out(b, "last digits of integers of 64 bits"));
done:
    brio_las_plan_free(&plan);
    brio_las_header_free(b->ctx, &h);
    return status;
}

const brio_codec brio_las_codec = {.starts = las_starts, .read = read_file, .rows = &brio_las_rows};
const brio_codec brio_laz_codec = {.starts = laz_starts, .read = read_file, .rows = &brio_laz_rows};
