/* brio offset: the surface at a distance from the one through the points of a file, or from the faces of a closed mesh,
 * with its certificate. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/steps/power_crust.h"
#include "cli/steps/properties.h"
#include "cli/run/sentences.h"
#include <math.h>

typedef struct arguments {
    double distance, error; /* error: 0 where it is not given */
    power_crust_options crust;
    bool vertex_normals, self_intersections;
} arguments;

static const option options[] = {
    {"distance", 'D', OPTION_NUMBER, offsetof(arguments, distance), "D",
     "how far, in the unit of the points: outwards when positive", 0},
    {"error", 'E', OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, error), "E",
     "of a closed mesh: most distance from the exact offset (default: a hundredth of D)", 0},
    {"triangulate", 0, OPTION_FLAG, offsetof(arguments, crust.triangulate), NULL, "cut the polygons into triangles", 0},
    {"simplify", 0, OPTION_FLAG, offsetof(arguments, crust.simplify), NULL, "a quarter as many faces, triangles", 0},
    {"labeling", 0, OPTION_CHOICE, offsetof(arguments, crust.labeling), "NAME",
     "what tells inside from outside (default: mesh if the input has faces, else global)", cli_labelings_or_mesh},
    {"noise", 0, OPTION_CHOICE, offsetof(arguments, crust.noise), "NAME",
     "what to do about noisy points (default auto: smooth if noise is found)", cli_noise},
    {"sampling-density", 'R', OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, crust.sampling_density), "R",
     "discard the nearer pole of cells too wide for an R-sample, 0 < R < 1", 0},
    {"sharp", 'B', OPTION_FLAG, offsetof(arguments, crust.sharp), NULL,
     "discard both poles there, for sharp edges without points (R defaults to 0.5)", 0},
    {"vertex-normals", 0, OPTION_FLAG, offsetof(arguments, vertex_normals), NULL,
     "give the vertices normals, as properties nx ny nz", 0},
    {"self-intersections", 0, OPTION_FLAG, offsetof(arguments, self_intersections), NULL,
     "count the pairs of faces that run through each other", 0},
    {0},
};

static const arguments defaults = {.distance = NAN, .crust.labeling = LABELS_OF_INPUT};

/* Makes the power crust of the points. */
static brio_status offset_points(run *r, const power_crust_options *crust, const brio_mesh *points,
                                 brio_mesh **surface) {
    const arguments *a = r->arguments;
    const brio_surface_options o = {.method = BRIO_SURFACE_OFFSET,
                                    .noise = (brio_noise)crust->noise,
                                    .seed = r->common.seed,
                                    .simplify = crust->simplify,
                                    .polygons = !crust->triangulate && !crust->simplify,
                                    .distance = a->distance,
                                    .poles = cli_pole_options(crust)};
    brio_surface_stats s = {0};
    facts *f = &r->facts;
    brio_status status = BRIO_OK;
    if (a->error > 0)
        FAIL(r, BRIO_ERR_ARGUMENT,
             "--error is for closed meshes: the error of an offset of points is that of the points");
    uint64_t work = 0;
    size_t usual;
    TRY(cli_usual_points(r, points, NULL, false, &usual));
    status = brio_estimate_surface(r->ctx, usual, &o, &work);
    TRY(cli_require_work(r, status, points, work));
    TRY(cli_experiment(r, &(brio_laboratory_options){.labeling = cli_label_experiment(crust->labeling)}));
    status = brio_surface(r->ctx, points->vertices, points->num_vertices, &o, surface, &s);
    brio_laboratory_end(r->lab);
    cli_suggest_labeling(r, status, points, false);
    TRY(status);
    brio_mesh_remove_property(*surface, "sample"); /* which no vertex is */
    cli_report_power_crust_stages(r, crust, &s);
    cli_fact_text(f, "method", "power-crust");
    cli_fact_real(f, "distance", a->distance);
    cli_fact_count(f, "samples", s.samples);
    cli_fact_count(f, "vertices", (*surface)->num_vertices);
    cli_fact_count(f, "faces", (*surface)->num_faces);
    cli_report_power_crust(r, crust, &s);
done:
    return status;
}

