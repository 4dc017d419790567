/* Which faces of a mesh cross others, and the boxes of faces that are searched for it. */
#ifndef BRIO_MESH_CROSSING_FACES_H
#define BRIO_MESH_CROSSING_FACES_H

#include "base/context.h"
#include <math.h>

/** GROUP: boxes side by side. LEVELS: 2^32 faces have eleven levels. */
enum { BRIO_GROUP = 8, BRIO_GROUP_LEVELS = 12 };

/** Four numbers side by side; what comparing them gives. */
typedef float brio_box_lanes __attribute__((vector_size(16)));
typedef int32_t brio_box_bits __attribute__((vector_size(16)));

/** Box i is in lane i % 4 of half i / 4. */
typedef struct {
    brio_box_lanes low[3][2], high[3][2];
} brio_box_group;

typedef struct {
    float low[3], high[3];
} brio_face_box;

/** Faces along a space-filling curve. Box i of level 0 is that of the face at place i; box i of level l + 1 holds group
 *  i of level l. The last level has one group. Places without a box meet nothing.
 *  I1  Coordinates of boxes are those of the mesh under one function that never decreases, so that boxes of the mesh
 *      that meet have boxes here that meet. */
typedef struct {
    brio_context *ctx;
    const brio_mesh *mesh;
    uint32_t *order; /* faces with three corners or more */
    size_t count;    /* of them */
    brio_box_group *group;
    size_t first[BRIO_GROUP_LEVELS + 1]; /* the groups of level l are group[first[l]] to group[first[l + 1] - 1] */
    int levels;                          /* 0 if there are no faces */
    double low[3], size[3];              /* what I1's function takes to 0, and by what it divides; half of each */
} brio_face_groups;

/** A group that a search has still to look into. Of each level at most seven wait, and one is looked into. */
typedef struct {
    size_t group;
    int level;
} brio_group_branch;

/** Sorts the faces and finds their boxes.
 *  mesh  checked, kept.   out  freed with brio_face_groups_free, on failure too.
 *  Cost: O(F log F), in threads. Memory: 33 bytes a face, 24 more meanwhile.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_face_groups_new(brio_context *ctx, const brio_mesh *mesh, brio_face_groups *out);
void brio_face_groups_free(brio_face_groups *g);

/** Finds the boxes again, after vertices have moved. The order stays: the farther they have moved, the slower is the
 *  search. */
brio_status brio_face_groups_fit(brio_face_groups *g);

/** Writes the box of a face of a mesh. */
static inline void brio_face_bounds(const brio_mesh *m, size_t face, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (uint64_t h = m->face_offsets[face]; h < m->face_offsets[face + 1]; h++)
        for (int k = 0; k < 3; k++) {
            double x = m->vertices[3 * (size_t)m->face_vertices[h] + (size_t)k];
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
}

/** Returns the group of a level. */
static inline const brio_box_group *brio_group_at(const brio_face_groups *g, int level, size_t i) {
    return g->group + g->first[level] + i;
}

/** Returns the i-th box of a group. */
static inline brio_face_box brio_lane_of(const brio_box_group *g, size_t i) {
    brio_face_box b;
    for (int k = 0; k < 3; k++) b.low[k] = g->low[k][i / 4][i % 4], b.high[k] = g->high[k][i / 4][i % 4];
    return b;
}

/** Returns the box of the face at a place. */
static inline brio_face_box brio_box_at(const brio_face_groups *g, size_t place) {
    return brio_lane_of(brio_group_at(g, 0, place / BRIO_GROUP), place % BRIO_GROUP);
}

/** Returns which boxes of a group meet a box: bit i for the i-th. In lanes by hand: compilers unroll the loop. */
static inline unsigned brio_group_meets(const brio_box_group *g, const brio_face_box *b) {
    static const brio_box_bits BIT[2] = {{1, 2, 4, 8}, {16, 32, 64, 128}};
    brio_box_bits meets = {0};
    for (int half = 0; half < 2; half++) {
        brio_box_bits hit = BIT[half];
        for (int k = 0; k < 3; k++)
            hit &= (brio_box_bits)(g->low[k][half] <= b->high[k]) & (brio_box_bits)(g->high[k][half] >= b->low[k]);
        meets |= hit;
    }
    return (unsigned)(meets[0] | meets[1] | meets[2] | meets[3]);
}

/** Returns whether the box of a face meets a box of the mesh. May say so where they are apart by less than rounding. */
bool brio_groups_meet(const brio_face_groups *g, const double low[3], const double high[3]);

/* --- crossings --- */

/** Counts pairs as brio_mesh_self_intersections does, with its cost and errors, and tells which faces they are of.
 *  only     NULL, or #F: 1 for the faces of which one at least is in each pair that counts.
 *  crosses  NULL, or #F: receives 1 or 0. */
brio_status brio_crossing_faces(brio_context *ctx, const brio_mesh *mesh, const uint8_t *only, uint8_t *crosses,
                                int64_t *pairs);

/** Counts and tells the same of faces whose boxes are found already: for several searches, between which vertices move
 *  a little. */
brio_status brio_search_crossings(const brio_face_groups *g, const uint8_t *only, uint8_t *crosses, int64_t *pairs);

#endif
