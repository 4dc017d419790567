/* Conversions whose input changes between two passes, or turns out to lack a column, and names that formats cut. The command
 * line's tests convert between all formats. */
#include "failing_allocator.h"
#include "harness.h"
#include "io_files.h"
#include <math.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ROWS = 70000 /* more than a block */ };

static void put_rows(const char *name, const char *header, const char *row, size_t count) {
    FILE *f = fopen(io_path(name), "w");
    fputs(header, f);
    for (size_t i = 0; i < count; i++) fputs(row, f);
    fclose(f);
}

static brio_status convert(const char *from, const char *to) {
    char path[4096];
    strcpy(path, io_path(from));
    return brio_convert(io_ctx, path, io_path(to), NULL, NULL);
}

static brio_mesh *read_back(const char *name) {
    brio_mesh *m = NULL;
    EXPECT(brio_read(io_ctx, io_path(name), NULL, &m) == BRIO_OK, "%s", brio_message(io_ctx));
    return m;
}

/* --- another file --- */

/* Gives another file the name of the input when the first pass is over. */
static int replace(const char *stage, double fraction, void *user) {
    const char *other = user;
    char path[4096];
    (void)stage;
    if (fraction < 0.5) return 0;
    strcpy(path, io_path(other));
    (void)!rename(path, io_path("in.csv")); /* the first time alone */
    return 0;
}

/* The ranges of properties were those of the first file: memory behind them was read, or the file promised points that it
 * had not. */
static void a_file_replaced_between_two_passes_is_an_error(void) {
    static const char *const outputs[] = {"out.las", "out.npy"};
    char many[4096] = "x,y,z", row[4096] = "1,2,3";
    for (int i = 0; i < 90; i++) snprintf(many + strlen(many), 16, ",p%d", i), strcat(row, ",1");
    strcat(many, "\n"), strcat(row, "\n");
    for (int kind = 0; kind < 3; kind++) {
        put_rows("in.csv", "x,y,z,a\n", "1,2,3,4\n", ROWS);
        put_rows("other.csv", kind == 1 ? many : "x,y,z,a\n", kind == 1 ? row : "1,2,3,4\n", kind == 0 ? 10 : ROWS);
        brio_context_set_progress(io_ctx, replace, "other.csv");
        EXPECT(convert("in.csv", outputs[0]) == BRIO_ERR_FORMAT, "kind %d", kind);
        EXPECT(strstr(brio_message(io_ctx), "in.csv: the file changed"), "%s", brio_message(io_ctx));
        EXPECT(io_count_files("out.") == 0);
        brio_context_set_progress(io_ctx, NULL, NULL);
    }
}

static int look_forwards(const char *stage, double fraction, void *user) {
    double *last = user;
    EXPECT(fraction >= *last, "%s %g after %g", stage, fraction, *last);
    *last = fraction;
    return 0;
}

