/* PCD and PTX files that are cut, changed, or lie: each is a status whose sentence names the file and the place, and
 * leaves nothing behind. */
#include "failing_allocator.h"
#include "io_files.h"

enum { POINTS = 9, RECORD = 19 };

/* --- PCD --- */

#define PCD_HEADER                                                                                                     \
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity rgb label\nSIZE 4 4 4 2 4 1\nTYPE F F F U U I\n"                 \
    "COUNT 1 1 1 1 1 1\nWIDTH 3\nHEIGHT 3\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 9\nDATA "

typedef struct {
    char bytes[4096];
    size_t size;
} file_bytes;

static void put(file_bytes *f, const void *bytes, size_t size) {
    memcpy(f->bytes + f->size, bytes, size);
    f->size += size;
}

static file_bytes with_text(const char *text) {
    file_bytes f = {.size = 0};
    put(&f, text, strlen(text));
    return f;
}

static void put_record(file_bytes *f, int i) {
    const float point[] = {(float)i, (float)i / 2, (float)-i};
    const uint16_t intensity = (uint16_t)(1000 * i);
    const uint32_t colour = 0x010203u * (uint32_t)i;
    const int8_t label = (int8_t)-i;
    put(f, point, 12);
    put(f, &intensity, 2);
    put(f, &colour, 4);
    put(f, &label, 1);
}

static file_bytes pcd_text(void) {
    file_bytes f = with_text(PCD_HEADER "ascii\n");
    for (int i = 0; i < POINTS; i++)
        f.size += (size_t)sprintf(f.bytes + f.size, "%d %g %d %d %d %d\n", i, i / 2.0, -i, 1000 * i, 0x010203 * i, -i);
    return f;
}

static file_bytes pcd_binary(void) {
    file_bytes f = with_text(PCD_HEADER "binary\n");
    for (int i = 0; i < POINTS; i++) put_record(&f, i);
    return f;
}

/* Compressed data stand in columns. LZF without a repetition: a byte n - 1, then n bytes. */
static file_bytes pcd_compressed(void) {
    static const size_t sizes[] = {4, 4, 4, 2, 4, 1};
    file_bytes f = with_text(PCD_HEADER "binary_compressed\n"), rows = {.size = 0}, columns = {.size = 0};
    for (int i = 0; i < POINTS; i++) put_record(&rows, i);
    for (size_t k = 0, at = 0; k < 6; at += sizes[k++])
        for (size_t i = 0; i < POINTS; i++) put(&columns, rows.bytes + i * RECORD + at, sizes[k]);
    uint32_t lengths[2] = {0, (uint32_t)columns.size};
    size_t place = f.size;
    put(&f, lengths, 8);
    for (size_t i = 0; i < columns.size; i += 32) {
        size_t n = columns.size - i < 32 ? columns.size - i : 32;
        put(&f, (char[]){(char)(n - 1)}, 1);
        put(&f, columns.bytes + i, n);
    }
    lengths[0] = (uint32_t)(f.size - place - 8);
    memcpy(f.bytes + place, lengths, 8);
    return f;
}

/* --- PTX --- */

#define PTX_HEADER "3\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n10 20 30 1\n"

static file_bytes ptx(int scans) {
    file_bytes f = {.size = 0};
    for (int scan = 0; scan < scans; scan++) {
        put(&f, PTX_HEADER, strlen(PTX_HEADER));
        for (int i = 0; i < POINTS; i++)
            f.size += (size_t)sprintf(f.bytes + f.size, "%d %g %d 0.5 %d 0 255\n", i, i / 2.0, -i, i);
    }
    return f;
}

/* --- all --- */

typedef struct {
    const char *name;
    file_bytes file;
    size_t points;
} sample;

enum { SAMPLES = 5 };
static sample samples[SAMPLES];

