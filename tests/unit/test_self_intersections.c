/* Self-intersections: known counts, against rational arithmetic by brute force, and at any scale. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "mesh/crossing_faces.h"
#include "mesh/triangles_cross.h"

static brio_mesh *triangles(brio_context *ctx, const double *p, size_t n, const uint32_t *v, size_t faces) {
    brio_mesh *mesh;
    uint64_t offsets[64];
    for (size_t f = 0; f <= faces; f++) offsets[f] = 3 * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, n) == BRIO_OK &&
           brio_mesh_set_faces(mesh, offsets, v, faces) == BRIO_OK);
    return mesh;
}

static int64_t count(const double *p, size_t n, const uint32_t *v, size_t faces) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = triangles(ctx, p, n, v, faces);
    int64_t pairs = -1;
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK, "%s", brio_message(ctx));
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return pairs;
}

static const uint32_t TWO[6] = {0, 1, 2, 3, 4, 5};

static void pairs_apart_touching_and_crossing(void) {
    const double base[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    const struct {
        double other[9];
        int64_t pairs;
    } cases[] = {
        {{0, 0, 1, 4, 0, 1, 0, 4, 1}, 0},   /* parallel */
        {{1, 1, -1, 1, 1, 1, 9, 9, 0}, 1},  /* through the inside */
        {{5, 5, -1, 5, 5, 1, 9, 9, 0}, 0},  /* through the plane, outside */
        {{1, 1, 0, 1, 1, 1, 2, 1, 1}, 1},   /* a corner on the inside */
        {{2, 0, 0, 2, -1, 1, 3, -1, 1}, 1}, /* a corner on an edge */
        {{0, 0, 0, -1, 0, 1, 0, -1, 1}, 0}, /* a common corner, and nothing else */
        {{0, 0, 0, 1, 1, 1, 1, 1, -1}, 1},  /* a common corner, and through the inside */
        {{0, 0, 0, 4, 0, 0, 0, 0, 4}, 0},   /* a common edge */
        {{0, 0, 0, 4, 0, 0, 0, -4, 0}, 0},  /* a common edge in one plane, on its other side */
        {{0, 0, 0, 4, 0, 0, 1, 1, 0}, 1},   /* ... on the same side */
        {{0, 0, 0, 4, 0, 0, 0, 4, 0}, 1},   /* the same */
        {{1, 1, 0, 2, 1, 0, 1, 2, 0}, 1},   /* inside, in one plane */
        {{5, 0, 0, 9, 0, 0, 5, 4, 0}, 0},   /* beside, in one plane */
        {{0, 0, 0, -4, 0, 0, 0, -4, 0}, 0}, /* in one plane with a common corner, apart */
        {{0, 0, 0, 4, 1, 0, 1, 4, 0}, 1},   /* in one plane with a common corner, overlapping */
        {{1, 1, -1, 1, 1, 1, 1, 1, 0}, 0},  /* no area */
        {{1, 0, 0, 3, 0, 0, 2, 0, 4}, 1},   /* an edge in an edge */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double p[18];
        for (int scale = -900; scale <= 900; scale += 300) {
            for (int k = 0; k < 9; k++) p[k] = ldexp(base[k], scale), p[9 + k] = ldexp(cases[i].other[k], scale);
            int64_t pairs = count(p, 6, TWO, 2);
            EXPECT(pairs == cases[i].pairs, "case %zu at 2^%d: %lld", i, scale, (long long)pairs);
        }
    }
}

/* The least displacement a double can hold decides. */
static void one_ulp_decides(void) {
    double p[18] = {0, 0, 1, 4, 0, 1, 0, 4, 1, 1, 1, 1, 2, 1, 3, 1, 2, 3};
    EXPECT(count(p, 6, TWO, 2) == 1);
    p[11] = nextafter(1, 2);
    EXPECT(count(p, 6, TWO, 2) == 0);
    p[11] = nextafter(1, 0);
    EXPECT(count(p, 6, TWO, 2) == 1);
}

/* --- against a test that cannot be wrong: whole coordinates, fractions with whole denominators --- */

typedef int64_t vec[3];

static int64_t det(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d) {
    int64_t u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Whether edge pq strictly crosses the inside of triangle t: general position only, 2 when it is not. */
static int pierces(const vec p, const vec q, const vec t[3]) {
    int64_t a = det(t[0], t[1], t[2], p), b = det(t[0], t[1], t[2], q), s[3];
    for (int i = 0; i < 3; i++) s[i] = det(p, q, t[i], t[(i + 1) % 3]);
    if (!a || !b || !s[0] || !s[1] || !s[2]) return 2;
    if ((a > 0) == (b > 0)) return 0;
    return (s[0] > 0) == (s[1] > 0) && (s[1] > 0) == (s[2] > 0);
}

static void random_pairs_in_general_position(void) {
    int crossing = 0, general = 0;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        vec v[6];
        double p[18];
        const double *t[3] = {p, p + 3, p + 6}, *u[3] = {p + 9, p + 12, p + 15};
        int expected = 0;
        for (int i = 0; i < 18; i++) v[i / 3][i % 3] = brio_rng_below(&rng, 64), p[i] = (double)v[i / 3][i % 3];
        for (int i = 0; i < 3; i++) {
            expected |= pierces(v[i], v[(i + 1) % 3], (const vec *)(v + 3));
            expected |= pierces(v[3 + i], v[3 + (i + 1) % 3], (const vec *)v);
        }
        if (expected & 2) continue;
        general++;
        crossing += expected;
        EXPECT(brio_triangles_cross(t, u) == expected, "trial %llu", (unsigned long long)trial);
        EXPECT(brio_triangles_cross(u, t) == expected, "trial %llu", (unsigned long long)trial);
    }
    EXPECT(general > 15000 && crossing > 2000, "%d of %d", crossing, general);
}

