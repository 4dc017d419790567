/* Offsets of meshes against exact volumes, exact distances, and points of the exact offsets. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "mesh/solid.h"
#include "points.h"
#include "surfaces.h"
#include <math.h>
#include <string.h>

#define PI 3.141592653589793

enum {
    UNKNOWN = -1,
    PLACES_A_FACE = SHORT_TESTS ? 3 : 8,
    PLACES = SHORT_TESTS ? 5000 : 20000,
    SIDES = SHORT_TESTS ? 12 : 32,
    TURNS = SHORT_TESTS ? 32 : 48
};

/* --- solids --- */

static brio_mesh *mesh_of(brio_context *ctx, const double *vertices, size_t count, const uint64_t *offsets,
                          const uint32_t *corners, size_t faces) {
    brio_mesh *mesh = NULL;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, vertices, count) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, corners, faces) == BRIO_OK);
    return mesh;
}

/* A polygon of n corners, counterclockwise, between two heights. */
static brio_mesh *prism(brio_context *ctx, const double (*corner)[2], uint32_t n, double low, double high) {
    double *v = malloc(6 * n * sizeof *v);
    uint64_t *offsets = malloc((n + 3) * sizeof *offsets);
    uint32_t *c = malloc(6 * n * sizeof *c);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = (i + 1) % n;
        const uint32_t side[4] = {i, j, n + j, n + i};
        for (int k = 0; k < 2; k++) v[3 * i + (size_t)k] = v[3 * (n + i) + (size_t)k] = corner[i][k];
        v[3 * i + 2] = low;
        v[3 * (n + i) + 2] = high;
        memcpy(c + 4 * i, side, sizeof side);
        offsets[i] = 4 * i;
        c[4 * n + i] = n - 1 - i;
        c[5 * n + i] = n + i;
    }
    offsets[n] = 4 * n;
    offsets[n + 1] = 5 * n;
    offsets[n + 2] = 6 * n;
    brio_mesh *mesh = mesh_of(ctx, v, 2 * n, offsets, c, n + 2);
    free(v);
    free(offsets);
    free(c);
    return mesh;
}

static brio_mesh *cube(brio_context *ctx, double low, double high) {
    const double corner[4][2] = {{low, low}, {high, low}, {high, high}, {low, high}};
    return prism(ctx, corner, 4, low, high);
}

static brio_mesh *regular_prism(brio_context *ctx, uint32_t n) {
    double corner[64][2];
    for (uint32_t i = 0; i < n; i++) corner[i][0] = cos(2 * PI * i / n), corner[i][1] = sin(2 * PI * i / n);
    return prism(ctx, (const double(*)[2])corner, n, -1, 1);
}

static brio_mesh *l_shape(brio_context *ctx) {
    static const double corner[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    return prism(ctx, corner, 6, 0, 1);
}

/* A torus of quadrilaterals, R = 1, r = 0.4. */
static brio_mesh *torus(brio_context *ctx, uint32_t n, uint32_t m) {
    double *v = malloc(3 * (size_t)n * m * sizeof *v);
    uint64_t *offsets = malloc(((size_t)n * m + 1) * sizeof *offsets);
    uint32_t *c = malloc(4 * (size_t)n * m * sizeof *c);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            uint32_t f = i * m + j, ii = (i + 1) % n, jj = (j + 1) % m;
            double a = 2 * PI * i / n, b = 2 * PI * j / m, r = 1 + 0.4 * cos(b);
            const uint32_t quad[4] = {f, ii * m + j, ii * m + jj, i * m + jj};
            v[3 * f] = r * cos(a), v[3 * f + 1] = r * sin(a), v[3 * f + 2] = 0.4 * sin(b);
            memcpy(c + 4 * f, quad, sizeof quad);
            offsets[f] = 4 * f;
        }
    offsets[n * m] = 4 * (uint64_t)n * m;
    brio_mesh *mesh = mesh_of(ctx, v, (size_t)n * m, offsets, c, (size_t)n * m);
    free(v);
    free(offsets);
    free(c);
    return mesh;
}

