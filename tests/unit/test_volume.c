/* Maps of densities and atoms: what files hold, what is refused, and the surfaces that are made of them. */
#include "io/ccp4.h"
#include "io/pdb.h"
#include "failing_allocator.h"
#include "io_files.h"

/* --- maps made by hand --- */

enum { MOST_BYTES = 1 << 20 };

/* Sizes, starts and intervals are those of columns, rows, sections and of x, y, z, as in the file. */
typedef struct {
    int32_t mode, size[3], start[3], intervals[3], axis[3], symmetry;
    float length[3], angle[3], origin[3];
    bool big;
    double (*value)(int x, int y, int z);
} map_plan;

static double numbered(int x, int y, int z) {
    return x + 7 * y + 18 * z;
}

static const map_plan plain = {.mode = 2,
                               .size = {6, 3, 4},
                               .intervals = {6, 3, 4},
                               .axis = {1, 2, 3},
                               .length = {6, 3, 4},
                               .angle = {90, 90, 90},
                               .value = numbered};

static size_t put_bytes(char *at, const void *scalar, size_t size, bool big) {
    for (size_t i = 0; i < size; i++) at[big ? size - 1 - i : i] = ((const char *)scalar)[i];
    return size;
}

static void put_whole(char *bytes, int offset, int32_t value, bool big) {
    put_bytes(bytes + offset, &value, 4, big);
}

static size_t put_value(char *at, int mode, double value, bool big) {
    if (mode == 0) return put_bytes(at, &(int8_t){(int8_t)value}, 1, big);
    if (mode == 1) return put_bytes(at, &(int16_t){(int16_t)value}, 2, big);
    if (mode == 6) return put_bytes(at, &(uint16_t){(uint16_t)value}, 2, big);
    return put_bytes(at, &(float){(float)value}, 4, big);
}

/* Makes the bytes of a map and returns their number. */
static size_t make_map(const map_plan *plan, char *bytes) {
    memset(bytes, 0, 1024);
    for (int k = 0; k < 3; k++) {
        put_whole(bytes, 0 + 4 * k, plan->size[k], plan->big);
        put_whole(bytes, 16 + 4 * k, plan->start[k], plan->big);
        put_whole(bytes, 28 + 4 * k, plan->intervals[k], plan->big);
        put_whole(bytes, 64 + 4 * k, plan->axis[k], plan->big);
        put_bytes(bytes + 40 + 4 * k, &plan->length[k], 4, plan->big);
        put_bytes(bytes + 52 + 4 * k, &plan->angle[k], 4, plan->big);
        put_bytes(bytes + 196 + 4 * k, &plan->origin[k], 4, plan->big);
    }
    put_whole(bytes, 12, plan->mode, plan->big);
    put_whole(bytes, 92, plan->symmetry, plan->big);
    memcpy(bytes + 208, "MAP ", 4);
    size_t at = 1024;
    memset(bytes + at, ' ', (size_t)plan->symmetry);
    at += (size_t)plan->symmetry;
    for (int s = 0; s < plan->size[2]; s++)
        for (int r = 0; r < plan->size[1]; r++)
            for (int c = 0; c < plan->size[0]; c++) {
                const int part[3] = {c, r, s};
                int place[3] = {c, r, s};
                for (int k = 0; k < 3; k++)
                    if (plan->axis[k]) place[plan->axis[k] - 1] = part[k];
                at += put_value(bytes + at, plan->mode, plan->value(place[0], place[1], place[2]), plan->big);
            }
    return at;
}

static brio_status read_bytes(const char *bytes, size_t size, brio_volume *volume) {
    brio_stream s = {.ctx = io_ctx, .file = -1};
    io_put("a.map", bytes, size);
    brio_status status = brio_stream_open(&s, io_ctx, io_path("a.map"));
    if (status == BRIO_OK) status = brio_ccp4_read(&s, volume);
    brio_stream_close(&s);
    return status;
}

static brio_volume read_plan(const map_plan *plan) {
    static char bytes[MOST_BYTES];
    brio_volume volume = {0};
    size_t size = make_map(plan, bytes);
    EXPECT(read_bytes(bytes, size, &volume) == BRIO_OK, "%s", brio_message(io_ctx));
    return volume;
}

