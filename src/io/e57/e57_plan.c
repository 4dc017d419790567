/* Finds what becomes of the fields of an E57 file.
 *
 * Fields of one name in several scans are one property, whose type holds the values of all of them. Where some scan
 * lacks the field, the property is a floating-point number, so that NaN can stand for what is missing.
 *
 * Based on: ASTM E2807-11, 8.4.4 (elements of a point). */
#include "io/e57/e57_plan.h"
#include "base/memory.h"
#include "base/utf8.h"
#include <string.h>

/* A property under construction: what its fields can hold. */
typedef struct {
    const char *source;       /* the name of its fields */
    char name[BRIO_E57_NAME]; /* of the property */
    int64_t least, most;      /* of those of its fields that hold integers */
    bool integers, singles, doubles;
    size_t scans;     /* that have it, of those with points */
    size_t last_scan; /* that has it */
} column;

typedef struct {
    brio_builder *builder;
    const brio_e57_scans *scans;
    brio_e57_plan *plan;
    column *columns;
    size_t num_columns, capacity;
    size_t with_points; /* scans that have points */
} planner;

/* --- names --- */

static bool is_taken(const planner *l, const char *name) {
    static const char *const others[] = {"x", "y", "z", "scan"};
    for (size_t i = 0; i < (l->plan->has_scan ? 4 : 3); i++)
        if (!strcmp(name, others[i])) return true;
    for (size_t i = 0; i < l->num_columns; i++)
        if (!strcmp(name, l->columns[i].name)) return true;
    return false;
}

/* Turns rowIndex into row_index, prefix:someName into prefix_some_name, and names colours and normals as other formats
 * do. Names of brio's own extension are those of properties. A name that is taken gets _2 behind it. */
static void make_name(const planner *l, const char *source, char name[BRIO_E57_NAME]) {
    static const char *const known[][2] = {{"colorRed", "red"},   {"colorGreen", "green"}, {"colorBlue", "blue"},
                                           {"nor:normalX", "nx"}, {"nor:normalY", "ny"},   {"nor:normalZ", "nz"}};
    bool own = !strncmp(source, "brio:", 5);
    size_t n = 0;
    for (const char *c = own ? source + 5 : source; *c && n + brio_utf8_length(c) < BRIO_E57_NAME - 4; c++) {
        bool upper = !own && *c >= 'A' && *c <= 'Z';
        if (upper && n && name[n - 1] != '_') name[n++] = '_';
        name[n++] = *c == ':' ? '_' : upper ? (char)(*c - 'A' + 'a') : *c;
    }
    name[n] = 0;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(source, known[i][0])) strcpy(name, known[i][1]);
    for (char last = '2'; is_taken(l, name) && last <= '9'; last++) {
        if (last == '2') n = strlen(name);
        memcpy(name + n, (char[]){'_', last, 0}, 3);
    }
}

/* --- types --- */

static bool is_integer(const brio_e57_code *code) {
    return code->kind == BRIO_E57_INTEGER || (code->kind == BRIO_E57_SCALED && code->scale == 1 && code->offset == 0);
}

/* The greatest integer that the bits of a field can make. */
static int64_t most_of(const brio_e57_code *code) {
    uint64_t range = code->bits < 64 ? (UINT64_C(1) << code->bits) - 1 : UINT64_MAX;
    uint64_t room = (uint64_t)INT64_MAX - (uint64_t)code->least;
    return range < room ? (int64_t)((uint64_t)code->least + range) : INT64_MAX;
}

/* Normals are never integers, since the pose may turn them. */
static void widen(column *c, const brio_e57_code *code) {
    if (is_integer(code) && strncmp(c->source, "nor:", 4) != 0) {
        int64_t most = most_of(code);
        if (!c->integers || code->least < c->least) c->least = code->least;
        if (!c->integers || most > c->most) c->most = most;
        c->integers = true;
    } else {
        *(code->kind == BRIO_E57_SINGLE ? &c->singles : &c->doubles) = true;
    }
}

/* The smallest type that holds all values. Integers that 32 bits do not hold become doubles. */
static brio_scalar type_of(const column *c, size_t scans) {
    if (c->singles && !c->integers && !c->doubles) return BRIO_SCALAR_FLOAT32;
    if (c->singles || c->doubles || c->scans < scans) return BRIO_SCALAR_FLOAT64;
    if (c->least >= 0) {
        if (c->most <= UINT8_MAX) return BRIO_SCALAR_UINT8;
        if (c->most <= UINT16_MAX) return BRIO_SCALAR_UINT16;
        return c->most <= UINT32_MAX ? BRIO_SCALAR_UINT32 : BRIO_SCALAR_FLOAT64;
    }
    if (c->least >= INT8_MIN && c->most <= INT8_MAX) return BRIO_SCALAR_INT8;
    if (c->least >= INT16_MIN && c->most <= INT16_MAX) return BRIO_SCALAR_INT16;
    return c->least >= INT32_MIN && c->most <= INT32_MAX ? BRIO_SCALAR_INT32 : BRIO_SCALAR_FLOAT64;
}

/* --- roles --- */

