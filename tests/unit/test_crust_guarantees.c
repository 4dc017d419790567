/* The guarantees of the power crust [Choi 2003, appendix B] on r-samples of surfaces whose local feature size is known:
 * sphere, torus, and a plate of genus 3. */
#include "harness.h"
#include "known_surfaces.h"
#include "points.h"
#include "reconstruct/labels/labelling.h"
#include "surface/closest_point.h"

enum { BOUNDING_POINTS = 8 };
/* Inner and outer balls meet at less than a right angle up to r = 0.235 (lemma 38), and labels are right up to there. */
static const double SPARSE = 0.22;
/* A crust vertex between nearly flat cells loses digits: half of them may go. */
static const double ROUNDING = 1e-8, BOUND = 15;

typedef brio_status (*label_fn)(const brio_pole_graph *, uint8_t *, brio_labelling_stats *);

/* The polar balls of one r-sample, with their true labels. */
typedef struct {
    brio_context *ctx;
    const known_surface *surface;
    double r;
    double *points; /* the samples; eight bounding points follow */
    size_t n;
    brio_triangulation *power;
    brio_poles poles;
    uint8_t *truth;
} theory;

static void add_bounding_points(theory *x) {
    x->points = realloc(x->points, sizeof *x->points * 3 * (x->n + BOUNDING_POINTS));
    for (size_t i = 0; i < BOUNDING_POINTS; i++)
        for (size_t k = 0; k < 3; k++) x->points[3 * (x->n + i) + k] = i >> k & 1 ? BOUND : -BOUND;
}

static theory theory_new(const known_surface *surface, double r) {
    theory x = {.ctx = new_context(), .surface = surface, .r = r};
    brio_pole_filter keep_all = {0};
    brio_triangulation *t;
    brio_context_set_threads(x.ctx, 1);
    x.points = surface->sample(r, 11, &x.n);
    add_bounding_points(&x);
    EXPECT(brio_delaunay(x.ctx, x.points, NULL, x.n + BOUNDING_POINTS, NULL, &t) == BRIO_OK);
    EXPECT(brio_poles_find(x.ctx, t, x.points, x.n, &keep_all, &x.poles) == BRIO_OK);
    EXPECT(brio_delaunay(x.ctx, x.poles.centre, x.poles.square, x.poles.count, NULL, &x.power) == BRIO_OK);
    x.truth = malloc(x.poles.count);
    for (size_t p = 0; p < x.poles.count; p++)
        x.truth[p] = surface->value(x.poles.centre + 3 * p) < 0 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    brio_triangulation_free(t);
    return x;
}

static void theory_free(theory *x) {
    brio_triangulation_free(x->power);
    brio_poles_free(x->ctx, &x->poles);
    EXPECT(brio_context_memory(x->ctx) == 0);
    brio_context_free(x->ctx);
    free(x->points);
    free(x->truth);
}

/* The angle at which two balls intersect, 0 where they do not. */
static double angle_between(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    return acos(fmin(1, fmax(-1, -brio_pole_graph_weight(g, p, q))));
}

/* Lemma 38, for the two balls of each sample and for all that share a face of the power diagram. */
static void check_intersections(const theory *x, const brio_pole_graph *g) {
    double limit = 2 * asin(3 * x->r), widest = 0;
    for (uint32_t p = 0; p < x->poles.count; p++)
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
            if (g->edge[e].weight >= 0 && x->truth[p] != x->truth[g->edge[e].pole])
                widest = fmax(widest, angle_between(g, p, g->edge[e].pole));
    for (size_t s = 0; s < x->n; s++) {
        uint32_t p = x->poles.of_sample[2 * s], q = x->poles.of_sample[2 * s + 1];
        EXPECT(p != BRIO_NO_POLE && q != BRIO_NO_POLE && x->truth[p] != x->truth[q], "the poles of sample %zu", s);
        if (p != BRIO_NO_POLE && q != BRIO_NO_POLE) widest = fmax(widest, angle_between(g, p, q));
    }
    EXPECT(widest > 0 && widest <= limit, "angle %g, at most %g", widest, limit);
}

/* Lemmata 56 and 57: every pole is reached, every label is right. */
static void check_labels(const theory *x, const brio_pole_graph *g, label_fn find) {
    brio_labelling_stats s = {0};
    size_t wrong = 0;
    uint8_t *label = calloc(x->poles.count, 1);
    EXPECT(find(g, label, &s) == BRIO_OK && s.unreached == 0 && s.open == 0 && s.toggled == 0);
    for (size_t p = 0; p < x->poles.count; p++) wrong += label[p] != x->truth[p];
    EXPECT(wrong == 0, "%zu of %zu labels are wrong", wrong, x->poles.count);
    free(label);
}

static brio_pole_graph graph_of(const theory *x, double least_weight) {
    brio_pole_graph g;
    brio_pole_evidence evidence = {least_weight, false};
    EXPECT(brio_pole_graph_new(x->ctx, &x->poles, x->points, x->n, x->power, evidence, &g) == BRIO_OK);
    return g;
}

static void check_poles(const theory *x) {
    brio_pole_graph all = graph_of(x, -1), deep = graph_of(x, BRIO_THEORETICAL_WEIGHT);
    check_intersections(x, &all);
    check_labels(x, &deep, brio_label_theoretical);
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

/* Theorem 54 and corollary 48. Returns the largest distance from the surface over r LFS. */
static double check_crust(const theory *x) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    EXPECT(brio_power_crust(x->ctx, x->points, x->n, NULL, &mesh, NULL) == BRIO_OK);
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

int main(void) {
    RUN(guarantees_hold_on_a_sphere);
    RUN(guarantees_hold_on_a_torus);
    RUN(guarantees_hold_on_a_plate_of_genus_three);
    return harness_end();
}
