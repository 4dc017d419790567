/* Files that fail at every point: each request for memory is refused, the caller cancels at each report of progress, the disk
 * is full behind each byte; in reading and converting the samples of corpus.h, in writing their meshes, cells and
 * filtrations. Each failure is its status, nothing stays, and the old file stays. Builds with small blocks (io/blocks.h) have
 * a point between any two parts of a file. */
#include "corpus.h"
#include "failing_allocator.h"
#include "io/blocks.h"
#include "io_files.h"
#include <sys/resource.h>

static const char *const targets[] = {"t.ply", "t.xyz",  "t.csv", "t.obj", "t.off", "t.vtu",
                                      "t.vtp", "t.node", "t.las", "t.stl", "t.npy", "t.glb"};

enum { TARGETS = sizeof targets / sizeof *targets };

typedef brio_status (*work_fn)(brio_context *ctx);

static const char *sample, *target; /* names of files in the folder */
static const brio_mesh *mesh;
static const brio_cells *cells;
static brio_alpha_complex complex_of_points = {0};
static uint32_t order[64];
static int way;          /* of writing, cells_formats, filtrations */
static char comment[64]; /* its length moves what is behind it over the blocks */
static const char old[] = "an old file";

/* --- what fails --- */

static int cancel_when_due(const char *stage, double fraction, void *user) {
    size_t *left = user;
    (void)stage;
    (void)fraction;
    return *left > 0 && --*left == 0;
}

static void expect_cancelled_at_every_report(work_fn work) {
    bool cancelled = true;
    for (size_t k = 1; k < 3000 && cancelled; k += BRIEF_TESTS ? 19 : SHORT_TESTS ? 3 : 1) {
        size_t left = k;
        brio_context *ctx;
        EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
        brio_context_set_threads(ctx, 1);
        brio_context_set_progress(ctx, cancel_when_due, &left);
        brio_status status = work(ctx);
        cancelled = left == 0;
        EXPECT(status == (cancelled ? BRIO_ERR_CANCELLED : BRIO_OK), "%s to %s, report %zu: %s", sample, target, k,
               brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == 0, "%s to %s, report %zu", sample, target, k);
        brio_context_free(ctx);
    }
}

