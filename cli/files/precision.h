/* What single precision does to coordinates, said before or beside the loss. */
#ifndef BRIO_CLI_PRECISION_H
#define BRIO_CLI_PRECISION_H

#include "cli/run/run.h"

/** Refuses points that an output with single precision alone, an STL file, would ruin. */
brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh);

/** Takes back --float32 where it would merge points or move them far, or cannot hold a coordinate, and says so.
 *  merged  receives the number of points that the file will merge with others. */
brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *options,
                                 size_t *merged);

/** Does the same before a file is converted, whose points the file itself tells.
 *  o  chooses among the points.   written  how the file is written.   Reads the file once if its points will be
 *     rounded. */
brio_status cli_settle_conversion(run *r, const char *from, const char *to, const brio_convert_options *o,
                                  brio_write_options *written, size_t *merged);

/** Says how far the points of a written file are from where they were. */
void cli_tell_moved(run *r, const char *path, double moved, size_t merged);

#endif
