/* What a power crust can be asked for beside its polygons: simplified, open, sharp, with normals. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "mesh/closest_point.h"

/* Small inputs: one thread is faster. */
static brio_context *new_small_context(void) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    return ctx;
}

static brio_mesh *crust(brio_context *ctx, const double *p, size_t n, const brio_surface_options *o,
                        brio_surface_stats *s) {
    brio_mesh *mesh = NULL;
    brio_status status = make_crust(ctx, p, n, o, &mesh, NULL, s);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    return mesh;
}

static brio_certificate certify(brio_context *ctx, const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    return c;
}

/* --- simplified --- */

static void simplified_torus_is_a_quarter_and_the_same(void) {
    enum { N = SHORT_TESTS ? 3000 : 6000 };
    static double p[3 * N];
    torus_points(1, N, p);
    brio_context *ctx = new_small_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *whole = crust(ctx, p, N, &o, NULL), *simple;
    brio_distance d = {0};
    o.simplify = 1;
    simple = crust(ctx, p, N, &o, NULL);
    brio_certificate c = certify(ctx, simple);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 1);
    EXPECT(fabs(c.volume - 3.158273) < 0.02 * 3.158273, "volume %g", c.volume);
    EXPECT(simple->num_faces <= whole->num_faces / 4 + 2, "%zu of %zu", simple->num_faces, whole->num_faces);
    EXPECT(simple->num_properties == 1 && brio_mesh_property(simple, "sample"));
    EXPECT(brio_mesh_distance(ctx, simple, whole, 20000, 1, &d) == BRIO_OK);
    EXPECT(d.mean < 5e-4 * d.diagonal && d.hausdorff < 0.02 * d.diagonal, "mean %g, most %g", d.mean / d.diagonal,
           d.hausdorff / d.diagonal);
    EXPECT(d.normal_consistency > 0.98, "%g", d.normal_consistency);
    brio_certificate_free(&c);
    brio_mesh_free(whole);
    brio_mesh_free(simple);
    brio_context_free(ctx);
}

