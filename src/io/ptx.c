/* Reads PTX files: scans as grids of rows, each scan with its own position.
 *
 * A scan begins with the numbers of columns and rows, the scanner's position and axes, and a matrix of 4 by 4 by which
 * a row (x, y, z, 1) is multiplied. A point at the origin is a place without a return and is left out. Points go column
 * by column.
 *
 * Based on: Leica Geosystems. Description of the PTX format. */
#include "io/formats.h"
#include "io/builder.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

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

brio_status brio_ptx_read(brio_stream *s, brio_builder *b) {
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
