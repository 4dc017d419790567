/* Chooses the format of a LAS file that is written, and the places of the properties in its records.
 *
 * The format is the first one whose fields take the most properties. A field takes the property of its name, capitals not
 * counted, if all values fit. Every other property becomes an extra number, with its type and its name: cut to 32 bytes, and
 * with _2, _3 and so on behind it where a reader of LAS has a field of that name, or another extra number has it. Numbers
 * that were scaled, or had 64 bits, in the LAS file they come from are so again if that gives back all their values.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "io/las/las_layout.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/little_endian.h"
#include <math.h>
#include <string.h>
#include <strings.h>

enum { LATE = 4 /* place of the first format of version 1.4 in the list of formats */, MOST_EXTRAS = 340 };
enum { UINT64 = 7, INT64 = 8, SINGLE = 9 /* types of extra bytes */ };

/* The names that readers give to fields of any format: an extra number of such a name would be a second one. */
static const char *const reserved[] = {"X",
                                       "Y",
                                       "Z",
                                       "x",
                                       "y",
                                       "z",
                                       "intensity",
                                       "bit_fields",
                                       "raw_classification",
                                       "classification_flags",
                                       "return_number",
                                       "number_of_returns",
                                       "scan_direction_flag",
                                       "edge_of_flight_line",
                                       "classification",
                                       "synthetic",
                                       "key_point",
                                       "withheld",
                                       "overlap",
                                       "scanner_channel",
                                       "scan_angle_rank",
                                       "scan_angle",
                                       "user_data",
                                       "point_source_id",
                                       "gps_time",
                                       "red",
                                       "green",
                                       "blue",
                                       "nir",
                                       "wavepacket_index",
                                       "wavepacket_offset",
                                       "wavepacket_size",
                                       "return_point_wave_location",
                                       "x_t",
                                       "y_t",
                                       "z_t",
                                       "ExtraBytes"};

/* --- ranges --- */

/* Finds what a property's extra bytes were described by in the file it comes from, or NULL. */
static const char *description_of(const brio_mesh *block, const char *name) {
    const brio_metadata *extras = brio_mesh_metadata(block, "las.extras");
    for (size_t at = 0; extras && extras->size - at >= BRIO_LAS_EXTRA_ENTRY; at += BRIO_LAS_EXTRA_ENTRY) {
        const char *bytes = extras->bytes + at + BRIO_LAS_EXTRA_ENTRY - BRIO_LAS_EXTRA;
        unsigned type = (uint8_t)bytes[BRIO_EXTRA_TYPE];
        if (!strncmp(extras->bytes + at, name, 64)) return brio_las_extra_bytes(type) ? bytes : NULL;
    }
    return NULL;
}

typedef struct {
    unsigned type;
    double scale, offset;
} number_form;

static number_form form_of(const char *description) {
    unsigned options = (uint8_t)description[BRIO_EXTRA_OPTIONS];
    number_form f = {(uint8_t)description[BRIO_EXTRA_TYPE], 1, 0};
    if (options & BRIO_EXTRA_SCALED) f.scale = brio_le_double(description + BRIO_EXTRA_SCALE);
    if (options & BRIO_EXTRA_SHIFTED) f.offset = brio_le_double(description + BRIO_EXTRA_OFFSET);
    return f;
}

/* Returns the number that stands for a value: a whole one, or for types of floating-point numbers any. */
static double raw_number(const number_form *f, double x) {
    double n = (x - f->offset) / f->scale;
    return f->type > SINGLE ? n : f->type == SINGLE ? (double)(float)n : rint(n);
}

/* Whether a reader finds the value. */
static bool gives_back(const number_form *f, double x) {
    static const double least[] = {0, 0, -128, 0, -32768, 0, -0x1p31, 0, -0x1p63, -INFINITY, -INFINITY};
    static const double above[] = {0, 256, 128, 65536, 32768, 0x1p32, 0x1p31, 0x1p64, 0x1p63, INFINITY, INFINITY};
    double n = raw_number(f, x);
    return n >= least[f->type] && n < above[f->type] && n * f->scale + f->offset == x;
}

static void widen(brio_las_range *r, const brio_property *p, const char *description, size_t count) {
    number_form f = {0, 1, 0};
    if (r->described) f = form_of(description);
    for (size_t i = 0; i < count; i++) {
        double x = brio_property_value(p, i);
        r->whole &= x == floor(x) && fabs(x) <= UINT32_MAX;
        if (x < r->low) r->low = x;
        if (x > r->high) r->high = x;
        if (f.type && !gives_back(&f, x)) f.type = 0;
    }
    r->described = f.type != 0;
}

