/* What is joined to what in a polygon mesh: faces across edges, corners round vertices.
 *
 * edge_rings links the half-edges of each edge into a ring. Two union-finds then run over the rings. The first joins
 * faces across every edge; its sets are patches. The second joins corners at both ends of every edge of two faces; its
 * sets are the fans. A vertex is manifold when its corners form one fan.
 *
 * The mesh may be a part of a surface. Then its own vertices are those of which it has all faces, and other vertices,
 * and edges between these, count for nothing. An edge is counted where its vertex with the lesser index is own. So over
 * parts each of whose vertices is own in one of them, each vertex and each edge is counted once. */
#ifndef BRIO_CERTIFICATE_TOPOLOGY_H
#define BRIO_CERTIFICATE_TOPOLOGY_H

#include "base/context.h"
#include "base/union_find.h"

typedef struct {
    brio_context *ctx;
    const brio_mesh *mesh;
    const uint8_t *own;    /* #V; NULL: all are */
    const uint64_t *index; /* #V, where `own` is given; no two are equal */
    size_t corners;
    uint32_t *ring;    /* #corners: edge rings (edge_rings.h) */
    uint32_t *face_of; /* #corners; NULL where all faces are triangles */
    uint32_t *fan;     /* #corners: union-find of the corners */
    uint32_t *patch;   /* #F: union-find of the faces */
    uint8_t *vertex;   /* #V: bits of brio_vertex_state */
} brio_topology;

enum brio_vertex_state {
    BRIO_VERTEX_SEEN = 1,
    BRIO_VERTEX_TWO_FANS = 2,
    BRIO_VERTEX_IN_DEGENERATE_FACE = 4,
    BRIO_VERTEX_USED = 8
};

/** Makes the edge rings, and a set of each face and of each corner. The mesh has passed brio_mesh_check_faces. On
 *  failure, too, the caller calls brio_topology_free.   own, index  as above; both NULL for a whole mesh. */
brio_status brio_topology_new(brio_context *ctx, const brio_mesh *mesh, const uint8_t *own, const uint64_t *index,
                              brio_topology *t);
void brio_topology_free(brio_topology *t);

static inline uint32_t brio_face_at(const brio_topology *t, uint32_t h) {
    return t->face_of ? t->face_of[h] : h / 3;
}

static inline uint32_t brio_next_corner(const brio_topology *t, uint32_t h) {
    const uint64_t *offsets = t->mesh->face_offsets;
    uint32_t f = brio_face_at(t, h);
    return h + 1 < offsets[f + 1] ? h + 1 : (uint32_t)offsets[f];
}

static inline bool brio_is_own(const brio_topology *t, uint32_t vertex) {
    return !t->own || t->own[vertex];
}

/** Returns whether the start of a half-edge is own. The end is brio_next_corner. */
static inline bool brio_starts_own(const brio_topology *t, uint32_t h) {
    return brio_is_own(t, t->mesh->face_vertices[h]);
}

/** Returns whether the edge of a half-edge is counted here. */
static inline bool brio_counts_edge(const brio_topology *t, uint32_t h) {
    if (!t->own) return true;
    uint32_t a = t->mesh->face_vertices[h], b = t->mesh->face_vertices[brio_next_corner(t, h)];
    return t->own[t->index[a] < t->index[b] ? a : b];
}

/** Counts of the edges that a closed oriented manifold does not have. */
typedef struct {
    size_t boundary, nonmanifold, flipped;
} brio_edge_faults;

/** Joins the faces across every edge, and the corners at both ends of every edge of two faces. Counts edges. */
brio_status brio_topology_join(const brio_topology *t, brio_edge_faults *out);

/** Marks the vertices of degenerate faces. Counts the degenerate faces, including faces without corners, and those of
 *  fewer than three corners. */
brio_status brio_topology_degenerate(const brio_topology *t, size_t *degenerate, size_t *thin);

typedef struct {
    int64_t faces, edges, vertices, loops;
} brio_component;

/** Writes the patch of each face, as the number of the patch's first face among those of all patches.
 *  number  #F.   *count  receives how many patches there are. */
brio_status brio_topology_patches(const brio_topology *t, uint32_t *number, size_t *count);

/** Adds the faces of a whole mesh or a part to the counts of components.   number  #F: the component of each. */
brio_status brio_topology_count_faces(const brio_topology *t, const uint32_t *number, brio_component *components);

/** Adds the edges, and one vertex for each fan. Marks vertices of two fans.
 *  skipped  NULL, or #corners: not 0 at the roots of fans that are not counted.
 *  *pinched  receives whether there is such a vertex: brio_topology_pinched. */
brio_status brio_topology_count(const brio_topology *t, const uint32_t *number, brio_component *components,
                                const uint8_t *skipped, bool *pinched);

/** Returns how many own vertices have faces. With one thread. */
size_t brio_topology_used(const brio_topology *t);

/** Lists the fans of own vertices that have several, as pairs: the vertex in the upper 32 bits, the component below.
 *  Sorted.   *fans  the caller's: brio_release. */
brio_status brio_topology_pinched(const brio_topology *t, const uint32_t *number, uint64_t **fans, size_t *count);

/** Joins fans across edges of more than two faces, and at the two ends of each boundary edge whose ends are both own.
 *  In a whole mesh every resulting set with a boundary edge is a boundary loop. Afterwards t->fan no longer describes
 *  the fans. */
brio_status brio_topology_join_loops(const brio_topology *t);

/** Counts the own vertices that are not manifold. After brio_topology_degenerate and brio_topology_count. */
brio_status brio_topology_bad_vertices(const brio_topology *t, size_t *count);

/** Returns the genus of a component: (2 - chi - loops) / 2, rounded down. */
int64_t brio_component_genus(const brio_component *c);

/** Writes the genera and their sum, the number of components and that of the loops: the component with the most faces
 *  comes first, and of components with equally many the one of the greatest genus. Components without faces are left
 *  out.   components  sorted. */
brio_status brio_components_list(brio_context *ctx, const brio_component *components, size_t count,
                                 brio_certificate *out);

#endif
