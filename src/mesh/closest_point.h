/* The triangles of a surface, and the nearest of their points to a query point. */
#ifndef BRIO_MESH_CLOSEST_POINT_H
#define BRIO_MESH_CLOSEST_POINT_H

#include "base/memory.h"

typedef struct brio_box {
    double low[3], high[3];
} brio_box;

/** The faces of a mesh, cut into triangles (brio_cut_polygon), in a hierarchy of boxes.
 *
 *  I1. The hierarchy is a binary tree over the sequence of triangles. A node is a range of the sequence. Its children
 *  are the two halves of the range, the lower one shorter by at most 1. A range of at most BRIO_LEAF_TRIANGLES is a
 *  leaf. So ranges are not stored: they follow from the path from the root.
 *  I2. boxes[i] is the exact bounding box of the triangles of node i. The root is node 0; the children of node i are
 *  2i + 1 and 2i + 2.
 *  brio_triangle_tree_new writes the fields; afterwards any thread may read them. */
typedef struct brio_triangle_tree {
    const double *vertices; /* the mesh's array, not owned */
    uint32_t (*triangles)[3];
    size_t num_triangles; /* at least 1 */
    brio_box *boxes;
} brio_triangle_tree;

enum { BRIO_LEAF_TRIANGLES = 8 };

/** Builds the tree of a mesh that passes brio_mesh_check_faces and outlives the tree.   out  freed with
 *  brio_triangle_tree_free, also after a failure.   Cost: O(n log n); per triangle 12 to 24 bytes for boxes and 12 for
 *  indices, and 28 more during the call.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no face with three corners), BRIO_ERR_NO_MEMORY. */
brio_status brio_triangle_tree_new(brio_context *ctx, const brio_mesh *mesh, brio_triangle_tree *out);

void brio_triangle_tree_free(brio_context *ctx, brio_triangle_tree *tree);

/** Finds the point of the triangles nearest to p, and the index of a triangle that holds this point. Returns the
 *  square of the distance. */
double brio_closest_point(const brio_triangle_tree *tree, const double *p, double *closest, size_t *triangle);

/** Does what brio_closest_point does for points whose squared distance is below `bound`. Returns INFINITY, and writes
 *  nothing, where there is none; a smaller bound is faster. */
double brio_closest_within(const brio_triangle_tree *tree, const double *p, double bound, double *closest,
                           size_t *triangle);

/** Returns whether a point of the triangles is nearer to p than the root of `bound`: faster than finding the nearest
 *  one.
 *  triangle  looked at first; receives one that is so near, if there is one. */
bool brio_is_within(const brio_triangle_tree *tree, const double *p, double bound, size_t *triangle);

/** Write the point of one triangle nearest to p; the triangle may be degenerate. */
void brio_closest_on_triangle(const brio_triangle_tree *tree, size_t triangle, const double *p, double *closest);
void brio_closest_on_corners(const double *const corners[3], const double *p, double *closest);

#endif
