/* The faces of a mesh that some balls may meet. */
#ifndef BRIO_SAMPLING_NEAR_FACES_H
#define BRIO_SAMPLING_NEAR_FACES_H

#include "base/context.h"

typedef struct {
    double centre[3], radius;
} brio_ball;

/** Lists the faces of three corners or more whose boxes meet the box of a ball, so that few balls need a tree of few faces.
 *  out  receives the faces alone; its vertices, and nothing else, are those of the mesh. The caller frees face_offsets
 *       and face_vertices, on failure too.
 *  Cost: O(F log B), in threads. Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_near_faces(brio_context *ctx, const brio_mesh *mesh, const brio_ball *ball, size_t num_balls,
                            brio_mesh *out);

#endif