brio_status brio_las_layout_see(brio_context *ctx, brio_las_layout *l, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    size_t n = block->num_properties;
    bool first = !l->ranges;
    if (first) BRIO_TRY(BRIO_ALLOC(ctx, l->ranges, n + 1));
    for (size_t i = 0; i < n; i++) {
        const char *description = description_of(block, block->properties[i].name);
        if (first) l->ranges[i] = (brio_las_range){true, INFINITY, -INFINITY, description != NULL};
        l->ranges[i].described &= description != NULL;
        widen(&l->ranges[i], &block->properties[i], description, block->num_vertices);
    }
done:
    return status;
}

/* --- fields --- */

static bool fits(const brio_las_field *f, const brio_las_range *r) {
    if (r->low > r->high) return r->whole; /* no values, or NaN alone */
    if (f->type == BRIO_SCALAR_FLOAT64) return true;
    bool is_signed = f->type == BRIO_SCALAR_INT8 || f->type == BRIO_SCALAR_INT16;
    int bits = f->bits ? f->bits : 8 * (int)brio_scalar_size(f->type);
    double most = ldexp(1, bits - is_signed) - 1;
    return r->whole && r->low >= (is_signed ? -most - 1 : 0) && r->high <= most;
}

/* Whether a property is the first one that a field's name stands for: that of the very name, or else of its letters. */
static bool is_owner(const brio_mesh *m, size_t property, const char *field) {
    const brio_property *exact = brio_mesh_property(m, field);
    if (exact) return exact == &m->properties[property];
    for (size_t i = 0; i < m->num_properties; i++)
        if (!strcasecmp(m->properties[i].name, field)) return i == property;
    return false;
}

/* Finds the field of a format that takes a property, or NULL. */
static const brio_las_field *field_of(const brio_las_field *fields, size_t count, const brio_mesh *m, size_t property,
                                      const brio_las_range *r) {
    for (size_t i = 0; i < count; i++)
        if (is_owner(m, property, fields[i].name)) return fits(&fields[i], r) ? &fields[i] : NULL;
    return NULL;
}

static unsigned choose_format(const brio_las_layout *l, const brio_mesh *m, bool late) {
    static const unsigned formats[] = {0, 1, 2, 3, 6, 7, 8};
    brio_las_field fields[BRIO_LAS_FIELDS];
    size_t most = 0, first = late ? LATE : 0;
    unsigned best = formats[first];
    for (size_t i = first; i < sizeof formats / sizeof *formats; i++) {
        size_t taken = 0, count = brio_las_fields_of(formats[i], fields);
        for (size_t j = 0; j < m->num_properties; j++) taken += field_of(fields, count, m, j, &l->ranges[j]) != NULL;
        if (taken <= most) continue;
        most = taken;
        best = formats[i];
    }
    return best;
}

/* --- extra numbers --- */

static bool is_taken(const brio_las_layout *l, size_t count, const char *name) {
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
        if (!strcmp(reserved[i], name)) return true;
    for (size_t i = 0; i < count; i++)
        if (l->places[i].extra && !strcmp(l->places[i].name, name)) return true;
    return false;
}

static void place_extra(brio_las_layout *l, const brio_mesh *m, size_t i) {
    const brio_property *p = &m->properties[i];
    const char *description = l->ranges[i].described ? description_of(m, p->name) : NULL;
    brio_las_place place = {.at = l->record, .type = p->type, .extra = true};
    if (description) {
        number_form f = form_of(description);
        place.raw = f.type;
        place.scale = f.scale;
        place.offset = f.offset;
    }
    brio_utf8_copy(place.name, sizeof place.name, p->name);
    for (size_t n = 2; is_taken(l, i, place.name); n++) brio_numbered_name(place.name, sizeof place.name, p->name, n);
    place.renamed = strcmp(place.name, p->name) != 0;
    l->places[i] = place;
    l->record += place.raw ? brio_las_extra_bytes(place.raw) : brio_scalar_size(p->type);
    l->num_extras++;
}

