/* Cell data of VTU, VTP and VTK files as properties of the faces.
 *
 * A face has the values of its cell's row; all triangles of a strip have those of the strip. Rows of cells that are no faces
 * become nothing, which is said unless they hold nothing but 0, as brio writes them. */
#include "base/memory.h"
#include "io/scalar.h"
#include "io/vtk/vtk_cells.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns whether a column has a number other than 0 in a row that is no face's.   taken  of all cells. */
static bool has_others(const brio_vtk_column *c, const uint8_t *taken) {
    size_t size = brio_scalar_size(c->type);
    for (uint64_t row = 0; row < c->rows; row++) {
        double x = taken[row] ? 0 : brio_scalar_load(c->data + row * size, c->type, false);
        if (x != 0 && !isnan(x)) return true;
    }
    return false;
}

static brio_status make_property(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                 brio_vtk_column *c) {
    brio_status status = BRIO_OK;
    char name[64];
    size_t size = brio_scalar_size(c->type);
    brio_vtk_choose_name(data, b, c, name);
    BRIO_TRY(brio_builder_face_property(b, name, c->type));
    char *to = b->mesh->face_properties[b->mesh->num_face_properties - 1].data;
    for (size_t f = 0; f < rows->count; f++) memcpy(to + f * size, c->data + rows->row[f] * size, size);
    if (c->rounded) BRIO_TRY(brio_builder_leave_out(b, "integers beyond 2^53"));
    brio_release(b->ctx, c->data);
    c->data = NULL;
done:
    return status;
}

brio_status brio_vtk_finish_cell_data(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                      uint64_t num_cells) {
    brio_status status = BRIO_OK;
    uint8_t *taken = NULL;
    char name[BRIO_XML_VALUE + 32];
    if (!data->num_columns) return BRIO_OK;
    if (rows->count) BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, taken, (size_t)num_cells));
    for (size_t f = 0; f < rows->count; f++) taken[rows->row[f]] = 1;
    for (size_t i = 0; i < data->num_columns; i++) {
        brio_vtk_column *c = &data->columns[i];
        if (c->rows != num_cells || !rows->count) {
            BRIO_TRY(brio_vtk_leave_out(data, b, c->source));
            continue;
        }
        snprintf(name, sizeof name, "%s of cells that are no polygons", c->source);
        if (has_others(c, taken)) BRIO_TRY(brio_builder_leave_out(b, name));
        BRIO_TRY(make_property(data, b, rows, c));
    }
done:
    brio_release(b->ctx, taken);
    return status;
}
