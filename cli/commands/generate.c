/* brio generate: test data, the same for the same seed. */
#include "brio/testdata.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct arguments {
    uint64_t points; /* NO_COUNT: not given */
    double noise;    /* NaN: not given */
    int views;       /* 0: not given */
    const char *truth;
    uint64_t truth_resolution;
    int solid; /* NO_SOLID: not given */
    uint64_t resolution;
} arguments;

#define NO_COUNT UINT64_MAX
#define NO_SOLID (-1)

static const option_choice solids[] = {{"implicit", BRIO_SOLID_IMPLICIT}, {"machined", BRIO_SOLID_MACHINED}, {NULL, 0}};

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    {"", 0, OPTION_TITLE, 0, NULL, "kinds", 0},
    {"cube ball", 0, OPTION_NOTE, 0, NULL, "points inside, uniform", 0},
    {"sphere torus cylinder", 0, OPTION_NOTE, 0, NULL, "points exactly on the surface, a hard case", 0},
    {"grid", 0, OPTION_NOTE, 0, NULL, "an integer grid, where everything is a tie", 0},
    {"moment", 0, OPTION_NOTE, 0, NULL, "points of the moment curve: quadratically many tetrahedra", 0},
    {"clusters", 0, OPTION_NOTE, 0, NULL, "points in clusters", 0},
    {"scan", 0, OPTION_NOTE, 0, NULL, "a simulated laser scan of a sculpture", 0},
    {"depth", 0, OPTION_NOTE, 0, NULL, "a frame of a simulated depth camera, depths rounded to 1 mm", 0},
    {"solid", 0, OPTION_NOTE, 0, NULL, "a random closed surface, as a mesh; see also brio iso", 0},
    {"", 0, OPTION_TITLE, 0, NULL, "options", 0},
    {"points", 'n', OPTION_NATURAL, FIELD(points), "N", "number of points", 0},
    {"noise", 0, OPTION_NUMBER, FIELD(noise), "S", "scan: noise, in units of the spacing (default 0.05)", 0},
    {"views", 0, OPTION_INT | OPTION_POSITIVE, FIELD(views), "V", "scan: number of sensor positions (default 12)", 0},
    {"truth", 0, OPTION_OUTPUT, FIELD(truth), "FILE", "scan: also write the surface that is scanned", 0},
    {"truth-resolution", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(truth_resolution), "R",
     "cells along its longest side (default 160)", 0},
    {"kind", 0, OPTION_CHOICE, FIELD(solid), "KIND", "solid: family (default implicit)", solids},
    {"resolution", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(resolution), "R",
     "solid: cells along its longest side (default 144)", 0},
    {0},
};
#undef FIELD

static const arguments defaults = {.points = NO_COUNT, .noise = NAN, .solid = NO_SOLID};

#define KINDS "cube ball sphere torus cylinder grid scan clusters moment depth solid"
#define SOLID BRIO_KIND_END /* no kind of points */

static const option_choice kinds[] = {{"cube", BRIO_KIND_CUBE},
                                      {"ball", BRIO_KIND_BALL},
                                      {"sphere", BRIO_KIND_SPHERE},
                                      {"torus", BRIO_KIND_TORUS},
                                      {"cylinder", BRIO_KIND_CYLINDER},
                                      {"grid", BRIO_KIND_GRID},
                                      {"scan", BRIO_KIND_SCAN},
                                      {"clusters", BRIO_KIND_CLUSTERS},
                                      {"moment", BRIO_KIND_MOMENT},
                                      {"depth", BRIO_KIND_DEPTH},
                                      {"moment-curve", BRIO_KIND_MOMENT},
                                      {"solid", SOLID},
                                      {NULL, 0}};

static const char *kind_name(const void *list, size_t i) {
    return ((const option_choice *)list)[i].name;
}

static brio_status find_kind(run *r, int *kind) {
    const char *name = r->operands[0];
    for (const option_choice *k = kinds; k->name; k++) {
        *kind = k->value;
        if (!strcmp(k->name, name)) return BRIO_OK;
    }
    const char *near = cli_nearest(name, kind_name, kinds);
    if (near) return cli_fail(r, BRIO_ERR_ARGUMENT, "unknown kind '%s'; did you mean '%s'?", name, near);
    return cli_fail(r, BRIO_ERR_ARGUMENT, "unknown kind '%s'; there are " KINDS, name);
}

