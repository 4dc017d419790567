/* What of a surface its points do not show, and what of the points it leaves, as facts. */
#include "cli/steps/coverage.h"
#include "cli/files/read_write.h"
#include "cli/steps/selection.h"
#include <stdlib.h>

/* Over this share of the area the user is told of bridges. As for guesses. */
static const double MANY = 0.02;

static void report_points(run *r, size_t left_out, size_t num_points) {
    cli_fact_count(&r->facts, "points_left_out", left_out);
    if (left_out) cli_warn(r, WARNING_LEFT_OUT, left_out, num_points);
}

brio_status cli_report_coverage(run *r, const brio_mesh *surface, const brio_mesh *points) {
    brio_coverage c = {0};
    facts *f = &r->facts;
    brio_status status = brio_mesh_coverage(r->ctx, surface, points->vertices, points->num_vertices, NULL, &c);
    if (status != BRIO_OK) return status;
    cli_lap(r, "coverage");
    cli_fact_open(f, "bridges", FACT_OBJECT);
    cli_fact_count(f, "number", c.bridges);
    cli_fact_real(f, "area_share", c.bridge_share);
    cli_fact_real(f, "largest_radius", c.bridge_radius);
    cli_fact_open(f, "largest_centre", FACT_LIST);
    for (int k = 0; k < 3; k++) cli_fact_real(f, NULL, c.bridge_centre[k]);
    cli_fact_close(f);
    cli_fact_close(f);
    cli_fact_real(f, "far_area_percent", 100 * c.far_share);
    if (c.bridge_share > MANY)
        cli_warn(r, WARNING_UNSEEN, 100 * c.bridge_share, c.bridges, c.bridge_centre[0], c.bridge_centre[1],
                 c.bridge_centre[2], 2 * c.bridge_radius);
    report_points(r, c.left_out, points->num_vertices);
    return BRIO_OK;
}

static brio_status write_chosen(run *r, const char *path, const brio_mesh *points, const uint8_t *chosen) {
    brio_mesh *some = NULL;
    brio_status status = cli_select_points(r, points, chosen, &some);
    if (status == BRIO_OK) status = cli_write_to(r, path, some);
    brio_mesh_free(some);
    return status;
}

brio_status cli_report_left_out(run *r, const brio_mesh *surface, const brio_mesh *points, const char *path) {
    size_t left_out;
    uint8_t *chosen = malloc(points->num_vertices + 1);
    brio_status status = BRIO_OK;
    if (!chosen) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu points", points->num_vertices);
    TRY(brio_mesh_left_out(r->ctx, surface, points->vertices, points->num_vertices, chosen, &left_out));
    cli_lap(r, "coverage");
    report_points(r, left_out, points->num_vertices);
    if (path) TRY(write_chosen(r, path, points, chosen));
done:
    free(chosen);
    return status;
}