/* Refuses options that say how a surface goes through points: they mean nothing for a mesh, whose faces are the
 * surface. */
static brio_status refuse_options_of_points(run *r) {
    const power_crust_options *crust = &((const arguments *)r->arguments)->crust;
    const char *name = crust->sharp                  ? "sharp"
                       : crust->sampling_density > 0 ? "sampling-density"
                       : crust->noise                ? "noise"
                       : crust->simplify             ? "simplify"
                                                     : NULL;
    if (!name) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_ARGUMENT,
                    "--%s is for points: %s has faces, which count (--labeling global goes by its points)", name,
                    r->operands[0]);
}

/* Makes the offset of the solid that the faces bound. */
static brio_status offset_mesh(run *r, const brio_mesh *mesh, brio_mesh **surface) {
    const arguments *a = r->arguments;
    brio_mesh_offset_options o = {0};
    brio_mesh_offset_stats s = {0};
    facts *f = &r->facts;
    uint64_t work = 0;
    brio_status status = BRIO_OK;
    o.error = a->error;
    TRY(refuse_options_of_points(r));
    status = brio_estimate_mesh_offset(r->ctx, mesh, a->distance, &o, &work);
    TRY(cli_require_work(r, status, mesh, work));
    status = brio_mesh_offset(r->ctx, mesh, a->distance, &o, surface, &s);
    cli_suggest_labeling(r, status, mesh, a->crust.labeling == LABELS_OF_INPUT);
    TRY(status);
    cli_lap(r, "offset");
    double asked = o.error > 0 ? o.error : 0.01 * fabs(a->distance);
    cli_fact_text(f, "method", "mesh");
    cli_fact_real(f, "distance", a->distance);
    cli_fact_real(f, "proven_error", s.error);
    cli_fact_count(f, "samples", s.samples);
    cli_fact_count(f, "rounds", s.rounds);
    cli_fact_count(f, "vertices", (*surface)->num_vertices);
    cli_fact_count(f, "faces", (*surface)->num_faces);
    cli_fact_text(f, "labeling", "mesh");
    if (s.error > asked) cli_warn(r, WARNING_PROVEN, s.error, asked);
done:
    return status;
}

static brio_status offset(run *r) {
    const arguments *a = r->arguments;
    power_crust_options crust = a->crust;
    brio_mesh *points = NULL, *surface = NULL;
    brio_status status = BRIO_OK;
    bool by_mesh;
    if (isnan(a->distance)) FAIL(r, BRIO_ERR_ARGUMENT, "no distance: --distance D is missing");
    TRY(cli_require_output_for(r, "vertex-normals", a->vertex_normals));
    TRY(cli_require_output(r, false));
    TRY(cli_read(r, r->operands[0], &points));
    TRY(cli_settle_labeling(r, points, &crust.labeling, &by_mesh));
    TRY(by_mesh ? offset_mesh(r, points, &surface) : offset_points(r, &crust, points, &surface));
    TRY(cli_check_interrupt(r));
    if (a->vertex_normals) TRY(brio_mesh_add_normals(surface));
    TRY(cli_carry_properties(r, points, NULL, surface));
    brio_mesh_free(points);
    points = NULL;
    TRY(cli_certify(r, surface, a->self_intersections ? CERTIFY_COUNTED : 0u));
    TRY(cli_write(r, surface));
done:
    brio_mesh_free(surface);
    brio_mesh_free(points);
    return status;
}

const command cli_offset = {
    .name = "offset",
    .operands = "IN",
    .summary = "surface at a distance from that of points, or from a closed mesh",
    .description =
        "Of a closed mesh the faces count: the offset is round about their convex edges and sharp in their concave "
        "ones outwards, the other way round inwards, and as close to the exact one as --error says. Of points "
        "it is the power crust of larger or smaller balls.",
    .examples =
        "brio offset scan.ply --distance 0.1 -o thicker.ply\n0.1 farther out\n"
        "brio offset mesh.ply --distance -0.1 -o thinner.ply\n0.1 farther in\n"
        "brio offset mesh.ply --distance 2 --error 0.001 -o far.ply\na thousandth of the unit from the exact offset\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = offset,
};
