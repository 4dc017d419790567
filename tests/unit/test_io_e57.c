/* E57 files: numbers of every width, wherever packets break; coordinates of every kind to the last bit; poses; points
 * that are none; fields of several scans; names and types of properties. */
#include "e57_image.h"

enum { RECORDS = 100, MOST = 300 };

static uint64_t numbers[MOST][RECORDS];
static char attributes[MOST][200];
static char names[MOST][40];
static e57_test_field fields[MOST];

static void set_field(size_t i, const char *name, unsigned bits, const char *text) {
    snprintf(names[i], sizeof names[i], "%s", name);
    snprintf(attributes[i], sizeof attributes[i], "%s", text);
    fields[i] = (e57_test_field){names[i], attributes[i], bits, numbers[i]};
}

static void random_numbers(size_t i, uint64_t *state) {
    uint64_t mask = fields[i].bits < 64 ? (UINT64_C(1) << fields[i].bits) - 1 : UINT64_MAX;
    for (size_t r = 0; r < RECORDS; r++) numbers[i][r] = (io_random(state) << 32 ^ io_random(state)) & mask;
}

static const char *const axes[] = {"cartesianX", "cartesianY", "cartesianZ"};

/* Fields 0 to 2: coordinates as doubles. */
static void set_axes(uint64_t *state) {
    for (size_t k = 0; k < 3; k++) {
        set_field(k, axes[k], 64, "type=\"Float\" precision=\"double\"");
        for (size_t r = 0; r < RECORDS; r++) numbers[k][r] = e57_double(io_random_double(state));
    }
}

static double expected_integer(int64_t least, uint64_t number) {
    return (double)(int64_t)((uint64_t)least + number);
}

/* The least value of the field with numbers of `bits` bits. */
static int64_t least_of(unsigned bits) {
    if (bits == 64) return INT64_MIN;
    return bits == 63 ? -5 : -((int64_t)1 << bits) / 3;
}

static void set_widths(void) {
    for (unsigned bits = 0; bits <= 64; bits++) {
        char name[40], text[200];
        int64_t least = least_of(bits),
                most = (int64_t)((uint64_t)least + (bits < 64 ? (UINT64_C(1) << bits) - 1 : ~0ull));
        snprintf(name, sizeof name, "width%u", bits);
        snprintf(text, sizeof text, "type=\"Integer\" minimum=\"%lld\" maximum=\"%lld\"", (long long)least,
                 (long long)most);
        set_field(3 + bits, name, bits, bits == 64 ? "type=\"Integer\"" : text);
    }
}

static void every_width_in_every_packet(void) {
    const size_t parts[] = {1, 2, 3, 7, 64, 850};
    uint64_t state = 1;
    set_axes(&state);
    set_widths();
    for (size_t i = 3; i < 68; i++) random_numbers(i, &state);
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        e57_image f = e57_begin();
        uint64_t section = e57_put_section(&f, fields, 68, RECORDS, parts[k]);
        e57_begin_xml(&f);
        e57_put_scan(&f, fields, 68, "100", section, "");
        e57_end_xml(&f);
        e57_finish(&f, "a.e57");
        brio_mesh *m = e57_read_right("a.e57");
        EXPECT(m && m->num_vertices == RECORDS && m->num_properties == 65, "part %zu", parts[k]);
        for (size_t r = 0; m && r < RECORDS; r++) {
            for (size_t i = 0; i < 3; i++)
                EXPECT(e57_double(m->vertices[3 * r + i]) == numbers[i][r], "part %zu, axis %zu", parts[k], i);
            for (unsigned bits = 0; bits <= 64; bits++)
                EXPECT(brio_property_value(&m->properties[bits], r) ==
                           expected_integer(least_of(bits), numbers[3 + bits][r]),
                       "part %zu, %u bits, record %zu", parts[k], bits, r);
        }
        brio_mesh_free(m);
    }
}