static void expect_numbered(const brio_volume *v, const char *name) {
    for (uint32_t z = 0; v->values && z < v->size[2]; z++)
        for (uint32_t y = 0; y < v->size[1]; y++)
            for (uint32_t x = 0; x < v->size[0]; x++) {
                double found = (double)v->values[((size_t)z * v->size[1] + y) * v->size[0] + x];
                EXPECT(found == numbered((int)x, (int)y, (int)z), "%s: %u %u %u: %g", name, x, y, z, found);
            }
}

/* --- what maps hold --- */

static void map_of_every_mode_order_and_axes(void) {
    static const int modes[] = {0, 1, 2, 6},
                     axes[6][3] = {{1, 2, 3}, {1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}};
    for (int m = 0; m < 4; m++)
        for (int big = 0; big < 2; big++)
            for (int a = 0; a < 6; a++) {
                map_plan plan = plain;
                char name[64];
                plan.mode = modes[m];
                plan.big = big;
                plan.symmetry = a * 80;
                for (int k = 0; k < 3; k++) {
                    plan.axis[k] = axes[a][k];
                    plan.start[k] = 10 * axes[a][k] - 20;
                }
                snprintf(name, sizeof name, "mode %d, big %d, axes %d", modes[m], big, a);
                brio_volume v = read_plan(&plan);
                for (int k = 0; k < 3; k++) {
                    EXPECT(v.size[axes[a][k] - 1] == (uint32_t)plan.size[k], "%s", name);
                    EXPECT(v.origin[k] == 10 * k - 10, "%s: origin %g", name, v.origin[k]);
                    for (int i = 0; i < 3; i++) EXPECT(v.step[k][i] == (i == k), "%s", name);
                }
                expect_numbered(&v, name);
                brio_volume_free(io_ctx, &v);
            }
}

static void axes_and_angles_left_zero(void) {
    for (int big = 0; big < 2; big++) {
        map_plan plan = plain;
        plan.big = big;
        for (int k = 0; k < 3; k++) {
            plan.axis[k] = 0;
            plan.angle[k] = 0;
        }
        brio_volume v = read_plan(&plan);
        expect_numbered(&v, "zero axes");
        EXPECT(v.step[1][0] == 0 && v.step[1][1] == 1 && v.step[2][2] == 1);
        brio_volume_free(io_ctx, &v);
    }
}

