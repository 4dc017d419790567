/* brio hull: the convex hull of the points of a file, with its certificate. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/steps/order.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <stdlib.h>

typedef struct arguments {
    order_options order;
    bool polygons;
} arguments;

static const option options[] = {
    {"polygons", 0, OPTION_FLAG, offsetof(arguments, polygons), NULL,
     "one polygon for each facet, not cut into triangles", 0},
    {"", 0, OPTION_TITLE, 0, NULL, "how points are inserted (the result is the same)", 0},
    ORDER_ROWS(arguments, order, ""),
    {0},
};

static const arguments defaults = {.order = NO_ORDER_OPTIONS};

static void report(run *r, const brio_mesh *hull, const brio_convex_hull_stats *s) {
    facts *f = &r->facts;
    cli_stage(r, "skip", s->skip_seconds);
    cli_stage(r, "hull", s->hull_seconds + s->mesh_seconds);
    r->lap = cli_clock();
    cli_fact_text(f, "method", "convex-hull");
    cli_fact_count(f, "samples", s->points);
    cli_fact_count(f, "candidates", s->candidates);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "vertices", s->vertices);
    cli_fact_count(f, "faces", hull->num_faces);
    cli_fact_count(f, "facets", s->facets);
    cli_fact_count(f, "created", s->created);
    cli_fact_count(f, "destroyed", s->destroyed);
    cli_fact_count(f, "walk_steps", s->walk_steps);
    cli_fact_count(f, "beyond_calls", s->beyond_calls);
    cli_fact_count(f, "exact_calls", s->exact_calls);
}

static brio_status hull(run *r) {
    const arguments *a = r->arguments;
    brio_convex_hull_options o = {.size = sizeof o};
    brio_convex_hull_stats s = {.size = sizeof s};
    brio_laboratory_options lab = {0};
    brio_mesh *input = NULL, *surface = NULL;
    uint32_t *samples = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_check_order(r, &a->order, cli_order_of(&a->order)));
    TRY(cli_require_output(r, false));
    TRY(cli_read_points(r, r->operands[0], &input));
    TRY(cli_require_memory(r, cli_hull_bytes(input)));
    o.polygons = a->polygons;
    o.order = cli_library_order(cli_order_of(&a->order));
    o.seed = r->common.seed;
    if (!isnan(a->order.round_ratio)) o.round_ratio = a->order.round_ratio;
    o.samples = samples = malloc((input->num_vertices + 1) * sizeof *samples);
    if (!samples) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu indices", input->num_vertices);
    cli_order_experiment(&a->order, &lab);
    TRY(cli_experiment(r, &lab));
    TRY(brio_convex_hull(r->ctx, input->vertices, input->num_vertices, &o, &surface, &s));
    if (s.dimension < 0) FAIL(r, BRIO_ERR_NO_ANSWER, "no points, so no convex hull");
    brio_laboratory_end(r->lab);
    report(r, surface, &s);
    TRY(cli_carry_properties(r, input, samples, surface));
    TRY(cli_check_interrupt(r));
    TRY(cli_certify(r, surface, s.dimension < 3 ? CERTIFY_OPEN : 0u)); /* flat hulls bound nothing */
    TRY(cli_write(r, surface));
done:
    free(samples);
    brio_mesh_free(surface);
    brio_mesh_free(input);
    return status;
}

const command cli_hull = {
    .name = "hull",
    .operands = "IN",
    .summary = "convex hull of points; flat ones are a polygon or an edge",
    .examples = "brio hull points.ply -o hull.ply\ntriangles\n"
                "brio hull points.ply --polygons -o hull.off\none polygon for each facet\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = hull,
};
