/* The triangles of a surface, and the point of them that is nearest to a given one. */
#ifndef BRIO_MESH_CLOSEST_POINT_H
#define BRIO_MESH_CLOSEST_POINT_H

#include "base/memory.h"

typedef struct brio_box {
    double low[3], high[3];
} brio_box;

/** The faces of a mesh, cut into fans of triangles from their first corners, in a hierarchy of boxes.
 *
 *  I1. The hierarchy is a binary tree over the sequence of triangles: a node is a range, its children are the two
 *      halves of the range (the lower one shorter by at most 1), and a range of at most BRIO_LEAF_TRIANGLES is a leaf.
 *      So ranges are not stored; they follow from the way down.
 *  I2. boxes[i] holds the triangles of node i, exactly; the children of node i are 2i + 1 and 2i + 2, the root is 0. */
typedef struct brio_triangle_tree {
    const double *vertices; /* of the mesh, not owned */
    uint32_t (*triangles)[3];
    size_t num_triangles; /* at least 1 */
    brio_box *boxes;
} brio_triangle_tree;

enum { BRIO_LEAF_TRIANGLES = 8 };

/** Builds the tree of a mesh that passes brio_mesh_check_faces and outlives the tree.   out  freed, also after a
 *  failure, with brio_triangle_tree_free.   Cost: O(n log n); 12 to 24 bytes for boxes and 12 for indices a triangle,
 *  and 16 more while it runs.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no face with three corners), BRIO_ERR_NO_MEMORY. */
brio_status brio_triangle_tree_new(brio_context *ctx, const brio_mesh *mesh, brio_triangle_tree *out);

void brio_triangle_tree_free(brio_context *ctx, brio_triangle_tree *tree);

/** Finds the point of the triangles nearest to p, and the triangle it is on. Returns the square of the distance. */
double brio_closest_point(const brio_triangle_tree *tree, const double *p, double *closest, size_t *triangle);

#endif
