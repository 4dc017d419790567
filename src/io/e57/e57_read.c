/* Reads E57 files: the points of all scans, each in the pose of its scan.
 *
 * The XML section, at the end, says where the points are. All sections are checked against the file's size before
 * memory is taken for their points. The bytes of a field are decoded to their places in the mesh at once.
 *
 * Based on: ASTM E2807-11. Standard specification for 3D imaging data exchange, version 1.0. Huber. The ASTM E57 file
 * format for 3D imaging data exchange. SPIE 7864, 2011. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/builder.h"
#include "io/e57/e57.h"
#include "io/formats.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- places of points and normals --- */

/* Places the points of a scan, and their normals.
 *
 * A pose turns by a unit quaternion, then moves. The quaternion is scaled to length 1 first, because its numbers are
 * rounded. A pose that does nothing leaves every bit as it was.
 *
 * Based on: ASTM E2807-11, 8.4.3 (pose) and 8.4.4.2 (spherical coordinates). */

typedef struct brio_e57_pose {
    double matrix[9], translation[3];
    bool turns, moves; /* whether it does anything */
} brio_e57_pose;

/* Makes the pose of a scan, whose numbers are finite. A quaternion of 0, which some programs write, is no turn. */
static void e57_pose_make(brio_e57_pose *pose, const brio_e57_scan *scan) {
    const double *t = scan->translation;
    double q[4] = {1, 0, 0, 0}, largest = 0;
    for (int k = 0; k < 4; k++) largest = fmax(largest, fabs(scan->rotation[k]));
    for (int k = 0; k < 4 && largest > 0; k++) q[k] = scan->rotation[k] / largest; /* no square is too large then */
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    *pose = (brio_e57_pose){.matrix = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                                       2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                       2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
                            .turns = x != 0 || y != 0 || z != 0,
                            .moves = t[0] != 0 || t[1] != 0 || t[2] != 0};
    memcpy(pose->translation, t, sizeof pose->translation);
}

/* Turns range, azimuth and elevation into x, y, z.   points  #P by 3, changed in place. */
static void e57_from_spherical(double *points, size_t num_points) {
    for (size_t i = 0; i < num_points; i++) {
        double *p = points + 3 * i;
        double range = p[0], azimuth = p[1], elevation = p[2], flat = range * cos(elevation);
        p[0] = flat * cos(azimuth);
        p[1] = flat * sin(azimuth);
        p[2] = range * sin(elevation);
    }
}

static void turn(const double *m, double *p) {
    double x = p[0], y = p[1], z = p[2];
    for (int k = 0; k < 3; k++) p[k] = m[3 * k] * x + m[3 * k + 1] * y + m[3 * k + 2] * z;
}

/* Turns the normals of the mesh's points from `first` on: the properties nx, ny, nz, if they are there and can hold
 *  fractions. */
static void e57_turn_normals(const brio_e57_pose *pose, brio_mesh *mesh, size_t first) {
    static const char *const names[] = {"nx", "ny", "nz"};
    const brio_property *p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = brio_mesh_property(mesh, names[k]);
        if (!p[k] || (p[k]->type != BRIO_SCALAR_FLOAT32 && p[k]->type != BRIO_SCALAR_FLOAT64)) return;
    }
    for (size_t v = first; v < mesh->num_vertices && pose->turns; v++) {
        double normal[3];
        for (int k = 0; k < 3; k++) normal[k] = brio_property_value(p[k], v);
        turn(pose->matrix, normal);
        for (int k = 0; k < 3; k++)
            brio_scalar_store((char *)p[k]->data + v * brio_scalar_size(p[k]->type), p[k]->type, normal[k]);
    }
}

/* Applies a pose.   points  #P by 3, changed in place. */
static void e57_move(const brio_e57_pose *pose, double *points, size_t num_points) {
    const double *t = pose->translation;
    for (size_t i = 0; i < num_points && pose->turns; i++) turn(pose->matrix, points + 3 * i);
    for (size_t i = 0; i < 3 * num_points && pose->moves; i++) points[i] += t[i % 3];
}

static size_t keep(char *values, size_t size, const uint8_t *invalid, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (!invalid[i]) memmove(values + kept++ * size, values + i * size, size);
    return kept;
}

