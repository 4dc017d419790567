/* PTX files: scans as grids of rows, each scan with its own position.
 *
 * A scan begins with the numbers of columns and rows, the scanner's position and axes, and a matrix of 4 by 4 by which
 * a row (x, y, z, 1) is multiplied. A point at the origin is a place without a return and is left out. Points go column
 * by column.
 *
 * All points are seen before the first one is written, for the scans (scans.h) and their grids. A scan whose points go
 * column by column is written as its grid, with lines of zeros where no point is; any other one as a grid of one row.
 * The matrix moves by the scanner's place and does not turn.
 *
 * Based on: Leica Geosystems. Description of the PTX format. */
#include "base/memory.h"
#include "io/builder.h"
#include "io/formats.h"
#include "io/scans.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* --- reading --- */

enum {
    SCANNER = 12 /* numbers of position and axes */,
    PLACE = 3 /* the position */,
    MATRIX = 16,
    LEAST = 3,
    INTENSITY = 4,
    COLOURS = 7
};

typedef struct {
    brio_text text;
    brio_builder *builder;
    double matrix[MATRIX], place[PLACE];
    int columns;            /* numbers of a point: 3, 4 or 7; 0 before the first point */
    uint64_t rows;          /* of the scan's grid */
    size_t first_place;     /* builder->scans: the property column_index, which row_index follows */
    bool begun, has_places; /* whether a scan came before; builder->scans: whether these properties are there */
} ptx_reader;

static brio_status read_scan_header(ptx_reader *r, uint64_t *points) {
    uint64_t columns, rows;
    double ignored, before[PLACE];
    brio_builder *b = r->builder;
    memcpy(before, r->place, sizeof before);
    BRIO_FORWARD(brio_text_count(&r->text, "the number of columns", UINT32_MAX, &columns));
    BRIO_FORWARD(brio_text_count(&r->text, "the number of rows", UINT32_MAX, &rows));
    for (int i = 0; i < SCANNER; i++) BRIO_FORWARD(brio_text_number(&r->text, i < PLACE ? &r->place[i] : &ignored));
    for (int i = 0; i < MATRIX; i++) BRIO_FORWARD(brio_text_number(&r->text, &r->matrix[i]));
    if (r->place[0] == 0 && r->place[1] == 0 && r->place[2] == 0)
        for (int k = 0; k < PLACE; k++) r->place[k] = r->matrix[12 + k]; /* some programs write the place there only */
    BRIO_FORWARD(brio_text_row_end(&r->text));
    if (columns > 1 && rows > 1 && !b->scans) BRIO_FORWARD(brio_builder_leave_out(b, "order in rows"));
    for (int i = 0; i < MATRIX; i++) {
        bool moves = i >= MATRIX - 4 && i < MATRIX - 1;
        if (r->matrix[i] != (i % 5 == 0) && !(moves && b->scans))
            BRIO_FORWARD(brio_builder_leave_out(b, b->scans ? "turns of scanners" : "poses"));
    }
    if (r->begun && (!b->scans || !memcmp(before, r->place, sizeof before)))
        BRIO_FORWARD(brio_builder_leave_out(b, "scans"));
    r->begun = true;
    r->rows = rows;
    *points = columns * rows;
    return BRIO_OK;
}

/* Adds the properties that the first point of the file has. */
static brio_status plan(ptx_reader *r, int columns) {
    static const char *const colours[] = {"red", "green", "blue"};
    brio_stream *s = r->text.stream;
    BRIO_EXPECT(s->ctx, columns == LEAST || columns == INTENSITY || columns == COLOURS, BRIO_ERR_FORMAT,
                "%s: line %zu: %d numbers, expected 3, 4 or 7", s->name, s->line, columns);
    BRIO_EXPECT(s->ctx, !r->columns || columns == r->columns, BRIO_ERR_FORMAT,
                "%s: line %zu: %d numbers, the first point has %d", s->name, s->line, columns, r->columns);
    if (r->columns) return BRIO_OK;
    r->columns = columns;
    if (columns >= INTENSITY) BRIO_FORWARD(brio_builder_property(r->builder, "intensity", BRIO_SCALAR_FLOAT32));
    for (int i = 0; i < 3 && columns == COLOURS; i++)
        BRIO_FORWARD(brio_builder_property(r->builder, colours[i], BRIO_SCALAR_UINT8));
    BRIO_FORWARD(brio_plan_origins(r->builder));
    if (!r->builder->scans) return BRIO_OK;
    r->first_place = r->builder->mesh->num_properties;
    BRIO_FORWARD(brio_builder_property(r->builder, "column_index", BRIO_SCALAR_UINT32));
    BRIO_FORWARD(brio_builder_property(r->builder, "row_index", BRIO_SCALAR_UINT32));
    r->has_places = true;
    return BRIO_OK;
}

