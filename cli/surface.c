/* brio surface: a surface through the points of a file, with its certificate. */
#include "certificate.h"
#include "commands.h"
#include "estimate.h"

typedef struct arguments {
    int method;
    bool triangulate;
} arguments;

static const option_choice methods[] = {
    {"power-crust", 0}, {"cocone", CHOICE_LATER}, {"tight-cocone", CHOICE_LATER}, {NULL, 0}};

static const option options[] = {
    {"method", 0, OPTION_CHOICE, offsetof(arguments, method), "NAME", "how to reconstruct", methods},
    {"triangulate", 0, OPTION_FLAG, offsetof(arguments, triangulate), NULL, "cut the polygons into triangles", 0},
    {0},
};

static const arguments defaults = {0};
static const brio_format formats[] = {BRIO_FORMAT_PLY, BRIO_FORMAT_OBJ, BRIO_FORMAT_OFF, BRIO_FORMAT_VTU,
                                      BRIO_FORMAT_AUTO};

static void report_counts(run *r, const arguments *a, const brio_mesh *surface, const brio_power_crust_stats *s) {
    facts *f = &r->facts;
    cli_fact_text(f, "method", methods[a->method].name);
    cli_fact_count(f, "samples", s->samples);
    cli_fact_count(f, "vertices", surface->num_vertices);
    cli_fact_count(f, "faces", surface->num_faces);
    cli_fact_count(f, "poles", s->poles);
    cli_fact_count(f, "hidden_poles", s->hidden_poles);
    cli_fact_count(f, "inner", s->inner);
    cli_fact_count(f, "outer", s->outer);
    cli_fact_count(f, "confused", s->confused);
}

static brio_status reconstruct(run *r, const arguments *a, const brio_mesh *points, brio_mesh **surface) {
    brio_surface_options o = brio_surface_options_default();
    brio_power_crust_stats s = {0};
    o.seed = r->common.seed;
    o.triangulate = a->triangulate;
    brio_status status = brio_power_crust(r->ctx, points->vertices, points->num_vertices, &o, surface, &s);
    if (status != BRIO_OK) return status;
    cli_stage(r, "delaunay", s.delaunay_seconds);
    cli_stage(r, "poles", s.poles_seconds);
    cli_stage(r, "power", s.power_seconds);
    cli_stage(r, "label", s.label_seconds);
    cli_stage(r, "crust", s.crust_seconds);
    r->lap = cli_clock();
    report_counts(r, a, *surface, &s);
    return cli_check_interrupt(r);
}

static brio_status surface(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *points = NULL, *result = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_require_output(r, formats, false));
    TRY(cli_read_points(r, r->operands[0], &points));
    TRY(cli_require_memory(r, cli_mesh_bytes(points) + cli_surface_bytes(points->num_vertices)));
    TRY(reconstruct(r, a, points, &result));
    brio_mesh_free(points);
    points = NULL;
    TRY(cli_certify(r, result, false));
    TRY(cli_write(r, result));
done:
    brio_mesh_free(result);
    brio_mesh_free(points);
    return status;
}

const command cli_surface = {
    .name = "surface",
    .operands = "IN",
    .summary = "closed surface through the points of a file, certified (.ply .obj .off .vtu)",
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = surface,
};
