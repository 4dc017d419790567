/* The power crust on the command line: its options, the call, what it counts. */
#include "cli/steps/power_crust.h"
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/steps/hints.h"
#include "cli/steps/properties.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const option_choice cli_labelings[] = {{"global", BRIO_LABELING_GLOBAL},
                                       {"greedy", BRIO_LABELING_GREEDY},
                                       {"naive", LABELS_NAIVE},
                                       {"theoretical", LABELS_THEORETICAL},
                                       {NULL, 0}};

const option_choice cli_noise[] = {
    {"auto", BRIO_NOISE_AUTO}, {"keep", BRIO_NOISE_KEEP}, {"smooth", BRIO_NOISE_SMOOTH}, {NULL, 0}};

const option_choice cli_labelings_or_mesh[] = {
    {"mesh", LABELS_OF_MESH}, {"global", BRIO_LABELING_GLOBAL},    {"greedy", BRIO_LABELING_GREEDY},
    {"naive", LABELS_NAIVE},  {"theoretical", LABELS_THEORETICAL}, {NULL, 0}};

brio_status cli_settle_labeling(run *r, const brio_mesh *input, int *labeling, bool *by_mesh) {
    if (*labeling == LABELS_OF_MESH && !input->num_faces)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--labeling mesh: %s has no faces", r->operands[0]);
    *by_mesh = *labeling == LABELS_OF_MESH || (*labeling == LABELS_OF_INPUT && input->num_faces > 0);
    if (*by_mesh || *labeling == LABELS_OF_INPUT) *labeling = BRIO_LABELING_GLOBAL;
    return BRIO_OK;
}

void cli_suggest_labeling(run *r, brio_status status, const brio_mesh *input, bool by_mesh) {
    bool hollow = status == BRIO_ERR_NO_ANSWER && cli_failure(r).reason == BRIO_REASON_OPEN_MESH;
    cli_examine(r, status, input);
    if (hollow && by_mesh) cli_hint(r, HINT_LABELING);
}

brio_status cli_write_normals(run *r, const char *path, const brio_mesh *points, const double *normals) {
    static const char *const names[3] = {"nx", "ny", "nz"};
    brio_mesh *out = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_mesh_new(r->ctx, &out));
    TRY(brio_mesh_set_vertices(out, points->vertices, points->num_vertices));
    for (size_t k = 0; k < 3; k++) {
        void *data;
        TRY(brio_mesh_add_property(out, names[k], BRIO_SCALAR_FLOAT64, &data));
        for (size_t i = 0; i < points->num_vertices; i++) ((double *)data)[i] = normals[3 * i + k];
    }
    TRY(cli_copy_properties(r, points, out));
    TRY(cli_write_to(r, path, out));
done:
    brio_mesh_free(out);
    return status;
}

void cli_report_power_crust_stages(run *r, const power_crust_options *a, const brio_surface_stats *s) {
    cli_stage(r, "noise", s->noise_seconds);
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "poles", s->poles_seconds);
    cli_stage(r, "power", s->poles.power_seconds);
    cli_stage(r, "label", s->poles.label_seconds);
    cli_stage(r, "crust", s->crust_seconds);
    if (a->simplify) cli_stage(r, "simplify", s->simplify_seconds);
    r->lap = cli_clock();
}

brio_labeling cli_library_labeling(int labeling) {
    return labeling < LABELS_NAIVE ? (brio_labeling)labeling : BRIO_LABELING_GLOBAL;
}

brio_laboratory_labeling cli_label_experiment(int labeling) {
    return labeling == LABELS_NAIVE         ? BRIO_LABELS_NAIVE
           : labeling == LABELS_THEORETICAL ? BRIO_LABELS_THEORETICAL
                                            : BRIO_LABELS_NONE;
}

brio_pole_options cli_pole_options(const power_crust_options *a) {
    return (brio_pole_options){
        .labeling = cli_library_labeling(a->labeling), .sampling_density = a->sampling_density, .sharp = a->sharp};
}

brio_status cli_read_open(run *r, const power_crust_options *a, double *spacings) {
    char *end = NULL;
    *spacings = a->closed ? 0 : NAN;
    if (!a->open) return BRIO_OK;
    if (a->closed) return cli_fail(r, BRIO_ERR_ARGUMENT, "--open and --closed exclude each other");
    if (!strcmp(a->open, "auto")) return BRIO_OK;
    *spacings = strtod(a->open, &end);
    if (end == a->open || *end || !isfinite(*spacings) || *spacings < 0)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--open: expected auto or a finite number, 0 or more, got '%s'", a->open);
    return BRIO_OK;
}

/* Returns the number of --open, 0 where there is none. */
static double open_of(run *r, const power_crust_options *a) {
    double spacings;
    return cli_read_open(r, a, &spacings) == BRIO_OK && spacings > 0 ? spacings : 0;
}

void cli_report_noise(run *r, double noise, bool smoothed) {
    cli_fact_real(&r->facts, "noise", noise);
    cli_fact_bool(&r->facts, "smoothed", smoothed);
}

void cli_report_power_crust(run *r, const power_crust_options *a, const brio_surface_stats *s) {
    facts *f = &r->facts;
    cli_report_noise(r, s->noise, s->smoothed);
    cli_fact_count(f, "poles", s->poles.poles);
    cli_fact_count(f, "hidden_poles", s->poles.hidden_poles);
    cli_fact_count(f, "inner", s->poles.inner);
    cli_fact_count(f, "outer", s->poles.outer);
    cli_fact_text(f, "labeling", cli_labelings[a->labeling].name);
    cli_fact_count(f, "confused", s->poles.confused);
    cli_fact_real(f, "energy", s->poles.energy);
    if (a->labeling == LABELS_NAIVE || a->labeling == LABELS_THEORETICAL)
        cli_fact_count(f, "unreached", brio_laboratory_results(r->lab)->unreached);
    if (a->labeling == BRIO_LABELING_GLOBAL) {
        cli_fact_real(f, "energy_greedy", s->poles.energy_greedy);
        cli_fact_count(f, "undecided", s->poles.undecided);
        cli_fact_count(f, "toggled", s->poles.toggled);
    }
    if (a->sharp || a->sampling_density > 0) cli_fact_count(f, "bad_cells", s->poles.bad_cells);
    if (open_of(r, a) > 0) cli_fact_count(f, "left_out", s->left_out);
}
