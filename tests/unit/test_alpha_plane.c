/* Alpha complexes of points in the plane against brute force: Gabriel by dyadic numbers over all points, values by long
 * doubles, the least alpha of one region by flooding; lists that are complete, flat points in space, hostile inputs. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "predicates/predicates.h"

enum { N = 90 };

typedef struct {
    double p[3 * N], w[N], record[N][4];
    bool weighted, flat; /* flat: points in space with one z */
    brio_context *ctx;
    brio_triangulation2 *t;
    brio_alpha_complex c;
} set;

static void make(set *s, int kind, uint64_t seed) {
    double space[3 * N];
    s->ctx = new_context();
    s->weighted = kind & 1;
    s->flat = kind & 2;
    if (kind & 4)
        integer_points(seed, N, 7, space);
    else
        uniform_points(seed, N, space);
    integer_weights(seed, N, 3, s->w);
    for (size_t i = 0; i < N; i++) {
        size_t d = s->flat ? 3 : 2;
        if (!(kind & 4)) s->w[i] *= 0.01;
        double own[4] = {space[3 * i], space[3 * i + 1], s->flat ? 5 : 0, s->weighted ? s->w[i] : 0};
        memcpy(s->record[i], own, sizeof own);
        memcpy(s->p + d * i, own, d * sizeof *own);
    }
}

static void build(set *s) {
    const double *w = s->weighted ? s->w : NULL;
    s->c = (brio_alpha_complex){.size = sizeof s->c};
    EXPECT((s->flat ? brio_delaunay2_flat : brio_delaunay2)(s->ctx, s->p, w, N, NULL, &s->t) == BRIO_OK);
    EXPECT(brio_alpha_values2(s->ctx, s->t, s->p, w, N, &s->c) == BRIO_OK, "%s", brio_message(s->ctx));
}

static void drop(set *s) {
    brio_alpha_complex_free(&s->c);
    brio_triangulation2_free(s->t);
    EXPECT(brio_context_memory(s->ctx) == 0);
    brio_context_free(s->ctx);
}

/* The squared radius of the circle of three weighted points, in long doubles. */
static long double circle(const set *s, const uint32_t *v) {
    const double *a = s->record[v[0]], *b = s->record[v[1]], *c = s->record[v[2]];
    long double ux = (long double)b[0] - a[0], uy = (long double)b[1] - a[1];
    long double vx = (long double)c[0] - a[0], vy = (long double)c[1] - a[1], det = 2 * (ux * vy - uy * vx);
    long double p = ux * ux + uy * uy - b[3] + a[3], q = vx * vx + vy * vy - c[3] + a[3];
    long double x = (p * vy - q * uy) / det, y = (q * ux - p * vx) / det;
    return x * x + y * y - a[3];
}

static long double smallest_circle(const set *s, const uint32_t *v) {
    const double *a = s->record[v[0]], *b = s->record[v[1]];
    long double ux = (long double)b[0] - a[0], uy = (long double)b[1] - a[1], square = ux * ux + uy * uy;
    long double p = square - b[3] + a[3];
    return p * p / (4 * square) - a[3];
}

static bool contains(const uint32_t *v, const uint32_t *face, int count) {
    for (int i = 0; i < count; i++)
        if (v[0] != face[i] && v[1] != face[i] && v[2] != face[i]) return false;
    return true;
}

static bool no_vertex_inside(const set *s, const uint32_t *edge) {
    for (size_t n = 0; n < s->c.counts[0]; n++) {
        uint32_t other = s->c.simplices[0][n];
        const double *p[3] = {s->record[edge[0]], s->record[edge[1]], s->record[other]};
        if (other != edge[0] && other != edge[1] && brio_attached_dyadic(p, 2, s->weighted)) return false;
    }
    return true;
}

static bool near(double value, long double wanted) {
    return fabsl(value - wanted) <= 1e-12L * (fabsl(wanted) + 1);
}

static void check_edge(const set *s, size_t n) {
    const uint32_t *v = s->c.simplices[1] + 2 * n;
    double least = INFINITY;
    for (size_t t = 0; t < s->c.counts[2]; t++)
        if (contains(s->c.simplices[2] + 3 * t, v, 2)) least = fmin(least, s->c.values[2][t]);
    bool gabriel = no_vertex_inside(s, v);
    EXPECT(v[0] < v[1] && s->c.gabriel[1][n] == gabriel && s->c.solid[1][n] == least, "edge %zu", n);
    EXPECT(gabriel ? near(s->c.values[1][n], smallest_circle(s, v)) : s->c.values[1][n] == least, "edge %zu", n);
    EXPECT(s->c.values[1][n] <= least, "edge %zu", n);
}

