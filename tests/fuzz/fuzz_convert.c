/* Files that are read block by block and converted. An input's first three bytes choose; the rest is a file as fuzz_read has
 * it. brio_read_blocks hands over what brio_read_memory reads, or both refuse. brio_convert writes the points that a choice by
 * brute force leaves (brio_outliers and brio_thin have a fuzzer of their own), with the numbers that it says. */
#include "fuzz_folder.h"
#include "read_input.h"

static const struct {
    const char *name;
    bool text; /* of doubles, as numbers */
    bool all;  /* holds points without faces and with properties */
} outputs[] = {{"b.ply", false, true}, {"b.xyz", true, true},  {"b.npy", false, true}, {"b.las", false, false},
               {"b.vtu", false, true}, {"b.obj", false, true}, {"b.csv", true, true},  {"b.node", false, true},
               {"b.e57", false, true}, {"b.ptx", true, false}};

enum { OUTPUTS = sizeof outputs / sizeof *outputs };

static char input_name[32];

static void forget_files(void) {
    fuzz_remove(input_name);
    for (size_t i = 0; i < OUTPUTS; i++) fuzz_remove(outputs[i].name);
    fuzz_remove("b.ele");
    fuzz_leave_folder();
}

/* A new file each time, under the name that its reader goes by. */
static const char *put(const read_input *r) {
    if (*input_name) fuzz_remove(input_name);
    snprintf(input_name, sizeof input_name, "%s", r->name ? r->name : "unknown");
    const char *path = fuzz_path(input_name);
    FILE *f = fopen(path, "wb");
    FUZZ_EXPECT(f && fwrite(r->bytes, 1, r->size, f) == r->size && fclose(f) == 0, "%s", path);
    return path;
}

/* --- block by block --- */

typedef struct {
    const brio_mesh *whole;
    size_t vertices, blocks;
} blocks_seen;

static int take_block(const brio_mesh *block, void *user) {
    blocks_seen *seen = user;
    const brio_mesh *m = seen->whole;
    FUZZ_EXPECT(m || block->num_vertices, "an empty block of a file that is refused");
    seen->blocks++;
    if (!m) return 0;
    FUZZ_EXPECT(seen->vertices + block->num_vertices <= m->num_vertices, "too many points");
    FUZZ_EXPECT(!block->num_vertices ||
                    !memcmp(block->vertices, m->vertices + 3 * seen->vertices, 24 * block->num_vertices),
                "other coordinates");
    FUZZ_EXPECT(block->num_properties == m->num_properties, "%zu properties", block->num_properties);
    for (size_t p = 0; p < m->num_properties; p++)
        for (size_t i = 0; i < block->num_vertices; i++) {
            double a = brio_property_value(&block->properties[p], i);
            double b = brio_property_value(&m->properties[p], seen->vertices + i);
            FUZZ_EXPECT(a == b || (isnan(a) && isnan(b)), "property %zu of %zu", p, i);
        }
    seen->vertices += block->num_vertices;
    return 0;
}

static void expect_blocks(brio_context *ctx, const char *path, const read_input *r, const brio_mesh *whole,
                          brio_status expected) {
    brio_read_options o = {0};
    brio_file_facts facts = {0};
    blocks_seen seen = {.whole = whole};
    o.columns = r->columns;
    brio_status status = brio_read_blocks(ctx, path, &o, take_block, &seen, &facts);
    fuzz_expect_failure(status);
    FUZZ_EXPECT(status == expected, "status %d, not %d: %s", (int)status, (int)expected, brio_message(ctx));
    if (whole) FUZZ_EXPECT(seen.blocks && seen.vertices == whole->num_vertices, "%zu points", seen.vertices);
}

/* --- conversion --- */

typedef struct {
    brio_convert_options o;
    size_t output;
} choice;

static choice choose(fuzz_input *in) {
    static const double spacings[] = {0, 0, 0.5, 2, 1e-3, 1e9, 1, 0.1};
    choice c = {.o = (brio_convert_options){0}};
    uint8_t bits = fuzz_byte(in), more = fuzz_byte(in);
    c.output = bits % OUTPUTS;
    c.o.crop = bits >> 3 & 1;
    for (int k = 0; k < 3; k++) c.o.box[k] = more & 1 ? -1e300 : 0, c.o.box[3 + k] = more & 2 ? 1e300 : 2;
    c.o.drop_outliers = bits & 16 ? 1 + (more >> 2 & 7) : 0;
    c.o.thin = spacings[bits >> 5];
    return c;
}

static bool is_in_box(const double *p, const double *box) {
    for (int k = 0; k < 3; k++)
        if (p[k] < box[k] || p[k] > box[3 + k]) return false;
    return true;
}

/* Keeps the marked rows of points, and their places.   Returns their number. */
static size_t keep(double *points, size_t *places, size_t n, const uint8_t *marks, uint8_t wanted) {
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (marks[i] != wanted) continue;
        memmove(points + 3 * kept, points + 3 * i, 3 * sizeof *points);
        places[kept++] = places[i];
    }
    return kept;
}

