/* brio voronoi: Voronoi cells of the points of a file or, with weights, power cells. */
#include "cli/files/files.h"
#include "cli/files/lost.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/run/interrupt.h"
#include "cli/run/run.h"
#include "cli/steps/estimate.h"
#include "cli/steps/periodic.h"
#include "cli/steps/tiles.h"
#include "cli/steps/weights.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- how far cells are from filling their box --- */

/* How far the cells in a box are from filling it.
 *
 * A box of side 2^-400 has the volume 0 in doubles, and so have its cells. Their volumes are then computed once more
 * with all lengths times a power of two by which the box has a volume near 1: cells of such points are the same
 * cells. */

/** What cells in a box were computed from. */
typedef struct boxed_diagram {
    const brio_triangulation *t;
    const brio_mesh *mesh;
    const double *weights;             /* NULL without weights */
    const brio_cells_options *options; /* with a box */
} boxed_diagram;

static double error_of(const brio_cells *cells) {
    return fabs(cells->volume_sum / cells->region_volume - 1);
}

/* Returns the exponent of the power of two that makes the volume of a box about 1. */
static int exponent_of(const double box[6]) {
    int sum = 0;
    for (int k = 0; k < 3; k++) sum += ilogb(box[3 + k] / 2 - box[k] / 2) + 1;
    return -sum / 3;
}

/* Multiplies numbers by 2^exponent. Returns NULL without memory, or without numbers. */
static double *scaled(const double *x, size_t count, int exponent) {
    double *out = x ? malloc((count + 1) * sizeof *out) : NULL;
    if (!out) return NULL;
    for (size_t i = 0; i < count; i++) out[i] = ldexp(x[i], exponent);
    return out;
}

static bool are_finite(const double *x, size_t count) {
    for (size_t i = 0; i < count && x; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

static brio_status scaled_error(run *r, const boxed_diagram *d, double *error) {
    brio_status status = BRIO_OK;
    brio_cells_options o = *d->options;
    brio_cells *cells = NULL;
    size_t n = d->mesh->num_vertices;
    int exponent = exponent_of(o.box);
    double *box = scaled(o.box, 6, exponent), *points = scaled(d->mesh->vertices, 3 * n, exponent);
    double *weights = scaled(d->weights, n, 2 * exponent);
    if (!box || (n && !points) || (d->weights && !weights))
        FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu scaled points", n);
    if (!are_finite(box, 6) || !are_finite(points, 3 * n) || !are_finite(weights, n)) goto done;
    o.no_areas = o.no_centroids = o.no_faces = 1;
    o.vertices = 0;
    o.box = box;
    TRY(brio_voronoi_cells(r->ctx, d->t, points, weights, n, &o, &cells));
    *error = error_of(cells);
done:
    brio_cells_free(cells);
    free(box), free(points), free(weights);
    return status;
}

/* Finds the difference of the cells' volume and the box's, as a share of the box's: NaN where doubles cannot hold what
 * it
 *  needs. */
static brio_status cli_box_error(run *r, const boxed_diagram *d, const brio_cells *cells, double *error) {
    *error = NAN;
    if (!cli_volume_is_held(cells->region_volume)) return scaled_error(r, d, error);
    *error = error_of(cells);
    return BRIO_OK;
}

/* --- the command --- */

typedef struct arguments {
    weights_options weights;
    periodic_options periodic;
    const char *box, *faces;
    uint64_t tiles; /* 0: not given */
} arguments;

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    WEIGHTS_ROWS(arguments, weights),
    PERIODIC_ROWS(arguments, periodic),
    TILES_ROWS(arguments, tiles),
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
    brio_status status = a->faces ? cli_check_beside(r, "faces", a->faces) : BRIO_OK;
    if (status != BRIO_OK) return status;
    if (!c->output && (c->json || a->faces || cli_showing(r))) return BRIO_OK;
    if (!c->output) return cli_fail_output(r, "no output: -o FILE is missing");
    if (c->format)
        *format = brio_cells_format_of(c->format);
    else if (strcmp(c->output, "-") != 0)
        *format = brio_cells_format_of(c->output);
    else
        return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format: vtu, npy or csv");
    if (*format == BRIO_CELLS_FORMAT_AUTO)
        return cli_fail_output(r, "%s: a file of this format cannot hold cells, expected .vtu .npy or .csv", c->output);
    if (c->compress) return cli_fail(r, BRIO_ERR_ARGUMENT, "--compress: cells are written without compression");
    return strcmp(c->output, "-") ? cli_check_target(r, c->output) : BRIO_OK;
}

/* Refuses work over --max-memory. */
static brio_status require_memory(run *r, const brio_mesh *mesh, const double *weights, bool vertices) {
    const arguments *a = r->arguments;
    double delaunay;
    size_t usual;
    if (cli_is_periodic(&a->periodic)) {
        FORWARD(cli_periodic_cells_bytes(r, &a->periodic, mesh, weights, vertices, &delaunay));
        return cli_require_memory(r, delaunay);
    }
    FORWARD(cli_delaunay_bytes(r, mesh, weights, NULL, &delaunay));
    FORWARD(cli_usual_points(r, mesh, weights, false, &usual));
    return cli_require_memory(r, cli_voronoi_bytes(delaunay, usual, vertices));
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

/* Warns of points outside: they are the sites of cells all the same, which seldom is what was meant. */
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
    double error;
    if (!d->options->box) return BRIO_OK;
    FORWARD(cli_box_error(r, d, cells, &error));
    tell_outside(r, d->mesh, d->options->box);
    cli_fact_real(&r->facts, "box_volume", cells->region_volume);
    cli_fact_real(&r->facts, "box_error", error);
    return BRIO_OK;
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

static brio_status show(run *r, const brio_mesh *mesh, const brio_cells *cells) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    shown_cells s = {.all = cells->num_cells, .has_sites = true};
    bool open = !a->box && !cli_is_periodic(&a->periodic);
    if (!cli_showing(r)) return BRIO_OK;
    if (open) cli_shown_cells_stay_near(&s, mesh->vertices, mesh->num_vertices);
    TRY(cli_shown_cells_add(r, &s, cells, NULL));
    status = cli_shown_cells_show(r, &s);
done:
    cli_shown_cells_free(&s);
    return status;
}

static brio_status compute(run *r, const brio_mesh *mesh, const double *weights, brio_cells_options *o,
                           brio_triangulation **t, brio_cells **cells) {
    FORWARD(brio_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, NULL, t));
    const brio_delaunay_stats *s = brio_triangulation_stats(*t);
    cli_stage(r, "order", s->order_seconds);
    cli_stage(r, "insert", s->insert_seconds);
    r->lap = cli_clock();
    FORWARD(brio_voronoi_cells(r->ctx, *t, mesh->vertices, weights, mesh->num_vertices, o, cells));
    cli_lap(r, "cells");
    return BRIO_OK;
}

