/* Signed distances of points from surfaces, and coverage: against brute force over all triangles. */
#include "brio/testdata.h"
#include "harness.h"
#include "points.h"
#include "surfaces.h"
#include "mesh/closest_point.h"
#include "mesh/solid.h"
#include "base/rng.h"
#include "base/vector.h"
#include <math.h>

static brio_context *ctx;

static double least_distance(const brio_mesh *m, const double *p) {
    double least = INFINITY;
    for (size_t f = 0; f < m->num_faces; f++) {
        const double *t[3];
        double q[3], square = 0;
        for (size_t k = 0; k < 3; k++) t[k] = m->vertices + 3 * (size_t)m->face_vertices[3 * f + k];
        brio_closest_on_corners(t, p, q);
        for (int k = 0; k < 3; k++) square += (p[k] - q[k]) * (p[k] - q[k]);
        least = fmin(least, sqrt(square));
    }
    return least;
}

/* The solid angle of all triangles over 4 pi: 1 inside, 0 outside; an own way to the side. */
static double turns_round(const brio_mesh *m, const double *p) {
    double sum = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        double v[3][3], l[3];
        for (size_t k = 0; k < 3; k++) {
            for (size_t i = 0; i < 3; i++) v[k][i] = m->vertices[3 * (size_t)m->face_vertices[3 * f + k] + i] - p[i];
            l[k] = sqrt(v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2]);
        }
        double det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                     v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                     v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        double ab = v[0][0] * v[1][0] + v[0][1] * v[1][1] + v[0][2] * v[1][2];
        double bc = v[1][0] * v[2][0] + v[1][1] * v[2][1] + v[1][2] * v[2][2];
        double ca = v[2][0] * v[0][0] + v[2][1] * v[0][1] + v[2][2] * v[0][2];
        sum += 2 * atan2(det, l[0] * l[1] * l[2] + ab * l[2] + bc * l[0] + ca * l[1]);
    }
    return sum / (4 * 3.14159265358979323846);
}

static double *places_round(size_t n, uint64_t seed, double size) {
    double *p = malloc(3 * n * sizeof *p);
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < 3 * n; i++) p[i] = size * (2 * brio_rng_double(&rng) - 1);
    return p;
}

/* Sculptures and spheres, faces inwards and outwards, from 1e-140 to 1e140. */
static void closed_surfaces_against_brute_force(void) {
    enum { N = 300 };
    static const double scales[] = {1, 1e-140, 1e140, -1};
    for (int s = 0; s < 4; s++) {
        brio_mesh *m = NULL;
        double scale = fabs(scales[s]), distance[N];
        EXPECT(brio_generate_truth(ctx, 16, &m) == BRIO_OK);
        double *p = places_round(N, 5 + (uint64_t)s, 1.2);
        for (size_t i = 0; i < 60; i++) memcpy(p + 3 * i, m->vertices + 3 * (i % m->num_vertices), 3 * sizeof *p);
        if (scales[s] < 0)
            for (size_t h = 0; h < 3 * m->num_faces; h += 3) {
                uint32_t v = m->face_vertices[h];
                m->face_vertices[h] = m->face_vertices[h + 1], m->face_vertices[h + 1] = v;
            }
        double exact[N];
        for (size_t i = 0; i < N; i++) {
            exact[i] = least_distance(m, p + 3 * i);
            if (exact[i] > 1e-9 && fabs(turns_round(m, p + 3 * i)) > 0.5) exact[i] = -exact[i];
        }
        for (size_t i = 0; i < 3 * m->num_vertices; i++) m->vertices[i] *= scale;
        for (size_t i = 0; i < 3 * N; i++) p[i] *= scale;
        EXPECT(brio_mesh_signed_distances(ctx, m, p, N, distance) == BRIO_OK, "%s", brio_message(ctx));
        size_t inside = 0;
        for (size_t i = 0; i < N; i++) {
            EXPECT(fabs(distance[i] / scale - exact[i]) < 1e-12, "%zu: %g, not %g", i, distance[i] / scale, exact[i]);
            inside += distance[i] < 0;
        }
        EXPECT(inside > 5 && distance[0] == 0 && distance[59] == 0, "%zu inside", inside);
        free(p);
        brio_mesh_free(m);
    }
}

