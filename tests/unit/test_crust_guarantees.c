/* The guarantees of the power crust [Choi 2003, appendix B] on r-samples of surfaces whose local feature size is known:
 * sphere, torus, and a plate of genus 3. */
#include "harness.h"
#include "known_balls.h"
#include "query/nearest_points.h"
#include "points.h"
#include "surface_calls.h"
#include "laboratory/laboratory.h"
#include "mesh/closest_point.h"

/* Inner and outer balls meet at less than a right angle up to r = 0.235 (lemma 38), and labels are right up to there. */
static const double SPARSE = 0.22;
/* A crust vertex between nearly flat cells loses digits: half of them may go. */
static const double ROUNDING = 1e-8;

typedef brio_status (*label_fn)(const brio_pole_graph *, uint8_t *, brio_labeling_stats *);

/* The angle at which two balls intersect, 0 where they do not. */
static double angle_between(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    return acos(fmin(1, fmax(-1, -brio_ball_weight(g->diagram->poles, p, q))));
}

/* Lemma 38, for the two balls of each sample and for all that share a face of the power diagram. */
static void check_intersections(const theory *x, const brio_pole_graph *g) {
    double limit = 2 * asin(3 * x->r), widest = 0;
    for (uint32_t p = 0; p < x->poles.count; p++)
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
            if (g->edge[e].weight >= 0 && x->truth[p] != x->truth[g->edge[e].node])
                widest = fmax(widest, angle_between(g, p, g->edge[e].node));
    for (size_t s = 0; s < x->n; s++) {
        uint32_t p = x->poles.of_sample[2 * s], q = x->poles.of_sample[2 * s + 1];
        EXPECT(p != BRIO_NO_POLE && q != BRIO_NO_POLE && x->truth[p] != x->truth[q], "the poles of sample %zu", s);
        if (p != BRIO_NO_POLE && q != BRIO_NO_POLE) widest = fmax(widest, angle_between(g, p, q));
    }
    EXPECT(widest > 0 && widest <= limit, "angle %g, at most %g", widest, limit);
}

/* Lemma 36: the balls of a sample intersect at O(r) LFS / rho. With the proof's steps: their circle has radius at most
 * r LFS(x) <= r / (1 - r) LFS(s) for the point x of the surface between their centres, and either ball makes an angle of
 * at most asin (radius / rho) with the circle's plane, rho being the radius of the smaller one. */
static void check_balls_of_samples(const theory *x, const brio_pole_graph *g) {
    double widest = 0;
    for (size_t s = 0; s < x->n; s++) {
        uint32_t p = x->poles.of_sample[2 * s], q = x->poles.of_sample[2 * s + 1];
        double rho = sqrt(fmin(x->poles.square[p], x->poles.square[q])), angle = angle_between(g, p, q);
        double limit = 2 * asin(x->r / (1 - x->r) * x->surface->feature_size / rho);
        EXPECT(angle <= limit, "lemma 36 at sample %zu: %g, at most %g", s, angle, limit);
        widest = fmax(widest, angle / limit);
    }
    EXPECT(widest > 0.1, "the limit is %g times too wide to tell anything", 1 / widest);
}

static size_t nearest_sample(const brio_point_tree *tree, const double *u) {
    brio_near_point near[BRIO_NEAR_ROOM];
    return brio_nearest_points(tree, u, 1, INFINITY, near) ? tree->index[near[0].place] : SIZE_MAX;
}

/* Lemma 40: a point of the cell of a sample that is in neither polar ball is within 2 r' LFS of the sample,
 * r' = r / (1 - r); the proof needs 3 asin r' < pi / 6, r < 0.147. Points are tried on 64 rays from each sample, at and
 * beyond that distance. */
static void check_points_outside_balls(const theory *x) {
    double limit = 2 * x->r / (1 - x->r) * x->surface->feature_size;
    size_t tried = 0, bare = 0;
    brio_point_tree tree;
    brio_rng rng = brio_rng_new(3);
    EXPECT(brio_point_tree_new(x->ctx, x->points, x->n, &tree) == BRIO_OK);
    for (size_t i = 0; i < 64 * x->n; i++) {
        const double *s = x->points + 3 * (i / 64);
        double z = 2 * brio_rng_double(&rng) - 1, a = 6.283185307179586 * brio_rng_double(&rng);
        double d = limit * (i % 2 ? 0.5 * brio_rng_double(&rng) : 1.0001 + 3 * brio_rng_double(&rng));
        double way[3] = {sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z}, u[3];
        for (int k = 0; k < 3; k++) u[k] = s[k] + d * way[k];
        if (nearest_sample(&tree, u) != i / 64) continue;
        bool covered = false;
        for (int k = 0; k < 2; k++) {
            uint32_t p = x->poles.of_sample[2 * (i / 64) + (size_t)k];
            covered |= square_between(u, x->poles.centre + 3 * (size_t)p) < x->poles.square[p];
        }
        tried += d > limit;
        bare += d <= limit && !covered;
        EXPECT(covered || d <= limit, "lemma 40 at sample %zu: %g, at most %g", i / 64, d, limit);
    }
    EXPECT(tried > 200 && bare > 200, "%zu points beyond the distance, %zu bare ones within", tried, bare);
    brio_point_tree_free(x->ctx, &tree);
}