static void types_are_the_smallest(void) {
    static const struct {
        const char *text;
        unsigned bits;
        brio_scalar type;
    } cases[] = {{"type=\"Integer\" minimum=\"0\" maximum=\"255\"", 8, BRIO_SCALAR_UINT8},
                 {"type=\"Integer\" minimum=\"0\" maximum=\"256\"", 9, BRIO_SCALAR_UINT16},
                 {"type=\"Integer\" minimum=\"-128\" maximum=\"127\"", 8, BRIO_SCALAR_INT8},
                 {"type=\"Integer\" minimum=\"-129\" maximum=\"0\"", 8, BRIO_SCALAR_INT16},
                 {"type=\"Integer\" minimum=\"-1\" maximum=\"65535\"", 17, BRIO_SCALAR_INT32},
                 {"type=\"Integer\" minimum=\"0\" maximum=\"4294967295\"", 32, BRIO_SCALAR_UINT32},
                 {"type=\"Integer\" minimum=\"0\" maximum=\"4294967296\"", 33, BRIO_SCALAR_FLOAT64},
                 {"type=\"Integer\" minimum=\"7\" maximum=\"7\"", 0, BRIO_SCALAR_UINT8},
                 {"type=\"Integer\"", 64, BRIO_SCALAR_FLOAT64},
                 {"type=\"ScaledInteger\" minimum=\"0\" maximum=\"3\" scale=\"1\"", 2, BRIO_SCALAR_UINT8},
                 {"type=\"ScaledInteger\" minimum=\"0\" maximum=\"3\" scale=\"0.5\"", 2, BRIO_SCALAR_FLOAT64},
                 {"type=\"Float\" precision=\"single\"", 32, BRIO_SCALAR_FLOAT32},
                 {"type=\"Float\"", 64, BRIO_SCALAR_FLOAT64}};
    uint64_t state = 2;
    set_axes(&state);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        set_field(3, "intensity", cases[k].bits, cases[k].text);
        random_numbers(3, &state);
        e57_write_scan("a.e57", fields, 4, RECORDS, "");
        brio_mesh *m = e57_read_right("a.e57");
        EXPECT(m && m->properties[0].type == cases[k].type, "%s", cases[k].text);
        brio_mesh_free(m);
    }
}

static void scaled_and_single_coordinates(void) {
    const double scales[] = {0.001, 1e-7, 0.00025}, offsets[] = {638982.55, -7.3, 0};
    const long long least[] = {-1000000, 0, -5};
    uint64_t state = 3;
    for (size_t k = 0; k < 3; k++) {
        char text[200];
        snprintf(text, sizeof text,
                 "type=\"ScaledInteger\" minimum=\"%lld\" maximum=\"%lld\" scale=\"%.17g\" offset=\"%.17g\"", least[k],
                 least[k] + (1ll << 40) - 1, scales[k], offsets[k]);
        set_field(k, axes[k], 40, text);
        random_numbers(k, &state);
    }
    e57_write_scan("a.e57", fields, 3, RECORDS, "");
    brio_mesh *m = e57_read_right("a.e57");
    for (size_t i = 0; m && i < 3 * RECORDS; i++) {
        double scaled = expected_integer(least[i % 3], numbers[i % 3][i / 3]) * scales[i % 3];
        EXPECT(m->vertices[i] == scaled + offsets[i % 3], "%zu", i);
    }
    brio_mesh_free(m);
    for (size_t k = 0; k < 3; k++) {
        set_field(k, axes[k], 32, "type=\"Float\" precision=\"single\"");
        for (size_t r = 0; r < RECORDS; r++) numbers[k][r] = e57_float((float)r / 7 + (float)k);
    }
    e57_write_scan("a.e57", fields, 3, RECORDS, "");
    m = e57_read_right("a.e57");
    for (size_t i = 0; m && i < 3 * RECORDS; i++)
        EXPECT(m->vertices[i] == (double)((float)(i / 3) / 7 + (float)(i % 3)), "%zu", i);
    brio_mesh_free(m);
}

/* --- places --- */

