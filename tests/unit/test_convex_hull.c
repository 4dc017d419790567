/* The convex hull against brute force: every vertex is strictly extreme, every point is on the inner side of every facet, and
 * the surface is closed; against the infinite tetrahedra of the Delaunay triangulation; for every order of the points. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "hull/hull_faces.h"

static brio_mesh *hull_of(brio_context *ctx, const double *p, size_t n, int polygons, uint32_t *samples,
                          brio_convex_hull_stats *s) {
    brio_convex_hull_options o = {0};
    brio_mesh *m = NULL;
    o.polygons = polygons;
    o.samples = samples;
    *s = (brio_convex_hull_stats){.size = sizeof *s};
    brio_status status = brio_convex_hull(ctx, p, n, &o, &m, s);
    EXPECT(status == BRIO_OK, "%s", brio_message(ctx));
    return m;
}

/* No point beyond a facet; turns of facets strictly convex: no three consecutive corners on a line. */
static void expect_convex(const brio_mesh *m, const double *p, size_t n, int polygons) {
    for (size_t f = 0; f < m->num_faces; f++) {
        const uint32_t *v = m->face_vertices + m->face_offsets[f];
        size_t size = (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
        const double *a = m->vertices + 3 * (size_t)v[0];
        for (size_t i = 0; i + 2 < size; i++) {
            const double *b = m->vertices + 3 * (size_t)v[i + 1], *c = m->vertices + 3 * (size_t)v[i + 2];
            EXPECT(!brio_collinear(a, b, c), "facet %zu", f);
            for (size_t q = 0; q < n; q++) EXPECT(brio_orient3d(a, b, c, p + 3 * q) <= 0, "facet %zu, point %zu", f, q);
        }
        for (size_t i = 0; i < size && polygons; i++) {
            const double *x[3];
            for (size_t k = 0; k < 3; k++) x[k] = m->vertices + 3 * (size_t)v[(i + k) % size];
            EXPECT(!brio_collinear(x[0], x[1], x[2]), "facet %zu, corner %zu", f, i);
        }
        for (size_t i = 1; i < size && polygons; i++)
            EXPECT(brio_lexicographic(a, m->vertices + 3 * (size_t)v[i]) < 0, "facet %zu", f);
    }
}

static void expect_closed(brio_context *ctx, const brio_mesh *m) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, m, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 0);
    EXPECT(!(c.volume < 0)); /* doubles hold no volume for some sets */
    brio_certificate_free(&c);
}

/* A vertex is the point of the lowest index at its position, and is not in the hull of the other points. */
static void expect_vertices(brio_context *ctx, const double *p, size_t n, const brio_mesh *m, const uint32_t *samples) {
    double *others = malloc(3 * n * sizeof *others + 1);
    for (size_t v = 0; v < m->num_vertices; v++) {
        size_t count = 0;
        EXPECT(!memcmp(m->vertices + 3 * v, p + 3 * (size_t)samples[v], 3 * sizeof *p));
        EXPECT(v == 0 || samples[v - 1] < samples[v]);
        for (size_t q = 0; q < samples[v]; q++)
            EXPECT(!brio_same_position(p + 3 * q, p + 3 * (size_t)samples[v]), "not the lowest index");
        for (size_t q = 0; q < n; q++)
            if (!brio_same_position(p + 3 * q, p + 3 * (size_t)samples[v]))
                memcpy(others + 3 * count++, p + 3 * q, 3 * sizeof *p);
        brio_convex_hull_stats s;
        brio_mesh *less = hull_of(ctx, others, count, 1, NULL, &s);
        if (s.dimension == 3) { /* without an extreme point, that point is beyond a facet */
            bool beyond = false;
            for (size_t f = 0; f < less->num_faces; f++) {
                const uint32_t *w = less->face_vertices + less->face_offsets[f];
                beyond |= brio_orient3d(less->vertices + 3 * (size_t)w[0], less->vertices + 3 * (size_t)w[1],
                                        less->vertices + 3 * (size_t)w[2], m->vertices + 3 * v) > 0;
            }
            EXPECT(beyond, "vertex %zu is not extreme", v);
        }
        brio_mesh_free(less);
    }
    free(others);
}

typedef void (*point_maker)(uint64_t seed, size_t n, double *points);

static void small_grid(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 3, p);
}
static void grid(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 9, p);
}
/* Nearly in a plane: heights are multiples of the least number. */
static void thin(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 6, p);
    for (size_t i = 0; i < n; i++) p[3 * i + 2] *= 0x1p-1074;
}
/* Far from the origin: one rounding unit between neighbours. */
static void far(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 7, p);
    for (size_t i = 0; i < 3 * n; i++) p[i] = 0x1p53 + 2 * p[i];
}
static void huge(uint64_t seed, size_t n, double *p) {
    uniform_points(seed, n, p);
    for (size_t i = 0; i < 3 * n; i++) p[i] = (p[i] - 0.5) * 0x1p1023;
}
static void sphere(uint64_t seed, size_t n, double *p) {
    sphere_points(seed, n, p);
}

