/* Places of scanners as properties of the points that they saw. */
#ifndef BRIO_IO_ORIGINS_H
#define BRIO_IO_ORIGINS_H

#include "io/builder.h"

/** Adds the properties x_origin, y_origin, z_origin (float64), if the caller asked for them (brio_read_options.origins) and
 *  the file has none of these names. Call once all other properties are there, before the first vertex or with all of
 *  them NaN. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_plan_origins(brio_builder *b);

/** Gives the mesh's vertices from `first` on their place. Does nothing if there is no such property.
 *  place  3; NULL: not known, which is NaN. */
void brio_set_origins(brio_builder *b, size_t first, const double *place);

#endif
