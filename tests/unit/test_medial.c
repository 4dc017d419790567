/* The power shape's parts against their definition, its simplification against brute force, labels from a known solid,
 * and inputs that have no medial axis. */
#include "failing_allocator.h"
#include "harness.h"
#include "medial_shapes.h"
#include "points.h"
#include "surface_calls.h"
#include "reconstruct/medial/ball_cover.h"
#include "reconstruct/power_crust/labeled_poles.h"
#include "mesh/solid.h"

static brio_mesh *shape_of(brio_context *ctx, const double *p, size_t n, const brio_power_shape_options *o) {
    brio_mesh *shape = NULL;
    EXPECT(brio_power_shape(ctx, p, n, o, &shape, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
    return shape;
}

static void expect_same(const brio_mesh *a, const brio_mesh *b) {
    EXPECT(a->num_vertices == b->num_vertices && a->num_edges == b->num_edges && a->num_faces == b->num_faces);
    if (a->num_vertices != b->num_vertices || a->num_edges != b->num_edges || a->num_faces != b->num_faces) return;
    EXPECT(!memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    EXPECT(!a->num_edges || !memcmp(a->edges, b->edges, 8 * a->num_edges));
    EXPECT(!memcmp(a->face_vertices, b->face_vertices, 12 * a->num_faces));
    EXPECT(a->num_tetrahedra == b->num_tetrahedra);
    if (a->num_tetrahedra == b->num_tetrahedra && a->num_tetrahedra)
        EXPECT(!memcmp(a->tetrahedra, b->tetrahedra, 16 * a->num_tetrahedra));
}

/* --- the shape --- */

/* The inner poles with a cell, numbered as the shape does it. */
static size_t number_inner(const brio_labeled_poles *l, uint32_t *number) {
    size_t count = 0;
    for (size_t p = 0; p < l->poles.count; p++) {
        bool cell = brio_triangulation_representatives(l->power)[p] == p;
        number[p] = cell && l->label[p] == BRIO_LABEL_INNER ? (uint32_t)count++ : UINT32_MAX;
    }
    return count;
}

/* The shape has the tetrahedra of the dual between inner poles, in their order and as they are turned. */
static void expect_tetrahedra_of_dual(const brio_labeled_poles *l, const uint32_t *number, const brio_mesh *shape) {
    size_t count = 0;
    for (size_t tet = 0; tet < l->diagram.num_finite; tet++) {
        const uint32_t *v = l->diagram.power.tet[tet].vertex;
        uint32_t w[4];
        int inner = 0;
        for (int i = 0; i < 4; i++) w[i] = number[v[i]], inner += w[i] != UINT32_MAX;
        if (inner < 4) continue;
        EXPECT(count < shape->num_tetrahedra && !memcmp(shape->tetrahedra + 4 * count, w, sizeof w));
        count++;
    }
    EXPECT(count == shape->num_tetrahedra && count > 0, "%zu, %zu", count, shape->num_tetrahedra);
}

/* Every pair, triple and quadruple of inner vertices of a tetrahedron of the dual is in the shape, and nothing else. */
static void shape_is_the_dual_between_inner_poles(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_ellipsoid, 0.35, 1);
    brio_labeled_poles l;
    brio_pole_request request;
    brio_surface_options surface = CRUST_OPTIONS;
    brio_mesh *shape = shape_of(ctx, c.points, c.count, NULL);
    EXPECT(brio_pole_request_of(ctx, &surface.poles, surface.noise, surface.seed, &request) == BRIO_OK);
    EXPECT(brio_labeled_poles_find(ctx, c.points, c.count, &request, &l) == BRIO_OK);
    uint32_t *number = malloc(l.poles.count * sizeof *number);
    size_t n = number_inner(&l, number), edges = 0, triangles = 0;
    uint8_t *edge = calloc(n * n, 1), *triangle = calloc(n * n * n, 1);
    EXPECT(shape->num_vertices == n && n < 400);
    for (size_t tet = 0; tet < l.diagram.num_finite; tet++)
        for (int i = 0; i < 64; i++) {
            const uint32_t *v = l.diagram.power.tet[tet].vertex;
            size_t a = number[v[i % 4]], b = number[v[i / 4 % 4]], d = number[v[i / 16]];
            if (a >= b || b == UINT32_MAX) continue;
            edges += !edge[n * a + b], edge[n * a + b] = 1;
            if (b >= d || d == UINT32_MAX) continue;
            triangles += !triangle[n * (n * a + b) + d], triangle[n * (n * a + b) + d] = 1;
        }
    EXPECT(shape->num_edges == edges && shape->num_faces == triangles, "%zu %zu, %zu %zu", shape->num_edges, edges,
           shape->num_faces, triangles);
    for (size_t e = 0; e < shape->num_edges; e++) {
        const uint32_t *v = shape->edges + 2 * e;
        EXPECT(v[0] < v[1] && edge[n * v[0] + v[1]] == 1);
        edge[n * v[0] + v[1]] = 0; /* none twice */
    }
    for (size_t f = 0; f < shape->num_faces; f++) {
        const uint32_t *v = shape->face_vertices + 3 * f;
        size_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
        low = v[2] < low ? v[2] : low, high = v[2] > high ? v[2] : high;
        size_t at = n * (n * low + (v[0] + v[1] + v[2] - low - high)) + high;
        EXPECT(triangle[at] == 1);
        triangle[at] = 0;
    }
    expect_tetrahedra_of_dual(&l, number, shape);
    free(number);
    free(edge);
    free(triangle);
    brio_labeled_poles_free(&l);
    brio_mesh_free(shape);
    brio_context_free(ctx);
    free(c.points);
}

/* Balls of an ellipsoid: each as large as its centre is far from the samples, on either side. */
static void radii_are_distances_to_samples_and_sides_are_told(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.3, 1);
    brio_power_shape_options o = {0};
    size_t inner = 0, outer = 0;
    o.sides = BRIO_SIDES_BOTH;
    brio_mesh *shape = shape_of(ctx, c.points, c.count, &o);
    const brio_property *radius = brio_mesh_property(shape, "radius"), *side = brio_mesh_property(shape, "side");
    for (size_t v = 0; v < shape->num_vertices; v++) {
        const double *p = shape->vertices + 3 * v;
        double least = INFINITY;
        for (size_t i = 0; i < c.count; i++) {
            const double *q = c.points + 3 * i;
            least = fmin(least, sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                                     (p[2] - q[2]) * (p[2] - q[2])));
        }
        EXPECT(fabs(least - brio_property_value(radius, v)) < 1e-9 * least, "%g %g", least,
               brio_property_value(radius, v));
        bool inside = torus_distance(p) < 0;
        EXPECT(brio_property_value(side, v) == (inside ? -1 : 1));
        EXPECT(inside || hypot(p[0], p[1]) < 0.2 + 0.3 * fabs(p[2])); /* near the axis of revolution */
        inner += inside;
        outer += !inside;
    }
    for (size_t e = 0; e < shape->num_edges; e++) {
        const uint32_t *v = shape->edges + 2 * e;
        EXPECT(brio_property_value(side, v[0]) == brio_property_value(side, v[1]));
    }
    EXPECT(inner > 50 && outer > 20, "%zu %zu", inner, outer);
    brio_mesh_free(shape);
    brio_context_free(ctx);
    free(c.points);
}

