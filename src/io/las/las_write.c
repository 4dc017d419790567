/* Writes LAS files: version 1.2 with formats 0 to 3, version 1.4 with formats 6 to 8.
 *
 * The format is the first one whose fields take the most properties. A field takes the property of its name if all
 * values fit; every other property is written as an extra number, with its name and type. Polygons are left out.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "base/memory.h"
#include "base/team.h"
#include "base/utf8.h"
#include "io/row_format.h"
#include "io/las/las_fields.h"
#include "io/las/las_grid.h"
#include "io/little_endian.h"
#include <math.h>
#include <string.h>

/* CHUNK: rows encoded at a time. Both chosen. */
enum { CHUNK = 1 << 15, ROWS_A_THREAD = 1 << 12 };
enum { HEADER = 227, HEADER_1_4 = 375, RECORD_HEADER = 54, EXTRA_RECORD = 192, MOST_EXTRAS = 340, EXTRA_NAME = 32 };
enum {
    LATE = 4 /* place of the first format of version 1.4 in a list of formats */,
    RETURNS = 15,
    WKT = 16 /* the flag of formats 6 to 10: coordinate systems as text */
};

/* Where a property goes. */
typedef struct {
    size_t at;
    brio_scalar type;
    uint8_t shift, bits;
    bool extra, renamed; /* renamed: as an extra number, because a field or another extra number has its name */
} place;

/* What the values of a property are. */
typedef struct {
    bool whole;
    double low, high;
} range;

typedef struct {
    const brio_mesh *block; /* that is being written; of the first one the properties count */
    brio_las_grid grid;
    unsigned format;
    size_t record, num_extras;
    place *places;
    range *ranges;
    uint64_t returns[RETURNS + 1]; /* points by the number of their return */
    char *rows;
    size_t first; /* the vertex of the first row */
} las_writer;

/* --- the format --- */

static void widen(range *r, const brio_property *p, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double x = brio_property_value(p, i);
        r->whole &= x == floor(x) && fabs(x) <= UINT32_MAX;
        if (x < r->low) r->low = x;
        if (x > r->high) r->high = x;
    }
}

static bool fits(const brio_las_field *f, const range *r) {
    if (r->low > r->high) return r->whole; /* no values, or NaN alone */
    if (f->type == BRIO_SCALAR_FLOAT64) return true;
    bool is_signed = f->type == BRIO_SCALAR_INT8 || f->type == BRIO_SCALAR_INT16;
    int bits = f->bits ? f->bits : 8 * (int)brio_scalar_size(f->type);
    double most = ldexp(1, bits - is_signed) - 1;
    return r->whole && r->low >= (is_signed ? -most - 1 : 0) && r->high <= most;
}

/* Finds the field of a format that takes a property, or NULL. */
static const brio_las_field *field_of(const brio_las_field *fields, size_t count, const brio_property *p,
                                      const range *r) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(fields[i].name, p->name)) return fits(&fields[i], r) ? &fields[i] : NULL;
    return NULL;
}

static bool is_field(const brio_las_field *fields, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(fields[i].name, name)) return true;
    return false;
}

static unsigned choose_format(const las_writer *w) {
    static const unsigned formats[] = {0, 1, 2, 3, 6, 7, 8};
    const brio_mesh *m = w->block;
    brio_las_field fields[BRIO_LAS_FIELDS];
    size_t most = 0;
    size_t first = w->grid.points > UINT32_MAX ? LATE : 0; /* the others count points in 32 bits */
    unsigned best = formats[first];
    for (size_t i = first; i < sizeof formats / sizeof *formats; i++) {
        size_t taken = 0, count = brio_las_fields_of(formats[i], fields);
        for (size_t j = 0; j < m->num_properties; j++)
            taken += field_of(fields, count, &m->properties[j], &w->ranges[j]) != NULL;
        if (taken <= most) continue;
        most = taken;
        best = formats[i];
    }
    return best;
}

static brio_status check_extra(brio_output *out, const las_writer *w) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(out->ctx, w->num_extras < MOST_EXTRAS, BRIO_ERR_ARGUMENT,
                 "%s: a LAS file holds at most %d properties that its format does not know", out->name, MOST_EXTRAS);
done:
    return status;
}