/* Lemma 47: the boundary of the union of the balls of one side is taken to the surface, point for point, by the nearest
 * point. So the normal at a point of the surface, half the local feature size long on either side, leaves the union once
 * and does not come back. (That each point of the boundary is within reach is theorem 43.) */
static void check_unions(const theory *x) {
    double reach = 0.5 * x->surface->feature_size;
    size_t n;
    double *points = x->surface->sample(1, 5, &n);
    for (size_t i = 0; i < n; i++)
        for (int side = 0; side < 2; side++) {
            double way[3], end = -reach;
            size_t count;
            x->surface->normal(points + 3 * i, way);
            for (int k = 0; k < 3 && side; k++) way[k] = -way[k];
            interval *cut = cut_line(x, side ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER, points + 3 * i, way, &count);
            size_t c = 0;
            for (; c < count && cut[c].from <= end; c++) end = fmax(end, cut[c].to);
            EXPECT(end > -reach && end < reach, "lemma 47: the union ends at %g", end);
            EXPECT(c == count || cut[c].from >= reach, "lemma 47: left at %g, entered again at %g", end, cut[c].from);
            free(cut);
        }
    free(points);
}

/* Lemma 55: two balls of one side that share a face of the power diagram within the tubular neighbourhood meet at a right
 * angle at least. The edges of the crust are in that neighbourhood (corollary 48): an edge has the cells of two balls of
 * one side around it, and of one of the other side. */
static void check_crust_edges(const theory *x, const brio_pole_graph *g) {
    double narrowest = INFINITY;
    size_t edges = 0;
    for (size_t facet = 0; facet < 4 * g->diagram->num_finite; facet++) {
        const uint32_t *v = g->diagram->power.tet[facet / 4].vertex;
        uint32_t p[3];
        int inner = 0;
        for (int k = 0; k < 3; k++) p[k] = v[BRIO_FACET[facet % 4][k]], inner += x->truth[p[k]] == BRIO_LABEL_INNER;
        if (inner == 0 || inner == 3 || *brio_mate(&g->diagram->power, (uint32_t)facet) < facet) continue;
        uint8_t twice = inner == 2 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        int odd = x->truth[p[0]] != twice ? 0 : x->truth[p[1]] != twice ? 1 : 2;
        narrowest = fmin(narrowest, angle_between(g, p[(odd + 1) % 3], p[(odd + 2) % 3]));
        edges++;
    }
    EXPECT(edges > x->n && narrowest >= 0.5 * 3.141592653589793, "lemma 55: %zu edges, angle %g", edges, narrowest);
}

/* Lemmata 56 and 57: every pole is reached, every label is right. */
static void check_labels(const theory *x, const brio_pole_graph *g, label_fn find) {
    brio_labeling_stats s = {0};
    size_t wrong = 0;
    uint8_t *label = calloc(x->poles.count, 1);
    EXPECT(find(g, label, &s) == BRIO_OK && s.undecided == 0 && s.toggled == 0);
    for (size_t p = 0; p < x->poles.count; p++) wrong += label[p] != x->truth[p];
    EXPECT(wrong == 0, "%zu of %zu labels are wrong", wrong, x->poles.count);
    free(label);
}

static brio_status label_theoretical(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_laboratory *lab;
    EXPECT(brio_laboratory_new(g->ctx, &(brio_laboratory_options){0}, &lab) == BRIO_OK);
    brio_status status = brio_label_theoretical(lab, g, label, stats);
    EXPECT(brio_laboratory_results(lab)->unreached == 0);
    brio_laboratory_free(lab);
    return status;
}

static brio_pole_graph graph_of(const theory *x, double least_weight) {
    brio_pole_graph g;
    brio_pole_evidence evidence = {least_weight, false};
    static brio_power_diagram diagram; /* of the one theory there is at a time */
    diagram = brio_power_diagram_of(&x->poles, x->points, x->n, x->power);
    EXPECT(brio_pole_graph_new(x->ctx, &diagram, evidence, &g) == BRIO_OK);
    return g;
}

