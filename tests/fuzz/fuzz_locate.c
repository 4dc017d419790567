/* Queries of a triangulation against brute force: the tetrahedron that holds a position, the nearest vertices, the vertex of
 * least power distance; and values, which reproduce a linear function. Few points on a grid, with queries on the same grid
 * and half of it, so that ties abound; or any finite doubles. */
#include "locate_brute.h"
#include "points_input.h"

enum { MOST = 20, QUERIES = 40, NEAREST = 4 };

typedef struct {
    size_t n, queries;
    bool weighted, plain; /* plain: small integers */
    double points[3 * MOST], weights[MOST], x[3 * QUERIES];
} task;

static void make_task(fuzz_input *in, task *k) {
    uint8_t mode = fuzz_byte(in);
    k->plain = mode & 3, k->weighted = mode & 4;
    k->n = fuzz_below(in, MOST + 1), k->queries = fuzz_below(in, QUERIES + 1);
    for (size_t i = 0; i < 3 * k->n; i++) k->points[i] = k->plain ? (double)(fuzz_byte(in) % 4) : fuzz_double(in);
    for (size_t i = 0; i < k->n; i++) k->weights[i] = k->weighted ? (double)(fuzz_byte(in) % 5) : 0;
    for (size_t i = 0; i < 3 * k->queries; i++) k->x[i] = k->plain ? fuzz_byte(in) % 10 / 2.0 - 0.5 : fuzz_double(in);
}

static void expect_tetrahedra(brio_context *ctx, const task *k, const brio_triangulation *t, const brio_locator *l) {
    uint32_t found[QUERIES];
    FUZZ_EXPECT(brio_locator_tetrahedra(ctx, l, k->x, k->queries, found) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < k->queries; i++) {
        uint32_t right = brute_tetrahedron(k->points, t, k->x + 3 * i);
        FUZZ_EXPECT(found[i] == right, "query %zu got %u, not %u", i, found[i], right);
    }
}

static void expect_nearest(brio_context *ctx, const task *k, const brio_triangulation *t, const brio_locator *l) {
    uint32_t found[NEAREST * QUERIES], power[QUERIES];
    const double *w = k->weighted ? k->weights : NULL;
    FUZZ_EXPECT(brio_locator_nearest(ctx, l, k->x, k->queries, NEAREST, found) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_locator_least_power(ctx, l, k->x, k->queries, power) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < k->queries; i++) {
        const double at[4] = {k->x[3 * i], k->x[3 * i + 1], k->x[3 * i + 2], 0};
        FUZZ_EXPECT((power[i] == BRIO_INFINITE) == (k->n == 0), "query %zu", i);
        if (k->n) FUZZ_EXPECT(number_before(k->points, w, t, at, power[i]) == 0, "query %zu got %u", i, power[i]);
        for (size_t j = 0; j < NEAREST; j++) {
            uint32_t v = found[NEAREST * i + j];
            FUZZ_EXPECT((v == BRIO_INFINITE) == (j >= brio_triangulation_stats(t)->vertices), "query %zu", i);
            if (v != BRIO_INFINITE) FUZZ_EXPECT(number_before(k->points, NULL, t, at, v) == j, "query %zu, %zu", i, j);
        }
    }
}

static double linear(const double *x) {
    return 2 * x[0] - 3 * x[1] + 0.5 * x[2] + 1;
}

static void expect_values(brio_context *ctx, const task *k, const brio_locator *l, brio_interpolation_method method,
                          int dimension) {
    double values[MOST], results[QUERIES];
    uint32_t found[QUERIES];
    brio_interpolation o = {0};
    for (size_t i = 0; i < k->n; i++) values[i] = linear(k->points + 3 * i);
    o.method = method, o.values = values;
    brio_status status = brio_locator_interpolate(ctx, l, k->x, k->queries, &o, results);
    bool refused = method == BRIO_INTERPOLATION_NATURAL && k->weighted;
    if (refused || dimension > 0) /* a single position has no values between, with points or without */
        FUZZ_EXPECT(status == (refused ? BRIO_ERR_ARGUMENT : BRIO_OK), "%s", brio_message(ctx));
    else
        FUZZ_EXPECT(status == BRIO_ERR_NO_ANSWER || status == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_locator_tetrahedra(ctx, l, k->x, k->queries, found) == BRIO_OK);
    for (size_t i = 0; status == BRIO_OK && i < k->queries; i++) {
        FUZZ_EXPECT(dimension < 3 || isnan(results[i]) == (found[i] == BRIO_INFINITE), "query %zu: %g", i, results[i]);
        if (found[i] != BRIO_INFINITE)
            FUZZ_EXPECT(fabs(results[i] - linear(k->x + 3 * i)) < 1e-9, "query %zu: %g", i, results[i]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    task k;
    brio_triangulation *t;
    brio_locator *l;
    make_task(&in, &k);
    const double *w = k.weighted ? k.weights : NULL;
    FUZZ_EXPECT(brio_delaunay(ctx, k.points, w, k.n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_locator_new(ctx, t, k.points, w, k.n, &l) == BRIO_OK, "%s", brio_message(ctx));
    expect_tetrahedra(ctx, &k, t, l);
    expect_nearest(ctx, &k, t, l);
    for (int method = 0; k.plain && method < BRIO_INTERPOLATION_END; method++)
        expect_values(ctx, &k, l, (brio_interpolation_method)method, brio_triangulation_stats(t)->dimension);
    brio_locator_free(l);
    brio_triangulation_free(t);
    fuzz_end();
    return 0;
}