/* Which axis the projection takes, and which corner comes first, must not matter: also with common corners, in one plane, and
 * without area. Whole coordinates are sheared exactly. */
static void sheared_pairs_cross_as_before(void) {
    int crossing = 0, sharing = 0;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        uint64_t most = 2 + brio_rng_below(&rng, 4), flat = brio_rng_below(&rng, 3), common = brio_rng_below(&rng, 3);
        double p[18], s[18];
        const double *t[3] = {p, p + 3, p + 6}, *u[3] = {p + 9, p + 12, p + 15}, *a[3], *b[3];
        for (int i = 0; i < 18; i++) p[i] = i % 3 == 2 && !flat ? 1 : (double)brio_rng_below(&rng, most);
        for (uint64_t c = 0; c < common; c++)
            memcpy(p + 9 + 3 * brio_rng_below(&rng, 3), p + 3 * brio_rng_below(&rng, 3), 3 * sizeof *p);
        int to = (int)brio_rng_below(&rng, 3), from = (to + 1) % 3, other = (to + 2) % 3;
        double by = (double)brio_rng_below(&rng, 7) - 3, also = (double)brio_rng_below(&rng, 7) - 3;
        for (int v = 0; v < 18; v += 3) {
            s[v] = p[v + to] + by * p[v + from] + also * p[v + other];
            s[v + 1] = p[v + other] + also * p[v + from], s[v + 2] = p[v + from];
        }
        int turn = (int)brio_rng_below(&rng, 3);
        for (int i = 0; i < 3; i++) a[i] = s + 3 * ((i + turn) % 3), b[i] = s + 9 + 3 * ((2 * i + turn) % 3);
        bool cross = brio_triangles_cross(t, u);
        EXPECT(brio_triangles_cross(a, b) == cross, "trial %llu", (unsigned long long)trial);
        EXPECT(brio_triangles_cross(b, a) == cross, "trial %llu", (unsigned long long)trial);
        crossing += cross, sharing += common > 0;
    }
    EXPECT(crossing > 2000 && sharing > 5000, "%d, %d", crossing, sharing);
}

/* --- whole meshes --- */

/* A tetrahedron at each place; two at a distance less than 1 cross. */
static brio_mesh *tetrahedra(brio_context *ctx, const double (*at)[3], uint32_t n) {
    static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t face[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    double p[3 * 4 * 8];
    uint32_t v[12 * 8];
    for (uint32_t t = 0; t < n; t++) {
        for (uint32_t i = 0; i < 12; i++) p[12 * t + i] = corner[i / 3][i % 3] + at[t][i % 3];
        for (uint32_t i = 0; i < 12; i++) v[12 * t + i] = 4 * t + face[i];
    }
    return triangles(ctx, p, 4 * n, v, 4 * n);
}

static void tetrahedra_that_interpenetrate(void) {
    const double apart[2][3] = {{0, 0, 0}, {2, 0, 0}}, across[2][3] = {{0, 0, 0}, {.25, .25, -.5}};
    brio_context *ctx = new_context();
    int64_t pairs;
    brio_mesh *mesh = tetrahedra(ctx, apart, 2);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 0, "%lld", (long long)pairs);
    brio_mesh_free(mesh);
    /* the peak of the second (.25, .25, .5) comes up through the base z = 0 of the first and touches its slope x+y+z=1:
     * the base meets three sides, the slope all three that meet in the peak */
    mesh = tetrahedra(ctx, across, 2);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 6, "%lld", (long long)pairs);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A pencil of n long triangles through a common line, no corners in common: every pair crosses. */
static void every_pair_of_a_pencil(void) {
    enum { N = 60 };
    double p[9 * N];
    uint32_t v[3 * N];
    for (uint32_t i = 0; i < N; i++) {
        double a = 3.14159 * i / N, t[9] = {cos(a), sin(a), -1 - i, -cos(a), -sin(a), -1 - i, 0, 0, 2 * i + 300.0};
        memcpy(p + 9 * i, t, sizeof t);
        for (uint32_t k = 0; k < 3; k++) v[3 * i + k] = 3 * i + k;
    }
    EXPECT(count(p, 3 * N, v, N) == N * (N - 1) / 2);
}