/* A sphere of radius 1: an octahedron, subdivided. */
static brio_mesh *sphere(brio_context *ctx) {
    static const double v[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t c[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    brio_mesh *mesh = triangle_mesh(ctx, v, 6, c, 8), *finer = NULL;
    EXPECT(brio_mesh_subdivide(ctx, mesh, SHORT_TESTS ? 3 : 4, &finer) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < finer->num_vertices; i++) {
        double *p = finer->vertices + 3 * i, length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int k = 0; k < 3; k++) p[k] /= length;
    }
    brio_mesh_free(mesh);
    return finer;
}

/* --- judging --- */

static double volume_of(brio_context *ctx, const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    double volume = c.volume;
    brio_certificate_free(&c);
    return volume;
}

static void expect_sound(brio_context *ctx, const brio_mesh *mesh, size_t components, int64_t genus, const char *what) {
    brio_certificate c = {0};
    int64_t pairs = -1;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented, "%s", what);
    EXPECT(genus == UNKNOWN || (c.components == components && c.genus == genus), "%s: %zu components, genus %lld", what,
           c.components, (long long)c.genus);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK && pairs == 0, "%s: %lld pairs cross", what,
           (long long)pairs);
    brio_certificate_free(&c);
}

/* Largest and mean distance from the exact offset, over random places of the faces, by area. */
static void measure(const brio_mesh *solid_mesh, const brio_mesh *mesh, double distance, double *most, double *mean) {
    brio_context *ctx = new_context();
    brio_solid solid;
    brio_rng rng = brio_rng_new(7);
    double area_sum = 0, sum = 0;
    EXPECT(brio_solid_new(ctx, solid_mesh, &solid) == BRIO_OK);
    *most = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const double *p[3];
        double u[3], v[3], n[3];
        for (int c = 0; c < 3; c++) p[c] = mesh->vertices + 3 * (size_t)mesh->face_vertices[3 * f + (size_t)c];
        for (int k = 0; k < 3; k++) u[k] = p[1][k] - p[0][k], v[k] = p[2][k] - p[0][k];
        for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < PLACES_A_FACE; i++) {
            double s = sqrt(brio_rng_double(&rng)), t = brio_rng_double(&rng), x[3], q[3];
            size_t triangle;
            for (int k = 0; k < 3; k++) x[k] = p[0][k] + s * (1 - t) * u[k] + s * t * v[k];
            double d = sqrt(brio_closest_point(&solid.tree, x, q, &triangle));
            if (brio_winding_number(&solid, x) != 0) d = -d;
            *most = fmax(*most, fabs(d - distance));
            sum += area / PLACES_A_FACE * fabs(d - distance);
        }
        area_sum += area;
    }
    *mean = sum / area_sum;
    brio_solid_free(ctx, &solid);
    brio_context_free(ctx);
}

/* The largest distance from random points of the exact offset to the result. A point at the distance from a random point of
 * a face is one, if no other face is nearer. */
static double missed(const brio_mesh *solid_mesh, const brio_mesh *mesh, double distance) {
    brio_context *ctx = new_context();
    brio_solid solid, result;
    brio_rng rng = brio_rng_new(9);
    double most = 0;
    EXPECT(brio_solid_new(ctx, solid_mesh, &solid) == BRIO_OK && brio_solid_new(ctx, mesh, &result) == BRIO_OK);
    const brio_triangle_tree *t = &solid.tree;
    for (int i = 0; i < PLACES; i++) {
        /* a random place about the box, its nearest point, and the point at the distance from there */
        double x[3], q[3], y[3];
        size_t triangle;
        for (int k = 0; k < 3; k++) {
            double low = t->boxes[0].low[k] - 1.5 * fabs(distance), high = t->boxes[0].high[k] + 1.5 * fabs(distance);
            x[k] = low + (high - low) * brio_rng_double(&rng);
        }
        double d = sqrt(brio_closest_point(t, x, q, &triangle));
        if ((brio_winding_number(&solid, x) != 0) != (distance < 0) || d < 1e-6) continue;
        for (int k = 0; k < 3; k++) y[k] = q[k] + fabs(distance) / d * (x[k] - q[k]);
        d = sqrt(brio_closest_point(t, y, q, &triangle));
        if (d < fabs(distance) * (1 - 1e-9) || (brio_winding_number(&solid, y) != 0) != (distance < 0)) continue;
        most = fmax(most, sqrt(brio_closest_point(&result.tree, y, q, &triangle)));
    }
    brio_solid_free(ctx, &solid);
    brio_solid_free(ctx, &result);
    brio_context_free(ctx);
    return most;
}