static void origin_of_mrc_before_starts(void) {
    map_plan plan = plain;
    for (int k = 0; k < 3; k++) {
        plan.origin[k] = (float)k - 0.5f;
        plan.start[k] = 99;
    }
    brio_volume v = read_plan(&plan);
    EXPECT(v.origin[0] == -0.5 && v.origin[1] == 0.5 && v.origin[2] == 1.5);
    brio_volume_free(io_ctx, &v);
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void skewed_cell_has_its_lengths_and_angles(void) {
    map_plan plan = plain;
    const float lengths[3] = {12, 9, 20}, angles[3] = {80, 105, 120};
    for (int k = 0; k < 3; k++) {
        plan.length[k] = lengths[k];
        plan.angle[k] = angles[k];
        plan.start[k] = k + 1;
    }
    brio_volume v = read_plan(&plan);
    for (int k = 0; k < 3; k++) {
        const double *a = v.step[(k + 1) % 3], *b = v.step[(k + 2) % 3], *c = v.step[k];
        double cosine = dot(a, b) / sqrt(dot(a, a) * dot(b, b));
        EXPECT(fabs(sqrt(dot(c, c)) - (double)lengths[k] / plan.intervals[k]) < 1e-12);
        EXPECT(fabs(cosine - cos((double)angles[k] * acos(-1) / 180)) < 1e-12, "angle %d", k);
        double sum = v.step[0][k] + 2 * v.step[1][k] + 3 * v.step[2][k];
        EXPECT(fabs(v.origin[k] - sum) < 1e-12);
    }
    EXPECT(v.step[0][1] == 0 && v.step[0][2] == 0 && v.step[1][2] == 0 && v.step[2][2] > 0);
    brio_volume_free(io_ctx, &v);
}

/* --- maps that are refused --- */

static void expect_map_error(const map_plan *plan, int offset, int32_t value, brio_status expected, const char *part) {
    static char bytes[MOST_BYTES];
    brio_volume volume = {0};
    size_t size = make_map(plan, bytes);
    put_whole(bytes, offset, value, plan->big);
    brio_status status = read_bytes(bytes, size, &volume);
    EXPECT(status == expected, "byte %d = %d: status %d", offset, (int)value, (int)status);
    EXPECT(strstr(brio_message(io_ctx), part), "\"%s\" without \"%s\"", brio_message(io_ctx), part);
    EXPECT(strstr(brio_message(io_ctx), "a.map: "), "%s", brio_message(io_ctx));
    brio_volume_free(io_ctx, &volume);
}

static int32_t bits_of(float x) {
    int32_t bits;
    memcpy(&bits, &x, 4);
    return bits;
}

static void wrong_headers(void) {
    for (int big = 0; big < 2; big++) {
        map_plan plan = plain;
        plan.big = big;
        expect_map_error(&plan, 208, 0, BRIO_ERR_FORMAT, "byte 208: expected the word \"MAP \"");
        expect_map_error(&plan, 12, 3, BRIO_ERR_FORMAT, "byte 12: mode 3 (a transform, no map), expected 0");
        expect_map_error(&plan, 12, 12, BRIO_ERR_FORMAT, "byte 12: mode 12, expected 0");
        expect_map_error(&plan, 12, -1, BRIO_ERR_FORMAT, "byte 64: the axes");
        expect_map_error(&plan, 64, 2, BRIO_ERR_FORMAT, "byte 64: the axes of columns, rows and sections are not");
        expect_map_error(&plan, 72, 4, BRIO_ERR_FORMAT, "byte 64: the axes");
        expect_map_error(&plan, 0, 0, BRIO_ERR_FORMAT, "byte 0: 0 columns");
        expect_map_error(&plan, 4, -5, BRIO_ERR_FORMAT, "byte 4: -5 rows");
        expect_map_error(&plan, 8, 0, BRIO_ERR_FORMAT, "byte 8: 0 sections");
        expect_map_error(&plan, 32, 0, BRIO_ERR_FORMAT, "byte 32: 0 intervals along the cell's y");
        expect_map_error(&plan, 40, bits_of(0), BRIO_ERR_FORMAT, "byte 40: the cell is 0 long along x");
        expect_map_error(&plan, 48, bits_of(NAN), BRIO_ERR_FORMAT, "byte 48: the cell is nan long along z");
        expect_map_error(&plan, 52, bits_of(0), BRIO_ERR_FORMAT, "byte 52: no cell has the angles 0, 90, 90");
        expect_map_error(&plan, 56, bits_of(180), BRIO_ERR_FORMAT, "no cell has the angles 90, 180, 90");
        expect_map_error(&plan, 60, bits_of(NAN), BRIO_ERR_FORMAT, "no cell has the angles");
        expect_map_error(&plan, 196, bits_of(INFINITY), BRIO_ERR_FORMAT, "byte 196: the origin");
        expect_map_error(&plan, 92, -80, BRIO_ERR_FORMAT, "byte 92: -80 bytes of symmetry records");
        expect_map_error(&plan, 92, 1 << 20, BRIO_ERR_FORMAT, "byte of the symmetry records");
        expect_map_error(&plan, 0, 7, BRIO_ERR_FORMAT, "promises at least 336 bytes after byte 1024, the file has 288");
        expect_map_error(&plan, 8, INT32_MAX, BRIO_ERR_FORMAT, "promises at least");
    }
    map_plan impossible = plain; /* each angle may be, the three together may not */
    impossible.angle[0] = impossible.angle[1] = 30;
    expect_map_error(&impossible, 60, bits_of(100), BRIO_ERR_FORMAT, "no cell has the angles 30, 30, 100");
    map_plan huge = plain;
    static char bytes[MOST_BYTES];
    brio_volume volume;
    size_t size = make_map(&huge, bytes);
    for (int k = 0; k < 3; k++) put_whole(bytes, 4 * k, INT32_MAX, false);
    EXPECT(read_bytes(bytes, size, &volume) == BRIO_ERR_TOO_LARGE, "%s", brio_message(io_ctx));
}

static double with_holes(int x, int y, int z) {
    if (x == 2 && y == 1) return z == 1 ? (double)NAN : z == 3 ? (double)INFINITY : 1;
    return 1;
}

static void values_that_are_not_finite(void) {
    map_plan plan = plain;
    plan.value = with_holes;
    plan.symmetry = 160;
    /* value (2, 1, 1) is number 2 + 6 * (1 + 3 * 1) of 4 bytes each */
    expect_map_error(&plan, 200, 0, BRIO_ERR_NOT_FINITE, "byte 1288: the value is not finite; there are 2 such values");
}

static void truncated_anywhere(void) {
    static char bytes[MOST_BYTES];
    size_t size = make_map(&plain, bytes);
    for (size_t kept = 0; kept < size; kept += kept < 1000 ? 97 : 7) {
        brio_volume volume = {0};
        EXPECT(read_bytes(bytes, kept, &volume) == BRIO_ERR_FORMAT, "%zu bytes", kept);
        brio_volume_free(io_ctx, &volume);
    }
    EXPECT(strstr(brio_message(io_ctx), "the file has"), "%s", brio_message(io_ctx));
}

/* --- surfaces of volumes --- */

static double ball(int x, int y, int z) {
    return 64 - (x - 10) * (x - 10) - (y - 11) * (y - 11) - (z - 12) * (z - 12);
}

static brio_certificate certify(const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(io_ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.volume > 0);
    return c;
}

static map_plan ball_plan(void) {
    map_plan plan = plain;
    plan.value = ball;
    for (int k = 0; k < 3; k++) plan.size[k] = plan.intervals[k] = 24;
    return plan;
}

static brio_mesh *surface_of(const map_plan *plan, double level, size_t resolution) {
    brio_volume v = read_plan(plan);
    brio_mesh *mesh = NULL;
    EXPECT(brio_volume_surface(io_ctx, &v, level, resolution, false, &mesh) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_volume_free(io_ctx, &v);
    return mesh;
}

/* A quadratic is what cubic splines of its values are, so the vertices lie on the sphere whatever the cells. */
static void ball_is_round_at_every_resolution(void) {
    const size_t resolutions[] = {0, 15, 60};
    for (int i = 0; i < 3; i++) {
        map_plan plan = ball_plan();
        for (int k = 0; k < 3; k++) plan.length[k] = 24;
        brio_mesh *mesh = surface_of(&plan, 0, resolutions[i]);
        brio_certificate c = certify(mesh);
        EXPECT(c.genus == 0 && c.components == 1);
        EXPECT(fabs(c.volume / (4 * acos(-1) / 3 * 512) - 1) < 0.03, "%g", c.volume);
        for (size_t v = 0; v < mesh->num_vertices; v++) {
            const double *p = mesh->vertices + 3 * v;
            double r = sqrt(pow(p[0] - 10, 2) + pow(p[1] - 11, 2) + pow(p[2] - 12, 2));
            EXPECT(fabs(r - 8) < 1e-6, "resolution %zu: %g", resolutions[i], r);
        }
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

static void skewed_ball_has_the_volume_of_its_cell(void) {
    map_plan plan = ball_plan();
    const float lengths[3] = {24, 48, 36}, angles[3] = {75, 100, 115};
    for (int k = 0; k < 3; k++) {
        plan.length[k] = lengths[k];
        plan.angle[k] = angles[k];
    }
    brio_volume v = read_plan(&plan);
    brio_mesh *mesh = surface_of(&plan, 0, 0);
    brio_certificate c = certify(mesh);
    double cell = v.step[0][0] * v.step[1][1] * v.step[2][2];
    EXPECT(fabs(c.volume / (cell * 4 * acos(-1) / 3 * 512) - 1) < 0.02, "%g", c.volume);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_volume_free(io_ctx, &v);
}

static double everywhere(int x, int y, int z) {
    return 1 + (x + y + z) % 2;
}
static double half_space(int x, int y, int z) {
    return x + 0.01 * y + 0.001 * z;
}

static void what_leaves_the_map_is_closed_flat(void) {
    map_plan plan = plain;
    plan.value = everywhere;
    brio_mesh *mesh = surface_of(&plan, 0, 0); /* a box of 4 by 1 by 2, its edges cut off */
    brio_certificate c = certify(mesh);
    EXPECT(c.genus == 0 && c.components == 1 && c.volume > 6 && c.volume <= 8 + 1e-9, "%g", c.volume);
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        const double *p = mesh->vertices + 3 * i;
        EXPECT(p[0] >= 0.5 - 1e-9 && p[0] <= 4.5 + 1e-9 && p[1] >= 0.5 - 1e-9 && p[1] <= 1.5 + 1e-9);
    }
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    plan.value = half_space;
    mesh = surface_of(&plan, 2.2, 60);
    c = certify(mesh);
    EXPECT(c.genus == 0 && c.components == 1);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
}

static void volumes_without_surface(void) {
    map_plan plan = plain;
    brio_mesh *mesh = surface_of(&plan, 1e9, 0);
    EXPECT(mesh->num_faces == 0 && mesh->num_vertices == 0);
    brio_mesh_free(mesh);
    plan.size[1] = 1;
    brio_volume v = read_plan(&plan);
    EXPECT(brio_volume_surface(io_ctx, &v, 0, 0, false, &mesh) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(strstr(brio_message(io_ctx), "6 x 1 x 4"), "%s", brio_message(io_ctx));
    v.size[0] = 3; /* of the same 24 values */
    v.size[1] = 2;
    EXPECT(brio_volume_surface(io_ctx, &v, 0, 40000, false, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    brio_volume_free(io_ctx, &v);
}

/* A step of 2^32 times the others: the number of cubes along the first axis did not fit its integer. */
static void steps_too_different_for_cubes_are_refused(void) {
    float values[27] = {0};
    values[13] = 1;
    for (int axis = 0; axis < 3; axis++) {
        brio_mesh *mesh = NULL;
        brio_volume v = {{3, 3, 3}, values, {0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
        v.step[axis][axis] = 0x1p32;
        EXPECT(brio_volume_surface(io_ctx, &v, 0.5, 0, true, &mesh) == BRIO_ERR_TOO_LARGE && !mesh, "axis %d", axis);
        EXPECT(strstr(brio_message(io_ctx), "choose their number with a resolution"), "%s", brio_message(io_ctx));
        v.step[axis][axis] = 0x1p-14; /* and as many cubes along the other two */
        EXPECT(brio_volume_surface(io_ctx, &v, 0.5, 0, true, &mesh) == BRIO_ERR_TOO_LARGE && !mesh, "axis %d", axis);
        v.step[axis][axis] = 2;
        EXPECT(brio_volume_surface(io_ctx, &v, 0.5, 0, true, &mesh) == BRIO_OK && mesh, "%s", brio_message(io_ctx));
        brio_mesh_free(mesh);
    }
}

static void statistics_of_a_volume(void) {
    float values[8] = {1, 1, 1, 1, 5, 5, 5, 5};
    const brio_volume v = {.size = {2, 2, 2}, .values = values};
    double mean, deviation;
    brio_volume_statistics(&v, &mean, &deviation);
    EXPECT(mean == 3 && deviation == 2);
}

/* --- atoms --- */

#define ATOM_LINE "%-6s%5d %4s%c%3s A%4d    %8.3f%8.3f%8.3f  1.00  0.00          %2s\n"

static brio_status read_atoms(const char *text, brio_atom **atoms, size_t *count) {
    brio_stream s = {.ctx = io_ctx, .file = -1};
    io_put("a.pdb", text, strlen(text));
    brio_status status = brio_stream_open(&s, io_ctx, io_path("a.pdb"));
    if (status == BRIO_OK) status = brio_pdb_read(&s, atoms, count);
    brio_stream_close(&s);
    return status;
}

static void atoms_of_a_file(void) {
    char text[2048];
    brio_atom *atoms;
    size_t count;
    int n = snprintf(text, sizeof text, "HEADER    TEST\r\nREMARK ATOM  is a word\nMODEL        1\n");
    n += snprintf(text + n, sizeof text - (size_t)n, ATOM_LINE ATOM_LINE ATOM_LINE ATOM_LINE ATOM_LINE ATOM_LINE,
                  "ATOM", 1, " N  ", ' ', "ALA", 1, 1.5, -2.25, 3.125, " N", "ATOM", 2, " CA ", 'A', "ALA", 1, -100.123,
                  -200.456, -999.999, " C", "ATOM", 3, " CA ", 'B', "ALA", 1, 9., 9., 9., " C", "HETATM", 4, " O  ",
                  ' ', "HOH", 2, 9., 9., 9., " O", "HETATM", 5, "ZN  ", ' ', " ZN", 3, 0., 0., 0., "zn", "ATOM", 6,
                  "HG11", ' ', "VAL", 4, 1., 1., 1., "");
    snprintf(text + n, sizeof text - (size_t)n,
             "ATOM      7  CB  ALA A   1       1.000   2.000   3.000\nATOM      8 XX   ALA A   1       1.000   2.000  "
             " 3.000\nENDMDL\nATOM      9  CB  ALA A   1       0.000   0.000   0.000\nEND\n");
    EXPECT(read_atoms(text, &atoms, &count) == BRIO_OK, "%s", brio_message(io_ctx));
    const double radii[] = {1.55, 1.7, 1.39, 1.1, 1.7, 1.8};
    EXPECT(count == 6, "%zu atoms", count);
    for (size_t i = 0; i < count && i < 6; i++) EXPECT(atoms[i].radius == radii[i], "atom %zu: %g", i, atoms[i].radius);
    EXPECT(atoms[0].position[0] == 1.5 && atoms[0].position[1] == -2.25 && atoms[0].position[2] == 3.125);
    EXPECT(atoms[1].position[0] == -100.123 && atoms[1].position[1] == -200.456 && atoms[1].position[2] == -999.999);
    brio_release(io_ctx, atoms);
}

static void expect_atom_error(const char *text, brio_status expected, const char *part) {
    brio_atom *atoms;
    size_t count;
    EXPECT(read_atoms(text, &atoms, &count) == expected && !atoms && !count, "%s", text);
    EXPECT(strstr(brio_message(io_ctx), part), "\"%s\" without \"%s\"", brio_message(io_ctx), part);
}

static void atoms_that_are_refused(void) {
    const char *none = "no line is an atom (ATOM or HETATM) other than of water";
    expect_atom_error("", BRIO_ERR_FORMAT, none);
    expect_atom_error("HEADER\nEND\n", BRIO_ERR_FORMAT, none);
    expect_atom_error("HETATM    4  O   HOH A   2       9.000   9.000   9.000\n", BRIO_ERR_FORMAT, none);
    expect_atom_error("END\nATOM      7  CB  ALA A   1       1.000   2.000\n", BRIO_ERR_FORMAT,
                      "a.pdb: line 2: an atom of 46 columns, expected coordinates in columns 31 to 54");
    expect_atom_error("ATOM      7  CB  ALA A   1       1.000   2.0x0   3.000\n", BRIO_ERR_FORMAT,
                      "line 1: columns 39 to 46: expected the coordinate y, found \"   2.0x0\"");
    expect_atom_error("ATOM      7  CB  ALA A   1                           3.000\n", BRIO_ERR_FORMAT,
                      "columns 31 to 38: expected the coordinate x");
    expect_atom_error("ATOM      7  CB  ALA A   1       1.000   2.000     nan\n", BRIO_ERR_NOT_FINITE,
                      "line 1: the coordinate z is not finite");
    expect_atom_error("ATOM      7  CB  ALA A   1       1.000   2.000   3.000\nATOM\n", BRIO_ERR_FORMAT, "line 2");
}

/* --- surfaces of atoms --- */

static void lone_atom_is_the_ball_of_its_radius(void) {
    const brio_atom atom = {{1, 2, 3}, 1.7};
    for (double blobbiness = 0.5; blobbiness < 20; blobbiness *= 2) {
        brio_mesh *mesh = NULL;
        EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1, blobbiness, 40, false}, &mesh) ==
               BRIO_OK);
        brio_certificate c = certify(mesh);
        EXPECT(c.genus == 0 && c.components == 1);
        for (size_t i = 0; i < mesh->num_vertices; i++) {
            const double *p = mesh->vertices + 3 * i;
            double r = sqrt(pow(p[0] - 1, 2) + pow(p[1] - 2, 2) + pow(p[2] - 3, 2));
            EXPECT(fabs(r - 1.7) < 2e-3, "blobbiness %g: %g", blobbiness, r);
        }
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

static double density_at(const brio_atom *atoms, size_t count, double blobbiness, const double *p) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) square += pow(p[k] - atoms[i].position[k], 2);
        sum += exp(blobbiness * (1 - square / (atoms[i].radius * atoms[i].radius)));
    }
    return sum;
}

/* Gaussians of all atoms, none left out by the buckets but for their ends. */
static void vertices_have_the_level(void) {
    enum { ATOMS = 300 };
    static brio_atom atoms[ATOMS];
    const double levels[] = {0.3, 1, 4};
    uint64_t state = 1;
    for (int i = 0; i < ATOMS; i++) {
        for (int k = 0; k < 3; k++) atoms[i].position[k] = (double)(io_random(&state) % 1600) / 100 - 30;
        atoms[i].radius = 1 + (double)(io_random(&state) % 100) / 100;
    }
    for (int l = 0; l < 3; l++) {
        brio_mesh *mesh = NULL;
        EXPECT(brio_density_surface(io_ctx, atoms, ATOMS, &(brio_density_options){levels[l], 2, 40, false}, &mesh) ==
               BRIO_OK);
        brio_certificate c = certify(mesh);
        for (size_t i = 0; i < mesh->num_vertices; i++) {
            double found = density_at(atoms, ATOMS, 2, mesh->vertices + 3 * i) / levels[l];
            EXPECT(found > 0.999 && found < 1.08, "level %g: %g", levels[l], found * levels[l]);
        }
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

/* Two atoms far apart: as many buckets as their box would hold could not be. */
static void atoms_far_apart(void) {
    const brio_atom atoms[2] = {{{-9999, -9999, -9999}, 1.5}, {{9999, 9999, 9999}, 1.5}};
    brio_mesh *mesh = NULL;
    EXPECT(brio_density_surface(io_ctx, atoms, 2, &(brio_density_options){1, 2, 30, false}, &mesh) == BRIO_OK, "%s",
           brio_message(io_ctx));
    brio_mesh_free(mesh);
}

static void level_above_all_densities(void) {
    const brio_atom atom = {{0, 0, 0}, 1};
    brio_mesh *mesh = NULL;
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1e9, 2, 0, false}, &mesh) == BRIO_OK &&
           mesh->num_faces == 0);
    brio_mesh_free(mesh);
}

static void density_arguments(void) {
    const brio_atom atom = {{0, 0, 0}, 1};
    brio_mesh *mesh = NULL;
    EXPECT(brio_density_surface(io_ctx, NULL, 0, &(brio_density_options){1, 2, 0, false}, &mesh) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){0, 2, 0, false}, &mesh) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){-1, 2, 0, false}, &mesh) ==
           BRIO_ERR_ARGUMENT);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1, 0, 0, false}, &mesh) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1, 1e9, 0, false}, &mesh) ==
           BRIO_ERR_ARGUMENT);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1, 2, 40000, false}, &mesh) ==
               BRIO_ERR_ARGUMENT &&
           !mesh);
}