/* The points of a mesh that stay, and their places; their number. */
static size_t select_points(brio_context *ctx, const brio_mesh *m, const brio_convert_options *o, double *points,
                            size_t *places) {
    size_t n = m->num_vertices;
    uint8_t *marks = malloc(n + 1);
    if (n) memcpy(points, m->vertices, 24 * n);
    for (size_t i = 0; i < n; i++) places[i] = i, marks[i] = !o->crop || is_in_box(points + 3 * i, o->box);
    n = keep(points, places, n, marks, 1);
    if (o->drop_outliers) {
        FUZZ_EXPECT(brio_outliers(ctx, points, n, o->drop_outliers, NULL, marks) == BRIO_OK, "%s", brio_message(ctx));
        n = keep(points, places, n, marks, 0);
    }
    if (o->thin > 0) {
        FUZZ_EXPECT(brio_thin(ctx, points, n, o->thin, marks, NULL) == BRIO_OK, "%s", brio_message(ctx));
        n = keep(points, places, n, marks, 1);
    }
    free(marks);
    return n;
}

/* Colours have another depth in some formats. */
static bool is_colour(const char *name) {
    return !strcmp(name, "red") || !strcmp(name, "green") || !strcmp(name, "blue") || !strcmp(name, "alpha");
}

static void expect_properties(const brio_mesh *m, const brio_mesh *written, const size_t *places, bool text) {
    FUZZ_EXPECT(m->num_properties == written->num_properties, "%zu properties of %zu", written->num_properties,
                m->num_properties);
    for (size_t p = 0; p < m->num_properties; p++)
        for (size_t i = 0; i < written->num_vertices && !is_colour(m->properties[p].name); i++) {
            double a = brio_property_value(&m->properties[p], places[i]);
            double b = brio_property_value(&written->properties[p], i);
            if (text && m->properties[p].type == BRIO_SCALAR_FLOAT32) b = (float)b;
            FUZZ_EXPECT(a == b || (isnan(a) && isnan(b)), "property %zu of %zu: %.17g was %.17g", p, i, b, a);
        }
}

static void expect_written(brio_context *ctx, const brio_mesh *m, const choice *c, const brio_convert_stats *stats) {
    brio_mesh *written;
    double *points = malloc(24 * (m->num_vertices + 1));
    size_t *places = malloc((m->num_vertices + 1) * sizeof *places);
    size_t n = select_points(ctx, m, &c->o, points, places);
    const char *name = outputs[c->output].name;
    FUZZ_EXPECT(stats->points_read == m->num_vertices && stats->points == n, "%llu of %llu points, not %zu of %zu",
                (unsigned long long)stats->points, (unsigned long long)stats->points_read, n, m->num_vertices);
    brio_status status = brio_read(ctx, fuzz_path(name), NULL, &written);
    FUZZ_EXPECT(status == BRIO_OK || !n, "%s", brio_message(ctx));
    if (written) FUZZ_EXPECT(written->num_vertices == n, "%zu points, not %zu", written->num_vertices, n);
    if (written && outputs[c->output].all) {
        FUZZ_EXPECT(!n || !memcmp(written->vertices, points, 24 * n), "other coordinates");
        bool properties = n && strcmp(name, "b.obj") && strcmp(name, "b.node");
        if (properties) expect_properties(m, written, places, outputs[c->output].text);
    }
    brio_mesh_free(written);
    free(points);
    free(places);
}

static void expect_conversion(brio_context *ctx, const char *path, const read_input *r, const brio_mesh *m,
                              const choice *c) {
    brio_convert_stats stats = {0};
    brio_read_options from = {0};
    brio_convert_options o = c->o;
    from.columns = r->columns;
    o.from = &from;
    fuzz_remove(outputs[c->output].name);
    brio_status status = brio_convert(ctx, path, fuzz_path(outputs[c->output].name), &o, &stats);
    fuzz_expect_failure(status);
    FUZZ_EXPECT(m || status != BRIO_OK, "a file that is refused was converted");
    bool there = access(fuzz_path(outputs[c->output].name), F_OK) == 0;
    FUZZ_EXPECT(there == (status == BRIO_OK), "status %d: %s", (int)status, brio_message(ctx));
    FUZZ_EXPECT(!m || status == BRIO_OK || status == BRIO_ERR_ARGUMENT || status == BRIO_ERR_TOO_LARGE, "%s",
                brio_message(ctx));
    if (m && status == BRIO_OK) expect_written(ctx, m, c, &stats);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static bool begun;
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    brio_mesh *m;
    brio_read_options o = {0};
    if (!begun) atexit(forget_files);
    begun = true;
    choice c = choose(&in);
    read_input r = fuzz_read_input(&in);
    if (r.name && !strcmp(r.name, "a.node")) fuzz_remove("a.ele");
    o.columns = r.columns;
    brio_status status = brio_read_memory(ctx, r.bytes, r.size, r.name ? r.name : "unknown", &o, &m);
    const char *path = put(&r);
    expect_blocks(ctx, path, &r, m, status);
    expect_conversion(ctx, path, &r, m, &c);
    brio_mesh_free(m);
    fuzz_end();
    return 0;
}