/* volume  exact, or 0: not known. */
static void expect_offset_of(brio_context *ctx, const brio_mesh *mesh, double distance, double volume, int64_t genus,
                             const char *name) {
    brio_mesh *out = NULL;
    brio_mesh_offset_stats s = {0};
    double most, mean, size = fabs(distance);
    EXPECT(brio_mesh_offset(ctx, mesh, distance, NULL, &out, &s) == BRIO_OK, "%s: %s", name, brio_message(ctx));
    if (out) {
        expect_sound(ctx, out, 1, genus, name);
        measure(mesh, out, distance, &most, &mean);
        double far = missed(mesh, out, distance);
        if (getenv("BRIO_TEST_VERBOSE"))
            fprintf(stderr,
                    "%s by %g: %zu vertices, largest %.5f, mean %.5f, proven %.5f, missed %.5f, volume %.6f of %.6f\n",
                    name, distance, out->num_vertices, most / size, mean / size, s.error / size, far / size,
                    volume_of(ctx, out), volume);
        EXPECT(s.error <= 0.01 * size * (1 + 1e-9), "%s by %g: proven %g", name, distance, s.error);
        EXPECT(most <= s.error * (1 + 1e-6), "%s by %g: largest %g, proven %g", name, distance, most, s.error);
        EXPECT(mean <= 0.005 * size, "%s by %g: mean %g", name, distance, mean);
        EXPECT(far <= 0.02 * size, "%s by %g: a point of the offset is %g away", name, distance, far);
        double got = volume_of(ctx, out);
        if (volume > 0)
            EXPECT(fabs(got - volume) <= 0.005 * volume, "%s by %g: volume %g, not %g", name, distance, got, volume);
    }
    brio_mesh_free(out);
}

static void expect_offset(brio_mesh *(*make)(brio_context *), double distance, double volume, int64_t genus,
                          const char *name) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = make(ctx);
    expect_offset_of(ctx, mesh, distance, volume, genus, name);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* --- the shapes --- */

static brio_mesh *unit_cube(brio_context *ctx) {
    return cube(ctx, 0, 1);
}

static brio_mesh *prism_of_many(brio_context *ctx) {
    return regular_prism(ctx, SIDES);
}

static brio_mesh *torus_of_many(brio_context *ctx) {
    return torus(ctx, TURNS, TURNS / 2);
}

/* Volume of a prism grown by d: base area A, perimeter P, height h, turn of the base 2 pi (convex). */
static double grown(double area, double perimeter, double h, double d) {
    return area * h + (2 * area + perimeter * h) * d + (PI * h + PI * perimeter / 2) * d * d + 4 * PI / 3 * d * d * d;
}

static void cube_has_sharp_corners_inside_and_round_ones_outside(void) {
    expect_offset(unit_cube, 0.1, grown(1, 4, 1, 0.1), 0, "cube");
    expect_offset(unit_cube, 1, grown(1, 4, 1, 1), 0, "cube");
    expect_offset(unit_cube, -0.1, 0.8 * 0.8 * 0.8, 0, "cube");
    expect_offset(unit_cube, -0.49, 0.02 * 0.02 * 0.02, 0, "cube");
}

static void prism_of_many_sides(void) {
    double turn = PI / SIDES, shrunk = 1 - 0.1 / cos(turn);
    double area = SIDES / 2 * sin(2 * turn), perimeter = 2 * SIDES * sin(turn);
    expect_offset(prism_of_many, 0.1, grown(area, perimeter, 2, 0.1), 0, "prism");
    expect_offset(prism_of_many, -0.1, area * shrunk * shrunk * 1.8, 0, "prism");
}

