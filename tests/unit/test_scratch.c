/* Scratch files: the same triangulation, array for array, as in memory. */
#include "harness.h"
#include "points.h"

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

SUITE(test_scratch) {
    RUN(uniform_points_give_the_same_arrays);
    RUN(weighted_lattice_with_duplicates_gives_the_same_arrays);
    RUN(little_memory_gives_the_same_arrays);
    RUN(vertex_of_very_many_tetrahedra_gives_the_same_arrays);
    return harness_end();
}