static const point_maker MAKERS[] = {uniform_points, small_grid, grid, thin, far, huge, sphere, clustered_points};
enum { MAKER_COUNT = sizeof MAKERS / sizeof *MAKERS, POINTS = 319 };

static void small_sets_against_brute_force(void) {
    static double p[3 * POINTS];
    static uint32_t samples[POINTS];
    brio_context *ctx = new_context();
    for (int maker = 0; maker < MAKER_COUNT; maker++)
        for (uint64_t seed = 1; seed <= 3; seed++)
            for (size_t n = 4; n <= POINTS; n = n * 2 + 1) {
                brio_convex_hull_stats s;
                MAKERS[maker](seed, n, p);
                brio_mesh *polygons = hull_of(ctx, p, n, 1, samples, &s);
                if (s.dimension == 3) {
                    expect_convex(polygons, p, n, 1);
                    expect_closed(ctx, polygons);
                    if (n < 80) expect_vertices(ctx, p, n, polygons, samples);
                    brio_mesh *triangles = hull_of(ctx, p, n, 0, NULL, &s);
                    expect_convex(triangles, p, n, 0);
                    expect_closed(ctx, triangles);
                    EXPECT(triangles->num_faces == 2 * triangles->num_vertices - 4);
                    EXPECT(s.facets == polygons->num_faces);
                    brio_mesh_free(triangles);
                }
                brio_mesh_free(polygons);
            }
    brio_context_free(ctx);
}

/* The same polygons come from the Delaunay triangulation, which is another way to the hull. */
static void delaunay_gives_the_same_polygons(void) {
    static double p[3 * POINTS], record[POINTS + 1][4];
    static uint32_t index[POINTS];
    brio_context *ctx = new_context();
    for (int maker = 0; maker < MAKER_COUNT; maker++) {
        brio_hull_records records = {record, index, POINTS};
        brio_polytope by_points = {0}, by_delaunay = {0};
        brio_hull_polygons one = {0}, other = {0};
        brio_filter filter;
        uint32_t corner[4];
        MAKERS[maker](7, POINTS, p);
        for (size_t i = 0; i < POINTS; i++) {
            index[i] = (uint32_t)(POINTS - 1 - i);
            for (size_t k = 0; k < 3; k++) record[i][k] = p[3 * i + k];
            record[i][3] = 0;
        }
        brio_filter_for(&filter, (const double(*)[4])record, POINTS, false);
        EXPECT(brio_general_position(&filter, (const double(*)[4])record, POINTS, corner) == 3);
        EXPECT(brio_polytope_build(ctx, &records, corner, 1, &by_points) == BRIO_OK);
        EXPECT(brio_polytope_by_delaunay(ctx, &records, &by_delaunay) == BRIO_OK);
        EXPECT(brio_hull_faces(ctx, &by_delaunay, &records, &other) == BRIO_OK);
        if (by_points.count > 0) {
            EXPECT(brio_hull_faces(ctx, &by_points, &records, &one) == BRIO_OK);
            EXPECT(one.count == other.count && one.first[one.count] == other.first[other.count], "maker %d", maker);
            uint64_t sum = 0, other_sum = 0; /* of hashed directed edges */
            for (size_t f = 0; f < one.count; f++)
                for (uint64_t c = one.first[f]; c < one.first[f + 1]; c++)
                    sum += brio_hash(one.corner[c], one.corner[c + 1 < one.first[f + 1] ? c + 1 : one.first[f]]);
            for (size_t f = 0; f < other.count; f++)
                for (uint64_t c = other.first[f]; c < other.first[f + 1]; c++)
                    other_sum +=
                        brio_hash(other.corner[c], other.corner[c + 1 < other.first[f + 1] ? c + 1 : other.first[f]]);
            EXPECT(sum == other_sum, "maker %d", maker);
        }
        brio_polytope_free(ctx, &by_points);
        brio_polytope_free(ctx, &by_delaunay);
        brio_hull_polygons_free(ctx, &one);
        brio_hull_polygons_free(ctx, &other);
    }
    brio_context_free(ctx);
}

