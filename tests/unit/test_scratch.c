/* Scratch files: the same triangulation, array for array, as in memory. */
#include "base/memory.h"
#include "base/team.h"
#include "harness.h"
#include "platform/disk.h"
#include "points.h"
#ifdef __linux__
#include <sys/resource.h>
#endif

typedef struct {
    const double *points, *weights;
    size_t n;
    brio_order order;
} input;

static brio_triangulation *triangulate(brio_context *ctx, const input *in) {
    brio_triangulation *t = NULL;
    brio_delaunay_options options = {0};
    options.order = in->order;
    EXPECT(brio_delaunay(ctx, in->points, in->weights, in->n, &options, &t) == BRIO_OK);
    return t;
}

/* limit: bytes of memory beside the scratch files, 0 for as much as there is. */
static void expect_same(const input *in, int threads, size_t limit) {
    brio_context *memory, *scratch;
    size_t n = in->n;
    brio_context_new(NULL, &memory);
    brio_context_new(NULL, &scratch);
    brio_context_set_threads(memory, 1);
    brio_context_set_threads(scratch, threads);
    EXPECT(brio_context_set_scratch(scratch, ".") == BRIO_OK);
    brio_context_set_memory_limit(scratch, limit);
    brio_triangulation *a = triangulate(memory, in), *b = triangulate(scratch, in);
    const brio_delaunay_stats *sa = brio_triangulation_stats(a), *sb = brio_triangulation_stats(b);
    size_t count = sa->tetrahedra + sa->hull_facets;
    EXPECT(sa->tetrahedra == sb->tetrahedra && sa->hull_facets == sb->hull_facets && sa->hidden == sb->hidden);
    EXPECT(
        !memcmp(brio_triangulation_tetrahedra(a), brio_triangulation_tetrahedra(b), count * sizeof(brio_tetrahedron)));
    EXPECT(!memcmp(brio_triangulation_representatives(a), brio_triangulation_representatives(b), n * sizeof(uint32_t)));
    EXPECT(brio_context_memory(scratch) < brio_context_memory(memory) / 4);
    brio_triangulation_free(a);
    brio_triangulation_free(b);
    brio_context_free(memory);
    brio_context_free(scratch);
}