static void shuffled_samples_give_the_same_shape(void) {
    static double p[3 * 1000], q[3 * 1000];
    static size_t to[1000];
    brio_context *ctx = new_context();
    brio_power_shape_options o = {0};
    torus_points(2, 1000, p);
    shuffle_points(5, 1000, p, q, to);
    for (int simplified = 0; simplified < 2; simplified++) {
        o.scale = simplified ? 1.1 : 1;
        o.redundancy = simplified ? 0.01 : 0;
        brio_context_set_threads(ctx, 1);
        brio_mesh *a = shape_of(ctx, p, 1000, &o);
        brio_context_set_threads(ctx, 4);
        brio_mesh *b = shape_of(ctx, q, 1000, &o);
        expect_same(a, b);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
    brio_context_free(ctx);
}

static void crust_of_all_balls_is_the_power_crust(void) {
    static double p[3 * 1000];
    brio_context *ctx = new_context();
    brio_mesh *shape, *crust, *expected;
    torus_points(4, 1000, p);
    EXPECT(brio_power_shape(ctx, p, 1000, NULL, &shape, &crust, NULL) == BRIO_OK);
    EXPECT(make_crust(ctx, p, 1000, NULL, &expected, NULL, NULL) == BRIO_OK);
    expect_same(crust, expected);
    brio_mesh_free(shape);
    brio_mesh_free(crust);
    brio_mesh_free(expected);
    brio_context_free(ctx);
}

/* --- simplification --- */

static double distance_between(const double *p, const double *q) {
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/* Whether ball a may stand for ball b, with a little to spare on either side. */
static bool stands_for(const brio_cover_rule *rule, double a, double b, double distance, double spare) {
    double scaled = rule->scale * (a - b), enlarged = (1 + rule->redundancy) * a - b;
    return distance <= fmax(scaled, enlarged) + spare * a;
}

/* Of what is kept, none stands for a smaller one; what is left out has something kept that stands for it. */
static void expect_cover(const double *centre, const double *square, size_t n, const brio_cover_rule *rule) {
    brio_context *ctx = new_context();
    uint32_t *balls = malloc(n * sizeof *balls);
    uint8_t *keep = malloc(n);
    for (size_t i = 0; i < n; i++) balls[i] = (uint32_t)i, keep[i] = 1;
    EXPECT(brio_cover_balls(ctx, &(brio_balls){centre, square, balls, n}, rule, keep) == BRIO_OK);
    for (size_t b = 0; b < n; b++) {
        bool left_out = false, surely = false;
        for (size_t a = 0; a < n; a++) {
            if (a == b || !keep[a] || square[a] < square[b]) continue;
            double d = distance_between(centre + 3 * a, centre + 3 * b);
            left_out |= stands_for(rule, sqrt(square[a]), sqrt(square[b]), d, 2e-9);
            surely |= square[a] > square[b] && stands_for(rule, sqrt(square[a]), sqrt(square[b]), d, 0);
        }
        EXPECT(keep[b] ? !surely : left_out, "ball %zu of %zu", b, n);
    }
    free(balls);
    free(keep);
    brio_context_free(ctx);
}

static void cover_is_what_brute_force_finds(void) {
    static double centre[3 * 300], square[300];
    for (uint64_t trial = 0; trial < 200; trial++) {
        brio_rng rng = brio_rng_new(trial);
        size_t n = 1 + trial * 3 % 300;
        brio_cover_rule rule = {trial % 3 ? 1 + brio_rng_double(&rng) : 1, trial % 4 ? 0.3 * brio_rng_double(&rng) : 0};
        if (trial % 2)
            uniform_points(trial, n, centre);
        else
            integer_points(trial, n, 4, centre);
        for (size_t i = 0; i < n; i++) square[i] = trial % 5 ? 0.3 * brio_rng_double(&rng) : 1;
        expect_cover(centre, square, n, &rule);
    }
}

static double largest_norm(const brio_mesh *mesh) {
    static const double origin[3] = {0};
    double most = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) most = fmax(most, distance_between(mesh->vertices + 3 * v, origin));
    return most;
}

/* Bumps of a noisy sphere have axes of their own, down to the centre; simplified, only balls near it are left. */
static void simplification_takes_the_noise_of_a_sphere_away(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_sphere, 0.15, 1);
    brio_power_shape_options o = {0};
    brio_mesh *all, *few, *crust;
    brio_power_shape_stats s = {0};
    brio_certificate certificate = {0};
    for (size_t i = 0; i < c.count; i++) {
        double r = 1 + 0.02 * (brio_rng_double(&c.rng) - 0.5);
        for (size_t k = 0; k < 3; k++) c.points[3 * i + k] *= r;
    }
    all = shape_of(ctx, c.points, c.count, &o);
    o.scale = 1.2;
    o.redundancy = 0.02;
    EXPECT(brio_power_shape(ctx, c.points, c.count, &o, &few, &crust, &s) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(largest_norm(all) > 0.3 && largest_norm(few) < 0.1, "%g %g", largest_norm(all), largest_norm(few));
    EXPECT(10 * few->num_vertices < all->num_vertices, "%zu of %zu", few->num_vertices, all->num_vertices);
    EXPECT(s.left_out > 0 && s.poles.inner + s.poles.outer == s.poles.poles && s.unlabeled == 0);
    EXPECT(brio_mesh_certificate(ctx, crust, &certificate) == BRIO_OK);
    EXPECT(certificate.closed && certificate.manifold && certificate.genus == 0 && certificate.components == 1);
    EXPECT(fabs(certificate.volume - 4.18879) < 0.15, "%g", certificate.volume);
    brio_certificate_free(&certificate);
    brio_mesh_free(all);
    brio_mesh_free(few);
    brio_mesh_free(crust);
    brio_context_free(ctx);
    free(c.points);
}

/* --- the scale axis --- */

static bool in_ball(const double *centre, double square, const double *p, double slack) {
    double d = distance_between(centre, p);
    return d * d < square * (1 + slack);
}

/* Whether points all over the sphere of ball i, and in it, lie in other scaled balls that `of` has: brute force. */
static bool seems_covered(const double *centre, const double *square, size_t n, size_t i, const uint8_t *of) {
    for (int k = 0; k < 2000; k++) {
        double z = (k + 0.5) / 1000 - 1, t = k * 2.399963, r = sqrt(1 - z * z), p[3];
        double reach = sqrt(square[i]) * (1 - 1e-9);
        p[0] = centre[3 * i] + reach * r * cos(t), p[1] = centre[3 * i + 1] + reach * r * sin(t);
        p[2] = centre[3 * i + 2] + reach * z;
        bool found = false;
        for (size_t j = 0; j < n && !found; j++)
            found = j != i && (!of || of[j]) && in_ball(centre + 3 * j, square[j], p, 0);
        if (!found) return false;
    }
    return true;
}

/* The scale axis leaves out no ball whose sphere sticks out of the others, and keeps few that do not: those that fill
 * what would be voids. The union stays what it was, at places all over it. */
static void scale_axis_is_what_a_union_by_brute_force_finds(void) {
    static double centre[3 * 120], square[120], scaled[120];
    size_t dropped = 0, kept_covered = 0, single = 0;
    for (uint64_t seed = 1; seed <= (SHORT_TESTS ? 20 : 100); seed++) {
        brio_context *ctx = new_context();
        brio_rng rng = brio_rng_new(seed);
        size_t n = 20 + seed % 100;
        uint32_t balls[120];
        uint8_t keep[120];
        double s = 1 + 0.5 * brio_rng_double(&rng);
        uniform_points(seed, n, centre);
        for (size_t i = 0; i < n; i++) {
            square[i] = 0.09 * pow(brio_rng_double(&rng), 2) + 1e-3;
            scaled[i] = square[i] * s * s, balls[i] = (uint32_t)i, keep[i] = 1;
        }
        EXPECT(brio_scale_axis(ctx, &(brio_balls){centre, square, balls, n}, s, 1, keep) == BRIO_OK);
        for (size_t i = 0; i < n; i++) {
            bool covered = seems_covered(centre, scaled, n, i, NULL);
            EXPECT(keep[i] || covered, "seed %d, ball %zu", (int)seed, i);
            EXPECT(keep[i] || seems_covered(centre, scaled, n, i, keep), "seed %d, ball %zu", (int)seed, i);
            dropped += !keep[i], kept_covered += keep[i] && covered;
            bool one = false;
            for (size_t j = 0; j < n; j++)
                one |= j != i && distance_between(centre + 3 * i, centre + 3 * j) <= sqrt(scaled[j]) - sqrt(scaled[i]);
            single += one;
            EXPECT(!one || !keep[i]);
        }
        for (int k = 0; k < 2000; k++) { /* no voids */
            double p[3];
            bool before = false, after = false;
            for (int d = 0; d < 3; d++) p[d] = brio_rng_double(&rng);
            for (size_t i = 0; i < n; i++) {
                bool in = in_ball(centre + 3 * i, scaled[i], p, 0);
                before |= in, after |= in && keep[i];
            }
            EXPECT(before == after, "seed %d", (int)seed);
        }
        brio_context_free(ctx);
    }
    EXPECT(dropped > single && single > 0, "%zu %zu", dropped, single);
    EXPECT(20 * kept_covered < dropped, "%zu of %zu", kept_covered, dropped);
}

/* A big ball with its sphere covered by small ones that leave its inside open fills what would be a void. */
static void a_ball_that_fills_a_void_is_kept(void) {
    static double centre[3 * 301], square[301];
    uint32_t balls[301];
    uint8_t keep[301];
    brio_context *ctx = new_context();
    for (size_t i = 0; i < 301; i++) {
        double z = ((double)i + 0.5) / 150 - 1, t = (double)i * 2.399963, r = sqrt(fmax(0, 1 - z * z));
        centre[3 * i] = r * cos(t), centre[3 * i + 1] = r * sin(t), centre[3 * i + 2] = z;
        square[i] = 0.04, balls[i] = (uint32_t)i, keep[i] = 1;
    }
    centre[900] = centre[901] = centre[902] = 0, square[300] = 1;
    EXPECT(brio_scale_axis(ctx, &(brio_balls){centre, square, balls, 301}, 1.01, 1, keep) == BRIO_OK);
    EXPECT(keep[300]);
    square[300] = 0.5; /* touches nothing: an island in the void, with a boundary */
    EXPECT(brio_scale_axis(ctx, &(brio_balls){centre, square, balls, 301}, 1.01, 1, keep) == BRIO_OK && keep[300]);
    brio_context_free(ctx);
}

/* Noise of a sphere goes with the scale axis, too. */
static void scale_axis_takes_the_noise_of_a_sphere_away(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_sphere, 0.15, 1);
    brio_power_shape_options o = {.size = sizeof o};
    brio_power_shape_stats s = {0};
    brio_mesh *all, *few;
    for (size_t i = 0; i < c.count; i++) {
        double r = 1 + 0.02 * (brio_rng_double(&c.rng) - 0.5);
        for (size_t k = 0; k < 3; k++) c.points[3 * i + k] *= r;
    }
    all = shape_of(ctx, c.points, c.count, &o);
    o.scale_axis = 1.2;
    EXPECT(brio_power_shape(ctx, c.points, c.count, &o, &few, NULL, &s) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(largest_norm(all) > 0.3 && largest_norm(few) < 0.15, "%g %g", largest_norm(all), largest_norm(few));
    EXPECT(s.left_out > 0);
    o.scale_axis = 0.5;
    brio_mesh *none;
    EXPECT(brio_power_shape(ctx, c.points, c.count, &o, &none, NULL, NULL) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(all);
    brio_mesh_free(few);
    brio_context_free(ctx);
    free(c.points);
}

/* --- a known solid --- */

/* The box of half sides 1, 0.7, 0.5; `split`: each face with corners of its own; `turn`: seen clockwise. */
static brio_mesh *box_mesh(brio_context *ctx, bool split, bool turn, size_t faces) {
    static const uint32_t corner[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    brio_mesh *mesh;
    double p[3 * 24];
    uint32_t v[24];
    uint64_t offsets[7];
    for (uint32_t i = 0; i < 24; i++) {
        uint32_t from = split ? corner[i / 4][i % 4] : i % 8;
        p[3 * i] = from & 1 ? 1 : -1, p[3 * i + 1] = from & 2 ? 0.7 : -0.7, p[3 * i + 2] = from & 4 ? 0.5 : -0.5;
        uint32_t slot = turn ? i / 4 * 4 + 3 - i % 4 : i;
        v[slot] = split ? i : corner[i / 4][i % 4];
    }
    for (uint64_t f = 0; f < 7; f++) offsets[f] = 4 * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, p, split ? 24 : 8) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, v, faces) == BRIO_OK);
    return mesh;
}