/* With points to choose and a format that is surveyed, the second half began when all was read. */
static void progress_never_runs_backwards(void) {
    static const char *const outputs[] = {"out.las", "out.npy", "out.ply"};
    char from[4096];
    put_rows("in.csv", "x,y,z,a\n", "1,2,3,4\n", ROWS);
    strcpy(from, io_path("in.csv"));
    for (int i = 0; i < 6; i++) {
        brio_convert_options o = {0};
        double last = 0;
        o.thin = i < 3 ? 0.5 : 0;
        o.drop_outliers = i < 3 ? 8 : 0;
        brio_context_set_progress(io_ctx, look_forwards, &last);
        EXPECT(brio_convert(io_ctx, from, io_path(outputs[i % 3]), &o, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        brio_context_set_progress(io_ctx, NULL, NULL);
    }
}

/* --- a column that late rows lack --- */

static void *count_lines(void *path) {
    static int count;
    FILE *f = fopen(path, "r");
    count = 0;
    for (int c; f && (c = getc(f)) != EOF;) count += c == '\n';
    if (f) fclose(f);
    return &count;
}

/* The rows of the first try stayed in the output, and all came again behind them. */
static void rows_in_a_pipe_are_written_once(void) {
    char pipe[4096];
    FILE *f = fopen(io_path("in.csv"), "w");
    fputs("x,y,z,q\n", f);
    for (int i = 0; i < 3 * ROWS; i++) fputs(i + 1 < 3 * ROWS ? "1,2,3,4\n" : "1,2,3\n", f);
    fclose(f);
    strcpy(pipe, io_path("pipe.csv"));
    EXPECT(mkfifo(pipe, 0600) == 0);
    pthread_t reader;
    void *count = NULL;
    EXPECT(pthread_create(&reader, NULL, count_lines, pipe) == 0);
    EXPECT(convert("in.csv", "pipe.csv") == BRIO_OK, "%s", brio_message(io_ctx));
    pthread_join(reader, &count);
    EXPECT(*(int *)count == 3 * ROWS + 1, "%d lines", *(int *)count);
}

/* --- LAS --- */

static void a_las_field_of_nan_alone_stays_nan(void) {
    static const char text[] = "x,y,z,intensity\n1,2,3,\n4,5,6,\n";
    io_put("in.csv", text, strlen(text));
    EXPECT(convert("in.csv", "out.las") == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh *m = read_back("out.las");
    size_t nans = 0;
    for (size_t p = 0; m && p < m->num_properties; p++) nans += isnan(brio_property_value(&m->properties[p], 1));
    EXPECT(nans == 1);
    brio_mesh_free(m);
}

/* --- long names --- */

/* Names of Latin-1 that UTF-8 makes longer than there is room were one name, and refused; LAS refused over 32 bytes. */
static void names_that_are_cut_stay_distinct(void) {
    static const char *const outputs[] = {"out.las", "out.ply", "out.vtu", "out.npy", "out.csv"};
    char name[33] = "", text[200];
    memset(name, 0xf6, 32);
    snprintf(text, sizeof text, "x,y,z,%s,%s1\n1,2,3,4,5\n", name, name);
    io_put("in.csv", text, strlen(text));
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++) {
        EXPECT(convert("in.csv", outputs[i]) == BRIO_OK, "%s", brio_message(io_ctx));
        brio_mesh *m = read_back(outputs[i]);
        size_t found = 0;
        for (size_t p = 0; m && p < m->num_properties; p++) {
            double value = brio_property_value(&m->properties[p], 0);
            found += (value == 4 || value == 5) && !strstr(m->properties[p].name, "\xc3\x83");
        }
        EXPECT(found == 2, "%s: %zu", outputs[i], found);
        brio_mesh_free(m);
    }
}

/* A name was cut in the midst of a character, and the rest taken for another one. */
static void names_are_cut_between_characters(void) {
    char text[200] = "x,y,z,a";
    for (int i = 0; i < 25; i++) strcat(text, "\xe6\xbc\xa2");
    strcat(text, "\n1,2,3,4\n");
    io_put("in.csv", text, strlen(text));
    brio_mesh *m = read_back("in.csv");
    EXPECT(m && m->num_properties == 1 && strlen(m->properties[0].name) == 61, "%s", m ? m->properties[0].name : "");
    brio_mesh_free(m);
}

static void an_npy_field_that_is_there_twice_is_refused(void) {
    static const char header[] = "{'descr': [('x', '<f8'), ('y', '<f8'), ('z', '<f8'), ('x', '<f8')], "
                                 "'fortran_order': False, 'shape': (1,), }\n";
    char bytes[256] = "\x93NUMPY\x01\x00";
    size_t length = strlen(header);
    bytes[8] = (char)length, bytes[9] = 0;
    memcpy(bytes + 10, header, length);
    io_put("in.npy", bytes, 10 + length + 32);
    brio_mesh *m = NULL;
    EXPECT(brio_read(io_ctx, io_path("in.npy"), NULL, &m) == BRIO_ERR_FORMAT, "%zu", m ? m->num_vertices : 0);
    EXPECT(strstr(brio_message(io_ctx), "two fields named x"), "%s", brio_message(io_ctx));
    brio_mesh_free(m);
}

/* --- tiles --- */

static const char *pattern = "tile#.ply";
static uint64_t seen[8]; /* points of each tile */
static size_t num_seen, most_tiles;

static int see_tile(const brio_convert_tile *t, void *user) {
    (void)user;
    EXPECT(t->size == sizeof *t && t->kind->num_vertices == 0 && t->kind->num_properties == 1);
    EXPECT(num_seen < 8 && strcmp(t->kind->properties[0].name, "a") == 0);
    seen[num_seen++] = t->points;
    return num_seen == most_tiles;
}

static brio_status convert_tiles(brio_context *ctx) {
    char from[4096], to[4096], folder[4096], more[4096];
    const char *const others[] = {more};
    strcpy(from, io_path("in.csv")), strcpy(more, io_path("more.csv"));
    strcpy(to, io_path(pattern)), strcpy(folder, io_path("."));
    brio_convert_options o = {.size = sizeof o, .tiles = 3, .scratch = folder, .num_more = 1, .more = others};
    o.thin = 0.5;
    o.tile = see_tile;
    num_seen = 0;
    return brio_convert(ctx, from, to, &o, NULL);
}

static void put_points(const char *name, size_t count) {
    FILE *f = fopen(io_path(name), "w");
    fputs("x,y,z,a\n", f);
    for (size_t i = 0; i < count; i++) fprintf(f, "%zu,%zu,%zu,%zu\n", i, i * i % 17, i * i * i % 13, i);
    fclose(f);
}

static void refused(const char *from, const char *to, const brio_convert_options *o, const char *words) {
    char path[4096];
    strcpy(path, io_path(from));
    EXPECT(brio_convert(io_ctx, path, io_path(to), o, NULL) == BRIO_ERR_ARGUMENT, "%s", words);
    EXPECT(strstr(brio_message(io_ctx), words), "%s", brio_message(io_ctx));
}

static void each_point_is_in_one_tile(void) {
    uint64_t sum = 0, read = 0;
    put_points("in.csv", 200), put_points("more.csv", 100);
    most_tiles = 0;
    EXPECT(convert_tiles(io_ctx) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(num_seen == 3, "%zu", num_seen);
    for (size_t i = 0; i < num_seen; i++) {
        char name[32];
        snprintf(name, sizeof name, "tile%zu.ply", i);
        brio_mesh *m = read_back(name);
        EXPECT(m->num_vertices == seen[i] && seen[i] > 50 && seen[i] < 80, "%zu points", m->num_vertices);
        sum += seen[i];
        read += m->num_vertices;
        brio_mesh_free(m);
    }
    EXPECT(sum == 200 && read == 200, "%zu: the same places came twice, and were thinned", (size_t)sum);
    most_tiles = 2;
    EXPECT(convert_tiles(io_ctx) == BRIO_ERR_CANCELLED && num_seen == 2);
    const brio_convert_options none = {.size = sizeof none, .tiles = 2}, many = {.size = sizeof many, .tiles = 70000};
    const brio_convert_options merged = {.size = sizeof merged, .tiles = 2, .scratch = "/tmp", .merge = 1};
    const brio_convert_options placed = {.size = sizeof placed, .tiles = 2, .scratch = "/tmp"};
    const brio_convert_options alone = {.size = sizeof alone, .num_more = 1};
    refused("in.csv", "t#.ply", &none, "tiles need a scratch folder");
    refused("in.csv", "t#.ply", &many, "70000 tiles; at most 65536");
    refused("in.csv", "t#.ply", &merged, "not into tiles");
    refused("in.csv", "t.ply", &placed, "files of tiles need a # in their name");
    refused("in.csv", "t.ply", &alone, "several inputs are for tiles");
}

/* Each request for memory is refused: nothing stays but files that are whole. */
static void tiles_without_memory_are_an_error(void) {
    static const char *const patterns[] = {"tile#.ply", "tile#.laz", "tile#.vtp"};
    put_points("in.csv", 40), put_points("more.csv", 10);
    most_tiles = 0;
    for (int form = 0; form < 3; form++) {
        pattern = patterns[form];
        expect_clean_failures(convert_tiles);
    }
    pattern = "tile#.ply";
}

SUITE(test_convert) {
    io_begin();
    RUN(a_file_replaced_between_two_passes_is_an_error);
    RUN(progress_never_runs_backwards);
    RUN(rows_in_a_pipe_are_written_once);
    RUN(a_las_field_of_nan_alone_stays_nan);
    RUN(names_that_are_cut_stay_distinct);
    RUN(names_are_cut_between_characters);
    RUN(an_npy_field_that_is_there_twice_is_refused);
    RUN(each_point_is_in_one_tile);
    RUN(tiles_without_memory_are_an_error);
    return io_end();
}
