/* brio voronoi: Voronoi cells of the points of a file or, with weights, power cells. */
#include "box_error.h"
#include "commands.h"
#include "estimate.h"
#include "files.h"
#include "interrupt.h"
#include "lost.h"
#include "weights.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    weights_options weights;
    const char *box, *faces;
} arguments;

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    WEIGHTS_ROWS(arguments, weights),
    {"box", 0, OPTION_TEXT, FIELD(box), "B", "clip the cells to x0,y0,z0,x1,y1,z1", 0},
    {"faces", 0, OPTION_OUTPUT, FIELD(faces), "FILE",
     "write a row for each face of each cell (.csv): site,neighbour,area,nx,ny,nz; walls are -1 to -6", 0},
    {0},
};
#undef FIELD

static const arguments defaults = {.weights.exponent = NO_EXPONENT};

/* Finds the format of -o, and whether a file of that name can be written. */
static brio_status require_output(run *r, brio_cells_format *format) {
    const common_options *c = &r->common;
    *format = BRIO_CELLS_FORMAT_AUTO;
    const arguments *a = r->arguments;
    brio_status status = a->faces ? cli_check_beside(r, "faces", a->faces, NULL) : BRIO_OK;
    if (status != BRIO_OK) return status;
    if (!c->output && (c->json || a->faces)) return BRIO_OK;
    if (!c->output) return cli_fail(r, BRIO_ERR_ARGUMENT, "no output: -o FILE is missing");
    if (c->format)
        *format = brio_cells_format_of(c->format);
    else if (strcmp(c->output, "-") != 0)
        *format = brio_cells_format_of(c->output);
    else
        return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format: vtu, npy or csv");
    if (*format == BRIO_CELLS_FORMAT_AUTO)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: a file of this format cannot hold cells, expected .vtu .npy or .csv",
                        c->output);
    if (c->compress) return cli_fail(r, BRIO_ERR_ARGUMENT, "--compress: cells are written without compression");
    return strcmp(c->output, "-") ? cli_check_target(r, c->output) : BRIO_OK;
}

/* Reads six numbers with commas between them. */
static brio_status read_box(run *r, const char *text, double box[6]) {
    const char *rest = text;
    for (int i = 0; i < 6; i++) {
        char *end;
        box[i] = strtod(rest, &end);
        if (end == rest || !isfinite(box[i]) || *end != (i < 5 ? ',' : 0))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--box: '%s' is not x0,y0,z0,x1,y1,z1", text);
        rest = end + 1;
    }
    for (int k = 0; k < 3; k++)
        if (!(box[k] < box[3 + k]))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--box: %c from %g to %g is empty", "xyz"[k], box[k], box[3 + k]);
    return BRIO_OK;
}

/* Refuses work over --max-memory. */
static brio_status require_memory(run *r, const brio_mesh *mesh, const double *weights, bool vertices) {
    double delaunay;
    size_t usual;
    brio_status status = BRIO_OK;
    TRY(cli_delaunay_bytes(r, mesh, weights, NULL, &delaunay));
    TRY(cli_usual_points(r, mesh, weights, false, &usual));
    TRY(cli_require_memory(r, cli_voronoi_bytes(delaunay, usual, vertices)));
done:
    return status;
}

static void report(run *r, const brio_cells *cells, const brio_delaunay_stats *s, bool weighted) {
    facts *f = &r->facts;
    size_t bounded = 0;
    for (size_t c = 0; c < cells->num_cells; c++) bounded += cells->bounded[c];
    cli_fact_bool(f, "weighted", weighted);
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "cells", cells->num_cells);
    cli_fact_count(f, "bounded", bounded);
    cli_fact_count(f, "faces", (size_t)cells->face_offsets[cells->num_cells]);
    cli_fact_real(f, "volume", cells->volume_sum);
}