static brio_status add_point(ptx_reader *r, const double *values) {
    brio_stream *s = r->text.stream;
    double point[3];
    if (values[0] == 0 && values[1] == 0 && values[2] == 0) return BRIO_OK;
    for (int k = 0; k < 3; k++)
        point[k] =
            values[0] * r->matrix[k] + values[1] * r->matrix[4 + k] + values[2] * r->matrix[8 + k] + r->matrix[12 + k];
    BRIO_FORWARD(brio_builder_vertex(r->builder, point));
    brio_mesh *m = r->builder->mesh;
    size_t v = m->num_vertices - 1;
    brio_set_origins(r->builder, v, r->place);
    if (r->has_places) {
        ((uint32_t *)m->properties[r->first_place].data)[v] = (uint32_t)(s->row / r->rows);
        ((uint32_t *)m->properties[r->first_place + 1].data)[v] = (uint32_t)(s->row % r->rows);
    }
    if (r->columns >= INTENSITY) ((float *)m->properties[0].data)[v] = (float)values[3];
    for (int i = 0; i < 3 && r->columns == COLOURS; i++) {
        double colour = values[4 + i];
        BRIO_EXPECT(s->ctx, colour >= 0 && colour <= 255 && colour == floor(colour), BRIO_ERR_FORMAT,
                    "%s: line %zu: the colour %g, expected a whole number from 0 to 255", s->name, s->line, colour);
        ((uint8_t *)m->properties[1 + i].data)[v] = (uint8_t)colour;
    }
    return BRIO_OK;
}

static brio_status read_point(ptx_reader *r) {
    double values[COLOURS];
    int columns = 0;
    BRIO_FORWARD(brio_text_number(&r->text, &values[columns++]));
    while (columns < COLOURS && brio_text_more(&r->text)) BRIO_FORWARD(brio_text_number(&r->text, &values[columns++]));
    BRIO_FORWARD(brio_text_row_end(&r->text));
    BRIO_FORWARD(plan(r, columns));
    return add_point(r, values);
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    ptx_reader r = {.text = {s, 0, NULL}, .builder = b};
    uint64_t points = 0;
    brio_builder_stream(b, BRIO_COUNT_UNKNOWN);
    do {
        brio_stream_element(s, "scan's header", 1);
        status = read_scan_header(&r, &points);
        if (r.begun && brio_salvage(b, s, brio_builder_count(b), false, &status)) return status;
        BRIO_TRY(status);
        if (!b->salvage) BRIO_TRY(brio_stream_expect(s, points, 2 * LEAST - 1, "the scan's header"));
        brio_stream_element(s, "point", points);
        for (; s->row < points; s->row++) {
            uint64_t before = brio_builder_count(b);
            status = read_point(&r);
            if (brio_salvage(b, s, before, true, &status)) return BRIO_OK;
            BRIO_TRY(status);
        }
        BRIO_TRY(brio_text_next_line(&r.text));
    } while (r.text.at);
done:
    return status;
}

/* --- writing --- */

enum { AXES = 3, CHANNELS = 3, CELLS_A_POINT = 16 /* of a grid, at most; chosen */ };

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

/* Returns the colours, if they are bytes, without alpha. */
static brio_channels colours_of(const brio_mesh *m) {
    brio_channels c = brio_colour_of(m);
    if (c.count > CHANNELS) c.count = CHANNELS;
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

static const brio_row_format rows = {.state = sizeof(ptx_writer),
                                     BRIO_SCANS_ROWS,
                                     .begin = begin,
                                     .rows = write_rows,
                                     .end = end,
                                     .free = free_state,
                                     .renames = renames,
                                     .lacks = lacks};

const brio_codec brio_ptx_codec = {.read = read_file, .rows = &rows};
