/* Whether two meshes of triangles have the same faces, whatever their order. */
#ifndef BRIO_TESTS_SAME_FACES_H
#define BRIO_TESTS_SAME_FACES_H

#include "brio/brio.h"
#include "harness.h"
#include <stdlib.h>
#include <string.h>

static inline int compare_triples(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* The faces with their vertices renamed, as a sorted list of triples that begin with their least vertex. */
static inline uint32_t *sorted_faces(const brio_mesh *mesh, const size_t *name) {
    uint32_t *list = malloc(12 * mesh->num_faces + 1);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        uint32_t v[3];
        int least = 0;
        for (int k = 0; k < 3; k++) {
            v[k] = mesh->face_vertices[3 * f + (size_t)k];
            if (name) v[k] = (uint32_t)name[v[k]];
            if (v[k] < v[least]) least = k;
        }
        for (int k = 0; k < 3; k++) list[3 * f + (size_t)k] = v[(k + least) % 3];
    }
    qsort(list, mesh->num_faces, 12, compare_triples);
    return list;
}

/* The faces of a, with its vertices renamed where there are names, are those of b. */
static inline void expect_same_faces(const brio_mesh *a, const size_t *name, const brio_mesh *b) {
    uint32_t *x = sorted_faces(a, name), *y = sorted_faces(b, NULL);
    EXPECT(a->num_faces == b->num_faces && !memcmp(x, y, 12 * a->num_faces), "%zu and %zu faces", a->num_faces,
           b->num_faces);
    free(x);
    free(y);
}

#endif
