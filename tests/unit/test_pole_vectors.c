/* Voronoi vertices: rows that are computed again after the centres were freed have the same bits. */
#include "dual/pole_vectors.h"
#include "harness.h"
#include "points.h"
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 2000 };

static void check_rows(void (*make)(uint64_t, size_t, double *), size_t n) {
    static double p[3 * SAMPLES];
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_pole_vectors v;
    make(1, n, p);
    EXPECT(brio_delaunay(ctx, p, NULL, n, NULL, &t) == BRIO_OK);
    EXPECT(brio_pole_vectors_find(ctx, t, p, n, 0.39, &v) == BRIO_OK);
    size_t count = v.t.count, differ = 0;
    double(*before)[4] = malloc(count * sizeof *before), row[4];
    memcpy(before, v.centre, count * sizeof *before);
    for (size_t tet = 0; tet < count; tet++) {
        brio_centre_row(&v, tet, row);
        differ += memcmp(row, before[tet], sizeof row) != 0;
    }
    size_t bytes = brio_context_memory(ctx);
    brio_pole_vectors_drop(ctx, &v);
    EXPECT(brio_context_memory(ctx) + count * sizeof *before <= bytes);
    for (size_t tet = 0; tet < count; tet++) {
        brio_centre_row(&v, tet, row);
        differ += memcmp(row, before[tet], sizeof row) != 0;
    }
    EXPECT(differ == 0 && count > v.num_finite, "%zu of %zu rows differ", differ, count);
    brio_pole_vectors_free(ctx, &v);
    brio_triangulation_free(t);
    free(before);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void lattice_points(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 9, p);
    for (size_t i = 0; i < 3 * n; i++) p[i] /= 16;
}

static void freed_centres_are_computed_again_with_the_same_bits(void) {
    check_rows(sphere_points, SAMPLES);
    check_rows(clustered_points, SAMPLES);
    check_rows(lattice_points, SAMPLES);
    check_rows(uniform_points, 5);
}

SUITE(test_pole_vectors) {
    RUN(freed_centres_are_computed_again_with_the_same_bits);
    return harness_end();
}
