/* When points of space are in a plane. */
#ifndef BRIO_PLANE_PLANE_FRAME_H
#define BRIO_PLANE_PLANE_FRAME_H

/** Points that are off a plane or a line by at most this share of the greatest coordinate are in it. Derived: the
 *  coordinates of a point are rounded by 2^-53 of themselves each, and so are those of the three points that span the
 *  frame; distances from it are wrong by less than 16 of these units. */
#define BRIO_FLAT_ROUNDING 0x1p-49

#endif
