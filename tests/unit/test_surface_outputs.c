/* What users get of a surface: components dropped, normals of points, confidence, holes left open, fewer triangles, the
 * co-cone of the dissertation. */
#include "brio/laboratory.h"
#include "base/rng.h"
#include "failing_allocator.h"
#include "harness.h"
#include "known_surfaces.h"
#include "points.h"
#include "same_faces.h"
#include "surface_calls.h"
#include <math.h>
#include <string.h>

enum { MANY = 4000 };

static brio_context *context_of(int threads) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, threads);
    return ctx;
}

/* Random points on the unit sphere, those with z over `cap` left out. */
static size_t sphere_below(double cap, uint64_t seed, size_t n, double *p) {
    size_t kept = 0;
    sphere_points(seed, n, p);
    for (size_t i = 0; i < n; i++)
        if (p[3 * i + 2] <= cap) memmove(p + 3 * kept++, p + 3 * i, 3 * sizeof *p);
    return kept;
}

static brio_certificate certificate_of(brio_context *ctx, const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    brio_certificate copy = c;
    copy.genera = NULL;
    brio_certificate_free(&c);
    return copy;
}

/* --- components --- */

/* Tetrahedra of side 1, 2 and 3, the last one with a face missing; vertex 12 is in no face. Property i is the index. */
static brio_mesh *three_components(brio_context *ctx) {
    static const uint32_t face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    double v[39] = {0};
    uint32_t f[33];
    uint64_t offsets[12];
    brio_mesh *mesh;
    void *data;
    for (uint32_t t = 0; t < 3; t++)
        for (size_t i = 1; i < 4; i++) v[3 * (4 * t + i) + i - 1] = t + 1;
    for (uint32_t i = 0; i < 33; i++) f[i] = face[i / 3 % 4][i % 3] + 4 * (i / 12);
    for (uint64_t i = 0; i < 12; i++) offsets[i] = 3 * i;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, v, 13) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, f, 11) == BRIO_OK);
    EXPECT(brio_mesh_add_property(mesh, "i", BRIO_SCALAR_UINT8, &data) == BRIO_OK);
    for (int i = 0; i < 13; i++) ((uint8_t *)data)[i] = (uint8_t)i;
    return mesh;
}

