/* LAS and LAZ: the compressed file is the plain one, for every number of threads and without its table; damaged files
 * are a status; what is written reads back bit for bit, compressed or not; other people's grids are kept. */
#include "failing_allocator.h"
#include "io/las/laz_pen.h"
#include "io_files.h"
#include "laz_samples.h"

typedef struct {
    const char *name;
    const uint8_t *plain, *compressed;
    size_t plain_size, compressed_size;
} sample;

static const sample samples[] = {{"format 3", las_format_3, laz_format_3, sizeof las_format_3, sizeof laz_format_3},
                                 {"format 8", las_format_8, laz_format_8, sizeof las_format_8, sizeof laz_format_8}};
enum { SAMPLES = sizeof samples / sizeof *samples };

static void expect_same(const brio_mesh *a, const brio_mesh *b, const char *what) {
    if (!a || !b) return;
    EXPECT(io_same_points(a, b), "%s", what);
    EXPECT(io_same_bytes(a->coordinate_step, b->coordinate_step, sizeof a->coordinate_step), "%s", what);
    EXPECT(io_same_bytes(a->coordinate_origin, b->coordinate_origin, sizeof a->coordinate_origin), "%s", what);
    EXPECT(a->num_properties == b->num_properties, "%s", what);
    for (size_t i = 0; i < a->num_properties && i < b->num_properties; i++) {
        const brio_property *p = &a->properties[i], *q = brio_mesh_property(b, p->name);
        EXPECT(q && q->type == p->type && io_same_bytes(p->data, q->data, a->num_vertices * brio_scalar_size(p->type)),
               "%s: %s", what, p->name);
    }
}

static brio_mesh *read_right(const char *name, const uint8_t *bytes, size_t size) {
    brio_status status;
    brio_mesh *mesh = io_read_bytes(name, bytes, size, &status);
    EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    return mesh;
}

static void fields_have_their_values(void) {
    brio_mesh *m = read_right("a.las", las_format_8, sizeof las_format_8);
    EXPECT(m && m->num_vertices == 60 && m->num_properties == 17, "%zu", m ? m->num_properties : 0);
    const brio_property *amp = m ? brio_mesh_property(m, "amp") : NULL;
    for (size_t i = 0; amp && i < 60; i++)
        EXPECT(brio_property_value(amp, i) == (double)i * 0.5 + 1, "%g", brio_property_value(amp, i));
    EXPECT(m && m->coordinate_step[0] == 0.01 && m->coordinate_origin[0] == 500000);
    brio_mesh_free(m);
}

static void compressed_is_plain(void) {
    for (int k = 0; k < SAMPLES; k++)
        for (int threads = 1; threads <= 3; threads += 2) {
            brio_context_set_threads(io_ctx, threads);
            brio_mesh *a = read_right("a.las", samples[k].plain, samples[k].plain_size);
            brio_mesh *b = read_right("a.laz", samples[k].compressed, samples[k].compressed_size);
            expect_same(a, b, samples[k].name);
            brio_mesh_free(a);
            brio_mesh_free(b);
        }
    brio_context_set_threads(io_ctx, 0);
}

