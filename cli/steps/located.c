/* What `brio locate` and `brio interpolate` share: see located.h. */
#include "cli/steps/located.h"
#include "cli/files/read_write.h"
#include "cli/steps/estimate.h"
#include "cli/run/sentences.h"
#include <stdlib.h>
#include <string.h>

const option_choice cli_located_planes[] = {{"xy", LOCATED_XY}, {"xz", LOCATED_ZX},   {"yz", LOCATED_YZ},
                                            {"zx", LOCATED_ZX}, {"fit", LOCATED_FIT}, {NULL, 0}};

brio_status cli_read_located(run *r, const char *at, const weights_options *weights, const periodic_options *periodic,
                             int plane, located *l) {
    double bytes;
    if (!at) return cli_fail(r, BRIO_ERR_ARGUMENT, "no places: --at FILE is missing");
    if (!strcmp(at, "-") && !strcmp(r->operands[0], "-"))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "points and places both want standard input");
    r->over_map = plane != LOCATED_SPACE;
    FORWARD(cli_read_points(r, r->operands[0], &l->points));
    FORWARD(cli_read_points(r, at, &l->at));
    if (weights) FORWARD(cli_weights(r, weights, l->points, &l->weights));
    if (!cli_limits_memory(r)) return BRIO_OK;
    if (periodic && cli_is_periodic(periodic)) {
        FORWARD(cli_periodic_locate_bytes(r, periodic, l->points, l->weights, l->at, &bytes));
    } else {
        FORWARD(cli_delaunay_bytes(r, l->points, l->weights, NULL, &bytes));
        bytes = cli_locate_bytes(l->points, bytes, l->at);
    }
    return cli_require_memory(r, bytes);
}

/* Sets the frame that --plane names. */
static brio_status frame_of(run *r, int plane, const brio_mesh *points, brio_plane_frame *frame) {
    *frame = (brio_plane_frame){.size = sizeof *frame, .dimension = 2};
    if (plane == LOCATED_FIT) return brio_plane_fit(r->ctx, points->vertices, points->num_vertices, frame);
    frame->axis[0][plane] = 1;
    frame->axis[1][(plane + 1) % 3] = 1;
    return BRIO_OK;
}

static brio_status project(run *r, const brio_plane_frame *frame, const brio_mesh *mesh, double **out) {
    *out = malloc(2 * mesh->num_vertices * sizeof **out + 1);
    if (!*out) return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for %zu points of the plane", mesh->num_vertices);
    brio_plane_project(frame, mesh->vertices, mesh->num_vertices, *out);
    return BRIO_OK;
}

static brio_status make_in_plane(run *r, int plane, located *l) {
    brio_status status = BRIO_OK;
    brio_triangulation2 *t = NULL;
    brio_delaunay2_options o = {0};
    brio_plane_frame frame;
    double *points = NULL;
    size_t count = l->points->num_vertices;
    o.seed = r->common.seed;
    TRY(frame_of(r, plane, l->points, &frame));
    TRY(project(r, &frame, l->points, &points));
    TRY(project(r, &frame, l->at, &l->places));
    TRY(brio_delaunay2(r->ctx, points, l->weights, count, &o, &t));
    cli_lap(r, "delaunay");
    TRY(brio_locator2_new(r->ctx, t, points, l->weights, count, &l->plane));
    cli_lap(r, "locator");
    l->duplicates = brio_triangulation2_stats(t)->duplicates;
    cli_fact_count(&r->facts, "points", brio_triangulation2_stats(t)->points);
    cli_fact_count(&r->facts, "duplicates", l->duplicates);
    cli_fact_count(&r->facts, "triangles", brio_triangulation2_stats(t)->triangles);
done:
    brio_triangulation2_free(t);
    free(points);
    return status;
}

brio_status cli_make_locator(run *r, int plane, bool own_plane, located *l) {
    if (plane != LOCATED_SPACE) return make_in_plane(r, plane, l);
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    brio_delaunay_options o = {0};
    size_t count = l->points->num_vertices;
    o.seed = r->common.seed;
    TRY(brio_delaunay(r->ctx, l->points->vertices, l->weights, count, &o, &t));
    cli_lap(r, "delaunay");
    int dimension = brio_triangulation_stats(t)->dimension;
    if (dimension == 2) cli_warn(r, WARNING_IN_PLANE);
    if (dimension == 1) cli_warn(r, WARNING_ON_LINE);
    if (dimension == 2 && own_plane) {
        brio_triangulation_free(t);
        return make_in_plane(r, LOCATED_FIT, l);
    }
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
    brio_locator2_free(l->plane);
    free(l->places);
    free(l->weights);
    brio_mesh_free(l->points);
    brio_mesh_free(l->at);
}

void cli_report_inside(run *r, size_t inside, size_t all) {
    cli_fact_count(&r->facts, "inside", inside);
    cli_fact_count(&r->facts, "outside", all - inside);
}
