/* Properties of points beside what a command computes. */
#ifndef BRIO_CLI_PROPERTIES_H
#define BRIO_CLI_PROPERTIES_H

#include "cli/run/run.h"

/** Frees a name for a result: a property of that name becomes input_NAME, and that is said. */
void cli_set_aside(run *r, brio_mesh *mesh, const char *name);

/** Adds the property `representative`: for each point the index of the vertex that stands for it, its own index for a
 *  vertex. Adds nothing if every point is a vertex.   representatives  #V. */
brio_status cli_add_representatives(run *r, brio_mesh *mesh, const uint32_t *representatives);

/** Moves the property "sample" of a surface into an array, so that it is in no file.   samples  for free. */
brio_status cli_take_samples(run *r, brio_mesh *surface, uint32_t **samples);

/** Gives the vertices of a surface the properties of points (brio_mesh_carry_properties), unless there are none.
 *  samples  the point of each vertex; NULL: the nearest point. */
brio_status cli_carry_properties(run *r, const brio_mesh *points, const uint32_t *samples, brio_mesh *surface);

/** Does the same for a surface whose vertex v is point v. */
brio_status cli_copy_properties(run *r, const brio_mesh *points, brio_mesh *surface);

#endif