static void polygons_count_once(void) {
    const double p[27] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 1, 1, -1, 3, 3, -1, 3, 3, 1, 1, 1, 1, 9, 9, 9};
    const uint64_t offsets[4] = {0, 4, 8, 10};
    const uint32_t v[10] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 8}; /* and a face of two corners */
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    int64_t pairs;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, 9) == BRIO_OK &&
           brio_mesh_set_faces(mesh, offsets, v, 3) == BRIO_OK);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 1, "%lld", (long long)pairs);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 0);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void a_surface_without_any(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    int64_t pairs;
    EXPECT(brio_generate_truth(ctx, 40, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 0, "%lld", (long long)pairs);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static brio_status small_count(brio_context *ctx) {
    const double p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint64_t offsets[2] = {0, 3};
    const uint32_t v[3] = {0, 1, 2};
    brio_mesh *mesh = NULL;
    int64_t pairs;
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, p, 3);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, v, 1);
    if (status == BRIO_OK) status = brio_mesh_self_intersections(ctx, mesh, &pairs);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_count);
}

/* --- searches --- */

/* Counts the pairs of triangles that cross, of which `only` has one at least, and compares what a search finds. */
static void check_search(const brio_face_groups *g, const uint8_t *only, const char *what) {
    const brio_mesh *m = g->mesh;
    uint8_t *wanted = calloc(m->num_faces, 1), *found = malloc(m->num_faces);
    int64_t pairs = 0, counted = -1;
    for (size_t a = 0; a < m->num_faces; a++)
        for (size_t b = 0; b < a; b++) {
            const double *t[3], *u[3];
            for (int k = 0; k < 3; k++) {
                t[k] = m->vertices + 3 * (size_t)m->face_vertices[3 * a + (size_t)k];
                u[k] = m->vertices + 3 * (size_t)m->face_vertices[3 * b + (size_t)k];
            }
            if ((only && !only[a] && !only[b]) || !brio_triangles_cross(t, u)) continue;
            wanted[a] = wanted[b] = 1;
            pairs++;
        }
    EXPECT(brio_search_crossings(g, only, found, &counted) == BRIO_OK && counted == pairs, "%s: %lld pairs, found %lld",
           what, (long long)pairs, (long long)counted);
    EXPECT(!memcmp(wanted, found, m->num_faces), "%s: other faces", what);
    free(wanted);
    free(found);
}

/* Random triangles, in space and in a plane, of as many groups as make one level and more; asked about all, some and
 * none; and once more after vertices have moved, some of them far out. */
static void searches_find_what_brute_force_finds(void) {
    static const size_t COUNTS[] = {1, 2, 8, 9, 63, 64, 65, 400};
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 2);
    for (size_t trial = 0; trial < 2 * sizeof COUNTS / sizeof *COUNTS; trial++) {
        brio_rng rng = brio_rng_new(trial);
        size_t n = COUNTS[trial / 2], flat = trial % 2;
        double *p = malloc(9 * n * sizeof *p);
        uint32_t *v = malloc(3 * n * sizeof *v);
        uint64_t *offsets = malloc((n + 1) * sizeof *offsets);
        uint8_t *only = malloc(n);
        for (size_t i = 0; i < 9 * n; i++)
            p[i] = flat && i % 3 == 2 ? 7 : brio_rng_double(&rng) * 0.2 + (double)(i / 9 * 37 % 100) / 100;
        for (size_t i = 0; i < 3 * n; i++) v[i] = (uint32_t)i;
        for (size_t f = 0; f <= n; f++) offsets[f] = 3 * f;
        brio_mesh m = {.context = ctx,
                       .num_vertices = 3 * n,
                       .vertices = p,
                       .num_faces = n,
                       .face_offsets = offsets,
                       .face_vertices = v};
        brio_face_groups g;
        EXPECT(brio_face_groups_new(ctx, &m, &g) == BRIO_OK && g.count == n);
        for (int moved = 0; moved < 2; moved++) {
            check_search(&g, NULL, "all");
            for (size_t f = 0; f < n; f++) only[f] = brio_rng_below(&rng, 3) == 0;
            check_search(&g, only, "some");
            memset(only, 0, n);
            check_search(&g, only, "none");
            for (size_t i = 0; i < 9 * n; i++)
                if (!flat || i % 3 != 2) p[i] += (i % 7 ? 0.05 : 0.6) * (brio_rng_double(&rng) - 0.5);
            EXPECT(brio_face_groups_fit(&g) == BRIO_OK);
        }
        brio_face_groups_free(&g);
        free(p);
        free(v);
        free(offsets);
        free(only);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_self_intersections) {
    RUN(pairs_apart_touching_and_crossing);
    RUN(one_ulp_decides);
    RUN(random_pairs_in_general_position);
    RUN(sheared_pairs_cross_as_before);
    RUN(tetrahedra_that_interpenetrate);
    RUN(every_pair_of_a_pencil);
    RUN(polygons_count_once);
    RUN(a_surface_without_any);
    RUN(searches_find_what_brute_force_finds);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