/* Drops from the mesh the points from `first` on whose `invalid` is not 0.   invalid  of the points from `first` on. */
static void e57_drop(brio_mesh *mesh, size_t first, const uint8_t *invalid) {
    size_t count = mesh->num_vertices - first, kept = 0;
    while (kept < count && !invalid[kept]) kept++;
    if (kept == count) return;
    for (size_t i = 0; i < mesh->num_properties; i++) {
        size_t size = brio_scalar_size(mesh->properties[i].type);
        keep((char *)mesh->properties[i].data + first * size, size, invalid, count);
    }
    kept = keep((char *)(mesh->vertices + 3 * first), 3 * sizeof *mesh->vertices, invalid, count);
    mesh->num_vertices = first + kept;
}

/* --- what becomes of the fields --- */

/* Finds what becomes of the fields of an E57 file.
 *
 * Fields of one name in several scans are one property, whose type holds the values of all of them. Where some scan
 * lacks the field, the property is a floating-point number, so that NaN can stand for what is missing.
 *
 * Based on: ASTM E2807-11, 8.4.4 (elements of a point). */

/** What a field is. PROPERTY + i is property i of the mesh. */
enum { BRIO_E57_UNUSED, BRIO_E57_AXIS, BRIO_E57_INVALID = BRIO_E57_AXIS + 3, BRIO_E57_PROPERTY };

typedef struct brio_e57_plan {
    uint32_t *roles;    /* of each field of all scans; AXIS + k is coordinate k */
    bool *spherical;    /* of each scan: the coordinates are range, azimuth, elevation */
    size_t num_columns; /* properties that are fields */
    bool has_scan;      /* the property behind them is the number of the scan */
} brio_e57_plan;

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

/* Returns the greatest integer that the bits of a field can make. */
static int64_t most_of(const brio_e57_code *code) {
    uint64_t range = code->bits < 64 ? (UINT64_C(1) << code->bits) - 1 : UINT64_MAX;
    uint64_t room = (uint64_t)INT64_MAX - (uint64_t)code->least;
    return range < room ? (int64_t)((uint64_t)code->least + range) : INT64_MAX;
}

/* Widens the range of a column by a field. Normals are never integers, since the pose may turn them. */
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

/* Returns the smallest type that holds all values. Integers that 32 bits do not hold become doubles. */
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
    size_t i = 0;
    while (i < l->num_columns && strcmp(l->columns[i].source, field->name) != 0) i++;
    if (i == l->num_columns) {
        column new = {.source = field->name, .last_scan = SIZE_MAX};
        make_name(l, field->name, new.name);
        BRIO_EXPECT(l->builder->ctx, i < BRIO_E57_MOST_FIELDS, BRIO_ERR_FORMAT,
                    "%s: the scans have more than %d different fields", l->builder->name, BRIO_E57_MOST_FIELDS);
        BRIO_FORWARD(BRIO_RESERVE(l->builder->ctx, l->columns, l->capacity, i + 1));
        l->columns[l->num_columns++] = new;
    }
    column *c = &l->columns[i];
    BRIO_EXPECT(l->builder->ctx, c->last_scan != scan, BRIO_ERR_FORMAT,
                "%s: scan %zu (counted from 0): two fields named %s", l->builder->name, scan, field->name);
    c->last_scan = scan;
    c->scans++;
    widen(c, &field->code);
    *role = BRIO_E57_PROPERTY + (uint32_t)i;
    return BRIO_OK;
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
    const brio_e57_field *found[4];
    for (int kind = 0; kind < 2; kind++) {
        for (int k = 0; k < 4; k++) found[k] = field_of(l, scan, names[kind][k]);
        l->plan->spherical[scan] = kind;
        if (found[0] && found[1] && found[2]) break;
    }
    BRIO_EXPECT(l->builder->ctx, found[0] && found[1] && found[2], BRIO_ERR_FORMAT,
                "%s: scan %zu (counted from 0): points without coordinates, expected cartesianX, Y and Z or "
                "sphericalRange, Azimuth and Elevation",
                l->builder->name, scan);
    for (uint32_t k = 0; k < 3; k++) l->plan->roles[found[k] - l->scans->fields] = BRIO_E57_AXIS + k;
    if (found[3]) l->plan->roles[found[3] - l->scans->fields] = BRIO_E57_INVALID;
    return BRIO_OK;
}

static bool is_coordinate(const char *name) {
    return !strncmp(name, "cartesian", 9) || !strncmp(name, "spherical", 9);
}

