/* What VTK's XML files have in common: the header, points with their properties, arrays appended raw behind the XML. */
#ifndef BRIO_IO_VTK_XML_H
#define BRIO_IO_VTK_XML_H

#include "io/formats.h"

typedef struct brio_vtk_writer {
    brio_output *out;
    const brio_write_job *job;
    const char *kind; /* of the data set: UnstructuredGrid, PolyData */
    bool wide;        /* indices do not fit Int32 */
    uint64_t offset;  /* of the next array among the appended data */
} brio_vtk_writer;

brio_vtk_writer brio_vtk_writer_new(brio_output *out, const brio_write_job *job, const char *kind);

/** The XML up to and with the tag of the data set. */
brio_status brio_vtk_begin(brio_vtk_writer *w);
/** The sections Points and PointData. */
brio_status brio_vtk_declare_points(brio_vtk_writer *w);
/** One array of numbers. */
brio_status brio_vtk_declare(brio_vtk_writer *w, const char *type, const char *name, int components, uint64_t bytes);
/** The arrays connectivity and offsets of cells. */
brio_status brio_vtk_declare_cells(brio_vtk_writer *w, size_t num_cells, size_t num_corners);
/** Closes piece and data set; the appended data begin. */
brio_status brio_vtk_begin_data(brio_vtk_writer *w);

/** Arrays, in the order in which they were declared: points and properties at once; the number of bytes in front of any
 *  other. */
brio_status brio_vtk_write_points(brio_vtk_writer *w);
brio_status brio_vtk_write_size(brio_vtk_writer *w, uint64_t bytes);
brio_status brio_vtk_write_indices(brio_vtk_writer *w, const uint32_t *indices, size_t count);
/** The offsets of cells that have `corners` corners each. */
brio_status brio_vtk_write_even_offsets(brio_vtk_writer *w, size_t num_cells, size_t corners);

brio_status brio_vtk_end(brio_vtk_writer *w);

/** Bytes of an index in the file. */
size_t brio_vtk_index_size(const brio_vtk_writer *w);

#endif