/* A surface with holes: wherever the nearest place is not at a rim, the side is that of the closed one. */
static void open_surfaces_have_the_side_of_their_faces(void) {
    enum { N = 400 };
    brio_mesh *whole = NULL;
    EXPECT(brio_generate_truth(ctx, 20, &whole) == BRIO_OK);
    uint32_t *corners = malloc(3 * whole->num_faces * sizeof *corners);
    size_t kept = 0;
    for (size_t f = 0; f < whole->num_faces; f++) {
        if (whole->vertices[3 * (size_t)whole->face_vertices[3 * f]] > 0.55) continue;
        memcpy(corners + 3 * kept++, whole->face_vertices + 3 * f, 3 * sizeof *corners);
    }
    brio_mesh *m = triangle_mesh(ctx, whole->vertices, whole->num_vertices, corners, kept);
    EXPECT(kept < whole->num_faces && kept > 100);
    double *p = places_round(N, 3, 1.1), open[N], closed[N];
    size_t same = 0, behind = 0;
    EXPECT(brio_mesh_signed_distances(ctx, whole, p, N, closed) == BRIO_OK);
    EXPECT(brio_mesh_signed_distances(ctx, m, p, N, open) == BRIO_OK);
    for (size_t i = 0; i < N; i++) {
        EXPECT(fabs(fabs(open[i]) - least_distance(m, p + 3 * i)) < 1e-12);
        if (fabs(open[i]) != fabs(closed[i])) continue; /* nearest to what was cut off */
        same++;
        behind += open[i] < 0;
        if (p[3 * i] < 0.4) EXPECT(open[i] == closed[i], "%zu: %g and %g", i, open[i], closed[i]);
    }
    EXPECT(same > 200 && behind > 5, "%zu, %zu behind", same, behind);
    free(p);
    free(corners);
    brio_mesh_free(m);
    brio_mesh_free(whole);
}

