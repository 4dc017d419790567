/* brio medial: the medial axis of a surface, known by points of it or as a closed mesh. */
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/curve.h"
#include "cli/steps/estimate.h"
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/steps/power_crust.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <string.h>

typedef struct arguments {
    int method, labeling, sides, noise;
    double sampling_density, spacing, scale, redundancy, scale_axis, theta, rho; /* 0 where they are not given */
    bool sharp, simplify;
    const char *crust; /* file, or NULL */
} arguments;

static const option_choice sides[] = {
    {"inner", BRIO_SIDES_INNER}, {"outer", BRIO_SIDES_OUTER}, {"both", BRIO_SIDES_BOTH}, {NULL, 0}};

enum { POWER_SHAPE, VORONOI };
static const option_choice methods[] = {{"power-shape", POWER_SHAPE}, {"voronoi", VORONOI}, {NULL, 0}};

static const option options[] = {
    {"method", 0, OPTION_CHOICE, offsetof(arguments, method), "NAME",
     "the power shape of the poles, or facets of the points' Voronoi diagram (default power-shape)", methods},
    {"theta", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, theta), "T",
     "voronoi: the angle condition's, in radians, below pi/2 (default pi/8)", 0},
    {"rho", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, rho), "R",
     "voronoi: the ratio condition's (default 8)", 0},
    {"sides", 0, OPTION_CHOICE, offsetof(arguments, sides), "NAME",
     "the side of the surface whose axis is wanted (default inner)", sides},
    {"labeling", 0, OPTION_CHOICE, offsetof(arguments, labeling), "NAME",
     "what tells inside from outside (default: mesh if the input has faces, else global)", cli_labelings_or_mesh},
    {"spacing", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, spacing), "S",
     "of a closed mesh: no place of a face is farther from a sample (default: a hundredth of the mesh's diagonal)", 0},
    {"simplify", 0, OPTION_FLAG, offsetof(arguments, simplify), NULL,
     "leave out what noise and close sampling add: the same as --scale 1.1 --redundancy 0.01", 0},
    {"scale", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, scale), "S",
     "leave out balls that lie in another when both are scaled by S", 0},
    {"redundancy", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, redundancy), "E",
     "leave out balls that lie in another enlarged by E of its radius", 0},
    {"scale-axis", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, scale_axis), "S",
     "leave out balls that lie in the union of the others when all are scaled by S", 0},
    {"crust", 0, OPTION_OUTPUT, offsetof(arguments, crust), "FILE",
     "also write the surface of the balls: their power crust", 0},
    {"noise", 0, OPTION_CHOICE, offsetof(arguments, noise), "NAME",
     "what to do about noisy points (default auto: smooth if noise is found)", cli_noise},
    {"sampling-density", 'R', OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, sampling_density), "R",
     "discard the nearer pole of cells too wide for an R-sample, 0 < R < 1", 0},
    {"sharp", 'B', OPTION_FLAG, offsetof(arguments, sharp), NULL,
     "discard both poles there, for sharp edges without points (R defaults to 0.5)", 0},
    {0},
};

static const arguments defaults = {.labeling = LABELS_OF_INPUT};
static const double SCALE = 1.1, REDUNDANCY = 0.01; /* of --simplify */
static const double SPACING = 0.01;                 /* of samples, in diagonals of the mesh; chosen */

/* Refuses what --method voronoi does not have. */
static brio_status check_voronoi(run *r, const arguments *a) {
    const struct {
        const char *name;
        bool given;
    } others[] = {{"simplify", a->simplify},
                  {"scale", a->scale != 0},
                  {"redundancy", a->redundancy != 0},
                  {"scale-axis", a->scale_axis != 0},
                  {"crust", a->crust != NULL},
                  {"sampling-density", a->sampling_density != 0},
                  {"sharp", a->sharp},
                  {"labeling", a->labeling != LABELS_OF_INPUT && a->labeling != LABELS_OF_MESH}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i].given) return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s is for --method power-shape", others[i].name);
    return BRIO_OK;
}

