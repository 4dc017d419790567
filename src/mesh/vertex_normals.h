/* Normals of the vertices of a mesh. */
#ifndef BRIO_MESH_VERTEX_NORMALS_H
#define BRIO_MESH_VERTEX_NORMALS_H

#include "base/memory.h"

/** Finds the normals that brio_mesh_add_normals adds.   normals  #V by 3, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_vertex_normals(const brio_mesh *mesh, double **normals);

#endif