static void poles_of_a_known_box_are_labeled_by_where_they_are(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_box, 0.2, 1);
    brio_power_shape_options o = {0};
    o.sides = BRIO_SIDES_BOTH;
    for (int kind = 0; kind < 4; kind++) {
        brio_mesh *box = box_mesh(ctx, kind & 1, kind & 2, 6);
        o.poles.solid = box;
        brio_mesh *shape = shape_of(ctx, c.points, c.count, &o);
        const brio_property *side = brio_mesh_property(shape, "side");
        for (size_t v = 0; v < shape->num_vertices; v++) {
            const double *p = shape->vertices + 3 * v;
            bool inside = fabs(p[0]) < 1 && fabs(p[1]) < 0.7 && fabs(p[2]) < 0.5;
            EXPECT(brio_property_value(side, v) == (inside ? -1 : 1), "%g %g %g", p[0], p[1], p[2]);
        }
        EXPECT(shape->num_vertices > 250, "%zu", shape->num_vertices);
        brio_mesh_free(shape);
        brio_mesh_free(box);
    }
    brio_context_free(ctx);
    free(c.points);
}

/* All poles are inner then, those on the hull of their triangulation, too. */
static void points_within_a_larger_solid_have_closed_crusts(void) {
    brio_context *ctx = new_context();
    brio_mesh *box = box_mesh(ctx, false, false, 6), *mesh, *shape;
    brio_power_shape_options medial = {0};
    brio_surface_options surface = CRUST_OPTIONS;
    double p[3 * 50];
    uniform_points(1, 50, p);
    for (size_t i = 0; i < 3 * box->num_vertices; i++) box->vertices[i] *= 1e4;
    medial.poles.solid = surface.poles.solid = box;
    for (int kind = 0; kind < 2; kind++) {
        brio_certificate c = {0};
        brio_status status = kind ? make_crust(ctx, p, 50, &surface, &mesh, NULL, NULL)
                                  : brio_power_shape(ctx, p, 50, &medial, &shape, &mesh, NULL);
        EXPECT(status == BRIO_OK && brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(c.closed && c.manifold && c.oriented);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
    brio_mesh_free(shape);
    brio_mesh_free(box);
    brio_context_free(ctx);
}

static void poles_that_are_kept_keep_what_is_theirs(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.3, 1);
    brio_labeled_poles l, all;
    brio_surface_options o = CRUST_OPTIONS;
    brio_pole_request request;
    EXPECT(brio_pole_request_of(ctx, &o.poles, o.noise, o.seed, &request) == BRIO_OK);
    request.spacing = true;
    EXPECT(brio_labeled_poles_find(ctx, c.points, c.count, &request, &l) == BRIO_OK);
    EXPECT(brio_labeled_poles_find(ctx, c.points, c.count, &request, &all) == BRIO_OK);
    uint8_t *keep = calloc(all.poles.count, 1);
    for (size_t p = 0; p < all.poles.count; p += 3) keep[p] = 1;
    EXPECT(brio_labeled_poles_keep(&l, keep) == BRIO_OK && l.poles.count == (all.poles.count + 2) / 3);
    for (size_t n = 0, p = 0; n < l.poles.count; n++, p += 3) {
        EXPECT(!memcmp(l.poles.centre + 3 * n, all.poles.centre + 3 * p, 24) &&
               l.poles.square[n] == all.poles.square[p]);
        EXPECT(l.label[n] == all.label[p] && l.spacing[n] == all.spacing[p]);
        EXPECT(l.poles.bounding[n] == all.poles.bounding[p]);
        EXPECT(!memcmp(l.poles.touched + 4 * n, all.poles.touched + 4 * p, 4 * sizeof *l.poles.touched));
    }
    free(keep);
    brio_labeled_poles_free(&l);
    brio_labeled_poles_free(&all);
    brio_context_free(ctx);
    free(c.points);
}

static void open_mesh_is_no_solid(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_box, 0.5, 1);
    brio_power_shape_options o = {0};
    brio_mesh *shape, *crust, *box = box_mesh(ctx, true, false, 5);
    o.poles.solid = box;
    EXPECT(brio_power_shape(ctx, c.points, c.count, &o, &shape, &crust, NULL) == BRIO_ERR_NO_ANSWER && !shape &&
           !crust);
    EXPECT(strstr(brio_message(ctx), "along 4 edges"), "%s", brio_message(ctx));
    brio_mesh_free(box);
    brio_context_free(ctx);
    free(c.points);
}