static brio_status check_arguments(run *r) {
    const arguments *a = r->arguments;
    if (a->scale != 0 && a->scale < 1) return cli_fail(r, BRIO_ERR_ARGUMENT, "--scale: %g is less than 1", a->scale);
    if (a->scale_axis != 0 && a->scale_axis < 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--scale-axis: %g is less than 1", a->scale_axis);
    if (a->method == VORONOI) return check_voronoi(r, a);
    if (a->theta != 0 || a->rho != 0)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s is for --method voronoi", a->theta != 0 ? "theta" : "rho");
    if (a->crust) FORWARD(cli_check_mesh_beside(r, "crust", a->crust, CLI_SURFACES));
    return BRIO_OK;
}

static brio_power_shape_options medial_options(const run *r, int labeling, const brio_mesh *solid) {
    const arguments *a = r->arguments;
    brio_power_shape_options o = {0};
    o.seed = r->common.seed;
    o.poles.labeling = cli_library_labeling(labeling);
    o.noise = (brio_noise)a->noise;
    o.poles.solid = solid;
    o.sides = (brio_sides)a->sides;
    o.poles.sampling_density = a->sampling_density;
    o.poles.sharp = a->sharp;
    if (a->simplify) o.scale = SCALE, o.redundancy = REDUNDANCY;
    if (a->scale != 0) o.scale = a->scale;
    if (a->redundancy > 0) o.redundancy = a->redundancy;
    o.size = sizeof o;
    o.scale_axis = a->scale_axis;
    return o;
}

/* Returns the spacing of samples that fits the size of the mesh. */
static double usual_spacing(const brio_mesh *mesh) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, diagonal = 0;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) {
        low[i % 3] = fmin(low[i % 3], mesh->vertices[i]);
        high[i % 3] = fmax(high[i % 3], mesh->vertices[i]);
    }
    for (int k = 0; k < 3; k++) diagonal = hypot(diagonal, high[k] - low[k]);
    return SPACING * diagonal;
}

/* Samples the faces of the mesh, so that it may be as coarse as it likes. */
static brio_status sample_faces(run *r, const brio_mesh *mesh, brio_mesh **samples) {
    const arguments *a = r->arguments;
    double spacing = a->spacing > 0 ? a->spacing : usual_spacing(mesh);
    FORWARD(brio_mesh_samples(r->ctx, mesh, spacing, samples));
    cli_lap(r, "sample");
    cli_fact_real(&r->facts, "spacing", spacing);
    return BRIO_OK;
}

static void report(run *r, const brio_power_shape_options *o, int labeling, const brio_power_shape_stats *s,
                   const brio_mesh *shape) {
    facts *f = &r->facts;
    cli_stage(r, "noise", s->noise_seconds);
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "poles", s->poles_seconds);
    cli_stage(r, "power", s->poles.power_seconds);
    cli_stage(r, "label", s->poles.label_seconds);
    cli_stage(r, "shape", s->shape_seconds);
    r->lap = cli_clock();
    cli_fact_text(f, "method", "power-shape");
    cli_fact_count(f, "samples", s->samples);
    cli_report_noise(r, s->noise, s->smoothed);
    cli_fact_count(f, "poles", s->poles.poles);
    cli_fact_count(f, "hidden_poles", s->poles.hidden_poles);
    cli_fact_count(f, "inner", s->poles.inner);
    cli_fact_count(f, "outer", s->poles.outer);
    cli_fact_count(f, "unlabelled", s->unlabeled);
    cli_fact_text(f, "labeling", o->poles.solid ? "mesh" : cli_labelings[labeling].name);
    if (o->scale > 1 || o->redundancy > 0 || o->scale_axis > 1) {
        cli_stage(r, "simplify", s->simplify_seconds);
        cli_fact_count(f, "left_out", s->left_out);
    }
    cli_fact_count(f, "vertices", shape->num_vertices);
    cli_fact_count(f, "edges", s->edges);
    cli_fact_count(f, "triangles", s->triangles);
    cli_fact_count(f, "tetrahedra", s->tetrahedra);
}