static bool has_scan_options(const arguments *a) {
    return !isnan(a->noise) || a->views || a->truth || a->truth_resolution;
}

static brio_status check_arguments(run *r, const arguments *a, brio_kind kind) {
    if (a->solid != NO_SOLID || a->resolution)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--kind and --resolution go with solid only");
    if (a->points == NO_COUNT)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "the number of points is missing, or too large: -n N");
    if (kind != BRIO_KIND_SCAN && has_scan_options(a))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--noise, --views, --truth and --truth-resolution go with scan only");
    if (a->noise < 0) return cli_fail(r, BRIO_ERR_ARGUMENT, "--noise: %g is negative", a->noise);
    if (a->truth_resolution && !a->truth) return cli_fail(r, BRIO_ERR_ARGUMENT, "--truth-resolution goes with --truth");
    if (a->truth_resolution && (a->truth_resolution < 4 || a->truth_resolution > 32768))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--truth-resolution: %llu is not between 4 and 32768",
                        (unsigned long long)a->truth_resolution);
    FORWARD(cli_require_output(r, false));
    if (!a->truth) return BRIO_OK;
    return cli_check_mesh_beside(r, "truth", a->truth, CLI_SURFACES);
}

static brio_status write_truth(run *r, const arguments *a) {
    brio_mesh *truth = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_generate_truth(r->ctx, (size_t)a->truth_resolution, &truth));
    cli_lap(r, "truth");
    TRY(cli_write_to(r, a->truth, truth));
    cli_fact_count(&r->facts, "truth_vertices", truth->num_vertices);
    cli_fact_count(&r->facts, "truth_faces", truth->num_faces);
done:
    brio_mesh_free(truth);
    return status;
}

static brio_status generate_points(run *r, const arguments *a, brio_kind kind) {
    brio_generate_options o = {0};
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    TRY(check_arguments(r, a, kind));
    TRY(cli_require_work(r, BRIO_OK, NULL, brio_estimate_generate((size_t)a->points)));
    o.seed = r->common.seed;
    if (!isnan(a->noise)) o.noise = a->noise > 0 ? a->noise : -1;
    if (a->views) o.views = a->views;
    TRY(brio_generate(r->ctx, kind, (size_t)a->points, &o, &mesh));
    cli_lap(r, "generate");
    cli_fact_count(&r->facts, "points", mesh->num_vertices);
    TRY(cli_write(r, mesh));
    if (a->truth) TRY(write_truth(r, a));
done:
    brio_mesh_free(mesh);
    return status;
}

static brio_status generate_solid(run *r, const arguments *a) {
    brio_solid_kind kind = a->solid == NO_SOLID ? BRIO_SOLID_IMPLICIT : (brio_solid_kind)a->solid;
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    if (a->points != NO_COUNT || has_scan_options(a))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "a solid takes --kind, --seed and --resolution, and no number of points");
    TRY(cli_require_output_holding(r, CLI_SURFACES, false));
    TRY(brio_generate_solid(r->ctx, kind, r->common.seed, (size_t)a->resolution, &mesh));
    cli_lap(r, "generate");
    cli_fact_count(&r->facts, "vertices", mesh->num_vertices);
    cli_fact_count(&r->facts, "faces", mesh->num_faces);
    TRY(cli_certify(r, mesh, 0));
    TRY(cli_write(r, mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

static brio_status generate(run *r) {
    const arguments *a = r->arguments;
    int kind;
    FORWARD(cli_refuse_input_options(r));
    FORWARD(find_kind(r, &kind));
    return kind == SOLID ? generate_solid(r, a) : generate_points(r, a, (brio_kind)kind);
}

const command cli_generate = {
    .name = "generate",
    .operands = "KIND",
    .summary = "test data, the same for the same seed",
    .examples = "brio generate scan -n 60000 -o scan.ply\na simulated laser scan of a sculpture of genus 3\n"
                "brio generate cube -n 1e6 -o cube.ply\nuniform in a cube\n"
                "brio generate solid --kind machined --seed 7 -o part.ply\na random machine part, as a mesh\n",
    .has_output = true,
    .choices = kinds,
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1,
    .first_input = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = generate,
};
