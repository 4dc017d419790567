/* The result behind the public handle of a triangulation of the plane. */
#ifndef BRIO_PLANE_TRIANGULATION2_H
#define BRIO_PLANE_TRIANGULATION2_H

#include "base/context.h"

struct brio_triangulation2 {
    brio_context *ctx;
    brio_triangle *triangle;  /* finite ones first; vertices are the caller's indices or BRIO_INFINITE */
    uint32_t *representative; /* of each point of the caller */
    uint32_t *line;           /* dimension 1: the vertices in lexicographic order */
    size_t line_count;
    brio_delaunay2_stats stats;
    uint64_t points_hash; /* base/points_hash.h */
};

#endif