/* Writes the shape. Tetrahedra are left out of files that cannot hold them, such as a VTP file. */
static brio_status write_shape(run *r, brio_mesh *shape) {
    brio_format format;
    if (!r->common.output) return cli_write(r, shape); /* --json alone asks for the facts */
    FORWARD(cli_output_format(r, r->common.output, r->common.format, &format));
    if (shape->num_tetrahedra && !(brio_format_facts(format)->holds & BRIO_HOLDS_TETRAHEDRA)) {
        shape->num_tetrahedra = 0;
        cli_warn(r, WARNING_TETRAHEDRA, r->common.output);
    }
    return cli_write(r, shape);
}

static brio_status write_crust(run *r, const brio_mesh *crust) {
    const arguments *a = r->arguments;
    if (!crust) return BRIO_OK;
    FORWARD(cli_certify(r, crust, 0));
    return cli_write_to(r, a->crust, crust);
}

/* Makes the shape of points in a plane, unless an option asks for what only space has.   done  whether it did. */
static brio_status try_plane(run *r, const brio_mesh *input, bool *done) {
    const arguments *a = r->arguments;
    brio_mesh *crust = NULL, *shape = NULL;
    brio_status status = BRIO_OK;
    bool greedy = a->labeling == defaults.labeling || a->labeling == BRIO_LABELING_GREEDY;
    *done = false;
    if (a->method == VORONOI || a->scale_axis != 0 || input->num_faces || a->sides != BRIO_SIDES_INNER || !greedy ||
        a->simplify || a->scale != 0 || a->redundancy > 0 || a->sampling_density != 0 || a->sharp || a->noise ||
        a->spacing > 0)
        return BRIO_OK;
    TRY(cli_is_flat(r, input, done));
    if (!*done) return BRIO_OK;
    status = cli_planar_shape(r, input, &crust, &shape);
    if (status == BRIO_ERR_NO_ANSWER && cli_failure(r).reason == BRIO_REASON_NOT_FLAT) {
        *done = false;
        return BRIO_OK;
    }
    cli_suggest_labeling(r, status, input, false);
    if (status != BRIO_OK) goto done;
    if (a->crust) TRY(cli_certify_edges(r, crust, NULL, true, NULL));
    if (a->crust) TRY(cli_write_to(r, a->crust, crust));
    TRY(write_shape(r, shape));
done:
    brio_mesh_free(crust);
    brio_mesh_free(shape);
    return status;
}

static void report_voronoi(run *r, const brio_voronoi_axis_stats *s, const brio_mesh *axis) {
    facts *f = &r->facts;
    cli_stage(r, "surface", s->surface_seconds);
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "facets", s->choose_seconds);
    cli_stage(r, "label", s->label_seconds);
    r->lap = cli_clock();
    cli_fact_text(f, "method", "voronoi");
    cli_fact_count(f, "samples", s->samples);
    cli_report_noise(r, s->noise, s->smoothed);
    cli_fact_count(f, "judged", s->edges);
    cli_fact_count(f, "by_angle", s->by_angle);
    cli_fact_count(f, "by_ratio", s->by_ratio);
    cli_fact_count(f, "across", s->across);
    cli_fact_count(f, "unbounded", s->unbounded);
    cli_fact_count(f, "vertices", axis->num_vertices);
    cli_fact_count(f, "faces", s->facets);
}

/* Makes the axis of facets of the Voronoi diagram.   solid  the closed mesh that was sampled, or NULL. */
static brio_status make_voronoi(run *r, const brio_mesh *points, const brio_mesh *solid, brio_mesh **axis) {
    const arguments *a = r->arguments;
    brio_voronoi_axis_stats s = {.size = sizeof s};
    brio_voronoi_axis_options o = {.size = sizeof o};
    brio_surface_options surface = {.size = sizeof surface};
    uint64_t work;
    size_t usual;
    o.noise = (brio_noise)a->noise;
    o.sides = (brio_sides)a->sides;
    o.solid = solid;
    o.theta = a->theta;
    o.rho = a->rho;
    o.seed = r->common.seed;
    FORWARD(cli_usual_points(r, points, NULL, false, &usual));
    brio_status status = brio_estimate_surface(r->ctx, usual, &surface, &work); /* which takes more than the axis */
    FORWARD(cli_require_work(r, status, points, work));
    FORWARD(brio_voronoi_axis(r->ctx, points->vertices, points->num_vertices, &o, axis, &s));
    report_voronoi(r, &s, *axis);
    return BRIO_OK;
}

