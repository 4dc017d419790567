/* A triangulated surface cut open into disks.
 *
 * Half-edges and twins are those of twins.h. A cut is a set of edges that includes all boundary edges. A sector is the
 * set of corners of one vertex that are joined across edges outside the cut. Where the cut passes through a vertex d
 * times, the vertex has d sectors. Sectors are the vertices of the disks. The boundary of each disk is a simple cycle
 * of at least three sectors. */
#ifndef BRIO_MESH_DISK_CUT_H
#define BRIO_MESH_DISK_CUT_H

#include "mesh/twins.h"

enum { BRIO_EDGE_CUT = 1 }; /* bit 0 of brio_disk_cut.flags; the user of the cut may use the other bits */

typedef struct brio_disk_cut {
    uint32_t *twin;     /* from brio_mesh_twins */
    uint8_t *flags;     /* of each half-edge; BRIO_EDGE_CUT is equal on the two half-edges of an edge */
    uint32_t *sector;   /* of each corner */
    size_t num_corners; /* number of corners, which is the number of half-edges */
    size_t num_sectors;
    uint64_t steps; /* half-edges visited */
} brio_disk_cut;

/** Cuts every component of a surface into one disk; cuts a sphere into one triangle and the rest. The cut of a closed
 *  component of genus g > 0 is a connected graph with 2 g independent cycles and no loose ends. So no vertex has more
 *  than 4 g sectors. Linear time; 9 bytes a corner in the result, and up to 16 more during the call.
 *  out  freed with brio_disk_cut_free, also after a failure.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (a face that is not a triangle, an
 *  edge of more than two faces, or two faces that disagree on the direction of an edge), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_disk_cut_make(brio_context *ctx, const brio_mesh *mesh, brio_disk_cut *out);
void brio_disk_cut_free(brio_context *ctx, brio_disk_cut *cut);

#endif
