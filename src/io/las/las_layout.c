/* Chooses the format of a LAS file that is written, and the places of the properties in its records.
 *
 * The format is the first one whose fields take the most properties. A field takes the property of its name, capitals
 * not counted, if all values fit. Every other property becomes an extra number, with its type and its name: cut to 32
 * bytes, and with _2, _3 and so on behind it where a reader of LAS has a field of that name, or another extra number
 * has it. Numbers that were scaled, or had 64 bits, in the LAS file they come from are so again if that gives back all
 * their values.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "io/las/las_layout.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/little_endian.h"
#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* --- the grid of the coordinates --- */

/* Finds scale and offset for the coordinates of a LAS file.
 *
 * A grid is accepted if for every coordinate x the nearest whole number n gives x = n * step + origin in doubles, the
 * way a reader computes it. Most grids that do not fit fail at one of the first points, or at one of the witnesses: a
 * candidate that fails behind the first block costs another pass. */

/* Powers of 1/10 and of 1/2 that are tried: a nanometre, and the last bits of singles near 1. ORIGINS: whole numbers
 * within the range that are tried as origins of the first COARSE decimals. MOST_PASSES: after these, coordinates are
 * rounded. WITNESSES_A_BLOCK: points of a block that become witnesses. All chosen. */
enum { DECIMALS = 9, HALVES = 24, ORIGINS = 1024, COARSE = 4, MOST_PASSES = 16, WITNESSES_A_BLOCK = 16 };

