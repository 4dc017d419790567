/* The files that a mesh is in TetGen's form. */
#ifndef BRIO_IO_NODE_FILES_H
#define BRIO_IO_NODE_FILES_H

#include "io/formats.h"

/** Writes .node, .ele if there are tetrahedra or an old .ele, and what the options ask for of .neigh, .face and .edge.
 *  All files are complete before any gets its name.
 *  expected  an estimate of the bytes of a file, for progress.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_TOO_LARGE, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
brio_status brio_node_write_files(brio_context *ctx, const char *path, const brio_write_job *job, uint64_t expected);

#endif