/* --- files to surfaces --- */

/* Gaussians without an end have no grid; their number of cells was not a number. */
static void density_that_reaches_everywhere_is_refused(void) {
    const brio_atom atom = {{1, 2, 3}, 1.5};
    brio_mesh *mesh = NULL;
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){5e-324, 2, 0, false}, &mesh) ==
               BRIO_ERR_ARGUMENT &&
           !mesh);
    EXPECT(brio_density_surface(io_ctx, &atom, 1, &(brio_density_options){1, 5e-324, 0, false}, &mesh) ==
               BRIO_ERR_ARGUMENT &&
           !mesh);
    EXPECT(strstr(brio_message(io_ctx), "reach too far"), "%s", brio_message(io_ctx));
}

static void write_ball_map(void) {
    static char bytes[MOST_BYTES];
    map_plan plan = ball_plan();
    io_put("ball.map", bytes, make_map(&plan, bytes));
    io_put("ball.dat", bytes, make_map(&plan, bytes));
}

static brio_status generate(const char *name, double level, const brio_iso_surface_options *options, brio_mesh **mesh) {
    return brio_iso_surface(io_ctx, io_path(name), level, options, mesh);
}

static void file_with_a_wanted_number_of_vertices(void) {
    const size_t wanted[] = {1000, 5000, 40000};
    write_ball_map();
    for (int i = 0; i < 3; i++) {
        brio_iso_surface_options o = {0};
        brio_mesh *mesh = NULL;
        o.vertices = wanted[i];
        EXPECT(generate("ball.map", 0, &o, &mesh) == BRIO_OK, "%s", brio_message(io_ctx));
        double ratio = (double)mesh->num_vertices / (double)wanted[i];
        EXPECT(fabs(ratio - 1) < 0.15, "%zu vertices for %zu", mesh->num_vertices, wanted[i]);
        brio_mesh_free(mesh);
    }
}