static void uniform_points_give_the_same_arrays(void) {
    enum { N = BRIEF_TESTS ? 30000 : 60000 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(3, N, p);
    for (int threads = 1; threads <= 2; threads++) expect_same(&(input){p, NULL, N, BRIO_ORDER_BRIO}, threads, 0);
    free(p);
}

static void weighted_lattice_with_duplicates_gives_the_same_arrays(void) {
    enum { N = 40000 };
    double *p = malloc(3 * N * sizeof *p), *w = malloc(N * sizeof *w);
    integer_points(4, N, 40, p);
    integer_weights(4, N, 3, w);
    expect_same(&(input){p, w, N, BRIO_ORDER_BRIO}, 1, 0);
    free(p);
    free(w);
}

/* Many partitions, each of several chunks, and what is left of each. */
static void little_memory_gives_the_same_arrays(void) {
    enum { N = 80000 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(5, N, p);
    expect_same(&(input){p, NULL, N, BRIO_ORDER_BRIO}, 1, 6 << 20);
    free(p);
}

/* The centre of a sphere comes last: its tetrahedra are one partition, which is larger than the memory. */
static void vertex_of_very_many_tetrahedra_gives_the_same_arrays(void) {
    enum { N = 20000 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(6, N, p);
    for (size_t i = 0; i < N; i++) {
        double *q = p + 3 * i, length = 0;
        for (int c = 0; c < 3; c++) length += (q[c] - 0.5) * (q[c] - 0.5);
        for (int c = 0; c < 3; c++) q[c] = i + 1 < N ? 0.5 + (q[c] - 0.5) / sqrt(length) : 0.5;
    }
    expect_same(&(input){p, NULL, N, BRIO_ORDER_INPUT}, 1, 0);
    expect_same(&(input){p, NULL, N, BRIO_ORDER_INPUT}, 1, 4 << 20);
    free(p);
}

/* --- loops along arrays --- */

/* PAGES: of an array of ROWS rows of two numbers. */
enum { ROWS = 1 << 19, PAGES = ROWS * 16 / 4096 };

typedef struct {
    uint64_t (*from)[2], (*to)[2];
    uint8_t *times; /* ROWS: how often the loop came by */
} copying;

static void copy_rows(void *user, size_t begin, size_t end, int thread) {
    const copying *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        c->to[i][0] = c->from[i][0], c->to[i][1] = c->from[i][1];
        c->times[i]++;
    }
}

static long faults(void) {
#ifdef __linux__
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_majflt : 0;
#else
    return 0;
#endif
}

/* Copies rows in scratch files to new ones. Returns how many page faults had to fetch a page. */
static long copy_all(brio_context *ctx, bool sweeps) {
    copying c = {.times = calloc(ROWS, 1)};
    size_t wrong = 0;
    EXPECT(BRIO_ALLOC(ctx, c.from, ROWS) == BRIO_OK && BRIO_ALLOC(ctx, c.to, ROWS) == BRIO_OK);
    for (size_t i = 0; i < ROWS; i++) c.from[i][0] = 3 * i, c.from[i][1] = ~i;
    int threads = brio_threads(ctx, ROWS, 1);
    long before = faults();
    if (sweeps)
        EXPECT(brio_sweep(ctx, threads, ROWS, copy_rows, &c, BRIO_READS(c.from), BRIO_WRITES(c.to)) == BRIO_OK);
    else
        EXPECT(brio_for(ctx, threads, ROWS, copy_rows, &c) == BRIO_OK);
    long taken = faults() - before;
    for (size_t i = 0; i < ROWS; i++) wrong += c.times[i] != 1 || c.to[i][0] != 3 * i || c.to[i][1] != ~i;
    EXPECT(wrong == 0, "%zu rows", wrong);
    brio_release(ctx, c.from);
    brio_release(ctx, c.to);
    free(c.times);
    return taken;
}

/* A loop that says which arrays it goes along finds its pages there: at most one page in eight is fetched by a fault. So
 * does any loop along rows where the disk's window is small: pages that are missing come with those about them. */
static void a_sweep_waits_for_few_pages(void) {
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    for (int threads = 1; threads <= 3; threads++) {
        brio_context_set_threads(ctx, threads);
        EXPECT(brio_context_set_scratch(ctx, NULL) == BRIO_OK);
        copy_all(ctx, true);
        EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
        long without = copy_all(ctx, false), with = copy_all(ctx, true);
        EXPECT(with <= PAGES / 8, "%ld of %d", with, PAGES);
        EXPECT(!ctx->scratch_in_runs || without <= PAGES / 8, "%ld of %d", without, PAGES);
    }
    size_t window = brio_read_around(".");
    EXPECT(ctx->scratch_in_runs == (window > 0 && window <= 1 << 17), "a window of %zu bytes", window);
    brio_context_set_memory_limit(ctx, 1 << 20);
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK && ctx->scratch_in_runs == (window > 0 && window <= 1 << 14));
    brio_context_set_memory_limit(ctx, 0);
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    if (!ctx->scratch_in_runs) printf("skipped: pages in runs, since this disk's window is unknown or large\n");
    brio_context_free(ctx);
}

/* --- little memory --- */

/* Blocks of less than a mebibyte were memory, which no file gives back: a few of them filled a small limit. */
static void blocks_below_a_mebibyte_filled_a_small_limit(void) {
    enum { BLOCKS = 16, BYTES = 900 << 10 };
    unsigned char *block[BLOCKS] = {NULL};
    brio_context *ctx;
    brio_context_new(NULL, &ctx);
    brio_context_set_memory_limit(ctx, 6 << 20);
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    for (int i = 0; i < BLOCKS; i++) {
        EXPECT(BRIO_ALLOC(ctx, block[i], 1000) == BRIO_OK && BRIO_RESIZE(ctx, block[i], BYTES) == BRIO_OK, "%s",
               brio_message(ctx));
        if (block[i]) memset(block[i], i, BYTES);
    }
    EXPECT(brio_context_memory(ctx) < BYTES, "%zu bytes", brio_context_memory(ctx));
    for (int i = 0; i < BLOCKS; i++) {
        EXPECT(block[i] && BRIO_RESIZE(ctx, block[i], 1000) == BRIO_OK && block[i][999] == i);
        brio_release(ctx, block[i]);
    }
    brio_context_free(ctx);
}

SUITE(test_scratch) {
    RUN(blocks_below_a_mebibyte_filled_a_small_limit);
    RUN(a_sweep_waits_for_few_pages);
    RUN(uniform_points_give_the_same_arrays);
    RUN(weighted_lattice_with_duplicates_gives_the_same_arrays);
    RUN(little_memory_gives_the_same_arrays);
    RUN(vertex_of_very_many_tetrahedra_gives_the_same_arrays);
    return harness_end();
}