static brio_status plan_scan(planner *l, size_t scan) {
    const brio_e57_scan *s = &l->scans->scans[scan];
    BRIO_FORWARD(plan_axes(l, scan));
    for (size_t i = s->first_field; i < s->first_field + s->num_fields; i++) {
        const brio_e57_field *field = &l->scans->fields[i];
        bool other = !strncmp(field->name, l->plan->spherical[scan] ? "cartesian" : "spherical", 9);
        if (field->text)
            BRIO_FORWARD(brio_builder_leave_out(l->builder, field->name));
        else if (other)
            BRIO_FORWARD(brio_builder_leave_out(l->builder, l->plan->spherical[scan] ? "cartesian coordinates"
                                                                                     : "spherical coordinates"));
        else if (!is_coordinate(field->name))
            BRIO_FORWARD(plan_column(l, scan, field, &l->plan->roles[i]));
    }
    return BRIO_OK;
}

/* Finds the roles and adds the properties to the mesh. Call e57_plan_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY. */
static brio_status e57_plan_make(brio_e57_plan *plan, brio_builder *b, const brio_e57_scans *scans) {
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

static void e57_plan_free(brio_context *ctx, brio_e57_plan *plan) {
    brio_release(ctx, plan->roles);
    brio_release(ctx, plan->spherical);
    *plan = (brio_e57_plan){.roles = NULL};
}

/* --- sections --- */

typedef struct {
    brio_builder *builder;
    brio_e57_pages pages;
    brio_e57_scans scans;
    brio_e57_plan plan;
    brio_e57_section *sections; /* of each scan */
    brio_e57_decoder *decoders; /* of the scan that is read */
    uint8_t *invalid;           /* of each of its points */
    size_t first;               /* its first vertex */
} e57_reader;

static bool starts(const char *bytes, size_t size) {
    return size >= 8 && !memcmp(bytes, "ASTM-E57", 8);
}

static int compare_places(const void *a, const void *b) {
    uint64_t i = *(const uint64_t *)a, j = *(const uint64_t *)b;
    return (i > j) - (i < j);
}

/* Ends the sections whose length is not known at the next section behind them, or at the XML section, or at the file's
 * end. */
static brio_status end_sections(e57_reader *r) {
    brio_status status = BRIO_OK;
    size_t count = 0, num_scans = r->scans.num_scans;
    uint64_t *places = NULL;
    BRIO_TRY(BRIO_ALLOC(r->builder->ctx, places, num_scans + 1));
    for (size_t i = 0; i < num_scans; i++)
        if (r->scans.scans[i].records) places[count++] = r->sections[i].begin;
    places[count++] = r->pages.xml;
    qsort(places, count, sizeof *places, compare_places);
    for (size_t i = 0; i < num_scans; i++) {
        brio_e57_section *s = &r->sections[i];
        if (!s->endless) continue;
        size_t low = 0, high = count;
        while (low < high) {
            size_t middle = (low + high) / 2;
            if (places[middle] > s->begin)
                high = middle;
            else
                low = middle + 1;
        }
        s->end = low < count ? places[low] : brio_e57_size(&r->pages);
    }
done:
    brio_release(r->builder->ctx, places);
    return status;
}

/* Finds and checks all sections, and makes room for their points. Sections may not lie upon one another: together they
 * are not longer than the file. */
static brio_status open_sections(e57_reader *r) {
    brio_context *ctx = r->builder->ctx;
    uint64_t points = 0, bytes = 0;
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->sections, r->scans.num_scans));
    for (size_t i = 0; i < r->scans.num_scans; i++)
        BRIO_FORWARD(brio_e57_section_open(&r->pages, &r->scans, i, &r->sections[i]));
    BRIO_FORWARD(end_sections(r));
    for (size_t i = 0; i < r->scans.num_scans; i++) {
        BRIO_FORWARD(brio_e57_section_check(&r->pages, &r->scans, &r->sections[i]));
        points += r->scans.scans[i].records;
        bytes += r->sections[i].end - r->sections[i].begin;
        BRIO_EXPECT(ctx, bytes <= brio_e57_size(&r->pages), BRIO_ERR_FORMAT,
                    "%s: scan %zu (counted from 0): the points of the scans up to this one have more bytes than the "
                    "file",
                    r->builder->name, i);
    }
    return brio_builder_expect_vertices(r->builder, points);
}

/* --- one scan --- */

static void aim(e57_reader *r, uint32_t role, brio_e57_decoder *d) {
    brio_mesh *m = r->builder->mesh;
    if (role >= BRIO_E57_PROPERTY) {
        const brio_property *p = &m->properties[role - BRIO_E57_PROPERTY];
        d->type = p->type;
        d->stride = brio_scalar_size(p->type);
        d->target = (char *)p->data + r->first * d->stride;
    } else if (role == BRIO_E57_INVALID) {
        d->type = BRIO_SCALAR_UINT8;
        d->tests = true;
        d->stride = 1;
        d->target = (char *)r->invalid;
    } else if (role >= BRIO_E57_AXIS) {
        d->type = BRIO_SCALAR_FLOAT64;
        d->stride = 3 * sizeof *m->vertices;
        d->target = (char *)(m->vertices + 3 * r->first + role - BRIO_E57_AXIS);
    }
}