static void level_in_deviations(void) {
    brio_iso_surface_options o = {0};
    brio_mesh *mesh = NULL, *same = NULL;
    static char bytes[MOST_BYTES];
    map_plan plan = ball_plan();
    brio_volume v;
    double mean, deviation;
    write_ball_map();
    EXPECT(read_bytes(bytes, make_map(&plan, bytes), &v) == BRIO_OK);
    brio_volume_statistics(&v, &mean, &deviation);
    o.deviations = 1;
    EXPECT(generate("ball.dat", 1.25, &o, &mesh) == BRIO_OK); /* known by its content */
    EXPECT(brio_volume_surface(io_ctx, &v, mean + 1.25 * deviation, 0, false, &same) == BRIO_OK);
    EXPECT(io_same_points(mesh, same) && mesh->num_faces == same->num_faces);
    brio_mesh_free(mesh);
    brio_mesh_free(same);
    brio_volume_free(io_ctx, &v);
}

static void expect_generate_error(const char *name, double level, const brio_iso_surface_options *o,
                                  brio_status expected, const char *part) {
    brio_mesh *mesh = NULL;
    brio_status status = generate(name, level, o, &mesh);
    EXPECT(status == expected && !mesh, "%s: status %d", name, (int)status);
    EXPECT(strstr(brio_message(io_ctx), part), "\"%s\" without \"%s\"", brio_message(io_ctx), part);
}