/* Whatever the input, simplification keeps components, genus and closedness. */
static void simplified_anything_stays_the_same_manifold(void) {
    double p[3 * 40];
    size_t collapsed = 0;
    brio_context *ctx = new_small_context();
    for (uint64_t trial = 0; trial < 120; trial++) {
        size_t n = 4 + trial % 37;
        brio_surface_options o = CRUST_OPTIONS;
        if (trial % 2)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        o.polygons = 0;
        brio_mesh *whole = crust(ctx, p, n, &o, NULL);
        if (!whole) continue;
        o.simplify = 1;
        brio_mesh *simple = crust(ctx, p, n, &o, NULL);
        brio_certificate a = certify(ctx, whole), b = certify(ctx, simple);
        EXPECT(b.closed && b.manifold && b.oriented, "trial %llu", (unsigned long long)trial);
        EXPECT(a.components == b.components && a.genus == b.genus, "trial %llu", (unsigned long long)trial);
        collapsed += whole->num_faces - simple->num_faces;
        brio_certificate_free(&a);
        brio_certificate_free(&b);
        brio_mesh_free(whole);
        brio_mesh_free(simple);
    }
    EXPECT(collapsed > 2000, "%zu", collapsed);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- open --- */

/* An infinite number was taken by one reconstruction and refused by the other. */
static void an_infinite_size_of_holes_is_refused(void) {
    const double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    brio_context *ctx = new_small_context();
    brio_surface_options crust = CRUST_OPTIONS;
    brio_surface_options labeled = LABELED_OPTIONS;
    brio_mesh *mesh;
    crust.open = labeled.open = INFINITY;
    EXPECT(make_crust(ctx, p, 4, &crust, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "expected a finite number, 0 or more"), "%s", brio_message(ctx));
    EXPECT(make_labeled(ctx, p, 4, &labeled, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "expected a finite number, 0 or more"), "%s", brio_message(ctx));
    brio_context_free(ctx);
}

/* A sphere without the samples of its cap z > 0.5: closed over by default, a disk when holes stay open. */
static void hole_of_the_samples_stays_open_on_request(void) {
    static double p[3 * 4000];
    size_t n = 0;
    sphere_points(6, 4000, p);
    for (size_t i = 0; i < 4000; i++)
        if (p[3 * i + 2] < 0.5) memmove(p + 3 * n++, p + 3 * i, 3 * sizeof *p);
    for (int simplify = 0; simplify < 2; simplify++) {
        brio_context *ctx = new_small_context();
        brio_surface_options o = CRUST_OPTIONS;
        brio_surface_stats s = {0};
        o.simplify = simplify;
        brio_mesh *mesh = crust(ctx, p, n, &o, &s);
        brio_certificate c = certify(ctx, mesh);
        EXPECT(c.closed && c.genus == 0 && s.left_out == 0);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
        o.open = 4;
        mesh = crust(ctx, p, n, &o, &s);
        c = certify(ctx, mesh);
        EXPECT(!c.closed && c.manifold && c.oriented && s.left_out > 0);
        EXPECT(c.components == 1 && c.genus == 0 && c.boundary_loops == 1, "%zu components, %zu loops", c.components,
               c.boundary_loops);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
}

/* A ball with a hollow of radius 0.6, and no samples of the hollow's cap z > 0.3. */
static size_t hollow_ball(double *p) {
    size_t n = 4000;
    sphere_points(6, 4000, p);
    sphere_points(7, 4000, p + 3 * 4000);
    for (size_t i = 4000; i < 8000; i++) {
        double q[3] = {0.6 * p[3 * i], 0.6 * p[3 * i + 1], 0.6 * p[3 * i + 2]};
        if (q[2] < 0.3) memmove(p + 3 * n++, q, sizeof q);
    }
    return n;
}

static int compare_keys(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The directed edges of the faces, sorted: tail in the upper 32 bits, head in the lower. */
static uint64_t *directed_edges(const brio_mesh *m, size_t *count) {
    *count = (size_t)m->face_offsets[m->num_faces];
    uint64_t *edge = malloc(*count * sizeof *edge);
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t i = m->face_offsets[f]; i < m->face_offsets[f + 1]; i++) {
            uint64_t next = i + 1 < m->face_offsets[f + 1] ? i + 1 : m->face_offsets[f];
            edge[i] = (uint64_t)m->face_vertices[i] << 32 | m->face_vertices[next];
        }
    qsort(edge, *count, sizeof *edge, compare_keys);
    return edge;
}

/* Vertices on edges that no other face runs back along: how many, and how far they are from the rim of the cap. */
static size_t far_from_rim(const brio_mesh *m, double *farthest) {
    size_t num_edges, count = 0;
    uint64_t *edge = directed_edges(m, &num_edges);
    *farthest = 0;
    for (size_t i = 0; i < num_edges; i++) {
        uint64_t back = edge[i] << 32 | edge[i] >> 32;
        if (bsearch(&back, edge, num_edges, sizeof *edge, compare_keys)) continue;
        const double *q = m->vertices + 3 * (edge[i] >> 32);
        *farthest = fmax(*farthest, hypot(hypot(q[0], q[1]) - 0.6 * sqrt(0.75), q[2] - 0.3));
        count++;
    }
    free(edge);
    return count;
}

/* Figure 3.9 of [Choi 2003]: the hole touches neither the hull nor a silhouette. The outer sphere stays closed, and the
 * hollow has one loop, along the rim of what was sampled. (Within the shell, balls are only a few spacings large; larger K
 * leave islands of small faces in the hole.) */
static void hole_inside_the_hull_stays_open_on_request(void) {
    static double p[3 * 8000];
    brio_context *ctx = new_small_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_surface_stats s = {0};
    double farthest;
    size_t n = hollow_ball(p);
    o.polygons = 0;
    brio_mesh *mesh = crust(ctx, p, n, &o, &s);
    brio_certificate c = certify(ctx, mesh);
    EXPECT(c.closed && c.components == 2 && c.genus == 0 && s.left_out == 0, "%zu components", c.components);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    o.open = 1;
    mesh = crust(ctx, p, n, &o, &s);
    c = certify(ctx, mesh);
    EXPECT(!c.closed && c.manifold && c.oriented && s.left_out > 0);
    EXPECT(c.components == 2 && c.genus == 0 && c.boundary_loops == 1, "%zu components, %zu loops", c.components,
           c.boundary_loops);
    EXPECT(far_from_rim(mesh, &farthest) == c.boundary_edges && farthest < 0.15, "%g from the rim", farthest);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void open_anything_is_manifold(void) {
    double p[3 * 60];
    size_t left_out = 0;
    brio_context *ctx = new_small_context();
    for (uint64_t trial = 0; trial < 120; trial++) {
        size_t n = 20 + trial % 40;
        brio_surface_options o = CRUST_OPTIONS;
        brio_surface_stats s = {0};
        o.open = 0.5 + (double)(trial % 4);
        o.simplify = trial % 3 == 0;
        if (trial % 2)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 4, p);
        brio_mesh *mesh = crust(ctx, p, n, &o, &s);
        if (!mesh) continue;
        brio_certificate c = certify(ctx, mesh);
        EXPECT(c.manifold && c.oriented, "trial %llu", (unsigned long long)trial);
        EXPECT((s.left_out > 0) == !c.closed, "trial %llu", (unsigned long long)trial);
        left_out += s.left_out;
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
    EXPECT(left_out > 100, "%zu", left_out);
    brio_context_free(ctx);
}

/* --- sharp --- */

/* Uniform samples inside the faces of the cube [0, 1]^3, none near its edges. */
static void cube_points(uint64_t seed, size_t n, double *p) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < n; i++) {
        size_t axis = i % 3;
        for (size_t k = 0; k < 3; k++) p[3 * i + k] = 0.02 + 0.96 * brio_rng_double(&rng);
        p[3 * i + axis] = (double)(i / 3 % 2);
    }
}

static double reach(const brio_mesh *mesh) {
    double most = 0; /* how near a vertex comes to the corner (1, 1, 1) */
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        const double *p = mesh->vertices + 3 * v;
        most = fmax(most, fmin(p[0], fmin(p[1], p[2])));
    }
    return most;
}