static brio_status plan_column(planner *l, size_t scan, const brio_e57_field *field, uint32_t *role) {
    brio_status status = BRIO_OK;
    size_t i = 0;
    while (i < l->num_columns && strcmp(l->columns[i].source, field->name) != 0) i++;
    if (i == l->num_columns) {
        column new = {.source = field->name, .last_scan = SIZE_MAX};
        make_name(l, field->name, new.name);
        BRIO_REQUIRE(l->builder->ctx, i < BRIO_E57_MOST_FIELDS, BRIO_ERR_FORMAT,
                     "%s: the scans have more than %d different fields", l->builder->name, BRIO_E57_MOST_FIELDS);
        BRIO_TRY(BRIO_RESERVE(l->builder->ctx, l->columns, l->capacity, i + 1));
        l->columns[l->num_columns++] = new;
    }
    column *c = &l->columns[i];
    BRIO_REQUIRE(l->builder->ctx, c->last_scan != scan, BRIO_ERR_FORMAT,
                 "%s: scan %zu (counted from 0): two fields named %s", l->builder->name, scan, field->name);
    c->last_scan = scan;
    c->scans++;
    widen(c, &field->code);
    *role = BRIO_E57_PROPERTY + (uint32_t)i;
done:
    return status;
}

static const brio_e57_field *field_of(const planner *l, size_t scan, const char *name) {
    const brio_e57_scan *s = &l->scans->scans[scan];
    for (size_t i = s->first_field; i < s->first_field + s->num_fields; i++)
        if (!strcmp(l->scans->fields[i].name, name) && !l->scans->fields[i].text) return &l->scans->fields[i];
    return NULL;
}

/* Chooses the coordinates of a scan, and the field that says which of them are none. */
static brio_status plan_axes(planner *l, size_t scan) {
    static const char *const names[2][4] = {
        {"cartesianX", "cartesianY", "cartesianZ", "cartesianInvalidState"},
        {"sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState"}};
    brio_status status = BRIO_OK;
    const brio_e57_field *found[4];
    for (int kind = 0; kind < 2; kind++) {
        for (int k = 0; k < 4; k++) found[k] = field_of(l, scan, names[kind][k]);
        l->plan->spherical[scan] = kind;
        if (found[0] && found[1] && found[2]) break;
    }
    BRIO_REQUIRE(l->builder->ctx, found[0] && found[1] && found[2], BRIO_ERR_FORMAT,
                 "%s: scan %zu (counted from 0): points without coordinates, expected cartesianX, Y and Z or "
                 "sphericalRange, Azimuth and Elevation",
                 l->builder->name, scan);
    for (uint32_t k = 0; k < 3; k++) l->plan->roles[found[k] - l->scans->fields] = BRIO_E57_AXIS + k;
    if (found[3]) l->plan->roles[found[3] - l->scans->fields] = BRIO_E57_INVALID;
done:
    return status;
}

static bool is_coordinate(const char *name) {
    return !strncmp(name, "cartesian", 9) || !strncmp(name, "spherical", 9);
}

static brio_status plan_scan(planner *l, size_t scan) {
    brio_status status = BRIO_OK;
    const brio_e57_scan *s = &l->scans->scans[scan];
    BRIO_TRY(plan_axes(l, scan));
    for (size_t i = s->first_field; i < s->first_field + s->num_fields; i++) {
        const brio_e57_field *field = &l->scans->fields[i];
        bool other = !strncmp(field->name, l->plan->spherical[scan] ? "cartesian" : "spherical", 9);
        if (field->text)
            BRIO_TRY(brio_builder_leave_out(l->builder, field->name));
        else if (other)
            BRIO_TRY(brio_builder_leave_out(l->builder, l->plan->spherical[scan] ? "cartesian coordinates"
                                                                                 : "spherical coordinates"));
        else if (!is_coordinate(field->name))
            BRIO_TRY(plan_column(l, scan, field, &l->plan->roles[i]));
    }
done:
    return status;
}

brio_status brio_e57_plan_make(brio_e57_plan *plan, brio_builder *b, const brio_e57_scans *scans) {
    brio_status status = BRIO_OK;
    planner l = {.builder = b, .scans = scans, .plan = plan};
    *plan = (brio_e57_plan){.has_scan = scans->num_scans > 1};
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, plan->roles, scans->num_fields));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, plan->spherical, scans->num_scans));
    for (size_t i = 0; i < scans->num_scans; i++) {
        if (!scans->scans[i].records) continue;
        l.with_points++;
        BRIO_TRY(plan_scan(&l, i));
    }
    plan->num_columns = l.num_columns;
    for (size_t i = 0; i < l.num_columns; i++)
        BRIO_TRY(brio_builder_property(b, l.columns[i].name, type_of(&l.columns[i], l.with_points)));
    if (plan->has_scan) BRIO_TRY(brio_builder_property(b, "scan", BRIO_SCALAR_UINT32));
done:
    brio_release(b->ctx, l.columns);
    return status;
}

void brio_e57_plan_free(brio_context *ctx, brio_e57_plan *plan) {
    brio_release(ctx, plan->roles);
    brio_release(ctx, plan->spherical);
    *plan = (brio_e57_plan){.roles = NULL};
}