static brio_status plan(brio_output *out, las_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->block;
    brio_las_field fields[BRIO_LAS_FIELDS];
    BRIO_TRY(BRIO_ALLOC_ZERO(out->ctx, w->places, m->num_properties + 1));
    w->format = choose_format(w);
    w->record = brio_las_record_bytes(w->format);
    size_t count = brio_las_fields_of(w->format, fields);
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        const brio_las_field *f = field_of(fields, count, p, &w->ranges[i]);
        if (f) {
            w->places[i] = (place){f->at, f->type, f->shift, f->bits, false, false};
            continue;
        }
        BRIO_TRY(check_extra(out, w));
        w->places[i] = (place){w->record, p->type, 0, 0, true, is_field(fields, count, p->name)};
        w->record += brio_scalar_size(p->type);
        w->num_extras++;
    }
done:
    return status;
}

/* --- the header --- */

static void put_limits(const las_writer *w, char *header) {
    const brio_las_grid *g = &w->grid;
    for (int k = 0; k < 3; k++) {
        int32_t low = g->points ? brio_las_grid_number(g, k, g->low[k]) : 0;
        int32_t high = g->points ? brio_las_grid_number(g, k, g->high[k]) : 0;
        brio_put_le_double(header + 131 + 8 * k, g->step[k]);
        brio_put_le_double(header + 155 + 8 * k, g->origin[k]);
        brio_put_le_double(header + 179 + 16 * k, high * g->step[k] + g->origin[k]);
        brio_put_le_double(header + 187 + 16 * k, low * g->step[k] + g->origin[k]);
    }
}

static brio_status write_header(brio_output *out, const brio_write_job *job, las_writer *w) {
    char header[HEADER_1_4] = "LASF";
    const brio_property *numbers = brio_mesh_property(w->block, "return_number");
    uint64_t n = job->points;
    bool late = w->format >= 6;
    size_t size = late ? HEADER_1_4 : HEADER, extras = w->num_extras ? RECORD_HEADER + EXTRA_RECORD * w->num_extras : 0;
    const char *comment = job->options->comment ? job->options->comment : "brio " BRIO_VERSION;
    if (numbers && w->places[numbers - w->block->properties].extra) memset(w->returns, 0, sizeof w->returns);
    brio_put_le16(header + 6, late ? WKT : 0);
    header[24] = 1;
    header[25] = late ? 4 : 2;
    memcpy(header + 26, "OTHER", 5);
    memcpy(header + 58, comment, strlen(comment) < 32 ? strlen(comment) : 31);
    brio_put_le16(header + 94, (uint16_t)size);
    brio_put_le32(header + 96, (uint32_t)(size + extras));
    brio_put_le32(header + 100, w->num_extras != 0);
    header[104] = (char)w->format;
    brio_put_le16(header + 105, (uint16_t)w->record);
    if (!late) brio_put_le32(header + 107, (uint32_t)n);
    for (int i = 0; i < 5 && !late; i++) brio_put_le32(header + 111 + 4 * i, (uint32_t)w->returns[i + 1]);
    put_limits(w, header);
    if (late) brio_put_le64(header + 247, n);
    for (int i = 0; i < RETURNS && late; i++) brio_put_le64(header + 255 + 8 * i, w->returns[i + 1]);
    return brio_output_bytes(out, header, size);
}

static bool is_taken(const char *extras, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strncmp(extras + EXTRA_RECORD * i + 4, name, EXTRA_NAME)) return true;
    return false;
}

/* Names have 32 bytes, without an end: a longer one is cut, and one that is taken gets _2, _3 and so on behind it.
 * Returns whether the name is the property's. */
static bool put_extra(char *extras, size_t count, const brio_property *p) {
    static const uint8_t types[BRIO_SCALAR_END] = {2, 1, 4, 3, 6, 5, 9, 10};
    char name[EXTRA_NAME + 1], *extra = extras + EXTRA_RECORD * count;
    brio_utf8_copy(name, sizeof name, p->name);
    for (size_t n = 2; is_taken(extras, count, name); n++) brio_numbered_name(name, sizeof name, p->name, n);
    extra[2] = (char)types[p->type];
    memcpy(extra + 4, name, strlen(name));
    return !strcmp(name, p->name);
}

static brio_status write_extras(brio_output *out, las_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->block;
    char header[RECORD_HEADER] = {0}, *extras = NULL;
    if (!w->num_extras) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(out->ctx, extras, EXTRA_RECORD * w->num_extras));
    memcpy(header + 2, "LASF_Spec", 9);
    brio_put_le16(header + 18, 4);
    brio_put_le16(header + 20, (uint16_t)(EXTRA_RECORD * w->num_extras));
    BRIO_TRY(brio_output_bytes(out, header, sizeof header));
    for (size_t i = 0, count = 0; i < m->num_properties; i++)
        if (w->places[i].extra) w->places[i].renamed |= !put_extra(extras, count++, &m->properties[i]);
    BRIO_TRY(brio_output_bytes(out, extras, EXTRA_RECORD * w->num_extras));
