/* Pieces of an opened surface that are too small to be more than a guess. */
#ifndef BRIO_RECONSTRUCT_SMALL_PIECES_H
#define BRIO_RECONSTRUCT_SMALL_PIECES_H

#include "reconstruct/open_surface/hole_cut.h"

/** Lets small pieces go: triangles that stay and meet across edges. Pieces without a rim are closed surfaces, and stay.
 *  part  #F, read and written: a brio_triangle_part.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_drop_small_pieces(const brio_triangle_net *n, uint8_t *part);

#endif
