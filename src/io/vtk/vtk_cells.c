/* The cells of a VTU or VTP file as polygons, tetrahedra and edges.
 *
 * A strip of n corners is n - 2 triangles, of which every second one is turned round; a line of n corners is n - 1
 * edges. Of quadratic cells the corners are kept. Other cells are passed over.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_cells.h"
#include "base/memory.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Types of cells of VTK. */
enum {
    VERTEX = 1,
    POLY_VERTEX = 2,
    LINE = 3,
    POLY_LINE = 4,
    TRIANGLE = 5,
    TRIANGLE_STRIP = 6,
    POLYGON = 7,
    PIXEL = 8,
    QUAD = 9,
    TETRAHEDRON = 10,
    QUADRATIC_TRIANGLE = 22,
    QUADRATIC_QUAD = 23,
    QUADRATIC_TETRAHEDRON = 24
};

/* Cells between two reports of progress. Chosen. */
enum { BETWEEN_REPORTS = 1 << 20 };

/* The cell that is being added. */
typedef struct {
    brio_builder *builder;
    const brio_vtk_cells *cells;
    uint64_t number, from, count; /* corners from `from` on */
} cell;

/* brio_vtk_number, without a call for the types that indices have. */
static inline double number_of(const brio_vtk_values *values, uint64_t i) {
    int32_t narrow;
    int64_t wide;
    if (values->type == BRIO_SCALAR_INT32) {
        memcpy(&narrow, values->bytes + i * sizeof narrow, sizeof narrow);
        return narrow;
    }
    if (values->type != BRIO_VTK_INT64) return brio_vtk_number(values, i);
    memcpy(&wide, values->bytes + i * sizeof wide, sizeof wide);
    return (double)wide;
}

/* Reads corner i of the cell, a vertex of the mesh. */
static brio_status corner(const cell *c, uint64_t i, double *vertex) {
    brio_status status = BRIO_OK;
    const brio_vtk_piece *piece = c->cells->piece;
    double index = number_of(&c->cells->connectivity, c->from + i);
    BRIO_REQUIRE(
        c->builder->ctx, index >= 0 && index < (double)piece->num_points && index == floor(index), BRIO_ERR_FORMAT,
        "%s: cell %" PRIu64 " (counted from 0): point %.17g, expected one of the %" PRIu64 " points, counted from 0",
        c->builder->name, c->number, index, piece->num_points);
    *vertex = index + (double)piece->first_point;
done:
    return status;
}

/* Adds a polygon.   order  the places of its corners in the cell; NULL for all of them, as they come. */
static brio_status add_face(const cell *c, const uint64_t *order, uint64_t count) {
    brio_status status = BRIO_OK;
    double vertex = 0;
    for (uint64_t i = 0; i < count; i++) {
        BRIO_TRY(corner(c, order ? order[i] : i, &vertex));
        BRIO_TRY(brio_builder_corner(c->builder, vertex));
    }
    BRIO_TRY(brio_builder_face(c->builder));
done:
    return status;
}

static brio_status add_tetrahedron(const cell *c) {
    brio_status status = BRIO_OK;
    double corners[4];
    for (uint64_t i = 0; i < 4; i++) BRIO_TRY(corner(c, i, &corners[i]));
    BRIO_TRY(brio_builder_tetrahedron(c->builder, corners));
done:
    return status;
}

static brio_status add_strip(const cell *c) {
    brio_status status = BRIO_OK;
    for (uint64_t i = 0; i + 2 < c->count; i++)
        BRIO_TRY(add_face(c, (const uint64_t[3]){i, i + 1 + i % 2, i + 2 - i % 2}, 3));
done:
    return status;
}

static brio_status add_line(const cell *c) {
    brio_status status = BRIO_OK;
    double ends[2] = {0, 0};
    for (uint64_t i = 0; i + 1 < c->count; i++) {
        BRIO_TRY(corner(c, i, &ends[0]));
        BRIO_TRY(corner(c, i + 1, &ends[1]));
        BRIO_TRY(brio_builder_edge(c->builder, ends));
    }
done:
    return status;
}

/* Returns the corners that a cell of this type has at least. */
static uint64_t least_corners(int type) {
    switch (type) {
    case PIXEL:
    case QUAD:
    case TETRAHEDRON:
        return 4;
    case TRIANGLE:
        return 3;
    case QUADRATIC_TRIANGLE:
        return 6;
    case QUADRATIC_QUAD:
        return 8;
    case QUADRATIC_TETRAHEDRON:
        return 10;
    default:
        return 0;
    }
}

static brio_status add_typed(const cell *c, int type) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(c->builder->ctx, c->count >= least_corners(type), BRIO_ERR_FORMAT,
                 "%s: cell %" PRIu64 " (counted from 0): %" PRIu64 " corners, expected %" PRIu64
                 " of a cell of type %d",
                 c->builder->name, c->number, c->count, least_corners(type), type);
    switch (type) {
    case LINE:
    case POLY_LINE:
        return add_line(c);
    case TRIANGLE_STRIP:
        return add_strip(c);
    case PIXEL:
        return add_face(c, (const uint64_t[4]){0, 1, 3, 2}, 4);
    case TRIANGLE:
    case POLYGON:
    case QUAD:
        return add_face(c, NULL, c->count);
    case QUADRATIC_TRIANGLE:
        BRIO_TRY(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_face(c, NULL, 3);
    case QUADRATIC_QUAD:
        BRIO_TRY(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_face(c, NULL, 4);
    case QUADRATIC_TETRAHEDRON:
        BRIO_TRY(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_tetrahedron(c);
    case TETRAHEDRON:
        return add_tetrahedron(c);
    case VERTEX:
    case POLY_VERTEX:
        break; /* points are there without */
    default:
        return brio_builder_leave_out(c->builder, "cells of other types");
    }
done:
    return status;
}

static brio_status add_cell(const cell *c) {
    switch (c->cells->section) {
    case BRIO_VTK_LINES:
        return add_line(c);
    case BRIO_VTK_STRIPS:
        return add_strip(c);
    case BRIO_VTK_POLYS:
        return add_face(c, NULL, c->count);
    default:
        return add_typed(c, (int)brio_vtk_number(&c->cells->types, c->number));
    }
}

brio_status brio_vtk_add_cells(brio_builder *b, const brio_vtk_cells *cells, brio_vtk_face_rows *rows) {
    brio_status status = BRIO_OK;
    cell c = {.builder = b, .cells = cells};
    uint64_t first_row = brio_vtk_first_row(cells->piece, cells->section);
    for (; c.number < cells->piece->num_cells[cells->section]; c.number++) {
        double to = number_of(&cells->offsets, c.number);
        if (c.number % BETWEEN_REPORTS == 0) BRIO_TRY(brio_progress(b->ctx, "read", 1));
        BRIO_REQUIRE(b->ctx, to >= (double)c.from && to <= (double)cells->connectivity.count, BRIO_ERR_FORMAT,
                     "%s: cell %" PRIu64 " (counted from 0): offset %.17g, expected %" PRIu64 " to %" PRIu64, b->name,
                     c.number, to, c.from, cells->connectivity.count);
        c.count = (uint64_t)to - c.from;
        BRIO_TRY(add_cell(&c));
        c.from += c.count;
        while (rows && rows->count < b->mesh->num_faces) {
            BRIO_TRY(BRIO_RESERVE(b->ctx, rows->row, rows->capacity, rows->count + 1));
            rows->row[rows->count++] = first_row + c.number;
        }
    }
done:
    return status;
}