/* Reports cells of space that repeats. */
static void report_periodic(run *r, const brio_cells *cells) {
    size_t bounded = 0;
    for (size_t c = 0; c < cells->num_cells; c++) bounded += cells->bounded[c];
    cli_fact_count(&r->facts, "cells", cells->num_cells);
    cli_fact_count(&r->facts, "bounded", bounded);
    cli_fact_count(&r->facts, "faces", (size_t)cells->face_offsets[cells->num_cells]);
    cli_fact_real(&r->facts, "volume", cells->volume_sum);
}

static brio_status compute_periodic(run *r, const brio_mesh *mesh, const double *weights, const brio_cells_options *o,
                                    brio_cells **cells) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    TRY(cli_periodic(r, &a->periodic, mesh, weights, &t));
    TRY(brio_periodic_cells(r->ctx, t, o, cells));
    cli_lap(r, "cells");
    report_periodic(r, *cells);
done:
    brio_periodic_free(t);
    return status;
}

/* --- in tiles --- */

/* Where the cells of tiles go: NULL is nowhere. */
typedef struct {
    run *r;
    brio_cells_table *cells, *faces;
    brio_status status;
} tables;

static int take_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    tables *t = user;
    if (t->cells) t->status = brio_cells_table_add(t->r->ctx, t->cells, cells, site);
    if (t->faces && t->status == BRIO_OK) t->status = brio_cells_table_add(t->r->ctx, t->faces, cells, site);
    if (t->status != BRIO_OK) cli_keep_failure(t->r, t->status);
    return t->status != BRIO_OK;
}

static brio_status check_tiles(run *r, brio_cells_format format) {
    const arguments *a = r->arguments;
    if (cli_is_periodic(&a->periodic)) return cli_fail(r, BRIO_ERR_ARGUMENT, "--cell, --periodic: not with --tiles");
    if (format == BRIO_CELLS_FORMAT_VTU)
        return cli_fail_output(r, "%s: --tiles writes cells to .npy and .csv", r->common.output);
    return cli_check_tiles(r, &a->weights, a->tiles);
}

/* What takes the cells that are shown. */
typedef struct {
    run *r;
    shown_cells shown;
    brio_status status;
} showing;

static int take_shown(const brio_cells *cells, const uint64_t *site, void *user) {
    showing *s = user;
    s->status = cli_shown_cells_add(s->r, &s->shown, cells, site);
    if (s->status != BRIO_OK) cli_keep_failure(s->r, s->status);
    return s->status != BRIO_OK;
}

/* Reads where the vertices of all tiles are: cells are shown near them. */
static brio_status stay_near(run *r, brio_tiles *t, shown_cells *shown) {
    const arguments *a = r->arguments;
    for (uint32_t i = 0; i < a->tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        FORWARD(brio_tiles_part(r->ctx, t, i, &part));
        cli_shown_cells_stay_near(shown, part.points, part.num_vertices);
        brio_tile_part_free(r->ctx, &part);
        FORWARD(cli_check_interrupt(r));
    }
    return BRIO_OK;
}