/* Places nearest to an edge or a corner of a cube without its lid, whose faces have their vertices to themselves. */
static void edges_and_corners_of_faces_apart(void) {
    static const double corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    static const int quads[5][4] = {{0, 2, 3, 1}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    double points[3 * 30];
    uint32_t corners[30];
    for (size_t f = 0; f < 5; f++)
        for (size_t k = 0; k < 6; k++) {
            static const int fan[6] = {0, 1, 2, 0, 2, 3};
            corners[6 * f + k] = (uint32_t)(6 * f + k);
            memcpy(points + 3 * (6 * f + k), corner[quads[f][fan[k]]], sizeof corner[0]);
        }
    brio_mesh *m = triangle_mesh(ctx, points, 30, corners, 10);
    static const double places[] = {-1,   -1,  -1,  -1,  -1,   0.3, 2,    2,   -2, 0.5, 0.5,
                                    0.25, 0.1, 0.1, 0.1, 0.01, 0.5, 0.01, 0.5, -3, -3};
    static const int side[] = {1, 1, 1, -1, -1, -1, 1};
    double distance[7];
    EXPECT(brio_mesh_signed_distances(ctx, m, places, 7, distance) == BRIO_OK);
    for (int i = 0; i < 7; i++)
        EXPECT((distance[i] > 0) == (side[i] > 0) && distance[i] != 0, "place %d: %g", i, distance[i]);
    EXPECT(fabs(distance[0] - sqrt(3)) < 1e-15 && fabs(distance[3] + 0.25) < 1e-15);
    brio_mesh_free(m);
}

static void wrong_calls_are_refused(void) {
    brio_mesh *m = NULL;
    double p[3] = {0, 0, NAN}, d;
    brio_coverage c = {0};
    EXPECT(brio_mesh_new(ctx, &m) == BRIO_OK);
    EXPECT(brio_mesh_signed_distances(ctx, m, p, 1, &d) == BRIO_ERR_NOT_FINITE);
    p[2] = 0;
    EXPECT(brio_mesh_signed_distances(ctx, m, p, 1, &d) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_coverage(ctx, m, p, 1, NULL, &c) == BRIO_ERR_ARGUMENT);
    c.size = 0;
    EXPECT(brio_mesh_coverage(ctx, m, p, 1, NULL, &c) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(m);
}

/* --- coverage --- */

/* A unit grid of points with a square hole of 20 in the middle, a plane of small triangles over all of it, and a patch of points
 * that the plane leaves. */
static void a_hole_is_one_bridge(void) {
    enum { N = 40 };
    double *p = malloc(3 * (N * N + 100) * sizeof *p);
    size_t n = 0, bridges = 0, out = 0;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++)
            if (x < 10 || x > 29 || y < 10 || y > 29) p[3 * n] = x, p[3 * n + 1] = y, p[3 * n++ + 2] = 0;
    size_t seen = n;
    for (int i = 0; i < 100; i++) p[3 * n] = i % 10, p[3 * n + 1] = i / 10, p[3 * n++ + 2] = 8;
    brio_mesh *m = flat_grid(ctx, N, N);
    for (int turn = 0; turn < 2; turn++) { /* small triangles, and all of it as two */
        if (turn) {
            const double square[12] = {0, 0, 0, N - 1, 0, 0, N - 1, N - 1, 0, 0, N - 1, 0};
            const uint32_t two[6] = {0, 1, 2, 0, 2, 3};
            brio_mesh_free(m);
            m = triangle_mesh(ctx, square, 4, two, 2);
        } else {
            double widest = 0;
            for (size_t i = 0; i < 3 * m->num_vertices; i++) widest = fmax(widest, m->vertices[i]);
            for (size_t i = 0; i < 3 * m->num_vertices; i++) m->vertices[i] *= (N - 1) / widest;
        }
        uint8_t *bridge = malloc(m->num_faces), *left = malloc(n);
        brio_coverage c = {0};
        size_t count = 0;
        EXPECT(brio_mesh_coverage(ctx, m, p, n, bridge, &c) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_mesh_left_out(ctx, m, p, n, left, &count) == BRIO_OK && count == c.left_out);
        EXPECT(c.bridges == 1 && c.bridge_radius > 8 && c.bridge_radius < 12, "%zu bridges, %g", c.bridges,
               c.bridge_radius);
        EXPECT(fabs(c.bridge_centre[0] - 19.5) < 2 && fabs(c.bridge_centre[1] - 19.5) < 2);
        EXPECT(c.left_out == n - seen, "%zu of %zu left out", c.left_out, n - seen);
        if (!turn)
            EXPECT(c.far_share > 0.005 && c.far_share < 0.06 && c.bridge_share > 0.06 && c.bridge_share < 0.25,
                   "%g and %g", c.far_share, c.bridge_share);
        bridges = out = 0;
        for (size_t f = 0; f < m->num_faces; f++) bridges += bridge[f];
        for (size_t i = 0; i < n; i++) out += left[i] == (i >= seen);
        EXPECT(out == n && (turn ? bridges == 2 : bridges > 100 && bridges < m->num_faces / 4), "%zu faces", bridges);
        free(bridge);
        free(left);
    }
    brio_mesh_free(m);
    free(p);
}

/* Points about a plane: most are at a vertex or near one, some are in the middle of a face, beyond the rim or far away,
 * and some vertices are on no face. Where rounding decides, either answer is right. */
static void points_left_out_against_brute_force(void) {
    enum { N = 36, MORE = 150, UNUSED = 150 };
    brio_mesh *m = flat_grid(ctx, N, N);
    size_t given = m->num_vertices, n = 0, count = 0, wrong = 0, wanted = 0;
    double *p = malloc(3 * (given + MORE) * sizeof *p), high = 0;
    uint8_t *left = malloc(given + MORE);
    brio_rng rng = brio_rng_new(4);
    for (size_t i = 0; i < 3 * given; i++) high = fmax(high, m->vertices[i]);
    const double step = high / (N - 1);
    for (; n < given; n++)
        for (size_t k = 0; k < 3; k++)
            p[3 * n + k] = m->vertices[3 * n + k] + (n % 3    ? 0.3
                                                     : n % 20 ? 0
                                                              : 6) *
                                                        step * (brio_rng_double(&rng) - 0.5);
    for (size_t i = 0; i < given; i++) /* dense points over a corner, whose vertices have no nearer ones */
        for (size_t k = 0; k < 3 && m->vertices[3 * i] < 5 * step && m->vertices[3 * i + 1] < 5 * step; k++)
            p[3 * i + k] = (k < 2 ? 2 : 1) * step + 0.6 * step * (brio_rng_double(&rng) - 0.5);
    for (; n < given + MORE; n++)
        for (size_t k = 0; k < 3; k++) p[3 * n + k] = high * (1.5 * brio_rng_double(&rng) - 0.25);
    m->num_faces -= UNUSED; /* their vertices are on no face any more */
    EXPECT(brio_mesh_left_out(ctx, m, p, n, left, &count) == BRIO_OK);
    for (size_t i = 0; i < n; i++) {
        double sixth[7] = {0}, d;
        size_t size = 0;
        for (size_t j = 0; j < n; j++) { /* the seven least squares, its own among them */
            size_t at = size < 7 ? size++ : 6;
            d = brio_square_distance(p + 3 * i, p + 3 * j);
            if (size == 7 && at == 6 && j >= 7 && d >= sixth[6]) continue;
            for (; at > 0 && sixth[at - 1] > d; at--) sixth[at] = sixth[at - 1];
            sixth[at] = d;
        }
        double most = 2 * sqrt(acos(-1) / 6 * sixth[6]), least = least_distance(m, p + 3 * i);
        wanted += least > most;
        wrong += fabs(least - most) > 1e-9 * high && left[i] != (least > most);
    }
    EXPECT(wrong == 0 && count == wanted && wanted > 50 && wanted < n / 4, "%zu of %zu, found %zu, %zu wrong", wanted,
           n, count, wrong);
    m->num_faces += UNUSED;
    brio_mesh_free(m);
    free(p);
    free(left);
}

SUITE(test_signed_distance) {
    ctx = new_context();
    RUN(closed_surfaces_against_brute_force);
    RUN(open_surfaces_have_the_side_of_their_faces);
    RUN(edges_and_corners_of_faces_apart);
    RUN(wrong_calls_are_refused);
    RUN(a_hole_is_one_bridge);
    RUN(points_left_out_against_brute_force);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