static void set_point(size_t r, double x, double y, double z) {
    numbers[0][r] = e57_double(x);
    numbers[1][r] = e57_double(y);
    numbers[2][r] = e57_double(z);
}

static void expect_point(const brio_mesh *m, size_t i, double x, double y, double z, double most) {
    const double *p = m ? m->vertices + 3 * i : NULL;
    EXPECT(p && fabs(p[0] - x) <= most && fabs(p[1] - y) <= most && fabs(p[2] - z) <= most, "%g %g %g", p ? p[0] : 0,
           p ? p[1] : 0, p ? p[2] : 0);
}

#define POSE(w, x, y, z, t)                                                                                            \
    "<pose type=\"Structure\"><rotation type=\"Structure\"><w>" w "</w><x> " x "\n</x><y>" y "</y><z>" z               \
    "</z></rotation><translation type=\"Structure\">" t "</translation></pose>"

static void poses_turn_and_move(void) {
    uint64_t state = 4;
    set_axes(&state);
    set_point(0, 1, 2, 3);
    e57_write_scan("a.e57", fields, 3, 1, POSE("0.7071067811865476", "0", "0", "0.7071067811865476", "<x>10</x><y/>"));
    brio_mesh *m = e57_read_right("a.e57");
    expect_point(m, 0, 8, 1, 3, 1e-14);
    brio_mesh_free(m);
    /* a third of a turn around (1, 1, 1), by a quaternion of the length 2 */
    e57_write_scan("a.e57", fields, 3, 1, POSE("1", "1", "1", "1", "<z>0.5</z>"));
    m = e57_read_right("a.e57");
    expect_point(m, 0, 3, 1, 2.5, 0);
    brio_mesh_free(m);
    set_point(0, 0.1, 1e-300, -0.0);
    e57_write_scan("a.e57", fields, 3, 1, POSE("1", "0", "0", "0", ""));
    m = e57_read_right("a.e57");
    EXPECT(m && io_same_bytes(m->vertices, (double[]){0.1, 1e-300, -0.0}, 24), "the identity changes nothing");
    brio_mesh_free(m);
    e57_write_scan("a.e57", fields, 3, 1, POSE("0", "0", "0", "0", "<x>10</x>"));
    m = e57_read_right("a.e57");
    expect_point(m, 0, 10.1, 0, 0, 1e-14);
    brio_mesh_free(m);
    e57_write_scan("a.e57", fields, 3, 1, POSE("0", "0", "0", "1e200", ""));
    m = e57_read_right("a.e57");
    expect_point(m, 0, -0.1, 0, 0, 1e-14);
    brio_mesh_free(m);
    e57_write_scan("a.e57", fields, 3, 1, POSE("1", "nan", "0", "0", ""));
    e57_refused("a.e57", BRIO_ERR_FORMAT, "expected a finite number");
    e57_write_scan("a.e57", fields, 3, 1, POSE("1", "0", "0", "0", "<x>1 2</x>"));
    e57_refused("a.e57", BRIO_ERR_FORMAT, "the pose has \"1 2\"");
}

/* Half a turn around z; single and double precision, and integers, which become doubles. */
static void normals_turn_and_do_not_move(void) {
    static const char *const normals[] = {"nor:normalX", "nor:normalY", "nor:normalZ"};
    uint64_t state = 14;
    set_axes(&state);
    set_point(0, 1, 2, 3);
    set_field(3, normals[0], 32, "type=\"Float\" precision=\"single\"");
    set_field(4, normals[1], 64, "type=\"Float\"");
    set_field(5, normals[2], 2, "type=\"Integer\" minimum=\"-1\" maximum=\"1\"");
    numbers[3][0] = e57_float(0.6f);
    numbers[4][0] = e57_double(-0.8);
    numbers[5][0] = 0;
    e57_write_scan("a.e57", fields, 6, 1, POSE("0", "0", "0", "1", "<x>10</x>"));
    brio_mesh *m = e57_read_right("a.e57");
    expect_point(m, 0, 9, -2, 3, 0);
    EXPECT(m && m->num_properties == 3 && m->properties[0].type == BRIO_SCALAR_FLOAT32);
    EXPECT(m && m->properties[2].type == BRIO_SCALAR_FLOAT64);
    const double expected[] = {(double)-0.6f, 0.8, -1};
    for (size_t k = 0; m && k < 3; k++)
        EXPECT(brio_property_value(&m->properties[k], 0) == expected[k], "%zu: %g", k,
               brio_property_value(&m->properties[k], 0));
    brio_mesh_free(m);
}

