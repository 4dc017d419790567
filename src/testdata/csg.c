/* Building of trees of solids. */
#include "testdata/csg.h"

void brio_csg_clear(brio_csg *tree) {
    tree->num_nodes = 1;
    tree->num_points = 0;
    tree->root = 0;
    tree->full = false;
}

uint32_t brio_csg_add(brio_csg *tree, brio_csg_kind kind, const double *v, int count) {
    if (tree->num_nodes == BRIO_CSG_NODES) {
        tree->full = true;
        return 0;
    }
    brio_csg_node *n = &tree->nodes[tree->num_nodes];
    *n = (brio_csg_node){.kind = kind, .point = tree->num_points};
    for (int i = 0; i < count; i++) n->v[i] = v[i];
    return tree->num_nodes++;
}

void brio_csg_join(brio_csg *tree, uint32_t parent, uint32_t child) {
    if (!parent || !child) return;
    brio_csg_node *n = &tree->nodes[parent];
    if (n->last)
        tree->nodes[n->last].next = child;
    else
        n->first = child;
    n->last = child;
}

uint32_t brio_csg_over(brio_csg *tree, brio_csg_kind kind, uint32_t child, const double *v, int count) {
    uint32_t node = brio_csg_add(tree, kind, v, count);
    brio_csg_join(tree, node, child);
    return node;
}

void brio_csg_point(brio_csg *tree, uint32_t node, double x, double y, double z, double radius) {
    if (tree->num_points == BRIO_CSG_POINTS) tree->full = true;
    if (tree->full || !node) return;
    double *point = tree->points[tree->num_points++];
    point[0] = x;
    point[1] = y;
    point[2] = z;
    point[3] = radius;
    tree->nodes[node].points++;
}
