/* Some of the points of a file, with their properties. */
#ifndef BRIO_CLI_SELECTION_H
#define BRIO_CLI_SELECTION_H

#include "cli/run/run.h"

/** Makes a mesh of the points whose flag is set, in their order, with their properties, the metadata of all, and no
 *  faces.
 *  chosen  #V.   out  owned by the caller. */
brio_status cli_select_points(run *r, const brio_mesh *points, const uint8_t *chosen, brio_mesh **out);

#endif
