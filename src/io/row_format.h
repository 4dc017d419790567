/* Formats that hold points row by row. Such a file can be written block by block, so that a conversion needs the memory
 * of a block. brio_write writes a mesh as one block. */
#ifndef BRIO_IO_ROW_FORMAT_H
#define BRIO_IO_ROW_FORMAT_H

#include "io/formats.h"

/** A format's functions. In all of them job->mesh is a block. The blocks of a file have the same properties. The state
 *  has `state` bytes, which are 0 at first. */
typedef struct brio_row_format {
    size_t state;
    bool counts;   /* whether the file begins with the number of points */
    bool comments; /* whether # % and // begin a comment in the line of names */

    /** Looks at a block before anything is written. NULL: the format need not know the points before it writes.
     *  All blocks are shown, from the first to the last, then `surveyed` is asked, and all again until it is true.
     *  surveyed  NULL: one pass is enough. */
    brio_status (*survey)(brio_context *ctx, const brio_write_job *job, void *state);
    bool (*surveyed)(void *state);
    uint64_t (*surveyed_points)(const void *state);
    /** Makes a file one of several: takes over what was found in the points of all of them, before its own are shown.
     *  from  the state of a writer that was shown them all.   columns  properties of a block.
     *  NULL: each file goes by its own points. */
    brio_status (*share)(brio_context *ctx, void *state, const void *from, size_t columns);

    /** Writes what comes before the points. job->points is their number or, if the output can be patched,
     *  BRIO_COUNT_UNKNOWN. */
    brio_status (*begin)(brio_output *out, const brio_write_job *job, void *state);
    brio_status (*rows)(brio_output *out, const brio_write_job *job, void *state);
    /** Writes what follows the points of the last block. job->points is their number. NULL: nothing does. */
    brio_status (*end)(brio_output *out, const brio_write_job *job, void *state);
    void (*free)(brio_context *ctx, void *state);
    /** Returns whether a reader finds property i by another name. NULL: job->names has the names of the file, each one
     *  word. Otherwise there is no job->names. */
    bool (*renames)(const void *state, size_t i);
    /** Returns whether the file has no place for property i. Asked when all is written. NULL: what the table of formats
     *  says. */
    bool (*lacks)(const void *state, size_t i);
    /** Returns whether coordinates are rounded. NULL: only as the options say. */
    bool (*rounds)(const void *state);
    /** Returns how far a vertex of a block is at most from where a reader finds it. NULL: as the options say. */
    double (*moved)(const void *state, const brio_mesh *block);
} brio_row_format;

/** Returns the functions of a format, or NULL if the format needs the whole mesh. */
const brio_row_format *brio_row_format_of(brio_format format);

/** A file that is written block by block. */
typedef struct brio_row_writer {
    brio_context *ctx;
    brio_format kind;
    const brio_row_format *format;
    brio_write_job job;
    brio_output out;
    void *state;
    brio_colour_plan colours;
    bool surveys; /* whether all blocks must be shown (again) before the first one is written */
    bool begun;   /* whether the output was opened */
    bool shown;   /* whether a block was seen, which has `columns` properties */
    size_t columns;
    uint64_t points; /* written */
} brio_row_writer;

/** Begins a writer.   job  without mesh and names; its options stay valid.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_row_writer_new(brio_row_writer *w, brio_context *ctx, brio_format format, const brio_write_job *job);
/** Returns whether the depth of colours shows only in all blocks: then brio_row_writer_look has to see them all before
 *  anything else, or the first block decides. */
bool brio_row_writer_is_open(const brio_row_writer *w, const brio_mesh *block);
void brio_row_writer_look(brio_row_writer *w, const brio_mesh *block);
void brio_row_writer_end_look(brio_row_writer *w);
/** Begins the file of a part of the points that `all` was shown. */
brio_status brio_row_writer_share(brio_row_writer *w, const brio_row_writer *all);
/** Shows a block before the writing begins. */
brio_status brio_row_writer_survey(brio_row_writer *w, const brio_mesh *block);
/** Ends a pass over all blocks. w->surveys says whether another one is needed. */
void brio_row_writer_end_survey(brio_row_writer *w);
/** Returns the number of points that were shown in a pass. */
uint64_t brio_row_writer_surveyed_points(const brio_row_writer *w);
/** Writes a block; the first one opens the output. */
brio_status brio_row_writer_write(brio_row_writer *w, const char *path, const brio_mesh *block);
/** Returns whether property i of the block that was written has another name in the file. */
bool brio_row_writer_renames(const brio_row_writer *w, const brio_mesh *block, size_t i);
/** Writes a part of the tetrahedra, of a file whose number of points was known and whose points are written: PLY. */
brio_status brio_row_writer_cells(brio_row_writer *w, const brio_mesh *cells);
/** Ends the file and gives it its name.   last  the mesh whose polygons, tetrahedra and edges follow its points. */
brio_status brio_row_writer_end(brio_row_writer *w, const brio_mesh *last);
/** Frees everything. A file that was not ended disappears. */
void brio_row_writer_free(brio_row_writer *w);

/* --- rows of properties --- */

/* Points as rows of binary numbers: three coordinates, then the properties, packed, in this machine's byte order. */

/** Writes the vertices of job->mesh. Threads encode chunks of rows; each chunk is written as a whole. */
brio_status brio_rows_write(brio_output *out, const brio_write_job *job);

#endif