static const double tenths[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

static double number_of(double x, double step, double origin) {
    return rint((x - origin) / step);
}

/* Returns whether an axis' candidate gives back coordinates. */
static bool gives_back(const brio_las_grid *g, int axis, const double *points, size_t count) {
    double step = g->step[axis], origin = g->origin[axis];
    if (!(step != 0) || !isfinite(step) || !isfinite(origin)) return false;
    for (size_t v = 0; v < count; v++) {
        double x = points[3 * v + (size_t)axis], n = number_of(x, step, origin);
        if (!(n >= INT32_MIN && n <= INT32_MAX) || n * step + origin != x) return false;
    }
    return true;
}

/* --- candidates --- */

/* Sets whole numbers within the range as origins. Near an origin products with the step are small, so their sums with
 * the origin round to the double nearest to the decimal number. The doubles of most texts are such. */
static bool set_origin(brio_las_grid *g, int axis, size_t which) {
    double low = g->low[axis], high = g->high[axis], first = floor(low), count = ceil(high) - first;
    if (!(count > 0 && fabs(low) + fabs(high) < 0x1p53)) return false;
    double stride = count > ORIGINS ? ceil(count / ORIGINS) : 1;
    size_t origins = (size_t)((high - first) / stride) + 1, decimals = which / origins;
    if (decimals > COARSE) return false;
    g->step[axis] = tenths[decimals];
    g->origin[axis] = first + (double)(which % origins) * stride;
    return true;
}

/* Sets the candidate of an axis by its number. Returns false behind the last one. */
static bool set_candidate(brio_las_grid *g, int axis) {
    const double origins[] = {0, floor(g->low[axis])};
    size_t which = g->candidate[axis] - 1;
    if (which < 2 * (DECIMALS + 1)) {
        g->step[axis] = tenths[which % (DECIMALS + 1)];
        g->origin[axis] = origins[which / (DECIMALS + 1)];
        return true;
    }
    which -= 2 * (DECIMALS + 1);
    if (which < 2 * HALVES) {
        g->step[axis] = ldexp(1, -(int)(which % HALVES) - 1);
        g->origin[axis] = origins[which / HALVES];
        return true;
    }
    return set_origin(g, axis, which - 2 * HALVES);
}

/* Returns the least power of ten by which half the width of an axis is a whole number of 32 bits. Below the powers of
 * ten that doubles hold well it is the least double, or that times a power of two. */
static double rounding_step(double half) {
    double step = pow(10, ceil(log10(half / (INT32_MAX - 1))));
    if (!(step > 0)) step = DBL_TRUE_MIN;
    while (half / step > INT32_MAX) step *= 2;
    return step;
}

/* Takes a grid on which coordinates are rounded. The least double as step rounds nothing. */
static void round_axis(brio_las_grid *g, int axis) {
    double low = g->low[axis], high = g->high[axis];
    double half = isfinite(high - low) ? (high - low) / 2 : high / 2 - low / 2;
    g->origin[axis] = low / 2 + high / 2;
    g->step[axis] = high > low ? rounding_step(half) : 1;
    g->found[axis] = true;
    g->rounds[axis] = g->step[axis] > DBL_TRUE_MIN;
}

/* Goes on to the next candidate that gives back the witnesses. */
static void next_candidate(brio_las_grid *g, int axis) {
    do {
        g->candidate[axis]++;
        if (set_candidate(g, axis)) continue;
        round_axis(g, axis);
        return;
    } while (!gives_back(g, axis, *g->witnesses, g->num_witnesses));
}

/* --- passes --- */

static void take_box(brio_las_grid *g, const brio_mesh *block) {
    for (size_t v = 0; v < block->num_vertices; v++)
        for (int k = 0; k < 3; k++) {
            double x = block->vertices[3 * v + (size_t)k];
            bool first = v == 0 && g->points == 0;
            if (first || x < g->low[k]) g->low[k] = x;
            if (first || x > g->high[k]) g->high[k] = x;
        }
    g->points += block->num_vertices;
}

static void take_witnesses(brio_las_grid *g, const brio_mesh *block) {
    size_t stride = block->num_vertices / WITNESSES_A_BLOCK + 1;
    for (size_t v = 0; v < block->num_vertices && g->num_witnesses < BRIO_LAS_WITNESSES; v += stride)
        memcpy(g->witnesses[g->num_witnesses++], block->vertices + 3 * v, sizeof *g->witnesses);
}

/* Tries the grid of the source, in the first pass: `failed` says whether the source's grid failed anywhere. */
static void try_source(brio_las_grid *g, int axis, const brio_mesh *block) {
    if (!g->begun) {
        g->step[axis] = block->coordinate_step[axis];
        g->origin[axis] = block->coordinate_origin[axis];
    }
    if (!g->failed[axis]) g->failed[axis] = !gives_back(g, axis, block->vertices, block->num_vertices);
}

static void try_candidates(brio_las_grid *g, int axis, const brio_mesh *block) {
    while (!g->found[axis] && !gives_back(g, axis, block->vertices, block->num_vertices)) {
        next_candidate(g, axis);
        g->failed[axis] |= g->begun;
    }
}

brio_status brio_las_grid_survey(brio_context *ctx, brio_las_grid *g, const brio_mesh *block) {
    if (!g->witnesses) BRIO_FORWARD(BRIO_ALLOC(ctx, g->witnesses, BRIO_LAS_WITNESSES));
    if (g->pass == 0) {
        take_box(g, block);
        take_witnesses(g, block);
    }
    for (int k = 0; k < 3; k++) {
        if (g->found[k]) continue;
        if (g->pass == 0)
            try_source(g, k, block);
        else
            try_candidates(g, k, block);
    }
    g->begun = true;
    return BRIO_OK;
}

bool brio_las_grid_end_pass(brio_las_grid *g) {
    g->pass++;
    g->begun = false;
    for (int k = 0; k < 3; k++) {
        if (!g->failed[k]) g->found[k] = true;
        if (!g->found[k] && g->pass == 1) next_candidate(g, k);
        if (!g->found[k] && g->pass == MOST_PASSES) round_axis(g, k);
        g->failed[k] = false;
    }
    return g->found[0] && g->found[1] && g->found[2];
}

void brio_las_grid_share(brio_las_grid *g, const brio_las_grid *found) {
    memcpy(g->step, found->step, sizeof g->step);
    memcpy(g->origin, found->origin, sizeof g->origin);
    memcpy(g->found, found->found, sizeof g->found);
    memcpy(g->rounds, found->rounds, sizeof g->rounds);
}

void brio_las_grid_free(brio_context *ctx, brio_las_grid *g) {
    brio_release(ctx, g->witnesses);
    g->witnesses = NULL;
}

/* Returns the number of steps. A whole step beside the largest double can lead to infinity: then the number nearer to
 * the origin is taken. */
int32_t brio_las_grid_number(const brio_las_grid *g, int axis, double x) {
    double step = g->step[axis], origin = g->origin[axis], n = number_of(x, step, origin);
    if (!isfinite(n * step + origin)) n -= copysign(1, n);
    return n <= INT32_MIN ? INT32_MIN : n >= INT32_MAX ? INT32_MAX : (int32_t)n;
}

double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *m) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double by[3];
        for (int k = 0; k < 3; k++) {
            double x = m->vertices[3 * v + (size_t)k];
            by[k] = x - (brio_las_grid_number(grid, k, x) * grid->step[k] + grid->origin[k]);
        }
        if (by[0] != 0 || by[1] != 0 || by[2] != 0) most = fmax(most, hypot(by[0], hypot(by[1], by[2])));
    }
    return most;
}

