/* Unions of balls: volumes and areas against closed forms and against slices; their boundary as a mesh. */
#include "harness.h"
#include "points.h"
#include <math.h>

static const double PI = 3.14159265358979323846;

typedef struct {
    double centre[3 * 512], weight[512], area[512];
    size_t count;
} balls;

static void add_ball(balls *b, double x, double y, double z, double radius) {
    double *c = b->centre + 3 * b->count;
    c[0] = x, c[1] = y, c[2] = z;
    b->weight[b->count++] = radius * radius;
}

static brio_ball_union_stats measure(balls *b) {
    brio_context *ctx = new_context();
    brio_ball_union_stats s = {.size = sizeof s};
    EXPECT(brio_ball_union(ctx, b->centre, b->weight, b->count, NULL, b->area, NULL, &s) == BRIO_OK, "%s",
           brio_message(ctx));
    brio_context_free(ctx);
    return s;
}

/* --- closed forms --- */

static double lens(double r, double s, double d) {
    return PI * (r + s - d) * (r + s - d) * (d * d + 2 * d * (r + s) - 3 * (r - s) * (r - s)) / (12 * d);
}

static double ball_volume(double r) {
    return 4 * PI / 3 * r * r * r;
}

static void expect_near(double is, double wanted, const char *what) {
    EXPECT(fabs(is - wanted) <= 1e-12 * fabs(wanted), "%s: %.17g, %.17g", what, is, wanted);
}