static void make_samples(void) {
    /* of PTX the first point of each scan is at the scanner: a place without a return */
    samples[0] = (sample){"a.pcd", pcd_text(), POINTS};
    samples[1] = (sample){"b.pcd", pcd_binary(), POINTS};
    samples[2] = (sample){"c.pcd", pcd_compressed(), POINTS};
    samples[3] = (sample){"a.ptx", ptx(1), POINTS - 1};
    samples[4] = (sample){"b.ptx", ptx(2), 2 * (POINTS - 1)};
}

static void expect_point(const brio_mesh *m, size_t v, double x, double y, double z) {
    const double *p = m->vertices + 3 * v;
    EXPECT(p[0] == x && p[1] == y && p[2] == z, "point %zu: %g %g %g", v, p[0], p[1], p[2]);
}

static void whole_files_are_read(void) {
    for (const sample *s = samples; s < samples + SAMPLES; s++) {
        brio_status status;
        brio_mesh *m = io_read_bytes(s->name, s->file.bytes, s->file.size, &status);
        EXPECT(status == BRIO_OK && m && m->num_vertices == s->points, "%s: %s", s->name, brio_message(io_ctx));
        bool is_ptx = s->points != POINTS;
        for (size_t v = 0; m && v < m->num_vertices; v++) {
            size_t i = is_ptx ? v % (POINTS - 1) + 1 : v, away = is_ptx;
            double x = (double)i;
            expect_point(m, v, x + 10. * (double)away, x / 2 + 20. * (double)away, -x + 30. * (double)away);
            const brio_property *red = brio_mesh_property(m, "red");
            EXPECT(red && brio_property_value(red, v) == x, "%s: red of point %zu", s->name, v);
        }
        brio_mesh_free(m);
    }
}

/* At the end of a text a line feed may be missing, and digits of the last number; no other prefix is whole. A PTX file of two scans
 * is whole where the first one ends. */
static void every_truncation_is_refused(void) {
    for (const sample *s = samples; s < samples + SAMPLES; s++) {
        bool text = s != &samples[1] && s != &samples[2];
        for (size_t n = 0; n < s->file.size; n++) {
            brio_status status;
            brio_mesh *m = io_read_bytes(s->name, s->file.bytes, n, &status);
            size_t one = samples[3].file.size;
            bool whole = text && (s->file.size - n <= 3 || (s == &samples[4] && n <= one && one - n <= 3));
            EXPECT(whole || status == BRIO_ERR_FORMAT, "%s: %zu bytes: status %d", s->name, n, (int)status);
            EXPECT(status == BRIO_OK || strstr(brio_message(io_ctx), s->name), "%s", brio_message(io_ctx));
            brio_mesh_free(m);
            EXPECT(brio_context_memory(io_ctx) == 0, "%s: %zu bytes", s->name, n);
        }
    }
}

static void random_changes_are_a_status(void) {
    uint64_t state = 9;
    for (const sample *s = samples; s < samples + SAMPLES; s++)
        for (size_t n = 0; n < 2000; n++) {
            file_bytes f = s->file;
            for (uint64_t i = 1 + io_random(&state) % 3; i > 0; i--)
                f.bytes[io_random(&state) % f.size] ^= (char)(1 << io_random(&state) % 8);
            brio_mesh *m = NULL;
            io_put(s->name, f.bytes, f.size);
            brio_status status = brio_read(io_ctx, io_path(s->name), NULL, &m);
            EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE,
                   "%s, change %zu: status %d: %s", s->name, n, (int)status, brio_message(io_ctx));
            EXPECT(status == BRIO_OK || strstr(brio_message(io_ctx), s->name), "%s", brio_message(io_ctx));
            brio_mesh_free(m);
            EXPECT(brio_context_memory(io_ctx) == 0, "%s, change %zu", s->name, n);
        }
}

