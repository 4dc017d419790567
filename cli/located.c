/* What `brio locate` and `brio interpolate` share: see located.h. */
#include "located.h"
#include "estimate.h"
#include <stdlib.h>
#include <string.h>

brio_status cli_read_located(run *r, const char *at, const weights_options *weights, located *l) {
    brio_status status = BRIO_OK;
    double delaunay;
    if (!at) FAIL(r, BRIO_ERR_ARGUMENT, "no places: --at FILE is missing");
    if (!strcmp(at, "-") && !strcmp(r->operands[0], "-"))
        FAIL(r, BRIO_ERR_ARGUMENT, "points and places both want standard input");
    TRY(cli_read_points(r, r->operands[0], &l->points));
    TRY(cli_read_points(r, at, &l->at));
    if (weights) TRY(cli_weights(r, weights, l->points, &l->weights));
    if (cli_limits_memory(r)) {
        TRY(cli_delaunay_bytes(r, l->points, l->weights, NULL, &delaunay));
        TRY(cli_require_memory(r, cli_locate_bytes(l->points, delaunay, l->at)));
    }
done:
    return status;
}

brio_status cli_make_locator(run *r, located *l) {
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    brio_delaunay_options o = brio_delaunay_options_default();
    size_t count = l->points->num_vertices;
    o.seed = r->common.seed;
    TRY(brio_delaunay(r->ctx, l->points->vertices, l->weights, count, &o, &t));
    cli_lap(r, "delaunay");
    TRY(brio_locator_new(r->ctx, t, l->points->vertices, l->weights, count, &l->locator));
    cli_lap(r, "locator");
    l->duplicates = brio_triangulation_stats(t)->duplicates;
    cli_fact_count(&r->facts, "points", brio_triangulation_stats(t)->points);
    cli_fact_count(&r->facts, "duplicates", l->duplicates);
    cli_fact_count(&r->facts, "tetrahedra", brio_triangulation_stats(t)->tetrahedra);
done:
    brio_triangulation_free(t);
    return status;
}

void cli_located_free(located *l) {
    brio_locator_free(l->locator);
    free(l->weights);
    brio_mesh_free(l->points);
    brio_mesh_free(l->at);
}

void cli_report_inside(run *r, size_t inside, size_t all) {
    cli_fact_count(&r->facts, "inside", inside);
    cli_fact_count(&r->facts, "outside", all - inside);
}
