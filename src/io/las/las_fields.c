/* The fields of LAS records. Coordinates are whole numbers times a scale plus an offset, computed as every reader of
 * LAS does, so that the doubles are the same.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "io/las/las_fields.h"
#include "base/memory.h"
#include "io/little_endian.h"
#include "io/scalar.h"
#include <stdio.h>
#include <string.h>

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

bool brio_las_has_colours(unsigned format) {
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
    brio_status status = BRIO_OK;
    bool more = (uint8_t)e->description[BRIO_EXTRA_OPTIONS] & BRIO_EXTRA_ALL_OPTIONS;
    if (!more && !e->description[BRIO_EXTRA_TEXT] && e->type != UINT64 && e->type != INT64) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(plan->ctx, kept->bytes, kept->capacity, kept->size + BRIO_LAS_EXTRA_ENTRY));
    memset(kept->bytes + kept->size, 0, 64);
    memcpy(kept->bytes + kept->size, name, strlen(name));
    memcpy(kept->bytes + kept->size + 64, e->description, BRIO_LAS_EXTRA);
    kept->size += BRIO_LAS_EXTRA_ENTRY;
done:
    return status;
}

/* Plans an extra number. A name that the format has already, or another extra number, gets "_2", "_3", ... behind
 * it. Numbers that are scaled, or have 64 bits, become doubles. */
static brio_status plan_extra(brio_las_plan *plan, brio_builder *b, const brio_las_header *h, const brio_las_extra *e,
                              brio_las_records *kept) {
    static const brio_scalar types[] = {
        F64, U8, I8, U16, I16, BRIO_SCALAR_UINT32, BRIO_SCALAR_INT32, F64, F64, BRIO_SCALAR_FLOAT32, F64};
    brio_status status = BRIO_OK;
    bool wide = e->scaled || e->type == UINT64 || e->type == INT64;
    brio_las_column c = {.property = b->mesh->num_properties,
                         .at = brio_las_record_bytes(h->format) + e->at,
                         .extra = wide ? e->type : 0,
                         .type = wide ? F64 : types[e->type],
                         .scale = e->scale,
                         .offset = e->offset};
    char name[64];
    brio_builder_new_name(b, e->name, name);
    BRIO_TRY(brio_builder_property(b, name, c.type));
    plan->columns[plan->num_columns++] = c;
    BRIO_TRY(keep_description(plan, kept, e, name));
done:
    return status;
}

static brio_status begin_plan(brio_las_plan *plan, const brio_builder *b, const brio_las_header *h) {
    *plan = (brio_las_plan){.ctx = b->ctx, .record = h->record, .rounded = plan->rounded};
    memcpy(plan->scale, h->scale, sizeof plan->scale);
    memcpy(plan->offset, h->offset, sizeof plan->offset);
    return BRIO_ALLOC(b->ctx, plan->columns, BRIO_LAS_FIELDS + h->num_extras);
}

brio_status brio_las_plan_make(brio_las_plan *plan, brio_builder *b, const brio_las_header *h) {
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
    brio_status status = BRIO_OK;
    brio_las_field fields[BRIO_LAS_FIELDS];
    size_t count = brio_las_fields_of(h->format, fields);
    BRIO_TRY(begin_plan(plan, b, h));
    for (size_t i = 0; i < count; i++)
        if (fields[i].at >= places[h->format].colour && fields[i].at < places[h->format].colour + 6)
            BRIO_TRY(plan_field(plan, b, h, &fields[i]));
done:
    return status;
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

/* Whether an integer of 64 bits is no double. */
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