static brio_status make_power_shape(run *r, const brio_mesh *points, const brio_mesh *solid, int labeling,
                                    brio_mesh **shape, brio_mesh **crust) {
    const arguments *a = r->arguments;
    brio_power_shape_stats s = {0};
    brio_power_shape_options o = medial_options(r, labeling, solid);
    uint64_t work;
    size_t usual;
    FORWARD(cli_usual_points(r, points, NULL, false, &usual));
    brio_status status = brio_estimate_power_shape(r->ctx, usual, &o, &work);
    FORWARD(cli_require_work(r, status, points, work));
    FORWARD(cli_experiment(r, &(brio_laboratory_options){.labeling = cli_label_experiment(labeling)}));
    status = brio_power_shape(r->ctx, points->vertices, points->num_vertices, &o, shape, a->crust ? crust : NULL, &s);
    cli_suggest_labeling(r, status, points, solid != NULL);
    brio_laboratory_end(r->lab);
    if (status == BRIO_OK) report(r, &o, labeling, &s, *shape);
    return status;
}

static brio_status medial(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *input = NULL, *samples = NULL, *shape = NULL, *crust = NULL;
    brio_status status = BRIO_OK;
    int labeling = a->labeling;
    bool by_mesh, planar;
    TRY(check_arguments(r));
    TRY(cli_require_output(r, false));
    TRY(cli_read(r, r->operands[0], &input));
    TRY(try_plane(r, input, &planar));
    if (planar) goto done;
    TRY(cli_settle_labeling(r, input, &labeling, &by_mesh));
    if (a->spacing > 0 && !by_mesh)
        FAIL(r, BRIO_ERR_ARGUMENT, "--spacing is for closed meshes: the points are samples already");
    if (by_mesh) TRY(sample_faces(r, input, &samples));
    const brio_mesh *points = by_mesh ? samples : input, *solid = by_mesh ? input : NULL;
    if (a->method == VORONOI)
        TRY(make_voronoi(r, points, solid, &shape));
    else
        TRY(make_power_shape(r, points, solid, labeling, &shape, &crust));
    TRY(cli_carry_properties(r, input, NULL, shape));
    if (crust) TRY(cli_carry_properties(r, input, NULL, crust));
    brio_mesh_free(input);
    input = NULL;
    TRY(cli_check_interrupt(r));
    TRY(write_crust(r, crust));
    TRY(write_shape(r, shape));
done:
    brio_mesh_free(input);
    brio_mesh_free(samples);
    brio_mesh_free(shape);
    brio_mesh_free(crust);
    return status;
}

const command cli_medial = {
    .name = "medial",
    .operands = "IN",
    .summary = "medial axis of the solid that points, or a closed mesh, bound",
    .description = "The balls of the power shape, each a vertex with the property radius, and how they are joined. A "
                   "mesh with faces says itself what is inside, and its faces are sampled; of points the labeling "
                   "finds the inside. --method voronoi takes facets of the points' Voronoi diagram instead, by an "
                   "angle and a ratio that hold for any model.",
    .examples = "brio medial scan.ply -o axis.vtp --simplify\nthe axis without what noise adds\n"
                "brio medial scan.ply -o axis.ply --scale-axis 1.2\nwithout branches that vanish in what is larger\n"
                "brio medial scan.ply -o axis.ply --method voronoi\nby facets of the Voronoi diagram of the points\n"
                "brio medial mesh.off -o axis.ply --sides both\nof a closed mesh, inside and outside\n",
    .has_output = true,
    .holds = CLI_BALLS,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = medial,
};
