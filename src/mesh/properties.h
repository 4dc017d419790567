/* Properties of the vertices and of the faces of a mesh. */
#ifndef BRIO_MESH_PROPERTIES_H
#define BRIO_MESH_PROPERTIES_H

#include <brio/brio.h>

/** Frees the properties that were added last, so that `left` remain. */
void brio_mesh_drop_properties(brio_mesh *mesh, size_t left);

/** Adds a property as brio_mesh_add_property, for a name that no property has: nothing is compared. */
brio_status brio_mesh_append_property(brio_mesh *mesh, const char *name, brio_scalar type);
/** Adds a property as brio_mesh_add_face_property, likewise. */
brio_status brio_mesh_append_face_property(brio_mesh *mesh, const char *name, brio_scalar type);

/** Adds the property "sample" of the vertices of a surface: the index of the point that each of them is, or -1.
 *  num_points  of the surface; decides the type.   samples  #V, or NULL: no vertex is a point.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_add_samples(brio_mesh *mesh, size_t num_points, const uint32_t *samples);

/** Copies row `from` of some properties to row `to`. */
void brio_properties_move(const brio_property *list, size_t count, size_t from, size_t to);

/** Returns a view of the faces of a mesh as points without positions, so that what serves the properties of points
 *  serves those of faces. It owns nothing. */
brio_mesh brio_mesh_faces_as_points(const brio_mesh *mesh);

#endif
