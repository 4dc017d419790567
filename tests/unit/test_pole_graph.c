/* The graph of poles: what its edges weigh, on samples too few for their surface. */
#include "harness.h"
#include "points.h"
#include "reconstruct/pole_graph.h"

enum { N = 150, BOUNDING_POINTS = 8 };

typedef struct {
    double points[3 * (N + BOUNDING_POINTS)];
    brio_poles poles;
    brio_triangulation *power;
    brio_pole_graph plain, balanced;
} graphs;

static void graphs_new(brio_context *ctx, uint64_t seed, graphs *x) {
    brio_pole_filter filter = {.shapes = BRIO_TRUSTED_SHAPE};
    brio_pole_evidence plain = {-2, false}, balanced = {0, true};
    brio_triangulation *t;
    torus_points(seed, N, x->points);
    for (size_t i = 0; i < BOUNDING_POINTS; i++)
        for (size_t k = 0; k < 3; k++) x->points[3 * (N + i) + k] = i >> k & 1 ? 15 : -15;
    EXPECT(brio_delaunay(ctx, x->points, NULL, N + BOUNDING_POINTS, NULL, &t) == BRIO_OK);
    EXPECT(brio_poles_find(ctx, t, x->points, N, &filter, &x->poles) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, x->poles.centre, x->poles.square, x->poles.count, NULL, &x->power) == BRIO_OK);
    EXPECT(brio_pole_graph_new(ctx, &x->poles, x->points, N, x->power, plain, &x->plain) == BRIO_OK);
    EXPECT(brio_pole_graph_new(ctx, &x->poles, x->points, N, x->power, balanced, &x->balanced) == BRIO_OK);
    brio_triangulation_free(t);
}

static void graphs_free(brio_context *ctx, graphs *x) {
    brio_pole_graph_free(&x->plain);
    brio_pole_graph_free(&x->balanced);
    brio_triangulation_free(x->power);
    brio_poles_free(ctx, &x->poles);
}

/* The weight of the edge from p to q, 0 without one. */
static double edge_weight(const brio_pole_graph *g, uint32_t p, uint32_t q) {
    for (size_t e = g->first_edge[p]; e < g->first_edge[p + 1]; e++)
        if (g->edge_pole[e] == q) return (double)g->edge_weight[e];
    return 0;
}

static void deep_neighbours_want_one_label_and_shallow_ones_two(void) {
    brio_context *ctx = new_context();
    size_t deep = 0, shallow = 0, silent = 0;
    for (uint64_t seed = 1; seed <= 5; seed++) {
        graphs x;
        graphs_new(ctx, seed, &x);
        for (uint32_t p = 0; p < x.poles.count; p++)
            for (size_t e = x.plain.first_edge[p]; e < x.plain.first_edge[p + 1]; e++) {
                uint32_t q = x.plain.edge_pole[e];
                double ball = fmin(brio_pole_graph_weight(&x.plain, p, q), 1), weight = edge_weight(&x.balanced, p, q);
                EXPECT(fabs((double)x.plain.edge_weight[e] - fmax(ball, 0)) < 1e-6);
                EXPECT(weight == edge_weight(&x.balanced, q, p));
                double least = ball > 0 ? ball * ball - 1e-6 : 0, most = ball > 0 ? ball * ball + 1e-6 : 0;
                bool meets_a_little = ball > -0.95 && ball < -0.5;
                if (meets_a_little) least = -0.2, most = -0.01;
                EXPECT(weight >= least && weight <= most, "%g of %g", weight, ball);
                *(ball > 0 ? &deep : meets_a_little ? &shallow : &silent) += 1;
            }
        graphs_free(ctx, &x);
    }
    EXPECT(deep > 500 && shallow > 500 && silent > 500, "%zu, %zu, %zu", deep, shallow, silent);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void badly_shaped_cells_count_less(void) {
    brio_context *ctx = new_context();
    size_t trusted = 0, doubted = 0;
    for (uint64_t seed = 1; seed <= 5; seed++) {
        graphs x;
        graphs_new(ctx, seed, &x);
        for (size_t p = 0; p < x.poles.count; p++)
            for (size_t e = x.plain.first_opposite[p]; e < x.plain.first_opposite[p + 1]; e++) {
                double full = x.plain.opposite_weight[e], weight = x.balanced.opposite_weight[e];
                EXPECT(x.plain.opposite_pole[e] == x.balanced.opposite_pole[e]);
                EXPECT(weight >= 0 && weight <= full);
                if (full > 0) trusted += weight == full, doubted += weight < full;
            }
        size_t bad = 0;
        for (size_t s = 0; s < N; s++) bad += x.poles.shape[s] < 1.3;
        EXPECT(bad > 0 && bad < N, "%zu", bad);
        graphs_free(ctx, &x);
    }
    EXPECT(trusted > 100 && doubted > 100, "%zu, %zu", trusted, doubted);
    brio_context_free(ctx);
}

int main(void) {
    RUN(deep_neighbours_want_one_label_and_shallow_ones_two);
    RUN(badly_shaped_cells_count_less);
    return harness_end();
}
