/* The cells of a VTU or VTP file as polygons, tetrahedra and edges. */
#ifndef BRIO_IO_VTK_CELLS_H
#define BRIO_IO_VTK_CELLS_H

#include "io/vtk/vtk_values.h"

/* The row of each face of the mesh in cell data. */
typedef struct brio_vtk_face_rows {
    uint64_t *row;
    size_t count, capacity;
} brio_vtk_face_rows;

/* The arrays of the cells of one section of one piece. */
typedef struct brio_vtk_cells {
    brio_vtk_section section;
    const brio_vtk_piece *piece;
    brio_vtk_values connectivity, offsets, types; /* VTP has no types */
} brio_vtk_cells;

/** Adds the cells to a mesh whose vertices have all been read.   rows  NULL, or receives the rows of its faces.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the message names the cell), BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_add_cells(brio_builder *b, const brio_vtk_cells *cells, brio_vtk_face_rows *rows);

/** Makes properties of faces of the columns that all cells have.   num_cells  of all pieces. */
brio_status brio_vtk_finish_cell_data(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                      uint64_t num_cells);

#endif
