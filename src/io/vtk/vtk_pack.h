/* Compressed arrays of VTK's XML files. */
#ifndef BRIO_IO_VTK_PACK_H
#define BRIO_IO_VTK_PACK_H

#include "io/vtk/vtk_writer.h"

/** Compresses an array into memory, block by block, in all threads. */
brio_status brio_vtk_pack(brio_vtk_writer *w, brio_vtk_appended *array);

#endif
