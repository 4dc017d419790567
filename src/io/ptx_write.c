/* Writes PTX files: the points of each scanner's place as a scan, in rows and columns where their places in a grid are
 * known.
 *
 * All points are seen before the first one is written, for the scans (scans.h) and their grids. A scan whose points go
 * column by column is written as its grid, with lines of zeros where no point is; any other one as a grid of one row.
 * The matrix moves by the scanner's place and does not turn.
 *
 * Based on: Leica Geosystems. Description of the PTX format. */
#include "base/memory.h"
#include "io/scans.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { AXES = 3, COLOURS = 3, CELLS_A_POINT = 16 /* of a grid, at most; chosen */ };

/* A line of zeros stands for no point. A point at the scanner's place itself is written this far from it. */
static const double BESIDE = 1e-30;

typedef struct {
    brio_scans scans; /* first: BRIO_SCANS_ROWS */
    bool *has;        /* of each property: whether the file has a place for it */
    size_t num_properties;
    bool has_colours;
    uint64_t cell; /* of the scan's grid, the next one */
} ptx_writer;

static bool has_grid(const brio_scan *scan) {
    return scan->grid && scan->points && scan->columns <= CELLS_A_POINT * scan->points &&
           scan->rows <= CELLS_A_POINT * scan->points / scan->columns;
}

/* --- beginning --- */

/* Returns the colours, if they are bytes, without alpha. */
static brio_channels colours_of(const brio_mesh *m) {
    brio_channels c = brio_colour_of(m);
    if (c.count > COLOURS) c.count = COLOURS;
    if (c.count && c.of[0]->type != BRIO_SCALAR_UINT8) c.count = 0;
    return c;
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    ptx_writer *w = state;
    const brio_mesh *m = job->mesh;
    const brio_channels colours = colours_of(m);
    bool grids = true;
    BRIO_FORWARD(brio_scans_settle(out->ctx, &w->scans));
    for (size_t i = 0; i < w->scans.count; i++) grids &= has_grid(&w->scans.list[i]);
    w->num_properties = m->num_properties;
    w->has_colours = colours.count != 0;
    BRIO_FORWARD(BRIO_ALLOC(out->ctx, w->has, m->num_properties + 1));
    for (size_t i = 0; i < m->num_properties; i++) {
        const char *name = m->properties[i].name;
        bool place_in_grid = !strcmp(name, "row_index") || !strcmp(name, "column_index");
        w->has[i] = !strcmp(name, "intensity") || brio_channels_have(&colours, &m->properties[i]) ||
                    brio_scans_hold(&w->scans, m, i) || (grids && place_in_grid);
    }
    return BRIO_OK;
}

/* --- scans --- */

static brio_status write_header(brio_output *out, const brio_scan *scan) {
    const double *place = scan->place;
    bool grid = has_grid(scan);
    BRIO_FORWARD(brio_output_format(out, "%" PRIu64 "\n%" PRIu64 "\n", grid ? scan->columns : scan->points,
                                    grid ? scan->rows : (uint64_t)(scan->points > 0)));
    BRIO_FORWARD(brio_output_point(out, place));
    BRIO_FORWARD(brio_output_string(out, "\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"));
    BRIO_FORWARD(brio_output_point(out, place));
    return brio_output_string(out, " 1\n");
}

/* Writes lines for cells without a point, up to a cell. */
static brio_status fill_to(brio_output *out, ptx_writer *w, uint64_t cell) {
    for (; w->cell < cell; w->cell++)
        BRIO_FORWARD(brio_output_string(out, w->has_colours ? "0 0 0 0.5 0 0 0\n" : "0 0 0 0.5\n"));
    return BRIO_OK;
}

static brio_status write_coordinates(brio_output *out, ptx_writer *w, const double *place, const double *point) {
    double local[AXES], far = 0;
    for (int k = 0; k < AXES; k++) local[k] = place[k] == 0 ? point[k] : point[k] - place[k];
    if (local[0] == 0 && local[1] == 0 && local[2] == 0) local[0] = BESIDE;
    for (int k = 0; k < AXES; k++) far = fmax(far, fabs(local[k] + place[k] - point[k]));
    w->scans.moved = fmax(w->scans.moved, far * sqrt(AXES));
    return brio_output_point(out, local);
}

static brio_status write_point(brio_output *out, ptx_writer *w, const brio_mesh *m, const brio_scan *scan, size_t v) {
    const brio_property *intensity = brio_mesh_property(m, "intensity");
    const brio_channels colours = colours_of(m);
    BRIO_FORWARD(write_coordinates(out, w, scan->place, m->vertices + AXES * v));
    BRIO_FORWARD(intensity ? brio_output_scalar(out, ' ', intensity, v) : brio_output_string(out, " 0.5"));
    for (int k = 0; k < colours.count; k++) BRIO_FORWARD(brio_output_scalar(out, ' ', colours.of[k], v));
    BRIO_FORWARD(brio_output_string(out, "\n"));
    w->cell++;
    return BRIO_OK;
}

static brio_status write_part(brio_output *out, ptx_writer *w, const brio_mesh *m, const brio_scan_part *part) {
    const brio_scan *scan = part->scan;
    const brio_property *column = brio_mesh_property(m, "column_index"), *row = brio_mesh_property(m, "row_index");
    bool grid = has_grid(scan);
    if (part->begins) {
        w->cell = 0;
        BRIO_FORWARD(write_header(out, scan));
    }
    for (size_t v = part->first; v < part->end; v++) {
        if (grid)
            BRIO_FORWARD(fill_to(
                out, w, (uint64_t)brio_property_value(column, v) * scan->rows + (uint64_t)brio_property_value(row, v)));
        BRIO_FORWARD(write_point(out, w, m, scan, v));
    }
    if (part->ends && grid) BRIO_FORWARD(fill_to(out, w, scan->columns * scan->rows));
    return BRIO_OK;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    ptx_writer *w = state;
    brio_scan_part part = {.end = 0};
    w->scans.moved = 0;
    while (brio_scans_next(&w->scans, job->mesh, &part)) BRIO_FORWARD(write_part(out, w, job->mesh, &part));
    w->scans.rounds |= w->scans.moved > 0;
    return BRIO_OK;
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    const ptx_writer *w = state;
    return job->points ? BRIO_OK : write_header(out, &w->scans.list[0]);
}

/* --- what is lost --- */

static bool lacks(const void *state, size_t i) {
    const ptx_writer *w = state;
    return i < w->num_properties && !w->has[i];
}

static bool renames(const void *state, size_t i) {
    (void)state, (void)i;
    return false;
}

static void free_state(brio_context *ctx, void *state) {
    ptx_writer *w = state;
    brio_scans_free(ctx, &w->scans);
    brio_release(ctx, w->has);
}

const brio_row_format brio_ptx_rows = {.state = sizeof(ptx_writer),
                                       BRIO_SCANS_ROWS,
                                       .begin = begin,
                                       .rows = write_rows,
                                       .end = end,
                                       .free = free_state,
                                       .renames = renames,
                                       .lacks = lacks};