static void check_poles(const theory *x) {
    brio_pole_graph all = graph_of(x, -1), deep = graph_of(x, BRIO_DEEP_WEIGHT);
    check_intersections(x, &all);
    check_balls_of_samples(x, &all);
    check_crust_edges(x, &all);
    check_unions(x);
    if (x->r < 0.147) check_points_outside_balls(x);
    check_labels(x, &deep, label_theoretical);
    check_labels(x, &all, brio_label_greedy);
    check_labels(x, &all, brio_label_global);
    brio_pole_graph_free(&all);
    brio_pole_graph_free(&deep);
}

/* The largest distance from the surface, looked at in the corners and the middle of each face. */
static double largest_distance(const theory *x, const brio_mesh *mesh) {
    double largest = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++)
        largest = fmax(largest, fabs(x->surface->value(mesh->vertices + 3 * v)));
    for (size_t f = 0; f < mesh->num_faces; f++) {
        uint64_t first = mesh->face_offsets[f], end = mesh->face_offsets[f + 1];
        double middle[3] = {0, 0, 0};
        for (uint64_t i = first; i < end; i++)
            for (size_t k = 0; k < 3; k++)
                middle[k] += mesh->vertices[3 * (size_t)mesh->face_vertices[i] + k] / (double)(end - first);
        largest = fmax(largest, fabs(x->surface->value(middle)));
    }
    return largest;
}

/* Section 3.3.2: every sample is on the crust. */
static void check_samples_are_on(const theory *x, const brio_mesh *mesh) {
    brio_triangle_tree tree;
    double largest = 0;
    EXPECT(brio_triangle_tree_new(x->ctx, mesh, &tree) == BRIO_OK);
    for (size_t s = 0; s < x->n; s++) {
        double closest[3];
        size_t triangle;
        largest = fmax(largest, brio_closest_point(&tree, x->points + 3 * s, closest, &triangle));
    }
    EXPECT(sqrt(largest) <= ROUNDING, "a sample is %g off", sqrt(largest));
    brio_triangle_tree_free(x->ctx, &tree);
}

/* Faces of a dense sample meet in common corners and edges only, as polygons, as triangles and simplified. */
static void check_no_faces_cross(const theory *x) {
    for (int form = 0; form < 3; form++) {
        brio_surface_options o = CRUST_OPTIONS;
        brio_mesh *mesh;
        int64_t pairs = -1;
        o.polygons = !(form == 1);
        o.simplify = form == 2;
        EXPECT(make_crust(x->ctx, x->points, x->n, &o, &mesh, NULL, NULL) == BRIO_OK);
        EXPECT(brio_mesh_self_intersections(x->ctx, mesh, &pairs) == BRIO_OK);
        EXPECT(pairs == 0, "r = %g, form %d: %lld pairs of faces cross", x->r, form, (long long)pairs);
        brio_mesh_free(mesh);
    }
}

/* Theorem 54 and corollary 48. Returns the largest distance from the surface over r LFS. */
static double check_crust(const theory *x) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    EXPECT(make_crust(x->ctx, x->points, x->n, NULL, &mesh, NULL, NULL) == BRIO_OK);
    EXPECT(brio_mesh_certificate(x->ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == x->surface->genus, "genus %lld",
           (long long)c.genus);
    double far = largest_distance(x, mesh) / (x->r * x->surface->feature_size);
    check_samples_are_on(x, mesh);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return far;
}

static double check_theory(const known_surface *surface, double r) {
    theory x = theory_new(surface, r);
    check_poles(&x);
    double far = check_crust(&x);
    if (r == SPARSE) check_no_faces_cross(&x);
    theory_free(&x);
    return far;
}

static void check_halved(const known_surface *surface) {
    double sparse = check_theory(surface, SPARSE), dense = check_theory(surface, SPARSE / 2);
    EXPECT(sparse > 0 && sparse <= 0.25 && dense <= sparse, "distance over r LFS: %g, with half of r %g", sparse,
           dense);
}

static void guarantees_hold_on_a_sphere(void) {
    check_halved(&known_sphere);
}

static void guarantees_hold_on_a_torus(void) {
    check_halved(&known_torus);
}

static void guarantees_hold_on_a_plate_of_genus_three(void) {
    check_halved(&known_plate);
}

SUITE(test_crust_guarantees) {
    RUN(guarantees_hold_on_a_sphere);
    RUN(guarantees_hold_on_a_torus);
    if (!SHORT_TESTS) RUN(guarantees_hold_on_a_plate_of_genus_three);
    return harness_end();
}
