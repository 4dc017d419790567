/* A triangulated surface cut open into disks.
 *
 * Half-edges and twins are those of twins.h. A cut is a set of edges, the boundary edges among them. The corners round
 * a vertex that are joined across edges that are not cut form a sector; where the cut passes through a vertex d times,
 * the vertex has d sectors, and they are the vertices of the disks. Each disk has its own boundary, a simple cycle of
 * at least three sectors. */
#ifndef BRIO_MESH_DISK_CUT_H
#define BRIO_MESH_DISK_CUT_H

#include "mesh/twins.h"

enum { BRIO_EDGE_CUT = 1 }; /* bit of disk_cut.flags; the others are the user's */

typedef struct brio_disk_cut {
    uint32_t *twin;     /* as brio_mesh_twins makes them */
    uint8_t *flags;     /* of each half-edge; the two of an edge are cut together */
    uint32_t *sector;   /* of each corner */
    size_t num_corners; /* = half-edges */
    size_t num_sectors;
    uint64_t steps; /* half-edges that were visited */
} brio_disk_cut;

/** Cuts every component of a surface into one disk or, where it is a sphere, into one triangle and the rest. The cut of
 *  a closed component of genus g > 0 is a connected graph of 2 g independent cycles without loose ends, so that no
 *  vertex has more than 4 g sectors. Linear time; 9 bytes a corner at the end, and up to 16 more on the way.
 *  out  to be freed, also when this fails.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (faces that are no triangles, edges
 *  of more than two faces or of faces that disagree), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_disk_cut_make(brio_context *ctx, const brio_mesh *mesh, brio_disk_cut *out);
void brio_disk_cut_free(brio_context *ctx, brio_disk_cut *cut);

#endif
