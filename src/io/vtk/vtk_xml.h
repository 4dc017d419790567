/* What VTK's XML files have in common: the header, points with their properties, and arrays of raw bytes behind the
 * XML. A writer declares all arrays, then writes them in the same order. */
#ifndef BRIO_IO_VTK_XML_H
#define BRIO_IO_VTK_XML_H

#include "io/formats.h"

typedef struct brio_vtk_writer {
    brio_output *out;
    const brio_write_job *job;
    const char *kind; /* kind of the data set: UnstructuredGrid or PolyData */
    bool wide;        /* whether indices do not fit in Int32 */
    uint64_t offset;  /* offset of the next array in the appended data */
} brio_vtk_writer;

brio_vtk_writer brio_vtk_writer_new(brio_output *out, const brio_write_job *job, const char *kind);

/** Writes the XML up to the tag of the data set, this tag included. */
brio_status brio_vtk_begin(brio_vtk_writer *w);
/** Declares the points and their properties. */
brio_status brio_vtk_declare_points(brio_vtk_writer *w);
/** Declares an array of numbers. */
brio_status brio_vtk_declare(brio_vtk_writer *w, const char *type, const char *name, int components, uint64_t bytes);
/** Declares the arrays connectivity and offsets of cells. */
brio_status brio_vtk_declare_cells(brio_vtk_writer *w, size_t num_cells, size_t num_corners);
/** Ends the declarations and begins the appended data. */
brio_status brio_vtk_begin_data(brio_vtk_writer *w);

/** Write the arrays in the order of their declarations. brio_vtk_write_points writes the points and all properties.
 *  Before the bytes of any other array, brio_vtk_write_size writes their number. */
brio_status brio_vtk_write_points(brio_vtk_writer *w);
brio_status brio_vtk_write_size(brio_vtk_writer *w, uint64_t bytes);
brio_status brio_vtk_write_indices(brio_vtk_writer *w, const uint32_t *indices, size_t count);
/** Writes the offsets of cells that have `corners` corners each. */
brio_status brio_vtk_write_even_offsets(brio_vtk_writer *w, size_t num_cells, size_t corners);

/** Ends the file. */
brio_status brio_vtk_end(brio_vtk_writer *w);

/** Returns the bytes of an index in the file. */
size_t brio_vtk_index_size(const brio_vtk_writer *w);

#endif
