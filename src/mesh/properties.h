/* Properties of the vertices of a mesh. */
#ifndef BRIO_MESH_PROPERTIES_H
#define BRIO_MESH_PROPERTIES_H

#include <brio/brio.h>

/** Frees the properties that were added last, so that `left` remain. */
void brio_mesh_drop_properties(brio_mesh *mesh, size_t left);

/** As brio_mesh_add_property, for a name that no property has: nothing is compared. */
brio_status brio_mesh_append_property(brio_mesh *mesh, const char *name, brio_scalar type);

#endif