static void cube_comes_out_with_its_edges(void) {
    static double p[3 * 6000];
    cube_points(2, 6000, p);
    brio_context *ctx = new_small_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_surface_stats s = {0};
    brio_mesh *plain = crust(ctx, p, 6000, &o, &s);
    EXPECT(s.poles.bad_cells == 0);
    o.poles.sharp = 1;
    brio_mesh *sharp = crust(ctx, p, 6000, &o, &s);
    EXPECT(s.poles.bad_cells > 0);
    brio_certificate a = certify(ctx, plain), b = certify(ctx, sharp);
    EXPECT(b.closed && b.manifold && b.oriented && b.components == 1 && b.genus == 0);
    EXPECT(fabs(b.volume - 1) < fabs(a.volume - 1), "%g, %g", b.volume - 1, a.volume - 1);
    EXPECT(reach(sharp) > 0.99, "%g", reach(sharp));
    brio_certificate_free(&a);
    brio_certificate_free(&b);
    brio_mesh_free(plain);
    brio_mesh_free(sharp);
    brio_context_free(ctx);
}

/* The largest and the mean distance from the edges of the cube [0, 1]^3, short of its corners, to the mesh. */
static double off_the_edges(brio_context *ctx, const brio_mesh *mesh, double *mean) {
    enum { STEPS = 100 };
    brio_triangle_tree tree = {0};
    double most = 0, sum = 0;
    EXPECT(brio_triangle_tree_new(ctx, mesh, &tree) == BRIO_OK);
    for (int edge = 0; edge < 12; edge++)
        for (int i = 0; i < STEPS; i++) {
            int axis = edge / 4;
            double p[3], nearest[3];
            size_t triangle;
            p[axis] = 0.03 + 0.94 * i / (STEPS - 1);
            p[(axis + 1) % 3] = edge & 1;
            p[(axis + 2) % 3] = edge >> 1 & 1;
            double distance = sqrt(brio_closest_point(&tree, p, nearest, &triangle));
            most = fmax(most, distance);
            sum += distance;
        }
    brio_triangle_tree_free(ctx, &tree);
    *mean = sum / (12 * STEPS);
    return most;
}

/* Means in spacings of the samples. */
static void edges_without_samples_come_out_sharp(void) {
    enum { N = 1500, TRIALS = 4 };
    static double p[3 * N];
    const double spacing = sqrt(6.0 / N);
    brio_context *ctx = new_small_context();
    double sum[3] = {0}; /* without --sharp, with it, with R = 0.4 */
    for (uint64_t trial = 1; trial <= TRIALS; trial++) {
        cube_points(trial, N, p);
        for (int i = 0; i < 3; i++) {
            brio_surface_options o = CRUST_OPTIONS;
            double mean;
            o.poles.sharp = i > 0;
            o.poles.sampling_density = i == 2 ? 0.4 : 0;
            brio_mesh *mesh = crust(ctx, p, N, &o, NULL);
            double most = off_the_edges(ctx, mesh, &mean);
            EXPECT(i == 0 || most < 1.5 * spacing, "trial %llu: %g", (unsigned long long)trial, most / spacing);
            sum[i] += mean / spacing / TRIALS;
            brio_mesh_free(mesh);
        }
    }
    EXPECT(sum[0] > 0.1 && sum[1] < sum[0] / 3 && sum[2] < 0.03, "%g, %g, %g", sum[0], sum[1], sum[2]);
    brio_context_free(ctx);
}

