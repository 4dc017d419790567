/* Files of cells: what the writers share. */
#ifndef BRIO_IO_CELLS_WRITE_H
#define BRIO_IO_CELLS_WRITE_H

#include "io/output.h"

/** Returns the number of faces of a cell. */
static inline uint64_t brio_cells_num_faces(const brio_cells *cells, size_t c) {
    return cells->face_offsets[c + 1] - cells->face_offsets[c];
}

/** Writes cells as VTU.   comment  NULL: none. */
brio_status brio_cells_vtu_write(brio_output *out, const brio_cells *cells, const char *comment);

#endif