static void limit_files(rlim_t bytes) {
    struct rlimit limit;
    EXPECT(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
    EXPECT(setrlimit(RLIMIT_FSIZE, &limit) == 0);
}

/* Whether the target is as long as it was. */
static bool is_old(void) {
    struct stat facts;
    return stat(io_path(target), &facts) == 0 && facts.st_size == sizeof old - 1;
}

static void expect_full_disk_at_every_byte(work_fn work) {
    enum { PLACES = BRIO_IO_BLOCK < 4096 ? 80 : 3 /* the buffer is written once */, SHIFTS = 61 };
    struct stat facts;
    memset(comment, 0, sizeof comment);
    EXPECT(work(io_ctx) == BRIO_OK && stat(io_path(target), &facts) == 0, "%s: %s", target, brio_message(io_ctx));
    io_put(target, old, sizeof old - 1);
    size_t size = (size_t)facts.st_size, step = size / PLACES + 1;
    for (size_t n = 0; n < size; n += step) {
        memset(comment, '.', n / step % SHIFTS);
        comment[n / step % SHIFTS] = 0;
        limit_files((rlim_t)n);
        brio_status status = work(io_ctx);
        limit_files(RLIM_INFINITY);
        EXPECT(status == BRIO_ERR_WRITE, "%s to %s, %zu of %zu bytes: %d, %s", sample, target, n, size, (int)status,
               brio_message(io_ctx));
        EXPECT(is_old(), "%s, %zu of %zu bytes", target, n, size);
    }
    comment[0] = 0;
}

/* --- work --- */

static brio_status read_sample(brio_context *ctx) {
    brio_mesh *m = NULL;
    brio_status status = brio_read(ctx, io_path(sample), NULL, &m);
    brio_mesh_free(m);
    return status;
}

static brio_write_options options_of_way(void) {
    brio_write_options o = {0};
    o.ascii = way & 1;
    o.compress = way >> 1 & 1;
    o.neighbours = o.faces = o.edges = way & 1;
    o.comment = comment;
    return o;
}

static brio_status write_mesh(brio_context *ctx) {
    brio_write_options o = options_of_way();
    return brio_write(ctx, io_path(target), mesh, &o);
}

static brio_status convert_sample(brio_context *ctx) {
    brio_convert_options o = {0};
    brio_write_options to = options_of_way();
    o.to = &to;
    o.crop = way & 1;
    for (int k = 0; k < 3; k++) o.box[k] = -100, o.box[k + 3] = 0.75;
    o.drop_outliers = way & 2;
    o.thin = way & 4 ? 0.1 : 0;
    return brio_convert(ctx, io_path(sample), io_path(target), &o, NULL);
}

static brio_status write_cells(brio_context *ctx) {
    return brio_cells_write(ctx, io_path(target), cells, (brio_cells_format)way, comment);
}

static brio_status write_filtration(brio_context *ctx) {
    return brio_write_filtration(ctx, io_path(target), &complex_of_points, order, (brio_filtration_format)way);
}

/* All faults in work that succeeds without one. */
static void expect_every_point(work_fn work, bool writes) {
    if (writes) expect_full_disk_at_every_byte(work);
    expect_clean_failures(work);
    expect_cancelled_at_every_report(work);
}

/* --- samples --- */

static void (*test_of_sample)(void);
static size_t taken;

/* Puts a file into the folder, and tests it if this build can read it. */
static void take_sample(const char *file, const char *name, const char *bytes, size_t size) {
    char copy[32];
    (void)file;
    snprintf(copy, sizeof copy, "%s", name);
    sample = copy;
    io_empty_folder();
    io_put(sample, bytes, size);
    if (read_sample(io_ctx) == BRIO_OK) test_of_sample(), taken++;
}

static void for_each_sample(void (*test)(void)) {
    test_of_sample = test;
    taken = 0;
    corpus_each(BRIO_CORPUS, take_sample);
    EXPECT(taken > 20, "%zu samples", taken);
}

static void read_it(void) {
    expect_every_point(read_sample, false);
}

static void write_it(void) {
    brio_mesh *m = NULL;
    EXPECT(brio_read(io_ctx, io_path(sample), NULL, &m) == BRIO_OK);
    mesh = m;
    for (size_t i = 0; m && i < TARGETS; i++)
        for (way = 0; way < 3; way++) {
            target = targets[i];
            if (BRIEF_TESTS && (taken + i + (size_t)way) % 2) continue; /* the next sample takes it */
            if (write_mesh(io_ctx) == BRIO_OK) expect_every_point(write_mesh, true);
        }
    brio_mesh_free(m);
}

static void convert_it(void) {
    static const char *const kinds[] = {"t.ply", "t.xyz", "t.las", "t.npy", "t.vtu"};
    for (way = 0; way < 8; way++) {
        target = kinds[(size_t)way % (sizeof kinds / sizeof *kinds)];
        if (convert_sample(io_ctx) == BRIO_OK) expect_every_point(convert_sample, true);
    }
}

/* --- tests --- */

static void reading_fails_cleanly(void) {
    for_each_sample(read_it);
}

static void writing_fails_cleanly(void) {
    for_each_sample(write_it);
}

static void converting_fails_cleanly(void) {
    for_each_sample(convert_it);
}

static void writing_cells_and_filtrations_fails_cleanly(void) {
    static const char *const names[] = {NULL, "t.vtu", "t.npy", "t.csv", "t.txt"};
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.25, 0.5, 0.25};
    brio_cells *c = NULL;
    brio_triangulation *t = NULL;
    brio_cells_options o = {0};
    const double box[] = {-1, -1, -1, 2, 2, 2};
    o.box = box;
    o.vertices = 1;
    EXPECT(brio_voronoi_cells(io_ctx, NULL, points, NULL, 5, &o, &c) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_delaunay(io_ctx, points, NULL, 5, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(io_ctx, t, points, NULL, 5, &complex_of_points) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_alpha_order(io_ctx, &complex_of_points, order) == BRIO_OK);
    cells = c;
    sample = "cells";
    for (way = BRIO_CELLS_FORMAT_VTU; way < BRIO_CELLS_FORMAT_END; way++) {
        target = names[way];
        expect_every_point(write_cells, true);
    }
    sample = "filtration";
    for (way = 0; way < BRIO_FILTRATION_END; way++) expect_every_point(write_filtration, true);
    brio_alpha_complex_free(&complex_of_points);
    brio_triangulation_free(t);
    brio_cells_free(c);
}

SUITE(test_io_every_point) {
    /* thousands of files are flushed, which disks take long for */
    if (access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    io_begin();
    RUN(reading_fails_cleanly);
    RUN(writing_fails_cleanly);
    RUN(converting_fails_cleanly);
    RUN(writing_cells_and_filtrations_fails_cleanly);
    return io_end();
}