/* Samples of a sphere down to 70 degrees from its pole: the inner poles are at the centre, below all samples. */
static void dome_whose_inner_poles_are_beyond_its_box_has_an_inside(void) {
    enum { N = 1500 };
    static double p[3 * N];
    brio_rng rng = brio_rng_new(11);
    double low = cos(70 * 3.14159265358979 / 180);
    for (size_t i = 0; i < N; i++) {
        double z = low + (1 - low) * brio_rng_double(&rng), turn = 6.283185307179586 * brio_rng_double(&rng);
        p[3 * i] = sqrt(1 - z * z) * cos(turn), p[3 * i + 1] = sqrt(1 - z * z) * sin(turn), p[3 * i + 2] = z;
    }
    brio_context *ctx = new_context();
    brio_mesh *mesh = NULL;
    brio_certificate c = {0};
    EXPECT(make_crust(ctx, p, N, NULL, &mesh, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK && c.closed && c.genus == 0 && c.components == 1);
    EXPECT(fabs(c.volume - 1.0621) < 0.03, "%g", c.volume);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void sampling_density_out_of_range_is_refused(void) {
    double p[3 * 20];
    uniform_points(1, 20, p);
    brio_context *ctx = new_small_context();
    const double bad[] = {-0.1, 1, 2, NAN};
    for (int i = 0; i < 4; i++) {
        brio_surface_options o = CRUST_OPTIONS;
        brio_mesh *mesh;
        o.poles.sampling_density = bad[i];
        EXPECT(make_crust(ctx, p, 20, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
        o.poles.sampling_density = 0;
        o.open = bad[i] == 1 || bad[i] == 2 ? -1 : bad[i];
        EXPECT(make_crust(ctx, p, 20, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    }
    brio_context_free(ctx);
}

/* --- normals --- */

static void normals_of_samples_are_those_of_the_sphere(void) {
    static double p[3 * 2200], normals[3 * 2200];
    sphere_points(3, 2000, p);
    memcpy(p + 6000, p, 600 * sizeof *p); /* 200 duplicates */
    for (int sharp = 0; sharp < 2; sharp++) {
        brio_context *ctx = new_small_context();
        brio_surface_options o = CRUST_OPTIONS;
        double worst = 1;
        o.poles.sampling_density = sharp ? 0.05 : 0; /* many samples then have no poles */
        o.poles.sharp = sharp;
        brio_mesh *mesh;
        EXPECT(make_crust(ctx, p, 2200, &o, &mesh, normals, NULL) == BRIO_OK, "%s", brio_message(ctx));
        for (size_t i = 0; i < 2200; i++) {
            const double *n = normals + 3 * i, *x = p + 3 * i;
            worst = fmin(worst, n[0] * x[0] + n[1] * x[1] + n[2] * x[2]);
            EXPECT(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-12);
        }
        EXPECT(worst > (sharp ? 0.9 : 0.98), "%g", worst);
        EXPECT(!memcmp(normals, normals + 6000, 600 * sizeof *normals));
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
}

static void normals_of_vertices_point_outwards(void) {
    static double p[3 * 3000];
    sphere_points(3, 3000, p);
    brio_context *ctx = new_small_context();
    brio_mesh *mesh = crust(ctx, p, 3000, NULL, NULL);
    EXPECT(brio_mesh_add_normals(mesh) == BRIO_OK);
    const brio_property *n[3] = {brio_mesh_property(mesh, "nx"), brio_mesh_property(mesh, "ny"),
                                 brio_mesh_property(mesh, "nz")};
    EXPECT(n[0] && n[1] && n[2]);
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        double outwards = 0;
        for (size_t k = 0; k < 3; k++) outwards += mesh->vertices[3 * v + k] * brio_property_value(n[k], v);
        EXPECT(outwards > 0.8, "%g", outwards);
    }
    EXPECT(brio_mesh_add_normals(mesh) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static brio_status everything_small(brio_context *ctx) {
    double p[3 * 40], normals[3 * 40];
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh;
    sphere_points(3, 40, p);
    o.simplify = o.poles.sharp = 1;
    o.open = 1;
    o.poles.sampling_density = 0.5;
    brio_status status = make_crust(ctx, p, 40, &o, &mesh, normals, NULL);
    if (status == BRIO_OK) status = brio_mesh_add_normals(mesh);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(everything_small);
}

SUITE(test_crust_outputs) {
    RUN(simplified_torus_is_a_quarter_and_the_same);
    RUN(simplified_anything_stays_the_same_manifold);
    RUN(hole_of_the_samples_stays_open_on_request);
    RUN(an_infinite_size_of_holes_is_refused);
    RUN(hole_inside_the_hull_stays_open_on_request);
    RUN(open_anything_is_manifold);
    RUN(cube_comes_out_with_its_edges);
    RUN(edges_without_samples_come_out_sharp);
    RUN(dome_whose_inner_poles_are_beyond_its_box_has_an_inside);
    RUN(sampling_density_out_of_range_is_refused);
    RUN(normals_of_samples_are_those_of_the_sphere);
    RUN(normals_of_vertices_point_outwards);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