static void one_and_two_balls_have_their_volumes(void) {
    static const double cases[][3] = {{1, 1, 1},    {1, 0.5, 1.2}, {3, 0.1, 3.05},
                                      {1, 1, 1e-3}, {1, 1, 1.999}, {5, 1, 4.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double r = cases[i][0], s = cases[i][1], d = cases[i][2];
        balls b = {.count = 0};
        add_ball(&b, 1, 2, 3, r);
        brio_ball_union_stats one = measure(&b);
        expect_near(one.volume, ball_volume(r), "one");
        expect_near(one.area, 4 * PI * r * r, "area of one");
        EXPECT(one.exposed == 1 && one.patches == 1 && !one.arcs && one.components == 1 && !one.tunnels && !one.voids);
        add_ball(&b, 1 + d * 0.6, 2 - d * 0.8, 3, s);
        brio_ball_union_stats two = measure(&b);
        double x = (d * d + r * r - s * s) / (2 * d);
        expect_near(two.volume, ball_volume(r) + ball_volume(s) - lens(r, s, d), "two");
        expect_near(two.area, 2 * PI * r * (r + x) + 2 * PI * s * (s + d - x), "area of two");
        expect_near(b.area[1], 2 * PI * s * (s + d - x), "area of the second");
        EXPECT(two.arcs == 1 && two.patches == 2 && !two.corners && two.components == 1);
    }
}

/* The intersection of four unit balls about the corners of a regular tetrahedron of side 1 is Reuleaux's. That of three
 * follows from the half of it that the corner of the three spheres cuts off. */
static void four_balls_have_the_volume_of_reuleaux(void) {
    double four = (3 * sqrt(2) - 49 * PI + 162 * atan(sqrt(2))) / 12, tetrahedron = sqrt(2) / 12;
    double dihedral = acos(1.0 / 3), solid = 3 * dihedral - PI, two = lens(1, 1, 1);
    double three = 2 * (tetrahedron - 3 * solid / 3 + 3 * dihedral / (2 * PI) * two);
    balls b = {.count = 0};
    add_ball(&b, 0, 0, 0, 1);
    add_ball(&b, 1, 0, 0, 1);
    add_ball(&b, 0.5, sqrt(3) / 2, 0, 1);
    expect_near(measure(&b).volume, 3 * ball_volume(1) - 3 * two + three, "three");
    add_ball(&b, 0.5, sqrt(3) / 6, sqrt(2.0 / 3), 1);
    expect_near(measure(&b).volume, 4 * ball_volume(1) - 6 * two + 4 * three - four, "four");
}

/* --- slices --- */

typedef struct {
    double from, to;
} interval;

static int by_start(const void *a, const void *b) {
    double p = ((const interval *)a)->from, q = ((const interval *)b)->from;
    return (p > q) - (p < q);
}

/* Marks the angles [from, to] of a circle as covered. */
static void cover(interval *list, size_t *n, double from, double to) {
    while (from < 0) from += 2 * PI, to += 2 * PI;
    while (from >= 2 * PI) from -= 2 * PI, to -= 2 * PI;
    list[(*n)++] = (interval){from, fmin(to, 2 * PI)};
    if (to > 2 * PI) list[(*n)++] = (interval){0, to - 2 * PI};
}

/* Returns the part of the area under an arc, by Green's theorem. */
static double under(double x, double y, double r, double from, double to) {
    return 0.5 * (r * r * (to - from) + r * x * (sin(to) - sin(from)) - r * y * (cos(to) - cos(from)));
}

/* Returns the area of the union of the disks in which a plane z cuts the balls. */
static double slice(const balls *b, double z) {
    double sum = 0;
    for (size_t i = 0; i < b->count; i++) {
        const double *p = b->centre + 3 * i;
        double square = b->weight[i] - (z - p[2]) * (z - p[2]), r = sqrt(fmax(square, 0)), at = 0;
        interval list[1100];
        size_t n = 0;
        bool whole = true;
        if (square <= 0) continue;
        for (size_t j = 0; j < b->count && whole; j++) {
            const double *q = b->centre + 3 * j;
            double other = b->weight[j] - (z - q[2]) * (z - q[2]), x = q[0] - p[0], y = q[1] - p[1], d = hypot(x, y);
            if (j == i || other <= 0) continue;
            double s = sqrt(other);
            if (d + r <= s && (d + s > r || j < i)) whole = false;
            if (d >= r + s || d + r <= s || d + s <= r) continue;
            double half = acos(fmax(-1, fmin(1, (d * d + square - other) / (2 * d * r)))), middle = atan2(y, x);
            cover(list, &n, middle - half, middle + half);
        }
        if (!whole) continue;
        qsort(list, n, sizeof *list, by_start);
        for (size_t k = 0; k < n; k++) {
            if (list[k].from > at) sum += under(p[0], p[1], r, at, list[k].from);
            at = fmax(at, list[k].to);
        }
        if (at < 2 * PI) sum += under(p[0], p[1], r, at, 2 * PI);
    }
    return sum;
}

static int by_value(const void *a, const void *b) {
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* Adds the heights where the slices change their kind: ends of balls and of circles of two, and points of three. */
static size_t find_breaks(const balls *b, double *z) {
    size_t n = 0;
    for (size_t i = 0; i < b->count; i++)
        for (size_t j = i; j < b->count; j++) {
            const double *p = b->centre + 3 * i, *q = b->centre + 3 * j;
            double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, d = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
            if (i == j) {
                z[n++] = p[2] - sqrt(b->weight[i]);
                z[n++] = p[2] + sqrt(b->weight[i]);
                continue;
            }
            double x = (d + (b->weight[i] - b->weight[j]) / d) / 2, square = b->weight[i] - x * x;
            if (square <= 0) continue;
            double centre[3], up[3], down[3], length, c = sqrt(square);
            for (int k = 0; k < 3; k++) u[k] /= d, centre[k] = p[k] + x * u[k];
            for (int k = 0; k < 3; k++) up[k] = (k == 2) - u[2] * u[k];
            length = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
            z[n++] = centre[2] + c * length;
            z[n++] = centre[2] - c * length;
            down[0] = u[1] * up[2] - u[2] * up[1], down[1] = u[2] * up[0] - u[0] * up[2];
            for (size_t k = j + 1; k < b->count; k++) { /* the circle c (cos t up + sin t down) on the sphere k */
                const double *q3 = b->centre + 3 * k;
                down[2] = u[0] * up[1] - u[1] * up[0];
                double e[3] = {centre[0] - q3[0], centre[1] - q3[1], centre[2] - q3[2]};
                double g = b->weight[k] - square - e[0] * e[0] - e[1] * e[1] - e[2] * e[2];
                double f = 2 * c / length * (e[0] * up[0] + e[1] * up[1] + e[2] * up[2]);
                double h = 2 * c / length * (e[0] * down[0] + e[1] * down[1] + e[2] * down[2]);
                double r = hypot(f, h);
                if (fabs(g) >= r) continue;
                double t = atan2(h, f), w = acos(g / r);
                z[n++] = centre[2] + c * cos(t + w) * length;
                z[n++] = centre[2] + c * cos(t - w) * length;
            }
        }
    qsort(z, n, sizeof *z, by_value);
    return n;
}

/* Returns the volume by slices, between breaks by the rule of tanh and sinh, which ends where roots begin do not hurt. */
static double volume_by_slices(const balls *b) {
    static double z[20000];
    size_t n = find_breaks(b, z);
    double sum = 0;
    for (size_t i = 0; i + 1 < n; i++) {
        double half = (z[i + 1] - z[i]) / 2, step = 1.0 / 16;
        if (half < 1e-13) continue;
        for (int k = -52; k <= 52; k++) {
            double t = k * step, e = exp(PI / 2 * sinh(t)), x = (e - 1 / e) / (e + 1 / e);
            double weight = PI / 2 * cosh(t) * 4 / ((e + 1 / e) * (e + 1 / e)) * step;
            sum += half * weight * slice(b, z[i] + half * (1 + x));
        }
    }
    return sum;
}

static void random_balls(balls *b, uint64_t seed, size_t n, double large) {
    brio_rng rng = brio_rng_new(seed);
    b->count = 0;
    for (size_t i = 0; i < n; i++) {
        double p[4];
        for (int k = 0; k < 4; k++) p[k] = brio_rng_double(&rng);
        add_ball(b, p[0], p[1], p[2], large * (0.2 + p[3]));
    }
}

static void random_balls_have_the_volume_of_their_slices(void) {
    static balls b;
    double worst = 0;
    size_t trials = SHORT_TESTS ? 16 : 120, corners = 0, hidden = 0, voids = 0;
    for (uint64_t seed = 1; seed <= trials; seed++) {
        random_balls(&b, seed, 3 + seed % 8, 0.2 + 0.1 * (double)(seed % 4));
        brio_ball_union_stats s = measure(&b);
        double wanted = volume_by_slices(&b);
        worst = fmax(worst, fabs(s.volume - wanted) / wanted);
        EXPECT(fabs(s.volume - wanted) < 1e-9 * wanted, "seed %d: %.15g, %.15g", (int)seed, s.volume, wanted);
        corners += s.corners, hidden += s.balls - s.exposed, voids += s.voids;
    }
    EXPECT(corners > 50 && hidden > 0, "%zu %zu", corners, hidden);
    printf("volumes by slices: %zu sets, %g off at most\n", trials, worst);
    (void)voids;
}

/* The derivative of the volume by a common change of all radii is the area. */
static void the_area_is_what_the_volume_grows_by(void) {
    static balls b, more, less;
    const double step = 1e-5;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        random_balls(&b, seed, 50, 0.1);
        more = less = b;
        for (size_t i = 0; i < b.count; i++) {
            double r = sqrt(b.weight[i]);
            more.weight[i] = (r + step) * (r + step);
            less.weight[i] = (r - step) * (r - step);
        }
        double area = (measure(&more).volume - measure(&less).volume) / (2 * step), sum = 0;
        brio_ball_union_stats s = measure(&b);
        for (size_t i = 0; i < b.count; i++) sum += b.area[i];
        EXPECT(fabs(area - s.area) < 1e-6 * area && fabs(sum - s.area) < 1e-12 * area, "%g %g %g", area, s.area, sum);
    }
}

/* --- the mesh --- */

/* Expects the mesh of a boundary to be closed and manifold, with vertices on their spheres and near the volume. */
static void expect_mesh(balls *b, double error) {
    brio_context *ctx = new_context();
    brio_ball_union_options o = {.size = sizeof o, .error = error};
    brio_ball_union_stats s = {.size = sizeof s};
    brio_certificate c = {.size = sizeof c};
    brio_mesh *mesh = NULL;
    EXPECT(brio_ball_union(ctx, b->centre, b->weight, b->count, &o, b->area, &mesh, &s) == BRIO_OK, "%s",
           brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(c.closed && c.manifold && c.oriented, "%d %d %d", c.closed, c.manifold, c.oriented);
    EXPECT(s.volume - c.volume > -1e-3 * error * s.area && s.volume - c.volume < 1.2 * error * s.area,
           "%.15g %.15g, error times area %g", c.volume, s.volume, error * s.area);
    EXPECT(fabs(s.area - c.area) < 0.2 * s.area, "%g %g", c.area, s.area);
    const brio_property *ball = brio_mesh_face_property(mesh, "ball");
    for (size_t f = 0; f < mesh->num_faces; f++) {
        size_t i = (size_t)brio_property_value(ball, f);
        double middle[3] = {0}, square = 0;
        EXPECT(b->area[i] > 0);
        for (size_t k = 0; k < 3; k++) {
            const double *p = mesh->vertices + 3 * (size_t)mesh->face_vertices[3 * f + k];
            for (size_t d = 0; d < 3; d++) middle[d] += p[d] / 3;
        }
        for (size_t d = 0; d < 3; d++) square += pow(middle[d] - b->centre[3 * i + d], 2);
        double depth = sqrt(b->weight[i]) - sqrt(square);
        EXPECT(depth > -1e-9 && depth < error * 1.0001, "%g", depth);
    }
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void boundaries_are_closed_and_manifold(void) {
    static balls b;
    for (uint64_t seed = 1; seed <= (SHORT_TESTS ? 12 : 60); seed++) {
        random_balls(&b, seed, 1 + seed * 7 % 60, 0.05 + 0.05 * (double)(seed % 4));
        expect_mesh(&b, 0.002);
    }
}

/* A ring of eight balls has a tunnel; a shell of balls about a sphere has a void. */
static void tunnels_and_voids_are_counted(void) {
    static balls b;
    b.count = 0;
    for (int i = 0; i < 8; i++) add_ball(&b, 2 * cos(i * PI / 4), 2 * sin(i * PI / 4), 0, 1);
    brio_ball_union_stats s = measure(&b);
    EXPECT(s.components == 1 && s.tunnels == 1 && s.voids == 0, "%zu %zu %zu", s.components, s.tunnels, s.voids);
    expect_mesh(&b, 0.01);
    b.count = 0;
    for (int i = 0; i < 200; i++) {
        double z = (i + 0.5) / 100 - 1, t = i * 2.399963, r = sqrt(1 - z * z);
        add_ball(&b, 3 * r * cos(t), 3 * r * sin(t), 3 * z, 0.7);
    }
    s = measure(&b);
    EXPECT(s.components == 1 && s.tunnels == 0 && s.voids == 1, "%zu %zu %zu", s.components, s.tunnels, s.voids);
    expect_mesh(&b, 0.01);
}

/* A big ball with many small ones on it: a patch with many holes. */
static void patches_with_many_holes_are_closed(void) {
    static balls b;
    b.count = 0;
    add_ball(&b, 0, 0, 0, 3);
    for (int i = 0; i < 60; i++) {
        double z = (i + 0.5) / 30 - 1, t = i * 2.399963, r = sqrt(1 - z * z);
        add_ball(&b, 3 * r * cos(t), 3 * r * sin(t), 3 * z, 0.2);
    }
    brio_ball_union_stats s = measure(&b);
    EXPECT(s.patches == 61 && s.arcs == 60 && !s.corners && s.components == 1 && !s.voids && !s.tunnels);
    expect_mesh(&b, 0.01);
}

/* --- edges of what there is --- */

static void balls_of_no_weight_are_none(void) {
    balls b = {.count = 0};
    brio_context *ctx = new_context();
    add_ball(&b, 0, 0, 0, 1);
    add_ball(&b, 9, 0, 0, 0);
    add_ball(&b, 5, 5, 5, 1);
    b.weight[2] = -1;
    brio_ball_union_stats s = measure(&b);
    EXPECT(s.balls == 1 && s.components == 1 && b.area[1] == 0 && b.area[2] == 0);
    EXPECT(brio_ball_union(ctx, b.centre, b.weight + 1, 1, NULL, NULL, NULL, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(brio_ball_union(ctx, b.centre, b.weight, 0, NULL, NULL, NULL, NULL) == BRIO_ERR_NO_ANSWER);
    b.weight[0] = INFINITY;
    EXPECT(brio_ball_union(ctx, b.centre, b.weight, 1, NULL, NULL, NULL, NULL) == BRIO_ERR_NOT_FINITE);
    b.weight[0] = 1, b.centre[0] = NAN;
    EXPECT(brio_ball_union(ctx, b.centre, b.weight, 1, NULL, NULL, NULL, NULL) == BRIO_ERR_NOT_FINITE);
    brio_context_free(ctx);
}

/* Equal balls in a grid meet in ties of eight, and copies of a ball count once. */
static void grids_and_copies_are_measured(void) {
    static balls b;
    b.count = 0;
    for (int i = 0; i < 125; i++) add_ball(&b, i % 5, i / 5 % 5, i / 25, sqrt(3) / 2);
    brio_ball_union_stats grid = measure(&b);
    for (int i = 0; i < 125; i++) add_ball(&b, i % 5, i / 5 % 5, i / 25, sqrt(3) / 2);
    brio_ball_union_stats twice = measure(&b);
    EXPECT(fabs(grid.volume - twice.volume) < 1e-12 * grid.volume, "%.17g %.17g", grid.volume, twice.volume);
    b.count = 125;
    for (int i = 0; i < 125; i++) b.weight[i] = 0.25; /* touching */
    brio_ball_union_stats touching = measure(&b);
    expect_near(touching.volume, 125 * PI / 6, "touching");
    expect_mesh(&b, 0.01);
    for (int i = 0; i < 125; i++) b.weight[i] = 0.75; /* eight meet in a point */
    expect_mesh(&b, 0.01);
}

/* The same balls in other units. */
static void units_do_not_matter(void) {
    static balls b;
    for (int e = -300; e <= 300; e += 150) {
        random_balls(&b, 3, 40, 0.15);
        double volume = measure(&b).volume;
        for (size_t i = 0; i < b.count; i++) {
            b.weight[i] = ldexp(b.weight[i], 2 * e);
            for (size_t k = 0; k < 3; k++) b.centre[3 * i + k] = ldexp(b.centre[3 * i + k], e);
        }
        EXPECT(measure(&b).volume == ldexp(volume, 3 * e));
    }
}

SUITE(test_ball_union) {
    RUN(one_and_two_balls_have_their_volumes);
    RUN(four_balls_have_the_volume_of_reuleaux);
    RUN(random_balls_have_the_volume_of_their_slices);
    RUN(the_area_is_what_the_volume_grows_by);
    RUN(boundaries_are_closed_and_manifold);
    RUN(tunnels_and_voids_are_counted);
    RUN(patches_with_many_holes_are_closed);
    RUN(balls_of_no_weight_are_none);
    RUN(grids_and_copies_are_measured);
    RUN(units_do_not_matter);
    return harness_end();
}