/* A sample with one text in place of another. */
static void expect_lie(const sample *s, const char *old, const char *new, const char *part) {
    file_bytes f = {.size = 0};
    const char *at = NULL;
    for (const char *c = s->file.bytes; !at && c < s->file.bytes + s->file.size; c++)
        if (!strncmp(c, old, strlen(old))) at = c;
    EXPECT(at, "no %s in %s", old, s->name);
    if (!at) return;
    size_t before = (size_t)(at - s->file.bytes), after = before + strlen(old);
    put(&f, s->file.bytes, before);
    put(&f, new, strlen(new));
    put(&f, s->file.bytes + after, s->file.size - after);
    brio_status status;
    brio_mesh *m = io_read_bytes(s->name, f.bytes, f.size, &status);
    EXPECT(status == BRIO_ERR_FORMAT && !m, "%s: %s: status %d", s->name, new, (int)status);
    EXPECT(strstr(brio_message(io_ctx), part) && strstr(brio_message(io_ctx), s->name), "\"%s\" without \"%s\"",
           brio_message(io_ctx), part);
    brio_mesh_free(m);
}

static void headers_of_pcd_that_lie(void) {
    static const struct {
        const char *old, *new, *part;
    } all[] = {
        {"WIDTH 3", "WIDTH 4", "9 points, WIDTH times HEIGHT is 12"},
        {"POINTS 9", "POINTS 0", "0 points, WIDTH times HEIGHT is 9"},
        {"WIDTH 3", "WIDTH 9223372036854775808", "WIDTH times HEIGHT is 18446744073709551615"},
        {"WIDTH 3\nHEIGHT 3\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 9", "", "expected WIDTH or POINTS before this line"},
        {"WIDTH 3", "WIDTH x", "line 7: expected a whole number"},
        {"SIZE 4 4 4 2 4 1", "SIZE 4 4 4 2 4 1 1", "line 4: expected a size"},
        {"SIZE 4 4 4 2 4 1", "SIZE 4 4 4 2 4", "line 4: expected a size"},
        {"SIZE 4 4 4 2 4 1", "SIZE 4 4 3 2 4 1", "line 4: expected a size"},
        {"SIZE 4 4 4 2 4 1", "SIZE 4 4 16 2 4 1", "line 4: expected a size"},
        {"SIZE 4 4 4 2 4 1", "SIZE 4 4 2 2 4 1", "a floating-point number of 2 bytes"},
        {"TYPE F F F U U I", "TYPE F F F U U X", "line 5: expected a type"},
        {"TYPE F F F U U I", "TYPE F F F U U I I", "line 5: expected a type"},
        {"COUNT 1 1 1 1 1 1", "COUNT 1 1 1 1 1 -1", "line 6: expected a count"},
        {"COUNT 1 1 1 1 1 1", "COUNT 1 1 1 1 1 4294967297", "line 6: expected a count"},
        {"VERSION 0.7\nFIELDS x", "SIZE 4\nFIELDS x", "line 2: expected FIELDS before this line"},
        {"FIELDS x y z", "FIELDS x y y", "no field z"},
        {"VERSION 0.7", "VERSOIN 0.7", "line 2: expected VERSION, FIELDS"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        for (int k = 0; k < 3; k++) expect_lie(&samples[k], all[i].old, all[i].new, all[i].part);
    expect_lie(&samples[0], "DATA ascii", "DATA zip", "line 11: expected DATA ascii, binary or binary_compressed");
    expect_lie(&samples[0], "COUNT 1 1 1 1 1 1", "COUNT 1 1 2 1 1 1", "no field z");
    expect_lie(&samples[1], "COUNT 1 1 1 1 1 1", "COUNT 1 1 2 1 1 1", "the header promises at least 207 bytes");
    expect_lie(&samples[0], "3 1.5 -3", "3 nothing -3", "line 15: expected a number, found \"nothing");
    expect_lie(&samples[0], "\n1 0.5 -1", "\n1 0.5 -1 7 7 7 7 7", "line 13: ");
}

static void points_of_pcd_that_lie(void) {
    const char *whole = "WIDTH 3\nHEIGHT 3\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 9";
    expect_lie(&samples[0], whole, "POINTS 8", "line 17: a row behind point 8 of 8");
    expect_lie(&samples[0], whole, "POINTS 10", "ends at byte");
    expect_lie(&samples[1], whole, "POINTS 10", "the header promises at least 190 bytes");
    expect_lie(&samples[2], whole, "POINTS 10", "171 bytes of data, the header announces 190");
    expect_lie(&samples[2], whole, "POINTS 8", "171 bytes of data, the header announces 152");
    for (int k = 0; k < 2; k++)
        expect_lie(&samples[k], whole, "POINTS 9223372036854775808",
                   "the header promises at least 18446744073709551615");
    expect_lie(&samples[2], whole, "POINTS 9223372036854775808", "compressed data hold 4 GiB at most");
    expect_lie(&samples[2], whole, "POINTS 200000000", "171 bytes of data, the header announces 3800000000");
}

/* The two sizes before compressed data, and the data. */
static void compressed_pcd_that_lies(void) {
    static const struct {
        size_t at;
        uint32_t value;
        const char *part;
    } cases[] = {{0, 0xffffffff, "the size of the data promises at least 4294967295 bytes"},
                 {0, 0, "cannot hold 171"},
                 {0, 20, "the compressed data are damaged"},
                 {4, 0xffffffff, "4294967295 bytes of data, the header announces 171"},
                 {4, 0, "0 bytes of data"},
                 {8, 0xffffffff, "the compressed data are damaged"}};
    size_t data = strlen(PCD_HEADER "binary_compressed\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        file_bytes f = samples[2].file;
        memcpy(f.bytes + data + cases[i].at, &cases[i].value, 4);
        brio_status status;
        brio_mesh *m = io_read_bytes("c.pcd", f.bytes, f.size, &status);
        EXPECT(status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), cases[i].part), "\"%s\" without \"%s\"",
               brio_message(io_ctx), cases[i].part);
        brio_mesh_free(m);
    }
}

