/* Queries of a triangulation of the plane against brute force: the triangle that holds a position, the vertex of least power
 * distance; and values, which reproduce a linear function. Few points on a grid, with queries on the same grid and half of
 * it, so that ties abound; or any finite doubles. */
#include "plane_input.h"
#include "plane_locate_brute.h"

enum { MOST = 20, QUERIES = 40 };

typedef struct {
    size_t n, queries;
    bool plain; /* small integers */
    const double *w;
    double points[2 * MOST], weights[MOST], x[2 * QUERIES];
} task;

static void make_task(fuzz_input *in, task *k) {
    uint8_t mode = fuzz_byte(in);
    plane_set s;
    k->plain = mode & 48;
    k->w = mode & 2 ? k->weights : NULL;
    fuzz_plane_sites(in, mode, MOST, &s);
    plane_sites_as_doubles(&s, k->points, k->weights);
    k->n = s.n, k->queries = fuzz_below(in, QUERIES + 1);
    double step = mode & 1 ? 8 : 0.5;
    for (size_t i = 0; i < 2 * k->n && !k->plain; i++) k->points[i] = fuzz_double(in);
    for (size_t i = 0; i < k->n && !k->plain && k->w; i++) k->weights[i] = fuzz_double(in);
    for (size_t i = 0; i < 2 * k->queries; i++) k->x[i] = k->plain ? step * (fuzz_byte(in) % 10 - 1) : fuzz_double(in);
}

static void expect_triangles(brio_context *ctx, const task *k, const brio_triangulation2 *t, const brio_locator2 *l) {
    uint32_t found[QUERIES];
    FUZZ_EXPECT(brio_locator2_triangles(ctx, l, k->x, k->queries, found) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < k->queries; i++) {
        uint32_t right = brute_triangle(k->points, t, k->x + 2 * i);
        FUZZ_EXPECT(found[i] == right, "query %zu got %u, not %u", i, found[i], right);
    }
}

static void expect_least_power(brio_context *ctx, const task *k, const brio_triangulation2 *t, const brio_locator2 *l) {
    uint32_t found[QUERIES];
    const uint32_t *representative = brio_triangulation2_representatives(t);
    FUZZ_EXPECT(brio_locator2_least_power(ctx, l, k->x, k->queries, found) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < k->queries; i++) {
        FUZZ_EXPECT((found[i] == BRIO_INFINITE) == (k->n == 0), "query %zu", i);
        if (!k->n) continue;
        FUZZ_EXPECT(found[i] < k->n && representative[found[i]] == found[i], "query %zu got %u", i, found[i]);
        for (size_t p = 0; p < k->n; p++)
            FUZZ_EXPECT(representative[p] != p || !plane_comes_before(k->points, k->w, k->x + 2 * i, p, found[i]),
                        "query %zu got %u, not %zu", i, found[i], p);
    }
}

static double linear(const double *x) {
    return 2 * x[0] - 3 * x[1] + 1;
}

static void expect_values(brio_context *ctx, const task *k, const brio_locator2 *l, brio_interpolation_method method,
                          int dimension) {
    double values[2 * MOST], results[2 * QUERIES];
    uint32_t found[QUERIES];
    brio_interpolation o = {0};
    for (size_t i = 0; i < k->n; i++) values[2 * i] = linear(k->points + 2 * i), values[2 * i + 1] = 1;
    o.method = method, o.values = values, o.components = 2;
    brio_status status = brio_locator2_interpolate(ctx, l, k->x, k->queries, &o, results);
    bool refused = method == BRIO_INTERPOLATION_NATURAL && k->w;
    if (refused || dimension > 0) /* a single position has no values between, with points or without */
        FUZZ_EXPECT(status == (refused ? BRIO_ERR_ARGUMENT : BRIO_OK), "%s", brio_message(ctx));
    else
        FUZZ_EXPECT(status == BRIO_ERR_NO_ANSWER || status == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_locator2_triangles(ctx, l, k->x, k->queries, found) == BRIO_OK);
    for (size_t i = 0; status == BRIO_OK && i < k->queries; i++) {
        const double *r = results + 2 * i;
        FUZZ_EXPECT(!k->plain || dimension < 2 || isnan(r[0]) == (found[i] == BRIO_INFINITE), "query %zu: %g", i, r[0]);
        if (k->plain && found[i] != BRIO_INFINITE)
            FUZZ_EXPECT(fabs(r[0] - linear(k->x + 2 * i)) < 1e-9 && fabs(r[1] - 1) < 1e-12, "query %zu: %g %g", i, r[0],
                        r[1]);
    }
}

/* A locator of another point set is refused. */
static void expect_refusal(brio_context *ctx, task *k, const brio_triangulation2 *t) {
    brio_locator2 *l;
    if (!k->n) return;
    double x = k->points[0];
    k->points[0] = x == 7 ? 8 : 7;
    brio_status status = brio_locator2_new(ctx, t, k->points, k->w, k->n, &l);
    FUZZ_EXPECT(status == BRIO_ERR_ARGUMENT && !l, "status %d", (int)status);
    k->points[0] = x;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    task k;
    brio_triangulation2 *t;
    brio_locator2 *l;
    make_task(&in, &k);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 200 ? 1 : 3);
    FUZZ_EXPECT(brio_delaunay2(ctx, k.points, k.w, k.n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_locator2_new(ctx, t, k.points, k.w, k.n, &l) == BRIO_OK, "%s", brio_message(ctx));
    expect_triangles(ctx, &k, t, l);
    expect_least_power(ctx, &k, t, l);
    for (int method = 0; method < BRIO_INTERPOLATION_END; method++)
        expect_values(ctx, &k, l, (brio_interpolation_method)method, brio_triangulation2_stats(t)->dimension);
    expect_refusal(ctx, &k, t);
    brio_locator2_free(l);
    brio_triangulation2_free(t);
    fuzz_end();
    return 0;
}