brio_status brio_las_layout_make(brio_context *ctx, brio_las_layout *l, const char *name, const brio_mesh *m,
                                 bool late) {
    brio_status status = BRIO_OK;
    brio_las_field fields[BRIO_LAS_FIELDS];
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, l->places, m->num_properties + 1));
    l->format = choose_format(l, m, late);
    l->record = brio_las_record_bytes(l->format);
    size_t count = brio_las_fields_of(l->format, fields);
    for (size_t i = 0; i < m->num_properties; i++) {
        const char *own = m->properties[i].name;
        const brio_las_field *f = field_of(fields, count, m, i, &l->ranges[i]);
        BRIO_REQUIRE(ctx, f || l->num_extras < MOST_EXTRAS, BRIO_ERR_ARGUMENT,
                     "%s: a LAS file holds at most %d properties that its format does not know", name, MOST_EXTRAS);
        if (!f) {
            place_extra(l, m, i);
            continue;
        }
        l->places[i] = (brio_las_place){
            .at = f->at, .type = f->type, .shift = f->shift, .bits = f->bits, .renamed = strcmp(own, f->name) != 0};
    }
done:
    return status;
}

void brio_las_layout_free(brio_context *ctx, brio_las_layout *l) {
    brio_release(ctx, l->places);
    brio_release(ctx, l->ranges);
    l->places = NULL;
    l->ranges = NULL;
}

/* A description of other values keeps its text alone. */
void brio_las_describe(const brio_las_layout *l, const brio_mesh *m, size_t property, char bytes[BRIO_LAS_EXTRA]) {
    static const uint8_t types[BRIO_SCALAR_END] = {2, 1, 4, 3, 6, 5, 9, 10};
    const brio_las_place *place = &l->places[property];
    const char *known = description_of(m, m->properties[property].name);
    memset(bytes, 0, BRIO_LAS_EXTRA);
    if (known && place->raw) memcpy(bytes, known, BRIO_LAS_EXTRA);
    if (known && !place->raw)
        memcpy(bytes + BRIO_EXTRA_TEXT, known + BRIO_EXTRA_TEXT, BRIO_LAS_EXTRA - BRIO_EXTRA_TEXT);
    if (!place->raw) bytes[BRIO_EXTRA_TYPE] = (char)types[place->type];
    memset(bytes + BRIO_EXTRA_NAME, 0, BRIO_LAS_NAME);
    memcpy(bytes + BRIO_EXTRA_NAME, place->name, strlen(place->name));
}

/* --- values --- */

static void put_number(char *bytes, brio_scalar type, double x) {
    float single = (float)x;
    uint32_t bits;
    switch (type) {
    case BRIO_SCALAR_FLOAT64:
        brio_put_le_double(bytes, x);
        return;
    case BRIO_SCALAR_FLOAT32:
        memcpy(&bits, &single, sizeof bits);
        brio_put_le32(bytes, bits);
        return;
    default:
        bits = (uint32_t)(int64_t)x;
        if (brio_scalar_size(type) == 4) brio_put_le32(bytes, bits);
        if (brio_scalar_size(type) == 2) brio_put_le16(bytes, (uint16_t)bits);
        if (brio_scalar_size(type) == 1) *bytes = (char)bits;
    }
}

static void put_raw(const brio_las_place *place, double x, char *bytes) {
    static const brio_scalar types[] = {
        [1] = BRIO_SCALAR_UINT8,  [2] = BRIO_SCALAR_INT8,  [3] = BRIO_SCALAR_UINT16,  [4] = BRIO_SCALAR_INT16,
        [5] = BRIO_SCALAR_UINT32, [6] = BRIO_SCALAR_INT32, [9] = BRIO_SCALAR_FLOAT32, [10] = BRIO_SCALAR_FLOAT64};
    const number_form f = {place->raw, place->scale, place->offset};
    double n = raw_number(&f, x);
    if (place->raw == UINT64)
        brio_put_le64(bytes, (uint64_t)n);
    else if (place->raw == INT64)
        brio_put_le64(bytes, (uint64_t)(int64_t)n);
    else
        put_number(bytes, types[place->raw], n);
}

void brio_las_put(const brio_las_place *place, const brio_property *property, size_t i, char *record) {
    double x = brio_property_value(property, i);
    char *bytes = record + place->at;
    if (place->bits)
        *bytes = (char)((uint8_t)*bytes | (unsigned)x << place->shift);
    else if (place->raw)
        put_raw(place, x, bytes);
    else
        put_number(bytes, place->type, x);
}
