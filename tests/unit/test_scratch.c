/* Scratch files: the same triangulation, array for array, as in memory. */
#include "harness.h"
#include "points.h"

static brio_triangulation *triangulate(brio_context *ctx, const double *p, const double *w, size_t n) {
    brio_triangulation *t = NULL;
    EXPECT(brio_delaunay(ctx, p, w, n, NULL, &t) == BRIO_OK);
    return t;
}

static void expect_same(const double *p, const double *w, size_t n, int threads) {
    brio_context *memory, *scratch;
    brio_context_new(NULL, &memory);
    brio_context_new(NULL, &scratch);
    brio_context_set_threads(memory, 1);
    brio_context_set_threads(scratch, threads);
    EXPECT(brio_context_set_scratch(scratch, ".") == BRIO_OK);
    brio_triangulation *a = triangulate(memory, p, w, n), *b = triangulate(scratch, p, w, n);
    const brio_stats *sa = brio_triangulation_stats(a), *sb = brio_triangulation_stats(b);
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
    enum { N = 60000 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(3, N, p);
    for (int threads = 1; threads <= 2; threads++) expect_same(p, NULL, N, threads);
    free(p);
}

static void weighted_lattice_with_duplicates_gives_the_same_arrays(void) {
    enum { N = 40000 };
    double *p = malloc(3 * N * sizeof *p), *w = malloc(N * sizeof *w);
    integer_points(4, N, 40, p);
    integer_weights(4, N, 3, w);
    expect_same(p, w, N, 1);
    free(p);
    free(w);
}

int main(void) {
    RUN(uniform_points_give_the_same_arrays);
    RUN(weighted_lattice_with_duplicates_gives_the_same_arrays);
    return harness_end();
}
