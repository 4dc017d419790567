/* The topology of the level sets of a function on a grid. */
#ifndef BRIO_TESTDATA_SOLID_LEVELS_H
#define BRIO_TESTDATA_SOLID_LEVELS_H

#include "brio/testdata.h"
#include "iso/iso_surface.h"

enum { BRIO_SOLID_LEVELS = 3 };

/** Writes the Euler characteristic of the surfaces where the function has the given values, as marching tetrahedra
 *  would make them: 2 for each component, less 2 for each handle.
 *  Returns what brio_marched_surface returns. */
brio_status brio_solid_euler(brio_context *ctx, const brio_implicit_grid *grid, const double levels[BRIO_SOLID_LEVELS],
                             int64_t euler[BRIO_SOLID_LEVELS]);

#endif