/* Poles were labeled by a solid with a corner that is no number. */
static void solid_with_nan_is_refused(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_box, 0.5, 1);
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *crust, *box = box_mesh(ctx, false, false, 6);
    o.poles.solid = box;
    box->vertices[7] = NAN;
    EXPECT(make_crust(ctx, c.points, c.count, &o, &crust, NULL, NULL) == BRIO_ERR_NOT_FINITE && !crust);
    EXPECT(strstr(brio_message(ctx), "vertex 2 of the solid: y is NaN"), "%s", brio_message(ctx));
    brio_mesh_free(box);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(c.points);
}

/* Rays through corners, along edges and through the diagonals of faces. */
static void winding_numbers_of_lattice_points_are_right(void) {
    brio_context *ctx = new_context();
    for (int kind = 0; kind < 4; kind++) {
        brio_mesh *box = box_mesh(ctx, kind & 1, kind & 2, 6);
        brio_solid solid;
        for (size_t i = 0; i < 3 * box->num_vertices; i++) box->vertices[i] = box->vertices[i] < 0 ? -2 : 2;
        EXPECT(brio_solid_new(ctx, box, &solid) == BRIO_OK, "%s", brio_message(ctx));
        for (int i = 0; i < 343; i++) {
            double p[3] = {i % 7 - 3, i / 7 % 7 - 3, i / 49 - 3}, most = 0;
            for (int k = 0; k < 3; k++) most = fmax(most, fabs(p[k]));
            if (most == 2) continue;
            int expected = most > 2 ? 0 : kind & 2 ? -1 : 1;
            EXPECT(brio_winding_number(&solid, p) == expected, "%g %g %g", p[0], p[1], p[2]);
        }
        brio_solid_free(ctx, &solid);
        brio_mesh_free(box);
    }
    brio_context_free(ctx);
}