/* --- places of properties --- */

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

/* Returns whether a reader finds the value. */
static bool form_gives_back(const number_form *f, double x) {
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
        if (f.type && !form_gives_back(&f, x)) f.type = 0;
    }
    r->described = f.type != 0;
}

brio_status brio_las_layout_see(brio_context *ctx, brio_las_layout *l, const brio_mesh *block) {
    size_t n = block->num_properties;
    bool first = !l->ranges;
    if (first) BRIO_FORWARD(BRIO_ALLOC(ctx, l->ranges, n + 1));
    for (size_t i = 0; i < n; i++) {
        const char *description = description_of(block, block->properties[i].name);
        if (first) l->ranges[i] = (brio_las_range){true, INFINITY, -INFINITY, description != NULL};
        l->ranges[i].described &= description != NULL;
        widen(&l->ranges[i], &block->properties[i], description, block->num_vertices);
    }
    return BRIO_OK;
}

brio_status brio_las_layout_share(brio_context *ctx, brio_las_layout *l, const brio_las_layout *found, size_t count) {
    BRIO_FORWARD(BRIO_ALLOC(ctx, l->ranges, count + 1));
    if (found->ranges) memcpy(l->ranges, found->ranges, count * sizeof *l->ranges);
    return BRIO_OK;
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

/* Returns whether a property is the first one that a field's name stands for: that of the very name, or else of its
 * letters. */
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
    brio_las_field fields[BRIO_LAS_FIELDS];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, l->places, m->num_properties + 1));
    l->format = choose_format(l, m, late);
    l->record = brio_las_record_bytes(l->format);
    size_t count = brio_las_fields_of(l->format, fields);
    for (size_t i = 0; i < m->num_properties; i++) {
        const char *own = m->properties[i].name;
        const brio_las_field *f = field_of(fields, count, m, i, &l->ranges[i]);
        BRIO_EXPECT(ctx, f || l->num_extras < MOST_EXTRAS, BRIO_ERR_ARGUMENT,
                    "%s: a LAS file holds at most %d properties that its format does not know", name, MOST_EXTRAS);
        if (!f) {
            place_extra(l, m, i);
            continue;
        }
        l->places[i] = (brio_las_place){
            .at = f->at, .type = f->type, .shift = f->shift, .bits = f->bits, .renamed = strcmp(own, f->name) != 0};
    }
    return BRIO_OK;
}

void brio_las_layout_free(brio_context *ctx, brio_las_layout *l) {
    brio_release(ctx, l->places);
    brio_release(ctx, l->ranges);
    l->places = NULL;
    l->ranges = NULL;
}

/* Makes a description. A description of other values keeps its text alone. */
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
