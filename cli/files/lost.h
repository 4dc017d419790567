/* What a file loses: what its format cannot hold, and what single precision does to coordinates. */
#ifndef BRIO_CLI_LOST_H
#define BRIO_CLI_LOST_H

#include "cli/run/run.h"

/** Says which parts of a mesh its file leaves out. Properties that no input had are not worth a word. */
void cli_tell_lost(run *r, const char *path, const brio_mesh *mesh, brio_format format);

/** Says that --ascii or --float32 were given for nothing.   ascii, float32  whether the file has a choice. */
void cli_tell_idle(run *r, const char *path, bool ascii, bool float32);

/** Refuses points that an output with single precision alone, an STL file, would ruin. */
brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh);

/** Takes back --float32 where it would merge points or move them far, or cannot hold a coordinate, and says so.
 *  merged  receives the number of points that the file will merge with others. */
brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *options,
                                 size_t *merged);

/** Does the same before operands are converted to -o, whose points the files themselves tell.
 *  inputs  the first operands, as many.   o  chooses among the points.   written  how they are written.   Reads the
 *  files once if their points will be rounded. */
brio_status cli_settle_conversion(run *r, int inputs, const brio_convert_options *o, brio_write_options *written,
                                  size_t *merged);

/** Says how far the points of a written file are from where they were. */
void cli_tell_moved(run *r, const char *path, double moved, size_t merged);

#endif
