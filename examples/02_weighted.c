/* Regular triangulation: points with weights. A point whose power cell is empty is hidden: it is no vertex of any
 * tetrahedron, and the vertex that is nearest to it in power distance represents it. */
#include "brio/testdata.h"
#include "common.h"

static const size_t NUM_POINTS = 1000;

static double power_distance(const double *x, const double *p, double weight) {
    double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - weight;
}

int main(void) {
    brio_context *ctx = NULL;
    brio_mesh *cloud = NULL;
    brio_triangulation *t = NULL;
    CHECK(ctx, brio_context_new(NULL, &ctx));
    CHECK(ctx, brio_generate(ctx, BRIO_KIND_CUBE, NUM_POINTS, NULL, &cloud));

    /* Every fiftieth point is a ball of radius 0.1, the others are points. */
    double *weights = calloc(NUM_POINTS, sizeof *weights);
    if (!weights) return EXIT_FAILURE;
    for (size_t i = 0; i < NUM_POINTS; i += 50) weights[i] = 0.1 * 0.1;

    CHECK(ctx, brio_delaunay(ctx, cloud->vertices, weights, NUM_POINTS, NULL, &t));
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    printf("points %zu = vertices %zu + duplicates %zu + hidden %zu\n", s->points, s->vertices, s->duplicates,
           s->hidden);

    const uint32_t *representative = brio_triangulation_representatives(t);
    int shown = 0;
    for (size_t i = 0; i < NUM_POINTS && shown < 4; i++) {
        uint32_t v = representative[i];
        if (v == i) continue;
        const double *x = cloud->vertices + 3 * i;
        printf("point %zu is hidden; vertex %u, of weight %g, represents it at power distance %.5f\n", i, v, weights[v],
               power_distance(x, cloud->vertices + 3 * (size_t)v, weights[v]));
        shown++;
    }
    CHECK(ctx, brio_triangulation_check(ctx, t, cloud->vertices, weights, NUM_POINTS));
    printf("checked exactly\n");

    brio_triangulation_free(t);
    free(weights);
    brio_mesh_free(cloud);
    brio_context_free(ctx);
    return EXIT_SUCCESS;
}