/* Outside the concave edge is sharp, inside it is round. */
static void l_shape_is_sharp_in_its_concave_edge_outside(void) {
    double d = 0.1, h = 1, area = 3, perimeter = 8;
    double base = area + perimeter * d + 5 * PI / 4 * d * d - d * d; /* of the polygon grown in its plane */
    /* A slice z beyond a lid has the polygon grown by r(z) = sqrt(d^2 - z^2): area + perimeter r + (5 pi / 4 - 1) r^2. */
    double lids = 2 * (area * d + perimeter * PI * d * d / 4 + (5 * PI / 4 - 1) * 2 * d * d * d / 3);
    expect_offset(l_shape, d, base * h + lids, 0, "L");
    expect_offset(l_shape, -d, (2 * 1.8 * 0.8 - 0.8 * 0.8 + d * d * (1 - PI / 4)) * 0.8, 0, "L");
}

static void sphere_and_torus_of_many_faces(void) {
    expect_offset(sphere, 0.2, 0, 0, "sphere");
    expect_offset(sphere, -0.2, 0, 0, "sphere");
    expect_offset(torus_of_many, 0.1, 0, 1, "torus");
    if (!SHORT_TESTS) expect_offset(torus_of_many, -0.1, 0, 1, "torus");
}

/* Machined parts with holes, of sharp edges and long triangles, where their files are there. */
static void machined_parts(void) {
    static const struct {
        const char *name;
        int64_t genus[2]; /* of the offsets by 0.03 and by -0.02 */
    } parts[] = {{"anchor", {4, 4}}, {"knot1", {UNKNOWN, 1}}};
    const char *folders[] = {getenv("BRIO_SHARED"), "../shared", "../../shared", "../../../shared"};
    for (int i = 0; i < 2; i++) {
        brio_context *ctx = new_context();
        brio_mesh *mesh = NULL;
        for (int j = 0; j < 4 && !mesh; j++) {
            char path[4096];
            snprintf(path, sizeof path, "%s/data/corpus/%s.ply", folders[j] ? folders[j] : ".", parts[i].name);
            if (brio_read(ctx, path, NULL, &mesh) != BRIO_OK) mesh = NULL;
        }
        if (mesh) {
            expect_offset_of(ctx, mesh, 0.03, 0, parts[i].genus[0], parts[i].name);
            expect_offset_of(ctx, mesh, -0.02, 0, parts[i].genus[1], parts[i].name);
        } else {
            printf("skipped: no %s.ply\n", parts[i].name);
        }
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
}

static void hole_of_a_torus_closes(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = torus_of_many(ctx), *out = NULL;
    EXPECT(brio_mesh_offset(ctx, mesh, 0.7, NULL, &out, NULL) == BRIO_OK, "%s", brio_message(ctx));
    if (out) expect_sound(ctx, out, 1, 0, "torus by 0.7");
    brio_mesh_free(out);
    EXPECT(brio_mesh_offset(ctx, mesh, -0.45, NULL, &out, NULL) == BRIO_ERR_NO_ANSWER && !out);
    EXPECT(strstr(brio_message(ctx), "swallows the whole object"), "%s", brio_message(ctx));
    EXPECT(brio_mesh_offset(ctx, mesh, -1e300, NULL, &out, NULL) == BRIO_ERR_NO_ANSWER && !out);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Two cubes 0.3 apart: two solids, then one. */
static void solids_that_meet_are_merged(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = cube(ctx, 0, 1), *out = NULL;
    double v[48];
    uint32_t c[48];
    uint64_t offsets[13];
    memcpy(v, a->vertices, 24 * sizeof *v);
    for (int i = 0; i < 24; i++) v[24 + i] = v[i] + (i % 3 == 0 ? 1.3 : 0);
    for (int i = 0; i < 24; i++) c[i] = a->face_vertices[i], c[24 + i] = a->face_vertices[i] + 8;
    for (int f = 0; f < 13; f++) offsets[f] = 4 * (uint64_t)f;
    brio_mesh *both = mesh_of(ctx, v, 16, offsets, c, 12);
    EXPECT(brio_mesh_offset(ctx, both, 0.1, NULL, &out, NULL) == BRIO_OK, "%s", brio_message(ctx));
    if (out) expect_sound(ctx, out, 2, 0, "cubes by 0.1");
    brio_mesh_free(out);
    EXPECT(brio_mesh_offset(ctx, both, 0.2, NULL, &out, NULL) == BRIO_OK, "%s", brio_message(ctx));
    if (out) expect_sound(ctx, out, 1, 0, "cubes by 0.2");
    brio_mesh_free(out);
    brio_mesh_free(both);
    brio_mesh_free(a);
    brio_context_free(ctx);
}

/* --- any input --- */

static void clockwise_faces_bound_the_same_solid(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = cube(ctx, 0, 1), *b = cube(ctx, 0, 1), *p = NULL, *q = NULL;
    for (int f = 0; f < 6; f++) {
        uint32_t *v = b->face_vertices + 4 * f, swap = v[1];
        v[1] = v[3];
        v[3] = swap;
    }
    EXPECT(brio_mesh_offset(ctx, a, 0.2, NULL, &p, NULL) == BRIO_OK);
    EXPECT(brio_mesh_offset(ctx, b, 0.2, NULL, &q, NULL) == BRIO_OK);
    EXPECT(p && q && fabs(volume_of(ctx, p) - volume_of(ctx, q)) < 1e-3);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_mesh_free(p);
    brio_mesh_free(q);
    brio_context_free(ctx);
}

static void threads_and_scale_change_nothing(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = l_shape(ctx), *p = NULL, *q = NULL;
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_mesh_offset(ctx, a, 0.2, NULL, &p, NULL) == BRIO_OK);
    for (size_t i = 0; i < 3 * a->num_vertices; i++) a->vertices[i] *= 0x1p300;
    brio_context_set_threads(ctx, 3);
    EXPECT(brio_mesh_offset(ctx, a, 0.2 * 0x1p300, NULL, &q, NULL) == BRIO_OK);
    bool same = p && q && p->num_vertices == q->num_vertices && p->num_faces == q->num_faces;
    for (size_t i = 0; same && i < 3 * p->num_vertices; i++) same = p->vertices[i] * 0x1p300 == q->vertices[i];
    EXPECT(same && !memcmp(p->face_vertices, q->face_vertices, 12 * p->num_faces));
    brio_mesh_free(a);
    brio_mesh_free(p);
    brio_mesh_free(q);
    brio_context_free(ctx);
}

static void smaller_error_is_met_with_more_vertices(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = cube(ctx, 0, 1), *p = NULL;
    size_t last = 0;
    for (double error = 0.01; error > 0.0005; error /= 4) {
        brio_mesh_offset_options o = {0};
        double most, mean;
        o.error = error;
        EXPECT(brio_mesh_offset(ctx, a, 0.1, &o, &p, NULL) == BRIO_OK, "%s", brio_message(ctx));
        if (!p) continue;
        measure(a, p, 0.1, &most, &mean);
        EXPECT(most <= error && p->num_vertices > last, "%zu vertices, %g of %g", p->num_vertices, most, error);
        last = p->num_vertices;
        brio_mesh_free(p);
    }
    brio_mesh_free(a);
    brio_context_free(ctx);
}

static void wrong_distances_and_errors_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = cube(ctx, 0, 1), *out = NULL;
    static const double wrong[] = {0, NAN, INFINITY, 1e308, 1e100};
    brio_mesh_offset_options o = {0};
    uint64_t bytes;
    for (int i = 0; i < 5; i++) {
        EXPECT(brio_mesh_offset(ctx, a, wrong[i], NULL, &out, NULL) == BRIO_ERR_ARGUMENT && !out, "%g", wrong[i]);
        EXPECT(brio_estimate_mesh_offset(ctx, a, wrong[i], NULL, &bytes) == BRIO_ERR_ARGUMENT, "%g", wrong[i]);
    }
    static const double errors[] = {-1, NAN, INFINITY, 0.1, 1, 1e-15};
    for (int i = 0; i < 6; i++) {
        o.error = errors[i];
        EXPECT(brio_mesh_offset(ctx, a, 0.1, &o, &out, NULL) == BRIO_ERR_ARGUMENT && !out, "%g", errors[i]);
    }
    a->num_faces = 5;
    EXPECT(brio_mesh_offset(ctx, a, 0.1, NULL, &out, NULL) == BRIO_ERR_NO_ANSWER && !out);
    EXPECT(strstr(brio_message(ctx), "do not close"), "%s", brio_message(ctx));
    a->num_faces = 6;
    brio_mesh_free(a);
    brio_context_free(ctx);
}