/* The crust of a torus as the solid: what is well inside or outside of it is known. */
static void winding_numbers_of_a_curved_mesh_are_right(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.15, 1);
    brio_rng rng = brio_rng_new(7);
    brio_mesh *crust;
    brio_solid solid;
    EXPECT(make_crust(ctx, c.points, c.count, NULL, &crust, NULL, NULL) == BRIO_OK);
    EXPECT(brio_solid_new(ctx, crust, &solid) == BRIO_OK);
    for (int i = 0; i < 2000; i++) {
        double p[3] = {3 * brio_rng_double(&rng) - 1.5, 3 * brio_rng_double(&rng) - 1.5, brio_rng_double(&rng) - 0.5};
        double d = torus_distance(p);
        if (fabs(d) > 0.05) EXPECT(brio_winding_number(&solid, p) == (d < 0), "%g %g %g", p[0], p[1], p[2]);
    }
    brio_solid_free(ctx, &solid);
    brio_mesh_free(crust);
    brio_context_free(ctx);
    free(c.points);
}

/* --- any input --- */

static void small_inputs_have_shapes_and_closed_crusts_or_say_so(void) {
    double p[3 * 40];
    int shapes = 0;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    for (uint64_t trial = 0; trial < 2000; trial += BRIEF_TESTS ? 7 : 1) {
        size_t n = 1 + trial % 40;
        brio_power_shape_options o = {0};
        brio_mesh *shape, *crust;
        brio_certificate certificate = {0};
        o.sides = (brio_sides)(trial / 40 % 3);
        o.scale = trial % 2 ? 1.1 : 1;
        o.redundancy = trial % 5 ? 0.05 : 0;
        if (trial % 3 == 0)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        brio_status status = brio_power_shape(ctx, p, n, &o, &shape, &crust, NULL);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !shape && !crust), "trial %d: %s", (int)trial,
               brio_message(ctx));
        if (status != BRIO_OK) continue;
        shapes++;
        EXPECT(brio_mesh_certificate(ctx, crust, &certificate) == BRIO_OK);
        EXPECT(certificate.closed && certificate.manifold && certificate.oriented, "trial %d", (int)trial);
        for (size_t i = 0; i < 3 * shape->num_vertices; i++) EXPECT(isfinite(shape->vertices[i]));
        brio_certificate_free(&certificate);
        brio_mesh_free(shape);
        brio_mesh_free(crust);
    }
    EXPECT(shapes > (BRIEF_TESTS ? 70 : 500), "%d", shapes);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void wrong_options_are_refused(void) {
    brio_context *ctx = new_context();
    double p[3 * 60];
    sphere_points(3, 60, p);
    for (int kind = 0; kind < 5; kind++) {
        brio_power_shape_options o = {0};
        brio_mesh *shape;
        if (kind == 0) o.scale = 0.5;
        if (kind == 1) o.redundancy = -1;
        if (kind == 2) o.scale = NAN;
        if (kind == 3) o.sides = BRIO_SIDES_END;
        if (kind == 4) o.poles.labeling = BRIO_LABELING_END;
        EXPECT(brio_power_shape(ctx, p, 60, &o, &shape, NULL, NULL) == BRIO_ERR_ARGUMENT && !shape, "%d", kind);
    }
    brio_context_free(ctx);
}

