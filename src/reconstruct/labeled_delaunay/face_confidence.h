/* How sure the surface is at each of its triangles. */
#ifndef BRIO_RECONSTRUCT_FACE_CONFIDENCE_H
#define BRIO_RECONSTRUCT_FACE_CONFIDENCE_H

#include "base/context.h"

/** Finds the probability that a triangle is right.
 *  corners     the confidences of its vertices.
 *  size        the radius of its circle, by the usual one there; INFINITY if its corners are collinear. */
float brio_face_confidence(const float corners[3], float size);

#endif