static void files_that_are_refused(void) {
    brio_iso_surface_options o = {0};
    const char *atom = "ATOM      7  CB  ALA A   1       1.000   2.000   3.000\n";
    write_ball_map();
    io_put("a.pdb", atom, strlen(atom));
    io_put("a.xyz", "1 2 3\n", 6);
    expect_generate_error("missing.map", 1, &o, BRIO_ERR_OPEN, "No such file");
    expect_generate_error("a.xyz", 1, &o, BRIO_ERR_FORMAT, "unknown format, expected .map .mrc .ccp4 or .pdb .ent");
    expect_generate_error("ball.map", 1e6, &o, BRIO_ERR_NO_ANSWER, "nothing is above the level 1e+06");
    expect_generate_error("ball.map", NAN, &o, BRIO_ERR_ARGUMENT, "level nan");
    o.deviations = 1;
    expect_generate_error("a.pdb", 1, &o, BRIO_ERR_ARGUMENT, "no mean");
    o.deviations = 0;
    o.resolution = 10;
    o.vertices = 10;
    expect_generate_error("a.pdb", 1, &o, BRIO_ERR_ARGUMENT, "one decides the other");
}

static void atoms_from_a_file(void) {
    const char *atom = "ATOM      7  CB  ALA A   1       1.000   2.000   3.000\n";
    brio_mesh *mesh = NULL;
    io_put("a.pdb", atom, strlen(atom));
    EXPECT(generate("a.pdb", 1, NULL, &mesh) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_certificate c = certify(mesh);
    EXPECT(fabs(c.volume / (4 * acos(-1) / 3 * pow(1.7, 3)) - 1) < 0.1, "%g", c.volume);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
}

static brio_status both_kinds(brio_context *failing) {
    brio_iso_surface_options o = {0};
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    o.resolution = 10;
    BRIO_TRY(brio_iso_surface(failing, io_path("ball.map"), 1, &o, &mesh));
    brio_mesh_free(mesh);
    mesh = NULL;
    BRIO_TRY(brio_iso_surface(failing, io_path("a.pdb"), 1, &o, &mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

static void memory_fails_cleanly(void) {
    write_ball_map();
    expect_clean_failures(both_kinds);
}

static int cancel(const char *stage, double fraction, void *user) {
    (void)fraction, (void)user;
    return !strcmp(stage, "surface");
}

static void cancelled(void) {
    write_ball_map();
    brio_context_set_progress(io_ctx, cancel, NULL);
    brio_iso_surface_options o = {0};
    brio_mesh *mesh = NULL;
    EXPECT(generate("ball.map", 1, &o, &mesh) == BRIO_ERR_CANCELLED && !mesh);
    brio_context_set_progress(io_ctx, NULL, NULL);
}

SUITE(test_volume) {
    io_begin();
    RUN(map_of_every_mode_order_and_axes);
    RUN(axes_and_angles_left_zero);
    RUN(origin_of_mrc_before_starts);
    RUN(skewed_cell_has_its_lengths_and_angles);
    RUN(wrong_headers);
    RUN(values_that_are_not_finite);
    RUN(truncated_anywhere);
    RUN(ball_is_round_at_every_resolution);
    RUN(skewed_ball_has_the_volume_of_its_cell);
    RUN(what_leaves_the_map_is_closed_flat);
    RUN(volumes_without_surface);
    RUN(steps_too_different_for_cubes_are_refused);
    RUN(statistics_of_a_volume);
    RUN(atoms_of_a_file);
    RUN(atoms_that_are_refused);
    RUN(lone_atom_is_the_ball_of_its_radius);
    RUN(vertices_have_the_level);
    RUN(atoms_far_apart);
    RUN(level_above_all_densities);
    RUN(density_arguments);
    RUN(density_that_reaches_everywhere_is_refused);
    RUN(file_with_a_wanted_number_of_vertices);
    RUN(level_in_deviations);
    RUN(files_that_are_refused);
    RUN(atoms_from_a_file);
    RUN(memory_fails_cleanly);
    RUN(cancelled);
    return io_end();
}