typedef struct {
    int left; /* calls until the one that cancels */
    double last;
} canceller;

static int cancel_later(const char *stage, double fraction, void *user) {
    canceller *c = user;
    EXPECT(fraction >= c->last && fraction <= 1, "%s: %g after %g", stage, fraction, c->last);
    c->last = fraction;
    return c->left-- == 0;
}

/* At every call of the progress function, which never goes back. */
static void work_can_be_cancelled_at_any_time(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_box, 0.2, 1);
    brio_mesh *box = box_mesh(ctx, false, false, 6), *shape, *crust, *offset;
    brio_power_shape_options medial = {0};
    brio_surface_options surface = OFFSET_OPTIONS;
    size_t held = brio_context_memory(ctx);
    medial.poles.solid = surface.poles.solid = box;
    medial.redundancy = 0.01;
    surface.simplify = 1;
    for (int kind = 0; kind < 2; kind++) {
        brio_status status = BRIO_ERR_CANCELLED;
        int calls = 0;
        for (; status == BRIO_ERR_CANCELLED && calls < 500; calls += BRIEF_TESTS ? 1 + calls / 5 : 1) {
            canceller at = {calls, 0};
            brio_context_set_progress(ctx, cancel_later, &at);
            status = kind ? make_offset(ctx, c.points, c.count, 0.1, &surface, &offset, NULL)
                          : brio_power_shape(ctx, c.points, c.count, &medial, &shape, &crust, NULL);
            if (status != BRIO_OK) EXPECT(status == BRIO_ERR_CANCELLED && brio_context_memory(ctx) == held);
        }
        EXPECT(status == BRIO_OK && calls > 5, "%d calls", calls);
        held = brio_context_memory(ctx);
    }
    brio_mesh_free(shape);
    brio_mesh_free(crust);
    brio_mesh_free(offset);
    brio_mesh_free(box);
    brio_context_free(ctx);
    free(c.points);
}

