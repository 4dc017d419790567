/* What single precision does to coordinates, said before or beside the loss. */
#ifndef BRIO_CLI_PRECISION_H
#define BRIO_CLI_PRECISION_H

#include "run.h"

/** Refuses points for which the output is a STL file that would merge them: the file holds single precision alone. */
brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh);

/** Takes back --float32 where it would merge points, or where a coordinate does not fit, and says so.
 *  merged  receives the number of points that the file will merge with others. */
brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *options,
                                 size_t *merged);

/** Says how far the points of a written file are from where they were. */
void cli_tell_moved(run *r, const char *path, double moved, size_t merged);

#endif
