/* A mesh of triangles whose edges collapse, as half-edges.
 *
 * Half-edge h of triangle h / 3 starts at vertex[h]; mate[h] is the half-edge of the same edge in the neighbouring
 * triangle. The half-edge with the smaller index names the edge.
 *
 * I1  vertex[h] is NONE in triangles that have vanished, and half_edge[v] is NONE when v has vanished.
 * I2  mate[mate[h]] == h; at the boundary mate[h] == h.
 * I3  error[h] is finite only if h names an edge that may be tried: neither end is on the boundary, the edge is not too
 *     long, its best point is within the tolerance, and no try has failed since one of its ends last changed.
 * I4  Vertices and triangles are numbered along a curve through space; vertex_name and face_name are their indices in
 *     the caller's mesh. */
#ifndef BRIO_MESH_COLLAPSE_MESH_H
#define BRIO_MESH_COLLAPSE_MESH_H

#include "mesh/quadric.h"
#include "mesh/simplify.h"

enum { BRIO_COLLAPSE_NONE = UINT32_MAX };

/* The bits of a vertex's mark. INSIDE: all neighbours belong to the vertex's block. SEEN: 0 between calls. */
enum { BRIO_COLLAPSE_BOUNDARY = 1, BRIO_COLLAPSE_INSIDE = 2, BRIO_COLLAPSE_SEEN = 4 };

typedef struct brio_collapse_guard brio_collapse_guard;

typedef struct {
    brio_context *ctx;
    const brio_collapse_options *options;
    size_t num_vertices, num_faces; /* at the beginning */
    double *position;               /* #V by 3; the caller's array */
    uint32_t *vertex, *mate;        /* #half-edges; vertex is the caller's array */
    float *error;                   /* #half-edges: in a unit in which the largest coordinate is about 1 */
    double unit;                    /* what an error is multiplied by to be in that unit */
    uint32_t *half_edge;            /* #V: a half-edge that starts at the vertex */
    uint8_t *marks;                 /* #V */
    double *spacing;                /* #V, or NULL: all 1 */
    brio_quadric *quadric;          /* #V */
    uint32_t *vertex_name, *face_name;
    uint32_t *second_order;     /* #V: the vertices along another curve */
    brio_collapse_guard *guard; /* collapses that make triangles cross are not tried; NULL: they are */
} brio_collapse_mesh;

static inline uint32_t brio_collapse_next(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t brio_collapse_before(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/** Returns the next half-edge round the start of h. */
static inline uint32_t brio_collapse_turn(const brio_collapse_mesh *m, uint32_t h) {
    return m->mate[brio_collapse_before(h)];
}

static inline uint32_t brio_collapse_end(const brio_collapse_mesh *m, uint32_t h) {
    return m->vertex[brio_collapse_next(h)];
}

static inline const double *brio_collapse_at(const brio_collapse_mesh *m, uint32_t v) {
    return m->position + 3 * (size_t)v;
}

/** Takes over the arrays of a mesh that is checked first: as brio_collapse_edges. Errors are not set.
 *  Returns the statuses of brio_collapse_edges; the caller calls brio_collapse_mesh_free in any case. */
brio_status brio_collapse_mesh_new(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options,
                                   brio_collapse_mesh *out);

/** Writes what is left over the arrays of the caller's mesh, in the caller's order, and frees m's other arrays. */
brio_status brio_collapse_mesh_write(brio_collapse_mesh *m, brio_mesh *mesh);

void brio_collapse_mesh_free(brio_collapse_mesh *m);

#endif