static brio_status small_shape(brio_context *ctx) {
    double p[3 * 60];
    brio_mesh *shape, *crust;
    brio_power_shape_options o = {0};
    sphere_points(3, 60, p);
    o.redundancy = 0.01;
    brio_status status = brio_power_shape(ctx, p, 60, &o, &shape, &crust, NULL);
    brio_mesh_free(shape);
    brio_mesh_free(crust);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_shape);
}

SUITE(test_medial) {
    RUN(shape_is_the_dual_between_inner_poles);
    RUN(radii_are_distances_to_samples_and_sides_are_told);
    RUN(shuffled_samples_give_the_same_shape);
    RUN(crust_of_all_balls_is_the_power_crust);
    RUN(cover_is_what_brute_force_finds);
    RUN(simplification_takes_the_noise_of_a_sphere_away);
    RUN(scale_axis_is_what_a_union_by_brute_force_finds);
    RUN(a_ball_that_fills_a_void_is_kept);
    RUN(scale_axis_takes_the_noise_of_a_sphere_away);
    RUN(poles_of_a_known_box_are_labeled_by_where_they_are);
    RUN(points_within_a_larger_solid_have_closed_crusts);
    RUN(poles_that_are_kept_keep_what_is_theirs);
    RUN(open_mesh_is_no_solid);
    RUN(solid_with_nan_is_refused);
    RUN(winding_numbers_of_lattice_points_are_right);
    RUN(winding_numbers_of_a_curved_mesh_are_right);
    RUN(small_inputs_have_shapes_and_closed_crusts_or_say_so);
    RUN(wrong_options_are_refused);
    RUN(work_can_be_cancelled_at_any_time);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