static void estimate_holds(void) {
    brio_mesh *(*const make[])(brio_context *) = {unit_cube, l_shape, prism_of_many, sphere, torus_of_many};
    for (int i = 0; i < (SHORT_TESTS ? 2 : 5); i++)
        for (double distance = -0.1; distance < 0.2; distance += 0.2) {
            brio_context *ctx = new_context();
            brio_mesh *mesh = make[i](ctx), *out = NULL;
            uint64_t bytes = 0;
            size_t before = brio_context_memory(ctx);
            EXPECT(brio_estimate_mesh_offset(ctx, mesh, distance, NULL, &bytes) == BRIO_OK);
            EXPECT(brio_mesh_offset(ctx, mesh, distance, NULL, &out, NULL) == BRIO_OK);
            double peak = (double)(brio_context_memory_peak(ctx) - before);
            EXPECT(peak <= 1.25 * (double)bytes && (double)bytes < 10e6 + 4 * peak, "shape %d by %g: %g of %g", i,
                   distance, peak, (double)bytes);
            brio_mesh_free(mesh);
            brio_mesh_free(out);
            brio_context_free(ctx);
        }
}

static int refuse(const char *stage, double fraction, void *user) {
    double *last = user;
    EXPECT(fraction >= *last, "%s goes back from %g to %g", stage, *last, fraction);
    *last = fraction;
    return fraction > 0.2;
}