/* Fills what no field of the scan fills: properties that it lacks, and its number. */
static void fill_rest(e57_reader *r, size_t scan) {
    brio_mesh *m = r->builder->mesh;
    const brio_e57_scan *s = &r->scans.scans[scan];
    for (size_t i = 0; i < m->num_properties; i++) {
        brio_property *p = &m->properties[i];
        bool number = i == r->plan.num_columns, there = false;
        for (size_t f = s->first_field; f < s->first_field + s->num_fields; f++)
            there |= r->plan.roles[f] == BRIO_E57_PROPERTY + i;
        size_t size = brio_scalar_size(p->type);
        for (size_t v = r->first; v < m->num_vertices && !there; v++)
            brio_scalar_store((char *)p->data + v * size, p->type, number ? (double)scan : (double)NAN);
    }
}

static brio_status decode_scan(e57_reader *r, size_t scan) {
    const brio_e57_scan *s = &r->scans.scans[scan];
    const brio_e57_field *fields = r->scans.fields + s->first_field;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(r->builder->ctx, r->decoders, s->num_fields));
    for (size_t i = 0; i < s->num_fields; i++) {
        uint32_t role = r->plan.roles[s->first_field + i];
        r->decoders[i] = (brio_e57_decoder){.code = fields[i].code, .count = s->records};
        if (role == BRIO_E57_INVALID) BRIO_FORWARD(BRIO_ALLOC(r->builder->ctx, r->invalid, s->records));
        aim(r, role, &r->decoders[i]);
    }
    BRIO_FORWARD(brio_e57_section_read(&r->pages, &r->sections[scan], fields, r->decoders, s->num_fields));
    for (size_t i = 0; i < s->num_fields; i++)
        if (r->decoders[i].rounded) BRIO_FORWARD(brio_builder_leave_out(r->builder, "integers beyond 2^53"));
    return BRIO_OK;
}

static brio_status read_scan(e57_reader *r, size_t scan) {
    brio_status status = BRIO_OK;
    brio_mesh *m = r->builder->mesh;
    const brio_e57_scan *s = &r->scans.scans[scan];
    brio_e57_pose pose;
    if (!s->records) return BRIO_OK;
    e57_pose_make(&pose, s);
    if (pose.turns && r->builder->has_origins) BRIO_TRY(brio_builder_leave_out(r->builder, "turns of scanners"));
    if ((pose.turns || pose.moves) && !r->builder->has_origins) BRIO_TRY(brio_builder_leave_out(r->builder, "poses"));
    r->first = m->num_vertices;
    BRIO_TRY(brio_builder_add_vertices(r->builder, (size_t)s->records));
    BRIO_TRY(decode_scan(r, scan));
    fill_rest(r, scan);
    if (r->invalid) e57_drop(m, r->first, r->invalid);
    double *points = m->vertices + 3 * r->first;
    if (r->plan.spherical[scan]) e57_from_spherical(points, m->num_vertices - r->first);
    e57_move(&pose, points, m->num_vertices - r->first);
    e57_turn_normals(&pose, m, r->first);
    bool known = pose.turns || pose.moves || r->plan.spherical[scan];
    brio_set_origins(r->builder, r->first, known ? pose.translation : NULL);
done:
    brio_release(r->builder->ctx, r->decoders);
    brio_release(r->builder->ctx, r->invalid);
    r->decoders = NULL;
    r->invalid = NULL;
    return status;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    e57_reader r = {.builder = b};
    BRIO_TRY(brio_e57_pages_open(&r.pages, s));
    BRIO_TRY(brio_e57_xml_read(&r.pages, b, &r.scans));
    BRIO_TRY(e57_plan_make(&r.plan, b, &r.scans));
    BRIO_TRY(brio_plan_origins(b));
    BRIO_TRY(open_sections(&r));
    r.pages.reports = true;
    for (size_t i = 0; i < r.scans.num_scans; i++) BRIO_TRY(read_scan(&r, i));
done:
    brio_release(b->ctx, r.sections);
    e57_plan_free(b->ctx, &r.plan);
    brio_e57_scans_free(b->ctx, &r.scans);
    brio_e57_pages_close(&r.pages);
    return status;
}

const brio_codec brio_e57_codec = {.starts = starts, .read = read_file, .rows = &brio_e57_rows};
