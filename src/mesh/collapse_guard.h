/* Keeps the triangles of a mesh whose edges collapse from crossing each other: they are kept in an octree, and the
 * triangles that a collapse would make are tested exactly against those near them. One thread may use it. */
#ifndef BRIO_MESH_COLLAPSE_GUARD_H
#define BRIO_MESH_COLLAPSE_GUARD_H

#include "mesh/collapse_mesh.h"

/** Puts the triangles of a mesh into an octree.   out  freed with brio_collapse_guard_free, on failure too.
 *  Cost: 12 bytes a triangle and 44 for each node, of which there are about as many as triangles.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_collapse_guard_new(const brio_collapse_mesh *m, brio_collapse_guard **out);
void brio_collapse_guard_free(brio_context *ctx, brio_collapse_guard *guard);

/** Returns whether the edge of h may collapse into `point`: no triangle round that point then meets another one in more
 *  than common corners and edges. False, and a status of the guard, where memory is refused. */
bool brio_collapse_guard_allows(const brio_collapse_mesh *m, uint32_t h, const double *point);

/** Takes the triangles round both ends of the last edge that was asked for out of the octree, and puts those that are
 *  left of them back when they have moved. */
void brio_collapse_guard_before(const brio_collapse_mesh *m);
void brio_collapse_guard_after(const brio_collapse_mesh *m);

/** Returns BRIO_ERR_NO_MEMORY if memory was refused since the guard was made. */
brio_status brio_collapse_guard_status(const brio_collapse_guard *guard);

#endif