static uint32_t number_at(const uint8_t *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* A writer that was interrupted leaves no table, and 0 for its place. */
static void table_may_be_missing(void) {
    for (int k = 0; k < SAMPLES; k++) {
        const sample *s = &samples[k];
        uint8_t *bytes = malloc(s->compressed_size);
        memcpy(bytes, s->compressed, s->compressed_size);
        uint8_t *place = bytes + number_at(bytes + 96);
        size_t table = number_at(place);
        memset(place, 0, 8);
        memset(bytes + table, 0, s->compressed_size - table);
        brio_mesh *a = read_right("a.las", s->plain, s->plain_size);
        brio_mesh *b = read_right("b.laz", bytes, table);
        brio_mesh *c = read_right("c.laz", bytes, s->compressed_size);
        expect_same(a, b, s->name);
        expect_same(a, c, s->name);
        brio_mesh_free(a);
        brio_mesh_free(b);
        brio_mesh_free(c);
        free(bytes);
    }
}

static void written_reads_back(void) {
    for (int k = 0; k < SAMPLES; k++) {
        brio_mesh *a = read_right("a.laz", samples[k].compressed, samples[k].compressed_size), *b = NULL;
        EXPECT(brio_write(io_ctx, io_path("b.las"), a, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("b.las"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
        expect_same(a, b, samples[k].name);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
}

/* What is written compressed is what is written plain. */
static void written_compressed_reads_back(void) {
    for (int k = 0; k < SAMPLES; k++) {
        brio_mesh *a = read_right("a.laz", samples[k].compressed, samples[k].compressed_size), *b = NULL;
        EXPECT(brio_write(io_ctx, io_path("b.laz"), a, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("b.laz"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
        expect_same(a, b, samples[k].name);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
}

/* Writes all properties as extra bytes, and attributes that jump about: returns, channels, times. */
static brio_mesh *make_jumping(size_t n, bool late, bool extras) {
    brio_mesh *m = io_make(n, extras ? IO_PROPERTIES : 0);
    uint64_t state = 5;
    static const char *const names[] = {"intensity",
                                        "return_number",
                                        "number_of_returns",
                                        "classification",
                                        "user_data",
                                        "point_source_id",
                                        "gps_time",
                                        "red",
                                        "green",
                                        "blue",
                                        "scanner_channel",
                                        "scan_angle",
                                        "nir"};
    static const uint32_t most[] = {65536, 8, 8, 32, 256, 65536, 0, 65536, 65536, 65536, 4, 32768, 65536};
    for (size_t i = 0; i < 3 * n; i++) m->vertices[i] = (double)(int32_t)(io_random(&state) >> (i / 3 % 24));
    for (size_t k = 0; k < (late ? 13 : 10); k++) {
        void *data = NULL;
        bool time = k == 6;
        EXPECT(brio_mesh_add_property(m, names[k], time ? BRIO_SCALAR_FLOAT64 : BRIO_SCALAR_UINT16, &data) == BRIO_OK);
        double now = 0;
        for (size_t i = 0; i < n && data; i++) {
            uint64_t kind = io_random(&state) % 16;
            now = kind == 0   ? io_random_double(&state)
                  : kind == 1 ? now - 3e-5
                  : kind == 2 ? 1e5
                  : kind < 9  ? now + 1e-5
                              : now;
            if (time) ((double *)data)[i] = now;
            if (!time)
                ((uint16_t *)data)[i] =
                    (uint16_t)(kind < 12 && i ? ((uint16_t *)data)[i - 1] : io_random(&state) % most[k]);
        }
    }
    return m;
}

/* Points about the size of a chunk: 50000. */
static void chunks_of_every_form_read_back(void) {
    static const size_t counts[] = {1, 2, 49999, 50000, 50001, 120000};
    for (size_t k = 0; k < 4 * sizeof counts / sizeof *counts; k += BRIEF_TESTS ? 3 : 1) {
        brio_mesh *a = make_jumping(counts[k / 4], k & 1, k & 2), *b = NULL;
        brio_context_set_threads(io_ctx, k % 3 ? 3 : 1);
        EXPECT(brio_write(io_ctx, io_path("j.laz"), a, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("j.laz"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(a && b && io_same_points(a, b), "case %zu", k);
        for (size_t i = 0; a && b && i < a->num_properties; i++) {
            const brio_property *p = &a->properties[i], *q = brio_mesh_property(b, p->name);
            bool same = q != NULL;
            for (size_t v = 0; same && v < a->num_vertices; v++) {
                double x = brio_property_value(p, v), y = brio_property_value(q, v);
                same = !memcmp(&x, &y, sizeof x);
            }
            EXPECT(same, "case %zu: %s", k, p->name);
        }
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
    brio_context_set_threads(io_ctx, 0);
}

/* What a pen writes a coder reads, also where carries run through many bytes. */
static void the_pen_is_the_coders_counterpart(void) {
    enum { COUNT = 20000 };
    static char memory[2][1 << 17];
    static uint8_t bytes[16 * COUNT];
    for (int kind = 0; kind < 4; kind++) {
        brio_laz_arena arenas[2] = {{memory[0], 0, sizeof memory[0]}, {memory[1], 0, sizeof memory[1]}};
        brio_laz_model symbols[2] = {{NULL, NULL, NULL, 0, 0, 0, 0, 0}};
        brio_laz_integer integers[2] = {{.k = 0}};
        brio_laz_pen pen;
        brio_laz_coder c;
        uint64_t state = 1 + (uint64_t)kind;
        brio_laz_pen_begin(&pen, bytes);
        for (int i = 0; i < COUNT; i++) {
            uint64_t x = io_random(&state);
            uint32_t symbol = kind == 0 ? 299 : kind == 1 ? (x % 97 == 0) * 299u : (uint32_t)(x % 300);
            int32_t number = kind == 3 ? (int32_t)(x >> 7) : (int32_t)x >> (x >> 40) % 32;
            brio_laz_put_symbol(&pen, &arenas[0], &symbols[0], 300, symbol);
            brio_laz_put_int32(&pen, &arenas[0], &integers[0], 7, number, 3);
            brio_laz_put_bits(&pen, 1 + i % 32, (uint32_t)(x >> 9) & (uint32_t)((UINT64_C(2) << i % 32) - 1));
        }
        size_t size = brio_laz_pen_end(&pen);
        EXPECT(size < sizeof bytes, "%zu", size);
        brio_laz_coder_begin(&c, bytes, bytes + size);
        state = 1 + (uint64_t)kind;
        bool same = true;
        for (int i = 0; i < COUNT && same; i++) {
            uint64_t x = io_random(&state);
            uint32_t symbol = kind == 0 ? 299 : kind == 1 ? (x % 97 == 0) * 299u : (uint32_t)(x % 300);
            int32_t number = kind == 3 ? (int32_t)(x >> 7) : (int32_t)x >> (x >> 40) % 32;
            same &= brio_laz_symbol(&c, &arenas[1], &symbols[1], 300) == symbol;
            same &= brio_laz_int32(&c, &arenas[1], &integers[1], 7, 3) == number;
            same &= brio_laz_bits(&c, 1 + i % 32) == ((uint32_t)(x >> 9) & (uint32_t)((UINT64_C(2) << i % 32) - 1));
        }
        EXPECT(same && !c.past, "kind %d", kind);
    }
}

/* Coordinates that came from no LAS file: decimals, singles, and such that no grid holds. */
static void grids_are_found(void) {
    const double cases[][3] = {{0.01, 123456.78, 0}, {0.001, -0.07, 1e-3}, {0.0625, 500000.0625, 0}, {0, 0, 0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        brio_mesh *a = NULL, *b = NULL;
        EXPECT(brio_mesh_new(io_ctx, &a) == BRIO_OK && brio_mesh_set_vertices(a, NULL, 500) == BRIO_OK);
        for (size_t i = 0; i < 1500; i++) {
            double n = (double)(int)(i * 7919 % 10007);
            a->vertices[i] = k == 2 ? (double)(float)(500000 + n * 0.0625) : n * cases[k][0] + (k == 1 ? -3 : 0);
        }
        EXPECT(brio_write(io_ctx, io_path("g.las"), a, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("g.las"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(b && io_same_points(a, b), "case %zu", k);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
    brio_mesh *a = io_make(9, 0), *b = NULL;
    for (size_t i = 0; i < 27; i++) a->vertices[i] = (double)i / 7;
    EXPECT(brio_write(io_ctx, io_path("h.las"), a, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, io_path("h.las"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
    for (size_t i = 0; b && i < 27; i++)
        EXPECT(fabs(a->vertices[i] - b->vertices[i]) <= 0.51 * b->coordinate_step[i % 3], "%zu", i);
    brio_mesh_free(a);
    brio_mesh_free(b);
}

/* A grid whose last step led to infinity, and grids that merged the points next to 0. */
static void coordinates_at_the_ends_of_doubles_read_back(void) {
    static const double most = 0x1.fffffffffffffp1023, least = 0x1p-1074;
    const double cases[][3] = {{-most, most, 0},         {most, most / 3, most / 2},
                               {-most, -1, 0},           {least, 2 * least, 4 * least},
                               {-least, 0, 1e9 * least}, {0, 7e9 * least, 1e-310}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        brio_mesh *a = io_make(3, 0), *b = NULL;
        brio_write_options o = {0};
        double moved, step = 0, size = fmax(fabs(cases[k][0]), fmax(fabs(cases[k][1]), fabs(cases[k][2])));
        o.moved = &moved;
        for (size_t i = 0; i < 9; i++) a->vertices[i] = cases[k][i / 3];
        EXPECT(brio_write(io_ctx, io_path("e.las"), a, &o) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path("e.las"), NULL, &b) == BRIO_OK, "%s", brio_message(io_ctx));
        for (size_t i = 0; b && i < 9; i++) {
            step = b->coordinate_step[i % 3];
            EXPECT(fabs(a->vertices[i] - b->vertices[i]) <= step, "case %zu, number %zu: %g, not %g", k, i,
                   b->vertices[i], a->vertices[i]);
            EXPECT(fabs(a->vertices[i]) > 1e-300 || fabs(a->vertices[i] - b->vertices[i]) <= 0.51 * step, "case %zu",
                   k);
        }
        EXPECT(moved <= 2 * step && step <= fmax(1e-8 * size, 100 * least), "case %zu: step %g, moved %g", k, step,
               moved);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
}

static void expect_status(const char *name, const uint8_t *bytes, size_t size, const char *how, size_t at) {
    brio_mesh *mesh = NULL;
    io_put(name, bytes, size);
    brio_status status = brio_read(io_ctx, io_path(name), NULL, &mesh);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE ||
               status == BRIO_ERR_TOO_LARGE,
           "%s %zu: status %d: %s", how, at, (int)status, brio_message(io_ctx));
    EXPECT((status == BRIO_OK) == (mesh != NULL) && (mesh || brio_message(io_ctx)[0]), "%s %zu", how, at);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(io_ctx) == 0, "%s %zu", how, at);
}

static void damaged_files_are_a_status(void) {
    uint64_t state = 3;
    for (int k = 0; k < SAMPLES; k++) {
        size_t size = samples[k].compressed_size;
        uint8_t *bytes = malloc(size);
        for (size_t n = 0; n < size; n += 3) expect_status("a.laz", samples[k].compressed, n, "prefix", n);
        for (size_t n = 0; n < (BRIEF_TESTS ? 1000 : 3000); n++) {
            memcpy(bytes, samples[k].compressed, size);
            for (uint64_t i = 1 + io_random(&state) % 4; i > 0; i--)
                bytes[io_random(&state) % size] ^= (uint8_t)(1 << io_random(&state) % 8);
            expect_status("a.laz", bytes, size, "change", n);
        }
        free(bytes);
    }
}

/* The arithmetic decoder began with a value that was not below its length, which then grew beyond it: symbols were far
 * beyond the models. */
static void four_bytes_of_ones_make_no_wrong_symbol(void) {
    enum { ARENA = 1 << 12, BYTES = 4096, SYMBOLS = 33 };
    static char memory[ARENA];
    static uint8_t bytes[BYTES];
    brio_laz_arena arena = {memory, 0, ARENA};
    brio_laz_model m = {.cumulative = NULL};
    brio_laz_coder c;
    memset(bytes, 0xff, sizeof bytes);
    brio_laz_coder_begin(&c, bytes, bytes + sizeof bytes);
    EXPECT(c.past, "no encoder writes them");
    for (int i = 0; i < 4 * BYTES; i++) {
        uint32_t symbol = brio_laz_symbol(&c, &arena, &m, SYMBOLS);
        EXPECT(symbol < SYMBOLS && c.value < c.length, "symbol %u of %d", symbol, SYMBOLS);
        if (symbol >= SYMBOLS || c.value >= c.length) return;
    }
}

/* Eight bytes of one value wherever a layer or a chunk may begin, or a size of one may stand. */
static void fill_anywhere(int value, const char *what) {
    for (int k = 0; k < SAMPLES; k++) {
        size_t size = samples[k].compressed_size;
        uint8_t *bytes = malloc(size);
        for (size_t n = 0; n + 8 <= size; n += BRIEF_TESTS ? 3 : 1) {
            memcpy(bytes, samples[k].compressed, size);
            memset(bytes + n, value, n % 2 ? 8 : 4);
            expect_status("a.laz", bytes, size, what, n);
        }
        free(bytes);
    }
}

static void ones_anywhere_in_a_file_are_a_status(void) {
    fill_anywhere(0xff, "ones");
}

/* A layer of no bytes has no decoder: where that of the coordinates was such a one, the program divided by zero. */
static void a_layer_of_no_bytes_divides_by_no_zero(void) {
    fill_anywhere(0, "zeros");
}

/* A chunk that is cut off names the file and the byte. */
static void errors_name_the_place(void) {
    brio_status status;
    uint8_t *bytes = malloc(sizeof laz_format_3);
    memcpy(bytes, laz_format_3, sizeof laz_format_3);
    size_t data = number_at(bytes + 96);
    memset(bytes + data, 0, 8);
    brio_mesh *m = io_read_bytes("cut.laz", bytes, data + 8 + 300, &status);
    EXPECT(status == BRIO_ERR_FORMAT && !m, "%d", (int)status);
    char place[64];
    snprintf(place, sizeof place, "at byte %zu", data + 8);
    EXPECT(strstr(brio_message(io_ctx), place), "%s", brio_message(io_ctx));
    free(bytes);
}

static const sample *current;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path("a.laz"), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    for (current = samples; current < samples + SAMPLES; current++) {
        io_put("a.laz", current->compressed, current->compressed_size);
        expect_clean_failures(read_current);
    }
}

static brio_mesh *written;

static brio_status write_compressed(brio_context *ctx) {
    return brio_write(ctx, io_path("w.laz"), written, NULL);
}

static void each_allocation_of_writing_fails(void) {
    for (current = samples; current < samples + SAMPLES; current++) {
        written = read_right("a.laz", current->compressed, current->compressed_size);
        if (written) brio_mesh_set_metadata(written, "crs.wkt", "LOCAL_CS[\"own\"]", 15);
        expect_clean_failures(write_compressed);
        brio_mesh_free(written);
    }
}

SUITE(test_io_las) {
    io_begin();
    RUN(fields_have_their_values);
    RUN(compressed_is_plain);
    RUN(table_may_be_missing);
    RUN(written_reads_back);
    RUN(written_compressed_reads_back);
    RUN(chunks_of_every_form_read_back);
    RUN(the_pen_is_the_coders_counterpart);
    RUN(grids_are_found);
    RUN(coordinates_at_the_ends_of_doubles_read_back);
    RUN(damaged_files_are_a_status);
    RUN(four_bytes_of_ones_make_no_wrong_symbol);
    RUN(ones_anywhere_in_a_file_are_a_status);
    RUN(a_layer_of_no_bytes_divides_by_no_zero);
    RUN(errors_name_the_place);
    RUN(each_allocation_fails);
    RUN(each_allocation_of_writing_fails);
    return io_end();
}
