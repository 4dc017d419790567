/* The formats, each in its own file. A reader takes a stream and fills a builder; a writer writes a mesh to an
 * output. */
#ifndef BRIO_IO_FORMATS_H
#define BRIO_IO_FORMATS_H

#include "io/builder.h"
#include "io/colour.h"
#include "io/output.h"
#include "io/stream.h"

typedef struct brio_write_job {
    const brio_mesh *mesh;
    const brio_write_options *options;
    char (*names)[64];         /* PLY, XYZ and NPY: the names of the properties, each as one word */
    char (*face_names)[64];    /* PLY: likewise of those of the faces */
    uint64_t points;           /* formats of rows: the number of points of all blocks, as row_format.h says */
    uint64_t expected;         /* an estimate of all bytes, for progress, or BRIO_NO_PROGRESS */
    brio_colour_plan *colours; /* of a format that is written as a whole */
} brio_write_job;

/** What a format does with files. One object in the format's own file, which the table in format_table.c names. */
typedef struct brio_codec {
    bool (*starts)(const char *bytes,
                   size_t size); /* whether a file that begins so is the format's; NULL: none tells */
    brio_status (*read)(brio_stream *s, brio_builder *b); /* NULL: read_columns */
    /* Reads a text of points.   columns  the names of the columns that the caller gives (brio_read_options), or NULL */
    brio_status (*read_columns)(brio_stream *s, brio_builder *b, const char *columns);
    const struct brio_row_format *rows;                                /* NULL: not written row by row */
    brio_status (*write)(brio_output *out, const brio_write_job *job); /* NULL: not written as a whole */
} brio_codec;

/* --- parts of formats that others call --- */

brio_status brio_xyz_read(brio_stream *s, brio_builder *b, const char *columns);
brio_status brio_npy_read(brio_stream *s, brio_builder *b);
brio_status brio_ele_read(brio_stream *s, brio_builder *b); /* after the .node file: its index base is in b */
/** Writes .node, .ele if there are tetrahedra or an old .ele, and what the options ask for of .neigh, .face and .edge.
 *  All files are complete before any gets its name.
 *  expected  an estimate of the bytes of a file, for progress.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_TOO_LARGE, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
brio_status brio_node_write_files(brio_context *ctx, const char *path, const brio_write_job *job, uint64_t expected);
/* Returns whether the first bytes are those of a chemical file. Only asked of what is called .xyz, and of standard
 * input: other texts are not so far from it. */
bool brio_chemical_starts(const char *bytes, size_t size);

/** Returns the number of faces of a cell. */
static inline uint64_t brio_cells_num_faces(const brio_cells *cells, size_t c) {
    return cells->face_offsets[c + 1] - cells->face_offsets[c];
}
/** Writes cells as VTU.   comment  NULL: none. */
brio_status brio_cells_vtu_write(brio_output *out, const brio_cells *cells, const char *comment);

/* --- the table --- */

/** A format's row of the table in format_table.c. */
typedef struct brio_format_row {
    brio_format_info info;
    const brio_codec *codec;
    brio_colours colours;      /* how a file that is written has colours */
    brio_colours face_colours; /* likewise of the faces */
    bool scans;                /* whether the writer makes scans (scans.h): the reader then tells places and grids */
    const char *keeps;         /* NULL, or how the names of the metadata begin that the writer keeps: "crs. las." */
} brio_format_row;

/** Returns the row of a format, or NULL. */
const brio_format_row *brio_format_row_of(brio_format format);
/** Returns whether a format holds something of `what`, bits such as BRIO_HOLDS_FACES. */
bool brio_format_holds(brio_format format, unsigned what);
/** Returns whether a format holds property i of a mesh, under the name that the format has for colours and normals. */
bool brio_format_holds_property(brio_format format, const brio_mesh *m, size_t i);
/** Returns whether a format holds property i of the faces of a mesh. */
bool brio_format_holds_face_property(brio_format format, const brio_mesh *m, size_t i);
/** Returns how colours become those of a format. */
brio_colour_plan brio_format_colours(brio_format format);
/** Returns whether the writer of a format keeps the metadata of a name. */
bool brio_format_keeps(brio_format format, const char *metadata);
/** Returns the format whose files begin with these bytes, or BRIO_FORMAT_AUTO. */
brio_format brio_format_that_starts(const char *bytes, size_t size);
/** Returns the format one of whose extensions `has` finds at a path, or BRIO_FORMAT_AUTO. */
brio_format brio_format_with(const char *path, bool (*has)(const char *path, const char *extension));

/** Lists the extensions of formats whose columns can be named, as brio_format_list does. */
void brio_format_list_columns(char *text, size_t size);

/** Writes a mesh as brio_write does, in a format that is not written row by row.
 *  colours  how its colours become those of the format: for one of several files whose colours go together. */
brio_status brio_write_with_colours(brio_context *ctx, const char *path, const brio_mesh *mesh,
                                    const brio_write_options *options, brio_colour_plan *colours);

/** Returns whether the format holds coordinates in single precision, by itself or by the options. */
bool brio_is_single(brio_format format, const brio_write_options *options);

/** Returns the greatest distance between a vertex and its coordinates in single precision. */
double brio_moved_by_singles(const brio_mesh *m);

/** Refuses formats that there are not, and those that are read only. */
brio_status brio_check_written(brio_context *ctx, const char *path, brio_format format);
/** Refuses more properties than readers of the format take. */
brio_status brio_check_properties(brio_context *ctx, const char *path, brio_format format, size_t count);
/** Refuses compression for a format that has none, and in a build without zlib. */
brio_status brio_check_compress(brio_context *ctx, const char *path, brio_format format,
                                const brio_write_options *options);

/** Refuses coordinates beyond single precision.   Returns BRIO_OK or BRIO_ERR_ARGUMENT. */
brio_status brio_check_single(brio_context *ctx, const char *path, const brio_mesh *m);

/** Returns whether this build can compress VTU and VTP. */
bool brio_vtk_has_zlib(void);

/** Returns whether a path names an .ele file, which stands for the pair of .node and .ele. */
bool brio_is_ele(const char *path);
/** Returns whether a path names a .gltf file, which is JSON where .glb is a container. */
bool brio_is_gltf(const char *path);
/** Makes the name of the other file of the pair.   out  owned by the caller (brio_release).
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_sibling(brio_context *ctx, const char *path, const char *extension, char **out);

#endif