static void check_vertex(const set *s, size_t n) {
    uint32_t v = s->c.simplices[0][n];
    double least = INFINITY, solid = INFINITY;
    bool gabriel = true;
    for (size_t k = 0; k < s->c.counts[1]; k++) {
        const uint32_t *e = s->c.simplices[1] + 2 * k;
        if (e[0] != v && e[1] != v) continue;
        const double *a = s->record[v], *b = s->record[e[0] == v ? e[1] : e[0]];
        least = fmin(least, s->c.values[1][k]);
        solid = fmin(solid, s->c.solid[1][k]);
        gabriel = gabriel && !(s->weighted && brio_power_compare(a, b, a) < 0);
    }
    EXPECT(s->c.gabriel[0][n] == gabriel && s->c.solid[0][n] == solid, "vertex %u", v);
    EXPECT(s->c.values[0][n] == (gabriel ? fmin(least, 0 - s->record[v][3]) : least), "vertex %u", v);
}

static void values_against_brute_force(void) {
    for (int kind = 0; kind < 8; kind++) {
        set s;
        make(&s, kind, (uint64_t)kind + 1);
        build(&s);
        const brio_delaunay2_stats *stats = brio_triangulation2_stats(s.t);
        EXPECT(s.c.counts[0] == stats->vertices && s.c.counts[2] == stats->triangles && s.c.counts[3] == 0);
        EXPECT(s.c.counts[0] + s.c.counts[2] == s.c.counts[1] + 1, "kind %d: not a disk", kind);
        for (size_t t = 0; t < s.c.counts[2]; t++)
            EXPECT(near(s.c.values[2][t], circle(&s, s.c.simplices[2] + 3 * t)) && s.c.gabriel[2][t], "kind %d", kind);
        for (size_t n = 0; n < s.c.counts[1]; n++) check_edge(&s, n);
        for (size_t n = 0; n < s.c.counts[0]; n++) check_vertex(&s, n);
        drop(&s);
    }
}

/* Whether the triangles of at most alpha are one region with all vertices, by flooding across edges. */
static bool is_one_region(const set *s, double alpha) {
    bool in[2 * N] = {false}, met[N] = {false};
    size_t reached = 0, inside = 0, vertices = 0, t = 0;
    const brio_triangle *triangle = brio_triangulation2_triangles(s->t);
    for (size_t k = 0; k < s->c.counts[2]; k++) inside += s->c.values[2][k] <= alpha;
    while (t < s->c.counts[2] && s->c.values[2][t] > alpha) t++;
    if (t == s->c.counts[2]) return false;
    in[t] = true;
    for (bool grows = true; grows;) {
        grows = false;
        for (size_t k = 0; k < s->c.counts[2]; k++)
            for (int i = 0; i < 3 && !in[k] && s->c.values[2][k] <= alpha; i++) {
                size_t other = triangle[k].mate[i] >> 2;
                in[k] = other < s->c.counts[2] && in[other];
                grows |= in[k];
            }
    }
    for (size_t k = 0; k < s->c.counts[2]; k++) {
        reached += in[k];
        for (int i = 0; i < 3 && in[k]; i++) met[triangle[k].vertex[i]] = true;
    }
    for (size_t v = 0; v < N; v++) vertices += met[v];
    return reached == inside && vertices == s->c.counts[0];
}

static void least_alpha_of_one_region(void) {
    for (int kind = 0; kind < 8; kind++) {
        set s;
        double alpha = -1;
        make(&s, kind, (uint64_t)kind + 20);
        build(&s);
        EXPECT(brio_alpha_auto(s.ctx, &s.c, &alpha) == BRIO_OK && is_one_region(&s, alpha), "kind %d", kind);
        for (size_t t = 0; t < s.c.counts[2]; t++)
            EXPECT(s.c.values[2][t] >= alpha || !is_one_region(&s, s.c.values[2][t]), "kind %d", kind);
        drop(&s);
    }
}

/* Values that became infinite or 0 were equal: the least alpha had another region than at other scales. */
static void the_least_alpha_is_the_same_at_every_scale_or_refused(void) {
    static const int exponents[] = {0, -1000, -560, -530, -515, -505, 505, 509, 520, 560, 900};
    double usual = 0, alpha = -1;
    for (int k = 0; k < 11; k++) {
        set s;
        make(&s, 0, 20);
        for (size_t i = 0; i < 2 * (size_t)N; i++) s.p[i] = ldexp(s.p[i], exponents[k]);
        build(&s);
        brio_status status = brio_alpha_auto(s.ctx, &s.c, &alpha);
        bool fits = abs(exponents[k]) < 510;
        EXPECT(status == (fits ? BRIO_OK : BRIO_ERR_NO_ANSWER), "2^%d", exponents[k]);
        if (!k) usual = alpha;
        if (fits) EXPECT(alpha == ldexp(usual, 2 * exponents[k]), "2^%d: %g", exponents[k], alpha);
        drop(&s);
    }
}

