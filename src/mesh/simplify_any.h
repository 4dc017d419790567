/* Any mesh made fit for the collapse of edges, and put together again. */
#ifndef BRIO_MESH_SIMPLIFY_ANY_H
#define BRIO_MESH_SIMPLIFY_ANY_H

#include "base/context.h"

/** Cuts polygons into triangles, drops faces without three distinct corners, and gives each fan of faces its own vertices, so that the
 *  mesh is manifold and oriented. Each vertex knows where it comes from by a property that is the last one. Faces keep their properties.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_take_apart(brio_context *ctx, brio_mesh *mesh);

/** Joins vertices that come from one, which are where it was, and removes the last property. */
brio_status brio_mesh_put_together(brio_context *ctx, brio_mesh *mesh);

#endif