static void spherical_coordinates(void) {
    static const char *const of_sphere[] = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
    const double pi = 3.14159265358979323846;
    for (size_t k = 0; k < 3; k++) set_field(k, of_sphere[k], 64, "type=\"Float\"");
    set_field(3, "sphericalInvalidState", 2, "type=\"Integer\" minimum=\"0\" maximum=\"2\"");
    set_point(0, 2, 0, 0);
    set_point(1, 2, pi / 2, 0);
    set_point(2, 2, 1, pi / 2);
    set_point(3, 5, 5, 5);
    set_point(4, 4, 0, -pi / 6);
    for (size_t r = 0; r < 5; r++) numbers[3][r] = r == 3;
    e57_write_scan("a.e57", fields, 4, 5, POSE("1", "0", "0", "0", "<x>1</x>"));
    brio_mesh *m = e57_read_right("a.e57");
    EXPECT(m && m->num_vertices == 4 && m->num_properties == 0);
    expect_point(m, 0, 3, 0, 0, 1e-15);
    expect_point(m, 1, 1, 2, 0, 1e-15);
    expect_point(m, 2, 1, 0, 2, 1e-15);
    expect_point(m, 3, 1 + sqrt(12), 0, -2, 1e-14);
    brio_mesh_free(m);
}

static void points_that_are_none(void) {
    uint64_t state = 5;
    set_axes(&state);
    set_field(3, "cartesianInvalidState", 2, "type=\"Integer\" minimum=\"0\" maximum=\"2\"");
    set_field(4, "rowIndex", 7, "type=\"Integer\" minimum=\"0\" maximum=\"127\"");
    for (unsigned pattern = 0; pattern < 4; pattern++) {
        size_t kept = 0, expected[RECORDS];
        for (size_t r = 0; r < RECORDS; r++) {
            numbers[4][r] = r;
            numbers[3][r] = pattern == 0 ? 0 : pattern == 1 ? 1 + r % 2 : pattern == 2 ? r % 3 : r < 50;
            if (!numbers[3][r])
                expected[kept++] = r;
            else
                set_point(r, NAN, NAN, NAN);
        }
        e57_write_scan("a.e57", fields, 5, RECORDS, "");
        brio_mesh *m = e57_read_right("a.e57");
        EXPECT(m && m->num_vertices == kept, "pattern %u", pattern);
        for (size_t i = 0; m && i < m->num_vertices; i++)
            EXPECT(brio_property_value(&m->properties[0], i) == (double)expected[i] &&
                       e57_double(m->vertices[3 * i]) == numbers[0][expected[i]],
                   "pattern %u, point %zu", pattern, i);
        brio_mesh_free(m);
        set_axes(&state);
    }
    set_point(7, 0, NAN, 0);
    e57_write_scan("a.e57", fields, 3, RECORDS, "");
    e57_refused("a.e57", BRIO_ERR_NOT_FINITE, "point 7");
}

/* --- several scans --- */