/* Shows cells of all tiles, or an even choice. They are computed once more, with vertices, tile after tile. */
static brio_status show_tiles(run *r, brio_tiles *t, const brio_cells_options *clipped) {
    brio_status status = BRIO_OK;
    brio_cells_options o = *clipped;
    showing s = {.r = r};
    if (!cli_showing(r)) return BRIO_OK;
    s.shown.all = brio_tiles_cells_facts(t)->cells;
    s.shown.has_sites = brio_tiles_facts(t)->points <= UINT32_MAX;
    o.vertices = 1;
    if (!o.box) TRY(stay_near(r, t, &s.shown));
    brio_status ended = brio_tiles_cells(r->ctx, t, &o, 0, take_shown, &s);
    TRY(s.status); /* why the function ended it */
    TRY(ended);
    status = cli_shown_cells_show(r, &s.shown);
done:
    cli_shown_cells_free(&s.shown);
    return status;
}

/* Writes the rows of all cells in the order of their sites, as without tiles. */
static brio_status voronoi_in_tiles(run *r, const brio_cells_options *o, brio_cells_format format) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_tiles *t = NULL;
    tables out = {.r = r};
    TRY(cli_triangulate_tiles(r, &a->weights, a->tiles, a->faces ? 1 : 3, &t));
    uint64_t vertices = brio_tiles_facts(t)->vertices;
    cli_interrupt_writing((r->common.output && strcmp(r->common.output, "-") != 0) || a->faces);
    if (r->common.output) TRY(brio_cells_table_new(r->ctx, r->common.output, format, vertices, &out.cells));
    if (a->faces) TRY(brio_cells_table_new(r->ctx, a->faces, BRIO_CELLS_FORMAT_FACES_CSV, vertices, &out.faces));
    if (out.cells) cli_tell_idle(r, r->common.output, format != BRIO_CELLS_FORMAT_NPY, false);
    if (out.faces) cli_tell_idle(r, a->faces, true, false);
    brio_status ended = brio_tiles_cells(r->ctx, t, o, a->faces ? 1 : 2, take_cells, &out);
    TRY(out.status); /* why the function ended it */
    TRY(ended);
    cli_lap(r, "cells");
    cli_report_tile_cells(r, brio_tiles_facts(t), brio_tiles_cells_facts(t));
    TRY(cli_check_interrupt(r));
    if (out.cells) TRY(brio_cells_table_finish(r->ctx, out.cells));
    if (out.faces) TRY(brio_cells_table_finish(r->ctx, out.faces));
    cli_lap(r, "write");
    cli_interrupt_writing(false);
    status = show_tiles(r, t, o);
done:
    brio_cells_table_free(out.cells);
    brio_cells_table_free(out.faces);
    cli_interrupt_writing(false);
    brio_tiles_free(t);
    return status;
}

static brio_status voronoi(run *r) {
    const arguments *a = r->arguments;
    brio_cells_options o = {0};
    brio_status status = BRIO_OK;
    brio_cells_format format;
    brio_mesh *mesh = NULL;
    double *weights = NULL, box[6];
    brio_triangulation *t = NULL;
    brio_cells *cells = NULL;
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(require_output(r, &format));
    TRY(cli_check_periodic(r, &a->periodic));
    if (a->box) TRY(cli_read_box(r, a->box, box));
    o.box = a->box ? box : NULL;
    if (a->tiles) {
        TRY(check_tiles(r, format));
        return voronoi_in_tiles(r, &o, format);
    }
    o.vertices = format == BRIO_CELLS_FORMAT_VTU || cli_showing(r);
    TRY(cli_read_points(r, r->operands[0], &mesh));
    bool weighted = cli_is_weighted(&a->weights, mesh);
    TRY(cli_weights(r, &a->weights, mesh, &weights));
    if (cli_limits_memory(r)) TRY(require_memory(r, mesh, weights, o.vertices));
    cli_tell_cell(r, &a->periodic, mesh);
    if (cli_is_periodic(&a->periodic)) {
        TRY(compute_periodic(r, mesh, weights, &o, &cells));
    } else {
        TRY(compute(r, mesh, weights, &o, &t, &cells));
        report(r, cells, brio_triangulation_stats(t), weighted);
        TRY(report_box(r, &(boxed_diagram){t, mesh, weights, &o}, cells));
    }
    TRY(write_file(r, r->common.output, cells, format));
    TRY(write_file(r, a->faces, cells, BRIO_CELLS_FORMAT_FACES_CSV));
    TRY(show(r, mesh, cells));
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
                "brio voronoi atoms.xyz --box 0,0,0,1,1,1 --view cells.html\na page that moves the cells apart\n"
                "brio voronoi atoms.xyz -o cells.csv\nvolume, area and centroid of each cell\n"
                "brio voronoi atoms.xyz --cell 20,20,20 -o cells.csv\natoms in a box that repeats\n"
                "brio voronoi scan.las --tiles 8 --scratch /var/tmp -o cells.npy\nmore points than fit in memory\n",
    .has_output = true,
    .outputs = ".vtu .npy .csv",
    .shown = true,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = voronoi,
};
