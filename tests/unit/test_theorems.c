/* Lemmas and theorems of [Choi 2003] that no other suite holds anything against: docs/thesis-theorems.md lists all. */
#include "iso/iso_surface.h"
#include "known_balls.h"
#include "surface_calls.h"
#include "order/order.h"
#include "query/nearest_points.h"
#include "trial.h"
#include <string.h>

static const double PI = 3.141592653589793;

static void difference(const double *a, const double *b, double *d) {
    for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The angle between two vectors, from 0 to pi. */
static double angle_of(const double *a, const double *b) {
    return acos(fmax(-1, fmin(1, dot(a, b) / sqrt(dot(a, a) * dot(b, b)))));
}

/* --- chapter 4 --- */

/* A value of its own for each node of the grid, 0 to 1, and outside on the border. */
static double noise(const double *p, const void *user) {
    uint64_t hash = *(const uint64_t *)user;
    bool border = false;
    for (int k = 0; k < 3; k++) {
        hash = brio_mix(hash + (uint64_t)(int64_t)floor(p[k] + 0.5));
        border |= p[k] < 0.5 || p[k] > 13.5;
    }
    return border ? 1 : (double)(hash >> 11) * 0x1p-53 - 0.5;
}

/* Lemma 12: an edge of the grid is in four cubes at most, and the loop in each is triangulated, so that no vertex has more
 * than 24 edges. (Cubes are cut into tetrahedra here, so that an edge is in six of them at most, with a triangle or a
 * quadrangle in each.) Noise has every case. */
static void lemma_12_isosurfaces_have_bounded_degree(void) {
    brio_context *ctx = new_context();
    for (uint64_t seed = 1; seed <= 4; seed++) {
        brio_implicit_grid grid = {.value = noise, .user = &seed, .cell = 1, .cells = {14, 14, 14}};
        brio_mesh *mesh;
        uint32_t most = 0;
        brio_status status =
            seed % 2 ? brio_marched_surface(ctx, &grid, &mesh) : brio_conforming_surface(ctx, &grid, &mesh);
        EXPECT(status == BRIO_OK && mesh->num_faces > 1000, "%s", brio_message(ctx));
        uint32_t *degree = calloc(mesh->num_vertices, sizeof *degree);
        for (uint64_t i = 0; i < mesh->face_offsets[mesh->num_faces]; i++) degree[mesh->face_vertices[i]]++;
        for (size_t v = 0; v < mesh->num_vertices; v++) most = degree[v] > most ? degree[v] : most;
        EXPECT(most > 8 && most <= 24, "seed %d: a vertex of %u faces among %zu", (int)seed, most, mesh->num_vertices);
        free(degree);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

/* --- chapter 5 --- */

enum { FEW = 256, SEEDS = 3000, TRIGGERS = 4, FIRST_STOPPER = 16 };

static double few[3 * FEW];

static void order_few(brio_context *ctx, int order, double ratio, uint64_t seed, uint32_t *to) {
    trial_options o = {0};
    brio_input input = {few, NULL, FEW};
    o.order = order, o.seed = seed, o.block_size = 4, o.round_ratio = ratio;
    EXPECT(trial_order(ctx, &input, &o, to, NULL, NULL, NULL) == BRIO_OK);
}

/* In what share of the orders all triggers come before all s stoppers: so often a tetrahedron with these appears. The
 * triggers lead the path through space, which is the worst for the bound. */
static double share_that_appear(int order, double ratio, uint32_t s) {
    brio_context *ctx = new_context();
    uint32_t path[FEW], at[FEW], place[FEW];
    int appear = 0;
    order_few(ctx, TRIAL_OCTREE, 0, 1, path);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        order_few(ctx, order, ratio, seed, at);
        for (uint32_t i = 0; i < FEW; i++) place[at[i]] = i;
        uint32_t last = 0, first = FEW;
        for (uint32_t i = 0; i < TRIGGERS; i++) last = place[path[i]] > last ? place[path[i]] : last;
        for (uint32_t i = 0; i < s; i++) {
            uint32_t stopper = path[FIRST_STOPPER + i * ((FEW - FIRST_STOPPER) / s)];
            first = place[stopper] < first ? place[stopper] : first;
        }
        appear += last < first;
    }
    brio_context_free(ctx);
    return (double)appear / SEEDS;
}

/* The share in an order that is random: 4! s! / (s + 4)!. */
static double share_at_random(double s) {
    return 24 / ((s + 1) * (s + 2) * (s + 3) * (s + 4));
}

/* Lemma 16, with the constant of its proof: 2^4 times the share of a random order for rounds that double, q^-4 for rounds of
 * ratio q. Rounds of an eighth pass the first bound, and keep the second; one round passes every bound. */
static void lemma_16_appearance_falls_with_the_fourth_power(void) {
    uniform_points(9, FEW, few);
    for (uint32_t s = 4; s <= 16; s *= 2) {
        double noise = 3 / sqrt((double)SEEDS), bound = share_at_random(s);
        double half = share_that_appear(TRIAL_BRIO_OCTREE, 0.5, s);
        double eighth = share_that_appear(TRIAL_BRIO_OCTREE, 0.125, s);
        double one = share_that_appear(TRIAL_OCTREE, 0, s), random = share_that_appear(BRIO_ORDER_RANDOM, 0, s);
        EXPECT(fabs(random - bound) <= noise * sqrt(bound) + 1e-3, "%u stoppers: %g at random, %g", s, random, bound);
        EXPECT(half > random && half <= 16 * bound + noise * sqrt(16 * bound), "%u stoppers: %g of %g", s, half,
               16 * bound);
        EXPECT(eighth <= 4096 * bound && one == 1, "%u stoppers: %g of %g, %g in one round", s, eighth, 4096 * bound,
               one);
        if (s == 16) EXPECT(eighth > 16 * bound, "%g, under the constant of rounds that double", eighth);
    }
}

/* K_s for each s: the tetrahedra of four of the points that have at most s others in their spheres. */
static void count_stoppers(const double *p, size_t n, double *most) {
    for (size_t s = 0; s < n; s++) most[s] = 0;
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < a; b++)
            for (size_t c = 0; c < b; c++)
                for (size_t d = 0; d < c; d++) {
                    const double *v[4] = {p + 3 * a, p + 3 * b, p + 3 * c, p + 3 * d};
                    int side = brio_orient3d(v[0], v[1], v[2], v[3]);
                    size_t s = 0;
                    for (size_t e = 0; e < n; e++)
                        if (e != a && e != b && e != c && e != d)
                            s += brio_insphere(v[0], v[1], v[2], v[3], p + 3 * e, NULL) * side > 0;
                    most[s]++;
                }
    for (size_t s = 1; s < n; s++) most[s] += most[s - 1];
}

/* Lemma 17 in the realistic case: K_s = O(n s^3); on the moment curve K_0 alone is quadratic. */
static void lemma_17_few_tetrahedra_have_few_stoppers(void) {
    double uniform[3 * 36], curve[3 * 36], most[36];
    uniform_points(4, 36, uniform);
    for (size_t i = 0; i < 36; i++)
        for (int k = 0; k < 3; k++) curve[3 * i + (size_t)k] = pow((double)i / 6, k + 1);
    for (size_t n = 18; n <= 36; n += 18) {
        count_stoppers(uniform, n, most);
        for (size_t s = 0; s < n; s++) {
            double bound = 7 * (double)n * pow((double)s + 1, 3);
            EXPECT(most[s] <= bound, "%zu points: %g tetrahedra with %zu stoppers, at most %g", n, most[s], s, bound);
        }
    }
    count_stoppers(curve, 36, most);
    EXPECT(most[0] > 7 * 36, "%g tetrahedra on the curve", most[0]);
}

static double conflicts_a_point(size_t n, int order, bool sorted) {
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    trial_options o = {0};
    brio_laboratory *lab;
    double *p = malloc(3 * n * sizeof *p);
    uniform_points(1, n, p);
    for (size_t i = 0; i < n && sorted; i++) p[3 * i] = (double)i;
    o.order = order, o.locate = BRIO_LOCATION_HISTORY, o.all_conflicts = 1, o.block_size = 200;
    EXPECT(trial_delaunay(ctx, p, NULL, n, &o, &t, &lab) == BRIO_OK);
    double conflicts = (double)brio_laboratory_results(lab)->history_conflicts / (double)n;
    brio_laboratory_free(lab);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    free(p);
    return conflicts;
}

/* Theorem 18 for X(n), the total conflict size: O(n log n) for a BRIO, as for a random order. */
static void theorem_18_conflicts_grow_as_n_log_n(void) {
    double brio[3], random[3];
    for (int i = 0; i < 3; i++) {
        size_t n = (size_t)(SHORT_TESTS ? 250 : 500) << (2 * i);
        brio[i] = conflicts_a_point(n, TRIAL_BRIO_OCTREE, false);
        random[i] = conflicts_a_point(n, BRIO_ORDER_RANDOM, false);
        EXPECT(brio[i] < 1.5 * random[i] && brio[i] > 0.7 * random[i], "%g, %g in random order", brio[i], random[i]);
    }
    EXPECT(brio[2] - brio[1] < 1.4 * (brio[1] - brio[0]), "%g, %g, %g a point", brio[0], brio[1], brio[2]);
    double sorted = conflicts_a_point(2000, BRIO_ORDER_INPUT, true);
    EXPECT(sorted > 4 * brio[1], "%g a point in sorted order", sorted);
}

/* --- appendix A --- */

/* Lemma 21: a point y of the surface in the cell of sample p is seen from p at more than pi / 2 - r from the normal. */
static void check_restricted_cells(const known_surface *surface, double r) {
    brio_context *ctx = new_context();
    brio_point_tree tree;
    size_t n, m;
    double *points = surface->sample(r, 1, &n), *places = surface->sample(r / 3, 2, &m), widest = 0;
    EXPECT(brio_point_tree_new(ctx, points, n, &tree) == BRIO_OK);
    for (size_t i = 0; i < m; i++) {
        brio_near_point near[BRIO_NEAR_ROOM];
        double normal[3], way[3];
        EXPECT(brio_nearest_points(&tree, places + 3 * i, 1, INFINITY, near) == 1);
        const double *p = points + 3 * (size_t)tree.index[near[0].place];
        if (near[0].square == 0) continue;
        surface->normal(p, normal);
        difference(places + 3 * i, p, way);
        widest = fmax(widest, fabs(PI / 2 - angle_of(way, normal)));
    }
    EXPECT(widest < r && widest > 0.1 * r, "lemma 21: %g off the tangent plane, at most %g", widest, r);
    brio_point_tree_free(ctx, &tree);
    brio_context_free(ctx);
    free(points), free(places);
}

static void lemma_21_restricted_cells_are_flat(void) {
    check_restricted_cells(&known_sphere, 0.08);
    check_restricted_cells(&known_torus, 0.08);
}

static void normal_of(const double *const v[3], double *normal) {
    double a[3], b[3];
    difference(v[1], v[0], a), difference(v[2], v[0], b);
    for (int k = 0; k < 3; k++) normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The nearest point of the surface, for a point that is near it: one step along the gradient of the distance, twice. */
static void onto(const known_surface *surface, const double *q, double *x) {
    memcpy(x, q, 3 * sizeof *x);
    for (int i = 0; i < 2; i++) {
        double gradient[3], value = surface->value(x), step = 1e-6;
        for (int k = 0; k < 3; k++) {
            double to[3] = {x[0], x[1], x[2]}, back[3] = {x[0], x[1], x[2]};
            to[k] += step, back[k] -= step;
            gradient[k] = (surface->value(to) - surface->value(back)) / (2 * step);
        }
        for (int k = 0; k < 3; k++) x[k] -= value * gradient[k];
    }
}

/* Lemma 28: the normal of a triangle is within 42 degrees of the surface's at the point nearest to each point of it. Property
 * I: two triangles at a vertex meet at more than a right angle: their normals, on the same side, differ by less. */
static void lemma_28_and_property_1_hold_on_the_cocone(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    size_t n;
    double *points = known_torus.sample(0.08, 1, &n), steepest = 0, widest = 0;
    EXPECT(make_cocone(ctx, points, n, NULL, &mesh, NULL) == BRIO_OK);
    double *seen = calloc(3 * n, sizeof *seen); /* a normal at each vertex */
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *at = mesh->face_vertices + 3 * f;
        const double *v[3] = {points + 3 * (size_t)at[0], points + 3 * (size_t)at[1], points + 3 * (size_t)at[2]};
        double normal[3], true_normal[3], q[3], x[3];
        normal_of(v, normal);
        for (int i = 0; i < 10; i++) {
            double a = (i % 4) / 3.0, b = (i / 4) / 3.0 * (1 - a);
            for (int k = 0; k < 3; k++) q[k] = (1 - a - b) * v[0][k] + a * v[1][k] + b * v[2][k];
            onto(&known_torus, q, x);
            known_torus.normal(x, true_normal);
            steepest = fmax(steepest, angle_of(normal, true_normal));
        }
        for (int i = 0; i < 3; i++) {
            double *other = seen + 3 * (size_t)at[i];
            if (dot(other, other) > 0) widest = fmax(widest, angle_of(other, normal));
            memcpy(other, normal, sizeof normal);
        }
    }
    EXPECT(steepest > 0.01 && steepest <= 42 * PI / 180, "lemma 28: %g", steepest);
    EXPECT(widest > 0.01 && widest < PI / 2, "property I: %g", widest);
    free(seen), free(points);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Whether a triangle meets the open segment from p to q. */
static bool meets(const double *const v[3], const double *p, const double *q) {
    int a = brio_orient3d(v[0], v[1], v[2], p), b = brio_orient3d(v[0], v[1], v[2], q);
    if (a * b >= 0) return false;
    int side[3];
    for (int k = 0; k < 3; k++) side[k] = brio_orient3d(v[k], v[(k + 1) % 3], p, q);
    return (side[0] >= 0 && side[1] >= 0 && side[2] >= 0) || (side[0] <= 0 && side[1] <= 0 && side[2] <= 0);
}

/* Lemma 31 and corollary 32: no candidate meets the open segment from a sample to the centre of its medial ball, which on the
 * torus of radii 1 and 1/2 is half along the inner normal. */
static void lemma_31_candidates_leave_the_normals_of_samples_free(void) {
    brio_context *ctx = new_context();
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    size_t n, tried = 0, met = 0, beyond = 0;
    double *points = known_torus.sample(0.08, 1, &n);
    brio_laboratory *lab;
    EXPECT(brio_laboratory_new(ctx, &(brio_laboratory_options){.extraction = BRIO_EXTRACTION_CANDIDATES}, &lab) ==
           BRIO_OK);
    EXPECT(make_cocone(ctx, points, n, &o, &mesh, NULL) == BRIO_OK);
    brio_laboratory_free(lab);
    for (size_t s = 0; s < n; s += 601, tried++) {
        const double *p = points + 3 * s;
        double normal[3], centre[3], through[3];
        known_torus.normal(p, normal);
        for (int k = 0; k < 3; k++) centre[k] = p[k] - 0.5 * normal[k], through[k] = p[k] - 1.2 * normal[k];
        for (size_t f = 0; f < mesh->num_faces; f++) {
            const uint32_t *at = mesh->face_vertices + 3 * f;
            const double *v[3] = {points + 3 * (size_t)at[0], points + 3 * (size_t)at[1], points + 3 * (size_t)at[2]};
            met += meets(v, p, centre);
            beyond += meets(v, p, through); /* to the other side of the tube: there are candidates */
        }
    }
    EXPECT(tried > 10 && met == 0 && beyond >= tried, "%zu of %zu segments met, %zu beyond", met, tried, beyond);
    free(points);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* --- appendix B, on the torus of radii 1 and 1/2, whose medial axis is the circle within and the axis of revolution --- */

static void nearest_of_circle(const double *c, double *m) {
    double far = sqrt(c[0] * c[0] + c[1] * c[1]);
    m[0] = c[0] / far, m[1] = c[1] / far, m[2] = 0;
}

/* Corollary 37: every polar ball holds a point of the medial axis. Outside, that is the axis of revolution, which only the
 * balls of samples round the hole are bounded by; the others reach to infinity. Observation 44: a ball at distance k from a
 * point of the surface has a radius of (LFS - k) / 2 at least; with k = 0 at its sample, LFS / 2. */
static void check_size_of_balls(const theory *x) {
    size_t tried = 0;
    for (size_t s = 0; s < 2 * x->n; s++) {
        uint32_t p = x->poles.of_sample[s];
        const double *c = x->poles.centre + 3 * (size_t)p, *at = x->points + 3 * (s / 2);
        double m[3], square = c[0] * c[0] + c[1] * c[1]; /* of the distance to the axis of revolution */
        EXPECT(sqrt(x->poles.square[p]) >= x->surface->feature_size / 2, "observation 44 at pole %u", p);
        if (x->truth[p] == BRIO_LABEL_INNER) {
            nearest_of_circle(c, m);
            square = square_between(c, m);
        } else if (at[0] * at[0] + at[1] * at[1] > 0.8)
            continue;
        EXPECT(square <= x->poles.square[p], "corollary 37 at pole %u", p);
        tried++;
    }
    EXPECT(tried > x->n);
}

/* Lemma 39: an outer polar ball and an inner medial ball meet at 2 arcsin 2 r at most. */
static void check_medial_balls(const theory *x) {
    double widest = 0, rho = 0.5;
    for (size_t p = 0; p < x->poles.count; p++) {
        double m[3], R = sqrt(x->poles.square[p]);
        if (x->truth[p] == BRIO_LABEL_INNER) continue;
        nearest_of_circle(x->poles.centre + 3 * p, m);
        double apart = sqrt(square_between(x->poles.centre + 3 * p, m));
        if (apart >= R + rho || apart <= fabs(R - rho)) continue;
        widest = fmax(widest, PI - acos((R * R + rho * rho - apart * apart) / (2 * R * rho)));
    }
    EXPECT(widest > 0 && widest <= 2 * asin(2 * x->r), "lemma 39: %g, at most %g", widest, 2 * asin(2 * x->r));
}

/* Along normals: lemma 42 where balls of both sides hold a point, with the 2 r LFS of its proof; theorem 43 at the end of the
 * union of each side, with the 2 r / (1 - r) LFS of lemmas 40 and 42. Returns the largest angle of lemma 45 and theorem 46,
 * between the normal and the way to the centre of the ball where a union ends. */
static double check_unions(const theory *x) {
    double lfs = x->surface->feature_size, reach = 2 * x->r / (1 - x->r) * lfs, widest = 0, deepest = 0;
    size_t n;
    double *places = x->surface->sample(0.5, 5, &n);
    for (size_t i = 0; i < n; i++) {
        double end[2], normal[3];
        x->surface->normal(places + 3 * i, normal);
        for (int side = 0; side < 2; side++) {
            double way[3], u[3], best = INFINITY;
            for (int k = 0; k < 3; k++) way[k] = side ? -normal[k] : normal[k];
            size_t count;
            interval *cut = cut_line(x, side ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER, places + 3 * i, way, &count);
            end[side] = -0.5 * lfs;
            for (size_t c = 0; c < count && cut[c].from <= end[side]; c++) end[side] = fmax(end[side], cut[c].to);
            free(cut);
            EXPECT(fabs(end[side]) <= reach, "theorem 43: a union ends %g away, at most %g", end[side], reach);
            for (int k = 0; k < 3; k++) u[k] = places[3 * i + (size_t)k] + end[side] * way[k];
            for (size_t p = 0; p < x->poles.count; p++) {
                double power = fabs(square_between(u, x->poles.centre + 3 * p) - x->poles.square[p]), to[3];
                if (x->truth[p] != (side ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER) || power >= best) continue;
                best = power;
                difference(u, x->poles.centre + 3 * p, to);
                if (power < 1e-9) widest = fmax(widest, angle_of(to, way));
            }
        }
        deepest = fmax(deepest, end[0] + end[1]); /* the unions overlap from -end[1] to end[0] */
    }
    EXPECT(deepest > 0 && deepest <= 2 * 2 * x->r * lfs, "lemma 42: %g", deepest);
    free(places);
    return widest;
}

static double power_of(const theory *x, uint32_t pole, const double *u) {
    return square_between(u, x->poles.centre + 3 * (size_t)pole) - x->poles.square[pole];
}

/* The most that a point at distance d from a sample is away from ball `pole` of the sample, if it is in neither of the
 * two: with u, v the directions to the centres, at an angle of pi - a, its own direction is at most
 * pi / 2 + a + arcsin (d / 2 R) from that to the ball's, R being the radius of the other one. */
static double farthest_from_ball(const theory *x, const double *sample, uint32_t pole, uint32_t other, double d) {
    double rho = sqrt(x->poles.square[pole]), large = sqrt(x->poles.square[other]), u[3], v[3];
    difference(sample, x->poles.centre + 3 * (size_t)pole, u);
    difference(sample, x->poles.centre + 3 * (size_t)other, v);
    double turn = fmin(PI / 2, PI - angle_of(u, v) + asin(fmin(1, d / (2 * large))));
    return sqrt(rho * rho + d * d + 2 * rho * d * sin(turn)) - rho;
}

/* Lemmas 50 and 51 for points u on normals, as far as theorem 43 lets unions end: of points in no ball the distance from
 * the smaller ball of their sample, and of points in no ball of that ball's side that from the ball of it of least power.
 * Both are held against what their proofs come to for the angle at which the balls of the sample meet. Returns the largest
 * distances in r^2 LFS^2 / rho and in r LFS. */
static void check_nearest_balls(const theory *x, double worst[2]) {
    double lfs = x->surface->feature_size, reach = 2 * x->r / (1 - x->r) * lfs;
    size_t n, tried[2] = {0, 0};
    double *places = x->surface->sample(0.5, 5, &n);
    worst[0] = worst[1] = 0;
    for (size_t i = 0; i < 41 * n; i++) {
        double normal[3], u[3], least[2] = {INFINITY, INFINITY}, nearest = INFINITY;
        uint32_t best[2] = {0, 0}, of[2];
        size_t s = 0;
        const double *place = places + 3 * (i / 41);
        x->surface->normal(place, normal);
        for (int k = 0; k < 3; k++) u[k] = place[k] + reach * ((double)(i % 41) / 20 - 1) * normal[k];
        for (uint32_t p = 0; p < x->poles.count; p++) {
            int side = x->truth[p] == BRIO_LABEL_INNER;
            double power = power_of(x, p, u);
            if (power < least[side]) least[side] = power, best[side] = p;
        }
        for (size_t q = 0; q < x->n; q++) {
            double square = square_between(place, x->points + 3 * q);
            if (square < nearest) nearest = square, s = q;
        }
        double d = sqrt(square_between(u, x->points + 3 * s));
        for (int k = 0; k < 2; k++)
            of[x->truth[x->poles.of_sample[2 * s + (size_t)k]] == BRIO_LABEL_INNER] =
                x->poles.of_sample[2 * s + (size_t)k];
        if (least[0] > 0 && least[1] > 0) {
            int small = x->poles.square[of[1]] < x->poles.square[of[0]];
            double rho = sqrt(x->poles.square[of[small]]), away = sqrt(power_of(x, of[small], u) + rho * rho) - rho;
            double most = farthest_from_ball(x, x->points + 3 * s, of[small], of[!small], d);
            EXPECT(away <= most * (1 + 1e-9), "lemma 50: %g, at most %g", away, most);
            worst[0] = fmax(worst[0], away * rho / (x->r * x->r * lfs * lfs));
            tried[0]++;
        }
        for (int side = 0; side < 2; side++) {
            if (least[side] <= 0 || x->poles.square[of[side]] > x->poles.square[of[!side]]) continue;
            double R = sqrt(x->poles.square[best[side]]), away = sqrt(least[side] + R * R) - R;
            double own = power_of(x, of[side], u);
            EXPECT(away <= sqrt(own) * (1 + 1e-9), "lemma 51: %g, at most %g", away, sqrt(own));
            worst[1] = fmax(worst[1], away / (x->r * lfs));
            tried[1]++;
        }
    }
    EXPECT(tried[0] > 0 && tried[1] > n, "%zu points in no ball, %zu in none of a side", tried[0], tried[1]);
    free(places);
}

/* Lemma 53: a normal crosses the crust once. */
static void check_normals(const theory *x) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh;
    size_t n, tried = 0, not_once = 0;
    double *places = x->surface->sample(0.5, 5, &n);
    o.polygons = 0;
    EXPECT(make_crust(x->ctx, x->points, x->n, &o, &mesh, NULL, NULL) == BRIO_OK);
    for (size_t i = 0; i < n; i += 16, tried++) {
        double normal[3], from[3], to[3];
        size_t crossed = 0;
        x->surface->normal(places + 3 * i, normal);
        for (int k = 0; k < 3; k++)
            from[k] = places[3 * i + (size_t)k] - 0.2 * normal[k], to[k] = from[k] + 0.4 * normal[k];
        for (size_t f = 0; f < mesh->num_faces; f++) {
            const uint32_t *at = mesh->face_vertices + 3 * f;
            const double *v[3] = {mesh->vertices + 3 * (size_t)at[0], mesh->vertices + 3 * (size_t)at[1],
                                  mesh->vertices + 3 * (size_t)at[2]};
            crossed += meets(v, from, to);
        }
        not_once += crossed != 1;
    }
    EXPECT(tried > 20 && not_once == 0, "lemma 53: %zu of %zu normals do not cross the crust once", not_once, tried);
    free(places);
    brio_mesh_free(mesh);
}

static void lemmas_37_to_53_hold_for_polar_balls(void) {
    double widest[2] = {0, 0}, away[2][2];
    for (int i = 0; i < (SHORT_TESTS ? 1 : 2); i++) {
        theory x = theory_new(&known_torus, i ? 0.1 : 0.2);
        check_size_of_balls(&x);
        check_medial_balls(&x);
        widest[i] = check_unions(&x);
        check_normals(&x);
        check_nearest_balls(&x, away[i]);
        /* lemmas 50 and 51: at most so many r^2 LFS^2 / rho and r LFS for any r. (The most was 1.2 and 2.6.) */
        EXPECT(away[i][0] < 12 && away[i][1] < 4, "lemmas 50 and 51 at r = %g: %g, %g", x.r, away[i][0], away[i][1]);
        if (getenv("BRIO_TEST_VERBOSE"))
            fprintf(stderr, "r %g: lemma 50 %g, lemma 51 %g\n", x.r, away[i][0], away[i][1]);
        theory_free(&x);
    }
    /* lemma 45, theorem 46 and observation 52: O(sqrt r), and at most pi / 6 */
    EXPECT(widest[0] > 0 && widest[0] <= PI / 6 && widest[1] <= widest[0], "normals of unions: %g, with half of r %g",
           widest[0], widest[1]);
}

SUITE(test_theorems) {
    RUN(lemma_12_isosurfaces_have_bounded_degree);
    RUN(lemma_16_appearance_falls_with_the_fourth_power);
    RUN(lemma_17_few_tetrahedra_have_few_stoppers);
    RUN(theorem_18_conflicts_grow_as_n_log_n);
    RUN(lemma_21_restricted_cells_are_flat);
    RUN(lemma_28_and_property_1_hold_on_the_cocone);
    RUN(lemma_31_candidates_leave_the_normals_of_samples_free);
    RUN(lemmas_37_to_53_hold_for_polar_balls);
    return harness_end();
}