static void scans_become_one_mesh(void) {
    uint64_t state = 6;
    e57_image f = e57_begin();
    set_axes(&state);
    set_field(3, "intensity", 8, "type=\"Integer\" minimum=\"0\" maximum=\"255\"");
    random_numbers(3, &state);
    set_field(4, "timeStamp", 64, "type=\"Float\"");
    for (size_t r = 0; r < RECORDS; r++) numbers[4][r] = e57_double((double)r / 3);
    set_field(5, "intensity", 16, "type=\"Integer\" minimum=\"0\" maximum=\"65535\"");
    random_numbers(5, &state);
    e57_test_field second[] = {fields[5], fields[0], fields[1], fields[2]};
    uint64_t a = e57_put_section(&f, fields, 5, RECORDS, 100), b = e57_put_section(&f, second, 4, 30, 9);
    e57_begin_xml(&f);
    e57_put_scan(&f, fields, 5, "100", a, "");
    e57_put_scan(&f, fields, 2, "0", 0, "");
    e57_put_scan(&f, second, 4, "30", b, POSE("1", "0", "0", "0", ""));
    e57_end_xml(&f);
    e57_finish(&f, "a.e57");
    brio_mesh *m = e57_read_right("a.e57");
    EXPECT(m && m->num_vertices == 130 && m->num_properties == 3);
    const brio_property *p = m ? m->properties : NULL;
    EXPECT(p && p[0].type == BRIO_SCALAR_UINT16 && p[1].type == BRIO_SCALAR_FLOAT64 && p[2].type == BRIO_SCALAR_UINT32);
    for (size_t i = 0; p && i < 130; i++) {
        size_t r = i < 100 ? i : i - 100;
        EXPECT(brio_property_value(&p[0], i) == (double)numbers[i < 100 ? 3 : 5][r], "intensity %zu", i);
        EXPECT(i < 100 ? brio_property_value(&p[1], i) == (double)r / 3 : isnan(brio_property_value(&p[1], i)),
               "time %zu", i);
        EXPECT(brio_property_value(&p[2], i) == (i < 100 ? 0 : 2), "scan %zu", i);
        EXPECT(e57_double(m->vertices[3 * i + 1]) == numbers[1][r], "y %zu", i);
    }
    brio_mesh_free(m);
}

static void names_of_properties(void) {
    static const char *const given[] = {"colorRed",       "colorGreen",  "colorBlue",   "nor:normalX",
                                        "nor:normalY",    "nor:normalZ", "columnIndex", "returnIndex",
                                        "demo:someThing", "red",         "scan",        "x"};
    static const char *const expected[] = {
        "red",          "green",           "blue",  "nx",   "ny", "nz", "column_index",
        "return_index", "demo_some_thing", "red_2", "scan", "x_2"};
    uint64_t state = 7;
    size_t count = sizeof given / sizeof *given;
    set_axes(&state);
    for (size_t i = 0; i < count; i++) {
        set_field(3 + i, given[i], 9, "type=\"Integer\" minimum=\"0\" maximum=\"511\"");
        random_numbers(3 + i, &state);
    }
    set_field(3 + count, "comment", 0, "type=\"String\"");
    fields[3 + count].numbers = NULL;
    e57_write_scan("a.e57", fields, 4 + count, RECORDS, "");
    brio_mesh *m = e57_read_right("a.e57");
    EXPECT(m && m->num_properties == count);
    for (size_t i = 0; m && i < m->num_properties; i++) {
        EXPECT(!strcmp(m->properties[i].name, expected[i]), "%s: %s", given[i], m->properties[i].name);
        EXPECT(brio_property_value(&m->properties[i], 99) == (double)numbers[3 + i][99], "%s", given[i]);
    }
    brio_mesh_free(m);
}

SUITE(test_io_e57) {
    io_begin();
    if (!e57_is_read()) {
        printf("skipped: unit.test_io_e57: brio was built without the library expat\n");
        io_end();
        return HARNESS_SKIP;
    }
    RUN(every_width_in_every_packet);
    RUN(types_are_the_smallest);
    RUN(scaled_and_single_coordinates);
    RUN(poses_turn_and_move);
    RUN(normals_turn_and_do_not_move);
    RUN(spherical_coordinates);
    RUN(points_that_are_none);
    RUN(scans_become_one_mesh);
    RUN(names_of_properties);
    return io_end();
}
