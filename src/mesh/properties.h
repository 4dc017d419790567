/* Properties of the vertices of a mesh. */
#ifndef BRIO_MESH_PROPERTIES_H
#define BRIO_MESH_PROPERTIES_H

#include <brio/brio.h>

/** Frees the properties that were added last, so that `left` remain. */
void brio_mesh_drop_properties(brio_mesh *mesh, size_t left);

#endif