static void progress_ascends_and_can_end_the_work(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = l_shape(ctx), *out = NULL;
    double last = 0;
    brio_context_set_progress(ctx, refuse, &last);
    EXPECT(brio_mesh_offset(ctx, a, 0.1, NULL, &out, NULL) == BRIO_ERR_CANCELLED && !out);
    brio_mesh_free(a);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status small_offset(brio_context *ctx) {
    brio_mesh *out = NULL, *mesh = NULL;
    double v[24];
    uint32_t c[24];
    uint64_t offsets[7];
    brio_context *other = new_context();
    brio_mesh *a = cube(other, 0, 1);
    memcpy(v, a->vertices, sizeof v);
    memcpy(c, a->face_vertices, sizeof c);
    memcpy(offsets, a->face_offsets, sizeof offsets);
    brio_mesh_free(a);
    brio_context_free(other);
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, v, 8);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, c, 6);
    if (status == BRIO_OK) status = brio_mesh_offset(ctx, mesh, -0.2, NULL, &out, NULL);
    brio_mesh_free(mesh);
    brio_mesh_free(out);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_offset);
}

SUITE(test_mesh_offset) {
    RUN(cube_has_sharp_corners_inside_and_round_ones_outside);
    RUN(prism_of_many_sides);
    RUN(l_shape_is_sharp_in_its_concave_edge_outside);
    RUN(sphere_and_torus_of_many_faces);
    if (!SHORT_TESTS) RUN(machined_parts);
    RUN(hole_of_a_torus_closes);
    RUN(solids_that_meet_are_merged);
    RUN(clockwise_faces_bound_the_same_solid);
    RUN(threads_and_scale_change_nothing);
    RUN(smaller_error_is_met_with_more_vertices);
    RUN(wrong_distances_and_errors_are_refused);
    RUN(estimate_holds);
    RUN(progress_ascends_and_can_end_the_work);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