static void faces_enter_before_triangles(void) {
    set s;
    uint32_t order[8 * N];
    make(&s, 0, 3);
    build(&s);
    size_t total = s.c.counts[0] + s.c.counts[1] + s.c.counts[2];
    EXPECT(brio_alpha_order(s.ctx, &s.c, order) == BRIO_OK && order[0] < s.c.counts[0]);
    for (size_t n = 1; n < total; n++) EXPECT(s.c.values[0][order[n - 1]] <= s.c.values[0][order[n]], "place %zu", n);
    drop(&s);
}

static void hostile_inputs(void) {
    set s;
    brio_mesh *mesh = NULL;
    make(&s, 0, 4);
    build(&s);
    brio_alpha_complex other = {0};
    EXPECT(brio_alpha_values2(s.ctx, s.t, s.p, NULL, N - 1, &other) == BRIO_ERR_ARGUMENT && !other.values[0]);
    EXPECT(brio_alpha_values2(s.ctx, s.t, s.p, NULL, N, &(brio_alpha_complex){.size = 3}) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_alpha_shape(s.ctx, s.p, &s.c, 1, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    s.p[7] = NAN;
    EXPECT(brio_alpha_values2(s.ctx, s.t, s.p, NULL, N, &other) == BRIO_ERR_NOT_FINITE);
    EXPECT(strstr(brio_message(s.ctx), "point 3"), "%s", brio_message(s.ctx));
    brio_triangulation2_free(s.t);
    for (size_t i = 0; i < N; i++) s.p[2 * i] = s.p[2 * i + 1] = (double)i;
    EXPECT(brio_delaunay2(s.ctx, s.p, NULL, N, NULL, &s.t) == BRIO_OK);
    EXPECT(brio_alpha_values2(s.ctx, s.t, s.p, NULL, N, &other) == BRIO_ERR_NO_ANSWER && !other.values[0]);
    drop(&s);
}

/* Vertices were called distinct points, though hidden points are distinct too. */
static void messages_count_hidden_points(void) {
    double p[10], space[15], w[5] = {0, 0, 10, 0, 0};
    brio_context *ctx = new_context();
    brio_triangulation2 *plane;
    brio_triangulation *t;
    brio_alpha_complex c = {0};
    for (int i = 0; i < 5; i++) {
        p[2 * i] = p[2 * i + 1] = i;
        for (int k = 0; k < 3; k++) space[3 * i + k] = i;
    }
    EXPECT(brio_delaunay2(ctx, p, w, 5, NULL, &plane) == BRIO_OK &&
           brio_delaunay(ctx, space, w, 5, NULL, &t) == BRIO_OK);
    size_t vertices[2] = {brio_triangulation2_stats(plane)->vertices, brio_triangulation_stats(t)->vertices};
    EXPECT(vertices[0] < 5 && vertices[1] < 5);
    for (int i = 0; i < 2; i++) {
        char expected[80];
        snprintf(expected, sizeof expected, "%zu vertices (%zu points are hidden)", vertices[i], 5 - vertices[i]);
        EXPECT((i ? brio_alpha_values(ctx, t, space, w, 5, &c) : brio_alpha_values2(ctx, plane, p, w, 5, &c)) ==
               BRIO_ERR_NO_ANSWER);
        EXPECT(strstr(brio_message(ctx), expected), "%s", brio_message(ctx));
    }
    brio_triangulation2_free(plane);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static brio_status run_alpha(brio_context *ctx) {
    double p[2 * 60], alpha;
    uint32_t order[8 * 60];
    brio_triangulation2 *t = NULL;
    brio_alpha_complex c = {0};
    uniform_points(1, 40, p);
    brio_status status = brio_delaunay2(ctx, p, NULL, 60, NULL, &t);
    if (status == BRIO_OK) status = brio_alpha_values2(ctx, t, p, NULL, 60, &c);
    if (status == BRIO_OK) status = brio_alpha_order(ctx, &c, order);
    if (status == BRIO_OK) status = brio_alpha_auto(ctx, &c, &alpha);
    brio_alpha_complex_free(&c);
    brio_triangulation2_free(t);
    return status;
}

static void memory_that_runs_out(void) {
    expect_clean_failures(run_alpha);
}

SUITE(test_alpha_plane) {
    RUN(values_against_brute_force);
    RUN(least_alpha_of_one_region);
    RUN(the_least_alpha_is_the_same_at_every_scale_or_refused);
    RUN(faces_enter_before_triangles);
    RUN(hostile_inputs);
    RUN(messages_count_hidden_points);
    RUN(memory_that_runs_out);
    return harness_end();
}
