/* What the writers of VTK's XML files have in common: the tags, the points with their properties, and arrays, which are
 * appended raw, appended and compressed, or written as text within the tags.
 *
 * A writer begins the file, opens sections, hands over the arrays of each, and ends the file. All functions that return
 * a status return BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_VTK_WRITER_H
#define BRIO_IO_VTK_WRITER_H

#include "io/formats.h"
#include "io/vtk/vtk.h"

/** Stores the numbers `first` to `first` + count - 1 of an array. The calls for an array go through its numbers once,
 *  from the first to the last. */
typedef void (*brio_vtk_fill)(void *user, uint64_t first, size_t count, void *to);

/* An array of a section. */
typedef struct brio_vtk_source {
    const char *name;
    int type, components; /* type: BRIO_SCALAR_* or BRIO_VTK_INT64 */
    uint64_t count;       /* of numbers */
    brio_vtk_fill fill;
    void *user;
} brio_vtk_source;

/* An array that the appended data will hold. */
typedef struct brio_vtk_appended {
    brio_vtk_source source;
    char *packed; /* the compressed array with the numbers in front of it, or NULL */
    size_t packed_size, capacity;
} brio_vtk_appended;

/* Properties of points or faces that are written as one array, and the rows of the array that are theirs; all others
 * are 0. */
typedef struct brio_vtk_property {
    brio_channels of;
    uint64_t first, rows;
} brio_vtk_property;

typedef struct brio_vtk_writer {
    brio_output *out;
    const brio_write_job *job;
    const char *kind; /* kind of the data set: UnstructuredGrid or PolyData */
    bool wide;        /* whether indices do not fit in Int32 */
    uint64_t offset;  /* of the next array in the appended data */
    brio_vtk_appended *appended;
    size_t num_appended, appended_capacity;
    char *part;                    /* numbers on their way to the output */
    char (*names)[64];             /* of the properties of the points, then of the faces, as XML has them */
    brio_vtk_property *properties; /* likewise */
    brio_bar bar;
    uint64_t compressed; /* bytes that have been compressed */
} brio_vtk_writer;

brio_vtk_writer brio_vtk_writer_new(brio_output *out, const brio_write_job *job, const char *kind);
void brio_vtk_writer_free(brio_vtk_writer *w);

/** Writes the XML up to the tag of the data set, this tag included. */
brio_status brio_vtk_begin(brio_vtk_writer *w);
/** Writes the sections of the points and of their properties. */
brio_status brio_vtk_write_points(brio_vtk_writer *w);
/** Writes the section of the properties of the faces, if there are some.   before, behind  cells that are no faces. */
brio_status brio_vtk_write_cell_data(brio_vtk_writer *w, uint64_t before, uint64_t behind);
/** Writes an array of the open section. It must be valid until the end of the file. */
brio_status brio_vtk_write_array(brio_vtk_writer *w, const brio_vtk_source *source);
/** Ends the piece and the file. */
brio_status brio_vtk_end(brio_vtk_writer *w);

/** Returns the type of an index in the file, and stores an index as number i. */
int brio_vtk_index_type(const brio_vtk_writer *w);
static inline void brio_vtk_store_index(const brio_vtk_writer *w, void *to, size_t i, uint32_t index) {
    if (w->wide)
        ((int64_t *)to)[i] = index;
    else
        ((uint32_t *)to)[i] = index;
}

#endif