static void expect_kept(int largest, size_t least, const char *vertices, size_t faces, size_t dropped) {
    brio_context *ctx = context_of(1);
    brio_mesh *mesh = three_components(ctx);
    size_t components = 99, gone = 99;
    EXPECT(brio_mesh_keep_components(mesh, largest, least, &components, &gone) == BRIO_OK);
    EXPECT(mesh->num_vertices == strlen(vertices) && mesh->num_faces == faces);
    for (size_t v = 0; v < mesh->num_vertices; v++)
        EXPECT(((uint8_t *)mesh->properties[0].data)[v] == vertices[v] - 'a', "vertex %zu", v);
    EXPECT(components == dropped && gone == 11 - faces, "%zu components, %zu faces", components, gone);
    brio_certificate c = certificate_of(ctx, mesh);
    EXPECT(c.components == 3 - dropped && c.manifold && c.oriented);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void components_are_dropped_by_area_and_by_faces(void) {
    expect_kept(0, 0, "abcdefghijklm", 11, 0);
    expect_kept(0, 4, "abcdefghm", 8, 1);
    expect_kept(1, 0, "ijklm", 3, 2);
    expect_kept(1, 4, "efghm", 4, 2);
}

/* All areas were 0, or none a number, and the component with the most faces stayed. */
static void the_largest_component_is_found_in_every_unit(void) {
    brio_context *ctx = context_of(1);
    for (int exponent = -1000; exponent <= 1000; exponent += 50) {
        brio_mesh *mesh = three_components(ctx);
        for (int i = 0; i < 39; i++) mesh->vertices[i] = ldexp(mesh->vertices[i], exponent);
        EXPECT(brio_mesh_keep_components(mesh, 1, 0, NULL, NULL) == BRIO_OK && mesh->num_faces == 3, "2^%d", exponent);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static void a_mesh_stays_as_it_was_where_nothing_would_be_left(void) {
    brio_context *ctx = context_of(1);
    brio_mesh *mesh = three_components(ctx);
    const uint32_t edge[2] = {0, 1};
    EXPECT(brio_mesh_keep_components(mesh, 0, 5, NULL, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(mesh->num_faces == 11 && mesh->num_vertices == 13);
    EXPECT(brio_mesh_set_edges(mesh, edge, 1) == BRIO_OK);
    EXPECT(brio_mesh_keep_components(mesh, 1, 0, NULL, NULL) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_keep_components(mesh, 1, 9, NULL, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- normals of points --- */

static void points_have_the_normals_of_their_vertices_or_neighbours(void) {
    static double p[3 * (MANY + 2)], normals[3 * (MANY + 2)];
    static uint32_t samples[MANY + 2];
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    sphere_points(3, MANY, p);
    for (size_t i = 0; i < 3 * MANY; i++) p[i] = ldexp(p[i], 400);
    memcpy(p + 3 * MANY, p + 3 * 17, 3 * sizeof *p);
    for (int k = 0; k < 3; k++) p[3 * MANY + 3 + k] = 0.5 * p[3 * 99 + k]; /* inside, on no triangle */
    EXPECT(make_labeled(ctx, p, MANY + 2, NULL, &mesh, samples, NULL) == BRIO_OK);
    EXPECT(brio_point_normals(ctx, p, MANY + 2, mesh, samples, normals) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < MANY + 2; i++) {
        double cosine = 0, size = 0;
        for (int k = 0; k < 3; k++) cosine += normals[3 * i + k] * ldexp(p[3 * i + k], -400);
        for (int k = 0; k < 3; k++) size += normals[3 * i + k] * normals[3 * i + k];
        EXPECT(cosine > (i == MANY + 1 ? 0.4 : 0.95) && fabs(size - 1) < 1e-12, "point %zu: %g", i, cosine);
    }
    EXPECT(!memcmp(normals + 3 * 17, normals + 3 * MANY, 24), "a duplicate has the normal of its twin");
    samples[0] = MANY + 2;
    EXPECT(brio_point_normals(ctx, p, MANY + 2, mesh, samples, normals) == BRIO_ERR_ARGUMENT);
    mesh->num_faces = 0;
    samples[0] = 0;
    EXPECT(brio_point_normals(ctx, p, MANY + 2, mesh, samples, normals) == BRIO_ERR_NO_ANSWER);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* The normals of points near a corner that is no number were none either. */
static void a_surface_with_nan_gives_no_normals(void) {
    double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, normals[12];
    const uint64_t offsets[] = {0, 3};
    const uint32_t corners[] = {0, 1, 2};
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, 3) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, corners, 1) == BRIO_OK);
    EXPECT(brio_point_normals(ctx, p, 4, mesh, NULL, normals) == BRIO_OK);
    mesh->vertices[5] = -INFINITY;
    EXPECT(brio_point_normals(ctx, p, 4, mesh, NULL, normals) == BRIO_ERR_NOT_FINITE);
    EXPECT(strstr(brio_message(ctx), "vertex 1 of the surface: z is infinite"), "%s", brio_message(ctx));
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Writes the normals of the vertices, and the normals that the points have by them. */
static void find_normals(brio_context *ctx, const brio_mesh *mesh, float *of_vertices, double *of_points) {
    static const char *const names[3] = {"nx", "ny", "nz"};
    size_t n = mesh->num_vertices;
    brio_mesh *copy;
    EXPECT(brio_mesh_new(ctx, &copy) == BRIO_OK && brio_mesh_set_vertices(copy, mesh->vertices, n) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(copy, mesh->face_offsets, mesh->face_vertices, mesh->num_faces) == BRIO_OK);
    EXPECT(brio_mesh_add_normals(copy) == BRIO_OK);
    for (size_t k = 0; k < 3; k++)
        memcpy(of_vertices + k * n, brio_mesh_property(copy, names[k])->data, n * sizeof *of_vertices);
    EXPECT(brio_point_normals(ctx, copy->vertices, n, copy, NULL, of_points) == BRIO_OK, "%s", brio_message(ctx));
    brio_mesh_free(copy);
}

/* They were 0 below 1e-160, 0 or no numbers above 1e155, and rough near these ends. */
static void normals_are_the_same_in_every_unit(void) {
    static double p[3 * 300], points[2][3 * 300];
    static float vertices[2][3 * 300];
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    sphere_points(8, 300, p);
    for (int i = 0; i < 900; i++)
        p[i] = rint(ldexp(p[i], 20)) / (1 << 20); /* so that doubles hold them times 2^-1000 */
    EXPECT(make_cocone(ctx, p, 300, NULL, &mesh, NULL) == BRIO_OK && mesh->num_vertices == 300);
    find_normals(ctx, mesh, vertices[0], points[0]);
    for (int exponent = -1000; exponent <= 1020; exponent += 5) {
        for (int i = 0; i < 900; i++) mesh->vertices[i] = ldexp(p[i], exponent);
        find_normals(ctx, mesh, vertices[1], points[1]);
        EXPECT(!memcmp(vertices[0], vertices[1], sizeof vertices[0]), "2^%d", exponent);
        EXPECT(!memcmp(points[0], points[1], sizeof points[0]), "2^%d", exponent);
    }
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Beside vertices that are no numbers, normals are 0. A vertex that no face uses is not part of the surface's extent. */
static void normals_of_odd_vertices_are_0(void) {
    const double no_numbers[][3] = {{NAN, 0, 0}, {0, NAN, NAN}, {NAN, NAN, NAN}, {INFINITY, 0, 0}, {1, 0, -INFINITY}};
    const double p[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -1, -1, 0, 1e300, 1e300, -1e300};
    const uint32_t faces[6] = {0, 1, 2, 2, 1, 3};
    const uint64_t offsets[3] = {0, 3, 6};
    float normals[15];
    double of_points[15];
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, 5) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, faces, 1) == BRIO_OK);
    find_normals(ctx, mesh, normals, of_points);
    EXPECT(normals[10] == 1 && normals[11] == 1 && normals[14] == 0);
    brio_mesh_free(mesh);
    for (size_t i = 0; i < sizeof no_numbers / sizeof *no_numbers; i++) {
        EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, 5) == BRIO_OK);
        EXPECT(brio_mesh_set_faces(mesh, offsets, faces, 2) == BRIO_OK);
        memcpy(mesh->vertices, no_numbers[i], sizeof no_numbers[i]);
        EXPECT(brio_mesh_add_normals(mesh) == BRIO_OK);
        for (size_t k = 0; k < 3; k++) {
            const float *n = brio_mesh_property(mesh, ((const char *const[]){"nx", "ny", "nz"})[k])->data;
            EXPECT(n[0] == 0 && n[1] == 0 && n[2] == 0, "vertex %zu: %g", i, (double)n[0]);
        }
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

/* A tetrahedron, with nz already if `has_z`, is given normals. */
static brio_status add_normals(brio_context *ctx, bool has_z) {
    static const double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    static const uint64_t offsets[5] = {0, 3, 6, 9, 12};
    brio_mesh *mesh;
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status != BRIO_OK) return status;
    status = brio_mesh_set_vertices(mesh, p, 4);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, faces, 4);
    if (status == BRIO_OK && has_z) status = brio_mesh_add_property(mesh, "nz", BRIO_SCALAR_FLOAT32, NULL);
    size_t before = mesh->num_properties;
    if (status == BRIO_OK) {
        status = brio_mesh_add_normals(mesh);
        EXPECT(mesh->num_properties == (status == BRIO_OK ? before + 3 : before), "%zu", mesh->num_properties);
    }
    brio_mesh_free(mesh);
    return status;
}

static brio_status add_normals_to_none(brio_context *ctx) {
    return add_normals(ctx, false);
}

/* Some of the three stayed, so that a second attempt found "two properties named nx". */
static void normals_that_fail_leave_the_mesh_as_it_was(void) {
    brio_context *ctx = context_of(1);
    EXPECT(add_normals(ctx, true) == BRIO_ERR_ARGUMENT);
    brio_context_free(ctx);
    expect_clean_failures(add_normals_to_none);
}

/* --- options of the labeled Delaunay triangulation --- */

static brio_mesh *surface_of(brio_context *ctx, const double *p, size_t n, const brio_surface_options *o,
                             uint32_t *samples, brio_surface_stats *s) {
    brio_mesh *mesh;
    *s = (brio_surface_stats){.size = sizeof *s};
    EXPECT(make_labeled(ctx, p, n, o, &mesh, samples, s) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

static double mean_confidence(const brio_mesh *mesh) {
    const brio_property *c = brio_mesh_property(mesh, "confidence");
    double sum = 0;
    EXPECT(c && c->type == BRIO_SCALAR_FLOAT32);
    for (size_t v = 0; c && v < mesh->num_vertices; v++) {
        double x = brio_property_value(c, v);
        EXPECT(x > 0 && x < 1);
        sum += x;
    }
    return sum / (double)mesh->num_vertices;
}

/* Points without a surface are all guesses; those of a sphere none; noise is in between. */
static void confidence_falls_with_the_evidence(void) {
    static double p[3 * MANY];
    brio_rng rng = brio_rng_new(3);
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s;
    o.confidence = 1;
    sphere_points(2, MANY, p);
    brio_mesh *clean = surface_of(ctx, p, MANY, &o, NULL, &s);
    EXPECT(s.uncertain_share == 0 && mean_confidence(clean) > 0.9, "%g", mean_confidence(clean));
    for (size_t i = 0; i < 3 * MANY; i++) p[i] += 0.05 * (brio_rng_double(&rng) - 0.5);
    brio_mesh *noisy = surface_of(ctx, p, MANY, &o, NULL, &s);
    EXPECT(mean_confidence(noisy) < mean_confidence(clean));
    uniform_points(5, MANY, p);
    brio_mesh *none = surface_of(ctx, p, MANY, &o, NULL, &s);
    EXPECT(s.uncertain_share > 0.3 && mean_confidence(none) < mean_confidence(noisy), "%g", s.uncertain_share);
    brio_mesh_free(clean);
    brio_mesh_free(noisy);
    brio_mesh_free(none);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* A sphere without its top: open, one loop, no triangle across the hole. Large K leave it closed. */
static void a_hole_stays_open(void) {
    static double p[3 * MANY];
    size_t n = sphere_below(0.9, 4, MANY, p);
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s;
    o.open = 4;
    brio_mesh *mesh = surface_of(ctx, p, n, &o, NULL, &s);
    brio_certificate c = certificate_of(ctx, mesh);
    EXPECT(c.manifold && c.oriented && !c.closed && c.components == 1 && c.boundary_loops == 1 && c.genus == 0,
           "%zu components, %zu loops", c.components, c.boundary_loops);
    EXPECT(s.left_out > 4, "%zu left out", s.left_out);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        double z = 0;
        for (size_t k = 0; k < 3; k++) z += mesh->vertices[3 * (size_t)mesh->face_vertices[3 * f + k] + 2] / 3;
        EXPECT(z < 0.9);
    }
    brio_mesh_free(mesh);
    o.open = 100;
    mesh = surface_of(ctx, p, n, &o, NULL, &s);
    EXPECT(certificate_of(ctx, mesh).closed && s.left_out == 0);
    brio_mesh_free(mesh);
    o.open = -1;
    EXPECT(make_labeled(ctx, p, n, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    o.open = 1e-3;
    EXPECT(make_labeled(ctx, p, n, &o, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    brio_context_free(ctx);
}

/* By default the library closes all holes, and says what it bridged; BRIO_HOLES_AUTO leaves open what chance does not
 * explain. */
static void holes_open_where_the_samples_end(void) {
    static double p[3 * MANY];
    size_t n = sphere_below(0, 4, MANY, p);
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s;
    brio_mesh *mesh = surface_of(ctx, p, n, &o, NULL, &s);
    EXPECT(certificate_of(ctx, mesh).closed && s.holes == 0 && s.bridges >= 1 && s.bridge_share > 0.25, "%g",
           s.bridge_share);
    brio_mesh_free(mesh);
    o.holes = BRIO_HOLES_AUTO;
    mesh = surface_of(ctx, p, n, &o, NULL, &s);
    brio_certificate c = certificate_of(ctx, mesh);
    EXPECT(c.manifold && c.oriented && !c.closed && c.components == 1 && s.holes >= 1 && s.bridge_share < 0.01);
    brio_mesh_free(mesh);
    o.holes = BRIO_HOLES_END;
    EXPECT(make_labeled(ctx, p, n, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    brio_context_free(ctx);
}

/* Whatever is left out, the rest is a manifold, and does not depend on the order of the points. */
static void open_surfaces_are_manifold_and_canonical(void) {
    static double p[3 * MANY], q[3 * MANY];
    static size_t to[MANY];
    static uint32_t samples[MANY];
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s;
    size_t left_out = 0;
    for (int trial = 0; trial < 8; trial += BRIEF_TESTS ? 3 : 1) {
        o.open = 1.5 + 0.25 * trial;
        o.noise = BRIO_NOISE_KEEP;
        if (trial % 2)
            uniform_points((uint64_t)trial, MANY, p);
        else
            torus_points((uint64_t)trial, MANY, p);
        shuffle_points(4, MANY, p, q, to);
        brio_mesh *one = surface_of(ctx, p, MANY, &o, samples, &s);
        brio_certificate c = certificate_of(ctx, one);
        EXPECT(c.manifold && c.oriented, "trial %d", trial);
        left_out += s.left_out;
        for (size_t h = 0; h < 3 * one->num_faces; h++) one->face_vertices[h] = samples[one->face_vertices[h]];
        brio_mesh *two = surface_of(ctx, q, MANY, &o, samples, &s);
        for (size_t h = 0; h < 3 * two->num_faces; h++) two->face_vertices[h] = samples[two->face_vertices[h]];
        expect_same_faces(one, to, two);
        brio_mesh_free(one);
        brio_mesh_free(two);
    }
    EXPECT(left_out > 1000, "%zu", left_out);
    brio_context_free(ctx);
}

/* A quarter of the triangles, the same topology; samples ascend, confidence stays. */
static void a_simplified_surface_stays_the_surface(void) {
    static uint32_t samples[MANY];
    static double p[3 * MANY];
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s;
    torus_points(8, MANY, p);
    for (size_t i = 0; i < 3 * MANY; i++) p[i] = ldexp(p[i], -500);
    o.simplify = o.confidence = 1;
    brio_mesh *mesh = surface_of(ctx, p, MANY, &o, samples, &s);
    brio_certificate c = certificate_of(ctx, mesh);
    EXPECT(c.closed && c.manifold && c.oriented && c.genus == 1 && mesh->num_faces < MANY, "%zu", mesh->num_faces);
    EXPECT(mesh->num_properties == 2 && mean_confidence(mesh) > 0.8);
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        double square = 0;
        EXPECT(v == 0 || samples[v] > samples[v - 1]);
        for (size_t k = 0; k < 3; k++)
            square += pow(ldexp(mesh->vertices[3 * v + k] - p[3 * (size_t)samples[v] + k], 500), 2);
        EXPECT(square < 0.25 * 0.25, "vertex %zu is %g from its sample", v, sqrt(square));
    }
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- the co-cone of the dissertation --- */

static brio_mesh *cocone_of(brio_context *ctx, const double *p, size_t n, brio_extraction extraction,
                            brio_surface_stats *s) {
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    *s = (brio_surface_stats){.size = sizeof *s};
    brio_laboratory *lab;
    EXPECT(brio_laboratory_new(ctx, &(brio_laboratory_options){.extraction = extraction}, &lab) == BRIO_OK);
    brio_status status = make_cocone(ctx, p, n, &o, &mesh, s);
    brio_laboratory_free(lab);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    return mesh;
}

/* On r-samples, r = 0.08, candidates hold the surface and the walk finds it, oriented outwards: two spheres, too. */
static void the_walk_finds_dense_surfaces(void) {
    const known_surface *all[] = {&known_sphere, &known_torus};
    brio_context *ctx = context_of(1);
    for (int i = 0; i < 2; i++) {
        size_t n;
        brio_surface_stats s;
        double *p = all[i]->sample(all[i]->r, 7, &n);
        p = realloc(p, 6 * n * sizeof *p);
        for (size_t k = 0; k < 3 * n; k++) p[3 * n + k] = p[k] + (k % 3 == 0 ? 5 : 0);
        brio_mesh *candidates = cocone_of(ctx, p, 2 * n, BRIO_EXTRACTION_CANDIDATES, &s);
        EXPECT(candidates->num_faces == s.candidates && s.pruned == 0);
        brio_mesh *pruned = cocone_of(ctx, p, 2 * n, BRIO_EXTRACTION_PRUNED, &s);
        EXPECT(pruned->num_faces == s.candidates - s.pruned);
        brio_mesh *walk = cocone_of(ctx, p, 2 * n, BRIO_EXTRACTION_WALK, &s);
        brio_certificate c = certificate_of(ctx, walk);
        EXPECT(c.closed && c.manifold && c.oriented && c.components == 2 && c.genus == 2 * all[i]->genus &&
                   c.volume > 0,
               "%zu components, genus %lld, volume %g", c.components, (long long)c.genus, c.volume);
        EXPECT(walk->num_faces <= pruned->num_faces && s.unused == 0);
        brio_mesh_free(candidates);
        brio_mesh_free(pruned);
        brio_mesh_free(walk);
        free(p);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Any input ends, with faces once each. */
static void the_walk_ends_on_anything(void) {
    double p[3 * 60];
    brio_context *ctx = context_of(1);
    for (uint64_t trial = 0; trial < (BRIEF_TESTS ? 150 : SHORT_TESTS ? 500 : 2000); trial++) {
        size_t n = 5 + trial % 50;
        brio_surface_stats s;
        if (trial % 2)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 4, p);
        brio_mesh *mesh = cocone_of(ctx, p, n, BRIO_EXTRACTION_WALK, &s);
        EXPECT(!mesh || mesh->num_faces <= s.candidates - s.pruned);
        brio_mesh_free(mesh);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void extractions_are_of_the_co_cone_in_one_piece(void) {
    brio_context *ctx = context_of(1);
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    double p[3 * 30];
    sphere_points(1, 30, p);
    brio_laboratory_options walk = {.extraction = BRIO_EXTRACTION_WALK};
    brio_laboratory *lab, *second;
    EXPECT(brio_laboratory_new(ctx, &walk, &lab) == BRIO_OK);
    EXPECT(brio_laboratory_new(ctx, &walk, &second) == BRIO_ERR_ARGUMENT && !second);
    o.method = BRIO_SURFACE_TIGHT_COCONE;
    EXPECT(make_cocone(ctx, p, 30, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    o.method = BRIO_SURFACE_COCONE, o.pieces = 3;
    EXPECT(make_cocone(ctx, p, 30, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    o.pieces = 0;
    EXPECT(make_cocone(ctx, p, 30, &o, &mesh, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    brio_laboratory_free(lab);
    walk.extraction = (brio_extraction)9;
    EXPECT(brio_laboratory_new(ctx, &walk, &lab) == BRIO_ERR_ARGUMENT && !lab);
    brio_context_free(ctx);
}

/* --- memory --- */

static brio_status make_surface(brio_context *ctx) {
    static double p[3 * 400], normals[3 * 400];
    static uint32_t samples[400];
    size_t n = sphere_below(0.8, 1, 400, p);
    brio_mesh *mesh;
    brio_surface_options o = LABELED_OPTIONS;
    o.confidence = o.simplify = 1;
    o.open = 3;
    brio_status status = make_labeled(ctx, p, n, &o, &mesh, samples, NULL);
    if (status == BRIO_OK) status = brio_point_normals(ctx, p, n, mesh, samples, normals);
    if (status == BRIO_OK) status = brio_mesh_keep_components(mesh, 1, 1, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}

static brio_status walk(brio_context *ctx) {
    static double p[3 * 200];
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh = NULL;
    brio_laboratory *lab;
    sphere_points(1, 200, p);
    brio_status status = brio_laboratory_new(ctx, &(brio_laboratory_options){.extraction = BRIO_EXTRACTION_WALK}, &lab);
    if (status == BRIO_OK) status = make_cocone(ctx, p, 200, &o, &mesh, NULL);
    brio_laboratory_free(lab);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(make_surface);
    expect_clean_failures(walk);
}

SUITE(test_surface_outputs) {
    RUN(components_are_dropped_by_area_and_by_faces);
    RUN(a_mesh_stays_as_it_was_where_nothing_would_be_left);
    RUN(the_largest_component_is_found_in_every_unit);
    RUN(points_have_the_normals_of_their_vertices_or_neighbours);
    RUN(a_surface_with_nan_gives_no_normals);
    RUN(normals_are_the_same_in_every_unit);
    RUN(normals_of_odd_vertices_are_0);
    RUN(normals_that_fail_leave_the_mesh_as_it_was);
    RUN(confidence_falls_with_the_evidence);
    RUN(a_hole_stays_open);
    RUN(holes_open_where_the_samples_end);
    RUN(open_surfaces_are_manifold_and_canonical);
    RUN(a_simplified_surface_stays_the_surface);
    RUN(the_walk_finds_dense_surfaces);
    RUN(the_walk_ends_on_anything);
    RUN(extractions_are_of_the_co_cone_in_one_piece);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