done:
    brio_release(out->ctx, extras);
    return status;
}

/* --- records --- */

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

static void encode(void *user, size_t begin, size_t end, int thread) {
    const las_writer *w = user;
    const brio_mesh *m = w->block;
    (void)thread;
    memset(w->rows + begin * w->record, 0, (end - begin) * w->record);
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++)
            brio_put_le32(w->rows + i * w->record + 4 * k,
                          (uint32_t)brio_las_grid_number(&w->grid, k, m->vertices[3 * (w->first + i) + (size_t)k]));
    for (size_t j = 0; j < m->num_properties; j++) {
        const place *p = &w->places[j];
        for (size_t i = begin; i < end; i++) {
            double x = brio_property_value(&m->properties[j], w->first + i);
            char *bytes = w->rows + i * w->record + p->at;
            if (p->bits)
                *bytes = (char)((uint8_t)*bytes | (unsigned)x << p->shift);
            else
                put_number(bytes, p->type, x);
        }
    }
}

static brio_status write_records(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    size_t n = job->mesh->num_vertices;
    w->block = job->mesh;
    if (!w->rows) BRIO_TRY(BRIO_ALLOC(out->ctx, w->rows, CHUNK * w->record));
    for (w->first = 0; w->first < n; w->first += CHUNK) {
        size_t count = n - w->first < CHUNK ? n - w->first : CHUNK;
        brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode, w);
        BRIO_TRY(brio_output_bytes(out, w->rows, count * w->record));
    }
done:
    return status;
}

/* --- what must be known before --- */

static void count_returns(las_writer *w, const brio_mesh *block) {
    const brio_property *p = brio_mesh_property(block, "return_number");
    for (size_t v = 0; p && v < block->num_vertices; v++) {
        double x = brio_property_value(p, v);
        if (x >= 0 && x <= RETURNS) w->returns[(int)x]++;
    }
}

static brio_status survey(brio_context *ctx, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    const brio_mesh *m = job->mesh;
    if (!w->ranges) {
        BRIO_TRY(BRIO_ALLOC(ctx, w->ranges, m->num_properties + 1));
        for (size_t i = 0; i < m->num_properties; i++) w->ranges[i] = (range){true, INFINITY, -INFINITY};
    }
    if (w->grid.pass == 0) {
        for (size_t i = 0; i < m->num_properties; i++) widen(&w->ranges[i], &m->properties[i], m->num_vertices);
        count_returns(w, m);
    }
    BRIO_TRY(brio_las_grid_survey(ctx, &w->grid, m));
done:
    return status;
}

static bool surveyed(void *state) {
    las_writer *w = state;
    return brio_las_grid_end_pass(&w->grid);
}

static uint64_t surveyed_points(const void *state) {
    const las_writer *w = state;
    return w->grid.points;
}

static bool renames(const void *state, size_t i) {
    const las_writer *w = state;
    return w->places[i].renamed;
}

static bool rounds(const void *state) {
    const las_writer *w = state;
    return w->grid.rounds[0] || w->grid.rounds[1] || w->grid.rounds[2];
}

static double moved(const void *state, const brio_mesh *block) {
    const las_writer *w = state;
    return brio_las_grid_moved(&w->grid, block);
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    las_writer *w = state;
    w->block = job->mesh;
    BRIO_TRY(plan(out, w));
    BRIO_TRY(write_header(out, job, w));
    BRIO_TRY(write_extras(out, w));
done:
    return status;
}

static void free_state(brio_context *ctx, void *state) {
    las_writer *w = state;
    brio_release(ctx, w->places);
    brio_release(ctx, w->ranges);
    brio_release(ctx, w->rows);
    brio_las_grid_free(ctx, &w->grid);
}

const brio_row_format brio_las_rows = {.state = sizeof(las_writer),
                                       .survey = survey,
                                       .surveyed = surveyed,
                                       .surveyed_points = surveyed_points,
                                       .begin = begin,
                                       .rows = write_records,
                                       .free = free_state,
                                       .renames = renames,
                                       .rounds = rounds,
                                       .moved = moved};