static void ptx_that_lies(void) {
    static const struct {
        const char *old, *new, *part;
    } cases[] = {{"3\n3\n0 0 0", "9223372036854775808\n3\n0 0 0", "line 1: the number of columns is"},
                 {"3\n3\n0 0 0", "4294967295\n4294967295\n0 0 0", "the scan's header promises at least"},
                 {"3\n3\n0 0 0", "-3\n3\n0 0 0", "line 1: the number of columns is -3"},
                 {"3\n3\n0 0 0", "3\n2.5\n0 0 0", "line 2: the number of rows is 2.5"},
                 {"3\n3\n0 0 0", "3\n4\n0 0 0", "ends at byte"},
                 {"3\n3\n0 0 0", "3\n2\n0 0 0", "in scan's header"},
                 {"10 20 30 1\n", "10 20 30\n", ""},
                 {"1 0 0 0\n", "1 0 zero 0\n", "line 7: expected a number"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5 -1 0.5 1 0 256", "line 12: the colour 256"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5 -1 0.5 1 0 -1", "line 12: the colour -1"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5 -1 0.5 1 0", "line 12: 6 numbers, expected 3, 4 or 7"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5 -1 0.5", "line 12: 4 numbers, the first point has 7"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5", "line 12: 2 numbers"},
                 {"1 0.5 -1 0.5 1 0 255", "1 0.5 -1 0.5 1 0 255 7", "line 12: expected the end of point 1"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_lie(&samples[3], cases[i].old, cases[i].new, cases[i].part);
}

static const sample *current;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(ctx, io_path(current->name), NULL, &m);
    brio_mesh_free(m);
    return status;
}

static void each_allocation_fails(void) {
    for (current = samples; current < samples + SAMPLES; current++) {
        io_put(current->name, current->file.bytes, current->file.size);
        expect_clean_failures(read_current);
    }
}

SUITE(test_io_scans_hostile) {
    io_begin();
    make_samples();
    RUN(whole_files_are_read);
    RUN(every_truncation_is_refused);
    RUN(random_changes_are_a_status);
    RUN(headers_of_pcd_that_lie);
    RUN(points_of_pcd_that_lie);
    RUN(compressed_pcd_that_lies);
    RUN(ptx_that_lies);
    RUN(each_allocation_fails);
    return io_end();
}