/* Shuffled points, one and four threads: the same hull. */
static void order_and_threads_change_nothing(void) {
    enum { N = 200000 };
    double *p = malloc(3 * N * sizeof *p), *q = malloc(3 * N * sizeof *q);
    size_t *to = malloc(N * sizeof *to);
    uint32_t *samples = malloc(N * sizeof *samples), *shuffled = malloc(N * sizeof *shuffled);
    brio_context *ctx = new_context();
    for (int maker = 0; maker < 3; maker++) {
        brio_convex_hull_stats s, t;
        MAKERS[maker == 1 ? 2 : 0](5, N, p);
        if (maker == 2) sphere_points(1, N, p);
        shuffle_points(3, N, p, q, to);
        brio_context_set_threads(ctx, 1);
        brio_mesh *one = hull_of(ctx, p, N, 0, samples, &s);
        brio_context_set_threads(ctx, 4);
        brio_mesh *again = hull_of(ctx, p, N, 0, shuffled, &t);
        EXPECT(one->num_faces == again->num_faces && s.candidates == t.candidates);
        EXPECT(!memcmp(one->face_vertices, again->face_vertices, 3 * one->num_faces * sizeof(uint32_t)));
        brio_mesh_free(again);
        again = hull_of(ctx, q, N, 0, shuffled, &t);
        EXPECT(one->num_faces == again->num_faces && s.facets == t.facets && s.vertices == t.vertices);
        if (maker == 0) EXPECT(s.candidates < N / 2, "%zu", s.candidates);
        brio_mesh_free(one);
        brio_mesh_free(again);
    }
    brio_context_free(ctx);
    free(p), free(q), free(to), free(samples), free(shuffled);
}

static void flat_inputs_are_a_polygon_an_edge_a_vertex(void) {
    double p[3 * 25];
    brio_context *ctx = new_context();
    brio_convex_hull_stats s;
    for (size_t axis = 0; axis < 3; axis++) { /* a grid of 5 by 5 in a plane, slanted */
        for (size_t i = 0; i < 25; i++) {
            p[3 * i + axis] = (double)(i % 5);
            p[3 * i + (axis + 1) % 3] = (double)(i / 5);
            p[3 * i + (axis + 2) % 3] = axis ? 0 : (double)(i % 5 + 2 * (i / 5));
        }
        brio_mesh *m = hull_of(ctx, p, 25, 1, NULL, &s);
        EXPECT(s.dimension == 2 && s.facets == 1 && m->num_vertices == 4 && m->num_faces == 1);
        brio_mesh_free(m);
        m = hull_of(ctx, p, 25, 0, NULL, &s);
        EXPECT(m->num_faces == 2 && m->num_edges == 0);
        double normal =
            brio_orient3d(m->vertices + 3 * (size_t)m->face_vertices[0], m->vertices + 3 * (size_t)m->face_vertices[1],
                          m->vertices + 3 * (size_t)m->face_vertices[2], (double[3]){100, 100, 1000});
        EXPECT(normal > 0, "axis %zu", axis);
        brio_mesh_free(m);
    }
    for (size_t i = 0; i < 25; i++)
        for (size_t k = 0; k < 3; k++) p[3 * i + k] = (double)((i * 7) % 25) * (double)(k + 1);
    brio_mesh *m = hull_of(ctx, p, 25, 0, NULL, &s);
    EXPECT(s.dimension == 1 && m->num_vertices == 2 && m->num_edges == 1 && m->num_faces == 0);
    brio_mesh_free(m);
    m = hull_of(ctx, p, 1, 0, NULL, &s);
    EXPECT(s.dimension == 0 && m->num_vertices == 1 && s.vertices == 1);
    brio_mesh_free(m);
    m = hull_of(ctx, NULL, 0, 0, NULL, &s);
    EXPECT(s.dimension == -1 && m->num_vertices == 0);
    brio_mesh_free(m);
    p[4] = NAN;
    EXPECT(brio_convex_hull(ctx, p, 25, NULL, &m, NULL) == BRIO_ERR_NOT_FINITE && !m);
    brio_context_free(ctx);
}

static brio_status run_hull(brio_context *ctx) {
    static double p[3 * 600];
    brio_mesh *m;
    uniform_points(1, 600, p);
    brio_status status = brio_convex_hull(ctx, p, 600, NULL, &m, NULL);
    brio_mesh_free(m);
    if (status != BRIO_OK) return status;
    thin(1, 30, p);
    status = brio_convex_hull(ctx, p, 30, NULL, &m, NULL);
    brio_mesh_free(m);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < 30; i++) p[3 * i + 2] = 0;
    status = brio_convex_hull(ctx, p, 30, NULL, &m, NULL);
    brio_mesh_free(m);
    return status;
}

static void memory_that_runs_out(void) {
    expect_clean_failures(run_hull);
}

SUITE(test_convex_hull) {
    RUN(small_sets_against_brute_force);
    RUN(delaunay_gives_the_same_polygons);
    RUN(order_and_threads_change_nothing);
    RUN(flat_inputs_are_a_polygon_an_edge_a_vertex);
    RUN(memory_that_runs_out);
    return harness_end();
}