/* Points outside are the sites of cells all the same, which seldom is what was meant. */
static void tell_outside(run *r, const brio_mesh *mesh, const double box[6]) {
    size_t outside = 0;
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        const double *p = mesh->vertices + 3 * i;
        bool inside = true;
        for (int k = 0; k < 3; k++) inside &= p[k] >= box[k] && p[k] <= box[k + 3];
        outside += !inside;
    }
    if (outside) cli_warn(r, WARNING_OUTSIDE, outside, mesh->num_vertices, r->operands[0]);
}

static brio_status report_box(run *r, const boxed_diagram *d, const brio_cells *cells) {
    brio_status status = BRIO_OK;
    double error;
    if (!d->options->box) return BRIO_OK;
    TRY(cli_box_error(r, d, cells, &error));
    tell_outside(r, d->mesh, d->options->box);
    cli_fact_real(&r->facts, "box_volume", cells->region_volume);
    cli_fact_real(&r->facts, "box_error", error);
done:
    return status;
}

static brio_status write_file(run *r, const char *path, const brio_cells *cells, brio_cells_format format) {
    brio_status status = BRIO_OK;
    if (!path) return BRIO_OK;
    TRY(cli_check_interrupt(r));
    cli_tell_idle(r, path, format != BRIO_CELLS_FORMAT_VTU && format != BRIO_CELLS_FORMAT_NPY, false);
    cli_interrupt_writing(strcmp(path, "-") != 0);
    status = brio_cells_write(r->ctx, path, cells, format, "brio " BRIO_VERSION);
    cli_interrupt_writing(false);
    cli_lap(r, "write");
done:
    return status;
}

static brio_status compute(run *r, const brio_mesh *mesh, const double *weights, brio_cells_options *o,
                           brio_triangulation **t, brio_cells **cells) {
    brio_status status = BRIO_OK;
    TRY(brio_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, NULL, t));
    const brio_delaunay_stats *s = brio_triangulation_stats(*t);
    cli_stage(r, "order", s->order_seconds);
    cli_stage(r, "insert", s->insert_seconds);
    r->lap = cli_clock();
    TRY(brio_voronoi_cells(r->ctx, *t, mesh->vertices, weights, mesh->num_vertices, o, cells));
    cli_lap(r, "cells");
done:
    return status;
}

static brio_status voronoi(run *r) {
    const arguments *a = r->arguments;
    brio_cells_options o = brio_cells_options_default();
    brio_status status = BRIO_OK;
    brio_cells_format format;
    brio_mesh *mesh = NULL;
    double *weights = NULL, box[6];
    brio_triangulation *t = NULL;
    brio_cells *cells = NULL;
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(require_output(r, &format));
    if (a->box) TRY(read_box(r, a->box, box));
    o.box = a->box ? box : NULL;
    o.vertices = format == BRIO_CELLS_FORMAT_VTU;
    TRY(cli_read_points(r, r->operands[0], &mesh));
    bool weighted = cli_is_weighted(&a->weights, mesh);
    TRY(cli_weights(r, &a->weights, mesh, &weights));
    if (cli_limits_memory(r)) TRY(require_memory(r, mesh, weights, o.vertices));
    TRY(compute(r, mesh, weights, &o, &t, &cells));
    report(r, cells, brio_triangulation_stats(t), weighted);
    TRY(report_box(r, &(boxed_diagram){t, mesh, weights, &o}, cells));
    TRY(write_file(r, r->common.output, cells, format));
    TRY(write_file(r, a->faces, cells, BRIO_CELLS_FORMAT_FACES_CSV));
done:
    brio_cells_free(cells);
    brio_triangulation_free(t);
    free(weights);
    brio_mesh_free(mesh);
    return status;
}

const command cli_voronoi = {
    .name = "voronoi",
    .operands = "IN",
    .summary = "Voronoi cells of points, power cells with weights",
    .examples = "brio voronoi atoms.xyz --box 0,0,0,1,1,1 -o cells.vtu\ncells clipped to a box, for ParaView\n"
                "brio voronoi atoms.xyz -o cells.csv\nvolume, area and centroid of each cell\n",
    .outputs = "vtu npy csv",
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = voronoi,
};
