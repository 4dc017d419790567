/* brio balls: the union of the balls of a file: its volume, its area, its surface. */
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/steps/certificate.h"
#include "cli/steps/estimate.h"
#include "cli/steps/weights.h"
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    weights_options weights;
    double error; /* 0 where it is not given */
} arguments;

static const option options[] = {
    {"error", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, error), "E",
     "of the mesh: no triangle is farther from its ball's sphere (default: a thousandth of the diagonal)", 0},
    WEIGHTS_ROWS(arguments, weights),
    {0},
};

static const arguments defaults = {.weights = {.exponent = NO_EXPONENT, .balls = true}};

/* Bytes a tetrahedron beside the filtration, and tetrahedra a ball. */
static const double TETRAHEDRON_BYTES = 100, TETRAHEDRA = 7;

static void report(run *r, const brio_ball_union_stats *s, const brio_mesh *mesh) {
    facts *f = &r->facts;
    cli_stage(r, "delaunay", s->delaunay_seconds);
    cli_stage(r, "measure", s->measure_seconds);
    cli_stage(r, "mesh", s->mesh_seconds);
    r->lap = cli_clock();
    cli_fact_count(f, "balls", s->balls);
    cli_fact_count(f, "exposed", s->exposed);
    cli_fact_real(f, "union_volume", s->volume);
    cli_fact_real(f, "union_area", s->area);
    cli_fact_count(f, "union_components", s->components);
    cli_fact_count(f, "tunnels", s->tunnels);
    cli_fact_count(f, "voids", s->voids);
    cli_fact_count(f, "patches", s->patches);
    cli_fact_count(f, "arcs", s->arcs);
    cli_fact_count(f, "corners", s->corners);
    if (!mesh) return;
    cli_fact_real(f, "error", s->error);
    cli_fact_count(f, "vertices", mesh->num_vertices);
    cli_fact_count(f, "faces", mesh->num_faces);
}

/* Gives faces the colours of their balls, where these have some, in their type: what writes or shows them knows the
 * depths of all types. */
static brio_status colour_faces(run *r, const brio_mesh *input, brio_mesh *mesh) {
    static const char *const names[] = {"red", "green", "blue"};
    const brio_metadata *depth = brio_mesh_metadata(input, "colour.depth");
    if (depth) FORWARD(brio_mesh_set_metadata(mesh, depth->name, depth->bytes, depth->size));
    for (int k = 0; k < 3; k++) {
        const brio_property *from = brio_mesh_property(input, names[k]);
        uint8_t *to;
        if (!from) continue;
        FORWARD(brio_mesh_add_face_property(mesh, names[k], from->type, (void **)&to));
        const brio_property *ball = brio_mesh_face_property(mesh, "ball");
        size_t size = brio_scalar_size(from->type);
        for (size_t f = 0; f < mesh->num_faces; f++) {
            size_t row = (size_t)brio_property_value(ball, f);
            memcpy(to + size * f, (const uint8_t *)from->data + size * row, size);
        }
    }
    return cli_check_interrupt(r);
}

static brio_status make_union(run *r, const brio_mesh *input, const double *weights) {
    const arguments *a = r->arguments;
    brio_ball_union_options o = {.size = sizeof o, .error = a->error, .seed = r->common.seed};
    brio_ball_union_stats s = {.size = sizeof s};
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_ball_union(r->ctx, input->vertices, weights, input->num_vertices, &o, NULL,
                        cli_wants_mesh(r) ? &mesh : NULL, &s));
    report(r, &s, mesh);
    if (!mesh) goto done;
    TRY(colour_faces(r, input, mesh));
    TRY(cli_certify(r, mesh, 0));
    TRY(cli_write(r, mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

static brio_status balls(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *input = NULL;
    double *weights = NULL;
    size_t usual;
    brio_status status = BRIO_OK;
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(cli_require_output(r, true));
    if (a->error > 0 && !cli_wants_mesh(r)) FAIL(r, BRIO_ERR_ARGUMENT, "--error is for the mesh: -o OUT is missing");
    TRY(cli_read_points(r, r->operands[0], &input));
    TRY(cli_weights(r, &a->weights, input, &weights));
    if (!weights)
        FAIL(r, BRIO_ERR_ARGUMENT, "%s: no radii: expected a property radius or weight, or --weights FILE",
             r->operands[0]);
    TRY(cli_usual_points(r, input, weights, false, &usual));
    TRY(cli_require_memory(r, cli_alpha_bytes(input, usual) + TETRAHEDRA * TETRAHEDRON_BYTES * (double)usual));
    TRY(make_union(r, input, weights));
done:
    free(weights);
    brio_mesh_free(input);
    return status;
}

const command cli_balls = {
    .name = "balls",
    .operands = "IN",
    .summary = "volume, area and surface of the union of balls",
    .description =
        "A point with the property radius is a ball, as brio medial writes them. Volume and area are exact up "
        "to rounding. The surface is closed and manifold; its faces have the property ball, the index of "
        "their ball, and its colour if it has one.",
    .examples =
        "brio balls axis.ply -o union.ply\nof the balls that brio medial wrote: a solid as the union of its balls\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .output_optional = true,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = balls,
};
