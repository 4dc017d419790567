/* Where a point is as seen from an offset surface of a solid. */
#ifndef BRIO_OFFSET_FIELD_H
#define BRIO_OFFSET_FIELD_H

#include "mesh/solid.h"

/** The offset of a solid's surface by `distance` > 0 to one side of it: outside, or with `inwards` inside. That side is
 *  the near side. Points of the other side, and points of the near side whose distance from the surface is less than
 *  `distance`, are covered; the offset is the boundary of what is covered. Any thread may read a field. */
typedef struct brio_offset_field {
    const brio_solid *solid;
    double distance;
    bool inwards;
} brio_offset_field;

/** Returns whether a point is on the far side of the solid's surface. */
bool brio_offset_is_beyond(const brio_offset_field *f, const double *p);

/** Writes a point of the offset close to p: where the way from p, straight away from the surface, reaches the distance;
 *  then, as long as another part of the surface is nearer than the distance, straight away from that part. From a point
 *  of the near side that is not covered, it is the nearest point of the offset.
 *  tolerance  most by which the point's distance may fall short.   normal  receives the direction, of length 1, of the
 *             last
 *  way.   Returns whether there is such a point after a few steps. */
bool brio_offset_reach(const brio_offset_field *f, const double *p, double tolerance, double *out, double *normal);

/** Writes the point of the offset where three sheets of it meet, or the point close to x on the crease of two, between
 *  the places `at`, which are around x. Creases are where balls about different parts of the surface meet; x is not
 *  covered.
 *  tolerance  most by which the distance of the point may be wrong.   Returns whether there is a crease. */
bool brio_offset_crease(const brio_offset_field *f, const double *x, const double *const at[3], double tolerance,
                        double *out);

#endif
